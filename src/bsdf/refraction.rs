//! Refraction at GGX microfacets, Walter et al. 2007, equation 21:
//! f cos θi = (1 − F) D G2 |wo·h| |wi·h| η² / (cos θo (wo·h + η wi·h)²), without the Fresnel term.
//!
//! η is the index on `wi`'s side over that on `wo`'s side. The value is of radiance carried from
//! `wi` to `wo` with the basic radiance L/n² kept, so that a path through glass and out again needs
//! no factor; within the glass radiance is understood divided by n².

use super::fresnel::refract;
use super::ggx::Ggx;
use crate::math::{Vec3, sqr};

/// The microfacet normal, z > 0, at which `wi` below is `wo` above refracted; `None` where no
/// microfacet does that.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3, eta: f32) -> Option<Vec3> {
    let h = (wo + wi * eta).try_normalize()?;
    let h = if h.z < 0.0 { -h } else { h };
    (h.z > 0.0 && wo.dot(h) > 0.0 && wi.dot(h) < 0.0).then_some(h)
}

/// Change of measure from `h` to `wi`, |wi·h| η² / (wo·h + η wi·h)².
#[inline]
fn jacobian(wo: Vec3, wi: Vec3, h: Vec3, eta: f32) -> f32 {
    wi.dot(h).abs() * sqr(eta) / sqr(wo.dot(h) + eta * wi.dot(h))
}

/// The value without the Fresnel term.
#[inline]
pub(super) fn f_cos(ggx: Ggx, wo: Vec3, wi: Vec3, h: Vec3, eta: f32) -> f32 {
    4.0 * ggx.d(h) * ggx.visibility(wo, wi) * wi.z.abs() * wo.dot(h) * jacobian(wo, wi, h, eta)
}

/// Density of `wi` where `h` is drawn from the visible normals, in solid angle.
#[inline]
pub(super) fn pdf(ggx: Ggx, wo: Vec3, wi: Vec3, h: Vec3, eta: f32) -> f32 {
    ggx.pdf_visible(wo, h) * jacobian(wo, wi, h, eta)
}

/// `wo` refracted at `h`; `None` for total internal reflection or a direction that stays above.
#[inline]
pub(super) fn direction(wo: Vec3, h: Vec3, eta: f32) -> Option<Vec3> {
    refract(wo, h, eta).filter(|wi| wi.z < 0.0)
}
