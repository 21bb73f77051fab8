//! Lambert's diffuse reflection: f = albedo/π.

use crate::math::Vec3;
use crate::sampling::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};

/// |cos θi|/π, which is the density of sampling too; 0 below the surface.
#[inline]
pub(super) fn f_cos(wi: Vec3) -> f32 {
    pdf_cosine_hemisphere(wi.z)
}

/// A direction above the surface.
#[inline]
pub(super) fn sample(u: [f32; 2]) -> Vec3 {
    sample_cosine_hemisphere(u)
}
