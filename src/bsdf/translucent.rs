//! Diffuse passage: Lambert's law on the other side of the surface.

use super::lobe::{Drawn, Scatter, Sides, Value};
use super::thin::mirrored;
use crate::math::{Rgb, Vec3};
use crate::sampling::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};

/// White.
#[derive(Clone, Copy, Debug)]
pub(super) struct Translucent;

impl Scatter for Translucent {
    fn albedo(&self) -> Sides {
        Sides { above: Rgb::BLACK, below: Rgb::WHITE }
    }

    fn eval(&self, _wo: Vec3, wi: Vec3) -> Value {
        let pdf = pdf_cosine_hemisphere(-wi.z);
        Value { f_cos: Rgb::splat(pdf), pdf }
    }

    fn sample(&self, _wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        Some(Drawn::plain(mirrored(sample_cosine_hemisphere(u))))
    }

    fn transmits(&self) -> bool {
        true
    }
}
