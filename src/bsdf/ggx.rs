//! The GGX distribution of microfacets, as wide along x as `x` says and along y as `y` says.
//!
//! D(h) = 1 / (π αx αy ((x/αx)² + (y/αy)² + z²)²): Walter, Marschner, Li and Torrance, *Microfacet Models for
//! Refraction through Rough Surfaces*, EGSR 2007. Smith's shadowing, correlated in height: Heitz,
//! JCGT 3(2), 2014. Visible normals: Heitz, JCGT 7(4), 2018, by the spherical caps of Dupuy and
//! Benyoub, *Sampling Visible GGX Normals with Spherical Caps*, HPG 2023; for reflection bounded as
//! in Tokuyoshi and Eto, *Bounded VNDF Sampling for Smith–GGX Reflections*, SIGGRAPH Asia 2023, by the
//! smaller width.
//!
//! Directions `w` have z > 0 here. All terms are written so that none cancels as α goes to 0.

use std::f32::consts::FRAC_1_PI;

use crate::math::{Vec3, sqr};
use crate::sampling::warp::sample_cone;

/// Width below which the distribution counts as a mirror. A lobe of 10⁻⁴ rad can't be told from one,
/// and half vectors in f32 resolve no less than a thousandth of it.
pub(super) const MIN_ALPHA: f32 = 1e-4;

/// GGX with widths ≥ [`MIN_ALPHA`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    pub x: f32,
    pub y: f32,
}

impl Ggx {
    /// As wide in every direction.
    #[cfg(test)]
    pub fn round(alpha: f32) -> Self {
        Self { x: alpha, y: alpha }
    }

    /// Of widths that are told from a mirror's; `None` for a mirror.
    pub fn new([x, y]: [f32; 2]) -> Option<Self> {
        (x.max(y) >= MIN_ALPHA).then(|| Self { x: x.max(MIN_ALPHA), y: y.max(MIN_ALPHA) })
    }

    /// At least as wide as `least` in every direction.
    pub fn widened(this: Option<Self>, least: f32) -> Option<Self> {
        let Self { x, y } = this.unwrap_or(Self { x: 0.0, y: 0.0 });
        Self::new([x.max(least), y.max(least)])
    }

    /// The width of a round distribution that is about as rough.
    pub fn mean(self) -> f32 {
        (self.x * self.y).sqrt()
    }

    /// Density of microfacet normals.
    #[inline]
    pub fn d(self, h: Vec3) -> f32 {
        let area = self.x * self.y;
        FRAC_1_PI / (area * sqr(sqr(h.x / self.x) + sqr(h.y / self.y) + h.z * h.z))
    }

    /// |z| √(1 + α² tan²θ) = |z| (1 + 2Λ).
    #[inline]
    pub fn slant(self, w: Vec3) -> f32 {
        (w.z * w.z + sqr(self.x * w.x) + sqr(self.y * w.y)).sqrt()
    }

    /// G2(wo, wi) / (4 cos θo) for directions on either side: shadowing correlated in height.
    #[inline]
    pub fn shadowing(self, wo: Vec3, wi: Vec3) -> f32 {
        let (zo, zi) = (wo.z.abs(), wi.z.abs());
        let sum = zo * self.slant(wi) + zi * self.slant(wo);
        if sum > 0.0 { 0.5 * zi / sum } else { 0.0 }
    }

    /// A normal visible from `wo`, with density D(h) G1(wo) (wo·h) / zo.
    #[inline]
    pub fn sample_visible(self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let stretched = self.stretch(wo);
        self.unstretch(stretched + sample_cone(u, 1.0 + stretched.z))
    }

    /// Density of [`Ggx::sample_visible`].
    #[inline]
    pub fn pdf_visible(self, wo: Vec3, h: Vec3) -> f32 {
        2.0 * self.d(h) * wo.dot(h).max(0.0) / (wo.z + self.slant(wo))
    }

    /// A normal visible from `wo` that mostly reflects upwards.
    #[inline]
    pub fn sample_bounded(self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let stretched = self.stretch(wo);
        self.unstretch(stretched + sample_cone(u, 1.0 + self.bound(wo) * stretched.z))
    }

