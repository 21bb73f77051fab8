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
    ggx.d(h) * ggx.visibility(wo, wi) * wi.z
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
