//! The GGX distribution of microfacets, isotropic.
//!
//! D(h) = α² / (π (x² + y² + α²z²)²): Walter, Marschner, Li and Torrance, *Microfacet Models for
//! Refraction through Rough Surfaces*, EGSR 2007. Smith's shadowing, correlated in height: Heitz,
//! JCGT 3(2), 2014. Visible normals: Heitz, JCGT 7(4), 2018, by the spherical caps of Dupuy and
//! Benyoub, *Sampling Visible GGX Normals with Spherical Caps*, HPG 2023; for reflection bounded as
//! in Tokuyoshi and Eto, *Bounded VNDF Sampling for Smith–GGX Reflections*, SIGGRAPH Asia 2023.
//!
//! Directions `w` have z > 0 here. All terms are written so that none cancels as α goes to 0.

use std::f32::consts::{FRAC_1_PI, TAU};

use crate::math::{Vec3, safe_sqrt, sqr};

/// Width below which the distribution counts as a mirror. A lobe of 10⁻⁴ rad can't be told from one,
/// and half vectors in f32 resolve no less than a thousandth of it.
pub(super) const MIN_ALPHA: f32 = 1e-4;

/// GGX with width `alpha` ≥ [`MIN_ALPHA`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Ggx {
    pub alpha: f32,
}

impl Ggx {
    /// Density of microfacet normals.
    #[inline]
    pub fn d(self, h: Vec3) -> f32 {
        let alpha_squared = sqr(self.alpha);
        alpha_squared * FRAC_1_PI / sqr(h.x * h.x + h.y * h.y + alpha_squared * h.z * h.z)
    }

    /// |z| √(1 + α² tan²θ) = |z| (1 + 2Λ).
    #[inline]
    pub fn slant(self, w: Vec3) -> f32 {
        (w.z * w.z + sqr(self.alpha) * (w.x * w.x + w.y * w.y)).sqrt()
    }

    /// G2(wo, wi) / (4 zo zi) for |z| of both.
    #[inline]
    pub fn visibility(self, wo: Vec3, wi: Vec3) -> f32 {
        0.5 / (wo.z.abs() * self.slant(wi) + wi.z.abs() * self.slant(wo))
    }

    /// A normal visible from `wo`, with density D(h) G1(wo) (wo·h) / zo.
    #[inline]
    pub fn sample_visible(self, wo: Vec3, u: [f32; 2]) -> Vec3 {
        let stretched = self.stretch(wo);
        self.unstretch(stretched + cap(stretched.z, u))
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
        self.unstretch(stretched + cap(self.bound(wo) * stretched.z, u))
    }

    /// Density of the direction reflected at [`Ggx::sample_bounded`], in solid angle of `wi`.
    #[inline]
    pub fn pdf_bounded(self, wo: Vec3, h: Vec3) -> f32 {
        0.5 * self.d(h) / (self.bound(wo) * wo.z + self.slant(wo))
    }

    /// The factor k by which the cap is cut: Tokuyoshi and Eto, equation 5.
    #[inline]
    fn bound(self, wo: Vec3) -> f32 {
        let alpha_squared = sqr(self.alpha.min(1.0));
        let s_squared = sqr(1.0 + (wo.x * wo.x + wo.y * wo.y).sqrt());
        (1.0 - alpha_squared) * s_squared / (s_squared + alpha_squared * wo.z * wo.z)
    }

    #[inline]
    fn stretch(self, w: Vec3) -> Vec3 {
        Vec3::new(self.alpha * w.x, self.alpha * w.y, w.z).normalize()
    }

    #[inline]
    fn unstretch(self, h: Vec3) -> Vec3 {
        Vec3::new(self.alpha * h.x, self.alpha * h.y, h.z.max(0.0)).normalize_or(Vec3::Z)
    }
}

/// A uniform direction of the spherical cap z ≥ −`depth`.
#[inline]
fn cap(depth: f32, u: [f32; 2]) -> Vec3 {
    let (sin, cos) = (TAU * u[0]).sin_cos();
    let z = (1.0 - u[1]) * (1.0 + depth) - depth;
    let r = safe_sqrt((1.0 - z) * (1.0 + z));
    Vec3::new(r * cos, r * sin, z)
}