    /// Density of the direction reflected at [`Ggx::sample_bounded`], in solid angle of `wi`.
    #[inline]
    pub fn pdf_bounded(self, wo: Vec3, h: Vec3) -> f32 {
        0.5 * self.d(h) / (self.bound(wo) * wo.z + self.slant(wo))
    }

    /// The factor k by which the cap is cut: Tokuyoshi and Eto, equation 5.
    #[inline]
    fn bound(self, wo: Vec3) -> f32 {
        let alpha_squared = sqr(self.x.min(self.y).min(1.0));
        let s_squared = sqr(1.0 + (wo.x * wo.x + wo.y * wo.y).sqrt());
        (1.0 - alpha_squared) * s_squared / (s_squared + alpha_squared * wo.z * wo.z)
    }

    #[inline]
    fn stretch(self, w: Vec3) -> Vec3 {
        Vec3::new(self.x * w.x, self.y * w.y, w.z).normalize()
    }

    #[inline]
    fn unstretch(self, h: Vec3) -> Vec3 {
        Vec3::new(self.x * h.x, self.y * h.y, h.z.max(0.0)).normalize_or(Vec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn views() -> impl Iterator<Item = Vec3> {
        [1e-3_f32, 0.1, 0.5, 0.99, 1.0].into_iter().map(|z| Vec3::new((1.0 - z * z).sqrt(), 0.0, z))
    }

    /// ∫ D(h) (h·z) dh = 1, on a grid in the tangent of the angle over α.
    #[test]
    fn projected_area_is_one() {
        for alpha in [1e-4_f32, 0.01, 0.3, 1.0] {
            let (ggx, n) = (Ggx::round(alpha), 4000);
            let mut sum = 0.0;
            for i in 0..n {
                // tan²θ = α² x/(1 − x) makes D cos θ dω uniform in x.
                let x = (i as f32 + 0.5) / n as f32;
                let tan_squared = sqr(alpha) * x / (1.0 - x);
                let cos_squared = 1.0 / (1.0 + tan_squared);
                let h = Vec3::new((tan_squared * cos_squared).sqrt(), 0.0, cos_squared.sqrt());
                let jacobian = sqr(alpha) * sqr(cos_squared) * sqr(1.0 / (1.0 - x));
                sum += f64::from(ggx.d(h) * jacobian * std::f32::consts::PI) / f64::from(n);
            }
            assert!((sum - 1.0).abs() < 1e-3, "{alpha}: {sum}");
        }
    }

    /// Drawn normals face the view, and weights G2/G1 never exceed 1.
    #[test]
    fn drawn_normals_are_visible() {
        for alpha in [1e-4, 0.05, 0.5, 1.0] {
            let ggx = Ggx::round(alpha);
            for wo in views() {
                for i in 0..200 {
                    let u = [(i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877).fract()];
                    for h in [ggx.sample_visible(wo, u), ggx.sample_bounded(wo, u)] {
                        assert!((h.length() - 1.0).abs() < 1e-5 && h.z >= 0.0);
                        assert!(wo.dot(h) > -1e-4, "{alpha} {wo} {h}");
                    }
                    let wi = Vec3::new(u[0] - 0.5, u[1] - 0.5, 0.3).normalize();
                    let ratio = 2.0 * ggx.shadowing(wo, wi) * (wo.z + ggx.slant(wo));
                    assert!((0.0..=1.0 + 1e-5).contains(&ratio));
                }
            }
        }
    }

    /// Bounding only takes away directions below the surface: its density is never smaller.
    #[test]
    fn bounding_raises_the_density() {
        for alpha in [0.05, 0.5, 1.0] {
            let ggx = Ggx::round(alpha);
            for wo in views() {
                let h = (wo + Vec3::Z).normalize();
                let visible = 0.5 * ggx.d(h) / (wo.z + ggx.slant(wo));
                assert!(ggx.pdf_bounded(wo, h) >= visible * (1.0 - 1e-5));
            }
        }
    }
}
