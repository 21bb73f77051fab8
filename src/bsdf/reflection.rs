//! Reflection at GGX microfacets: f cos θi = F(wo·h) D(h) G2 / (4 cos θo), without the Fresnel term.

use super::ggx::Ggx;
use crate::math::Vec3;

/// Half vector of a reflection, wo and wi above the surface.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> Vec3 {
    (wo + wi).normalize_or(Vec3::Z)
}

/// The mirror image of `wo` about `h`.
#[inline]
pub(super) fn reflect(wo: Vec3, h: Vec3) -> Vec3 {
    (h * (2.0 * wo.dot(h)) - wo).normalize()
}

/// D G2 / (4 cos θo) for half vector `h`.
#[inline]
pub(super) fn f_cos(ggx: Ggx, wo: Vec3, wi: Vec3, h: Vec3) -> f32 {
    ggx.d(h) * ggx.shadowing(wo, wi)
}

/// Density of [`sample`].
#[inline]
pub(super) fn pdf(ggx: Ggx, wo: Vec3, h: Vec3) -> f32 {
    ggx.pdf_bounded(wo, h)
}

/// Density of reflecting at a visible normal, whether upwards or not.
#[inline]
pub(super) fn pdf_visible(ggx: Ggx, wo: Vec3, h: Vec3) -> f32 {
    0.5 * ggx.d(h) / (wo.z + ggx.slant(wo))
}

/// A reflected direction; `None` where it points into the surface.
#[inline]
pub(super) fn sample(ggx: Ggx, wo: Vec3, u: [f32; 2]) -> Option<Vec3> {
    let wi = reflect(wo, ggx.sample_bounded(wo, u));
    (wi.z > 0.0).then_some(wi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_scattering_is_reciprocal() {
        let (a, b) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.9, 0.1).normalize());
        let h = half_vector(a, b);
        for alpha in [1e-4, 0.01, 0.3, 1.0] {
            let ggx = Ggx { alpha };
            let (f, g) = (f_cos(ggx, a, b, h) / b.z, f_cos(ggx, b, a, h) / a.z);
            assert!((f / g - 1.0).abs() < 1e-5, "{alpha}: {f} {g}");
        }
    }
}
