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
    4.0 * ggx.d(h) * ggx.shadowing(wo, wi) * wo.dot(h) * jacobian(wo, wi, h, eta)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// With basic radiance kept, the value towards the denser side is η² times that back.
    #[test]
    fn single_scattering_is_reciprocal_but_for_the_index() {
        for eta in [0.7_f32, 1.1, 1.5, 2.4] {
            let wo = Vec3::new(0.3, 0.1, 0.9).normalize();
            let normal = Vec3::new(-0.1, 0.05, 0.99).normalize();
            let wi = direction(wo, normal, eta).unwrap();
            let h = half_vector(wo, wi, eta).unwrap();
            assert!((h - normal).length() < 1e-5);
            // Seen from the other side, that side is up.
            let (back_wo, back_wi) = (-wi, -wo);
            let back_h = half_vector(back_wo, back_wi, 1.0 / eta).unwrap();
            for alpha in [0.05, 0.3, 1.0] {
                let ggx = Ggx::round(alpha);
                let there = f_cos(ggx, wo, wi, h, eta) / wi.z.abs();
                let back = f_cos(ggx, back_wo, back_wi, back_h, 1.0 / eta) / back_wi.z.abs();
                assert!((there / (eta * eta * back) - 1.0).abs() < 1e-4, "{eta} {alpha}: {there} {back}");
            }
        }
    }

    #[test]
    fn no_microfacet_refracts_to_the_same_side() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        assert!(half_vector(wo, Vec3::new(-0.6, 0.0, 0.8), 1.5).is_none());
        assert!(direction(Vec3::new(0.9, 0.0, 0.436), Vec3::Z, 1.0 / 1.5).is_none());
    }
}
