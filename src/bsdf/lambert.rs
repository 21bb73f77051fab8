//! Lambert's diffuse reflection: f = albedo/π.

use super::lobe::{Drawn, Scatter, Sides, Value};
use crate::math::{Rgb, Vec3};
use crate::sampling::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};

/// White.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lambert;

impl Scatter for Lambert {
    fn albedo(&self) -> Sides {
        Sides::above(Rgb::WHITE)
    }

    #[inline]
    fn eval(&self, _wo: Vec3, wi: Vec3) -> Value {
        // |cos θi|/π, which is the density of sampling too; 0 below the surface.
        let pdf = pdf_cosine_hemisphere(wi.z);
        Value { f_cos: Rgb::splat(pdf), pdf }
    }

    #[inline]
    fn sample(&self, _wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        Some(Drawn::plain(sample_cosine_hemisphere(u)))
    }
}
