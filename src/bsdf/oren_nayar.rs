//! Diffuse reflection at rough surfaces that keeps its energy.
//!
//! Yasuhiro Fujii, *A tiny improvement of Oren–Nayar reflectance model*, for single scattering; what
//! is lost comes back as one lobe of several bounces, as in Jamie Portsmouth, Peter Kutz and Stephen Hill,
//! *EON: A Practical Energy-Preserving Rough Diffuse BRDF*, JCGT 14(1), 2025, which is how Cycles has it.

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

use super::lobe::{Drawn, Scatter, Sides, Value};
use crate::math::{Rgb, Vec3, safe_acos, safe_sqrt, sqr};
use crate::sampling::warp::{pdf_cosine_hemisphere, sample_cosine_hemisphere};

/// Of a color that is not part of it: the value has to be multiplied by the color.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrenNayar {
    a: f32,
    b: f32,
    /// Of several bounces, but for what depends on `wi`.
    several: Rgb,
    albedo: Rgb,
}

impl OrenNayar {
    /// Of roughness 0 (which is Lambert's) to 1, where the surface is of diffuse `color`. Without `multiscatter`
    /// single scattering alone.
    pub fn new(color: Rgb, roughness: f32, multiscatter: bool, wo: Vec3) -> Self {
        let sigma = roughness.clamp(0.0, 1.0);
        let a = 1.0 / (PI + sigma * (FRAC_PI_2 - 2.0 / 3.0));
        let b = sigma * a;
        // Albedos of single scattering: over the hemisphere, and towards `wo`.
        let average = a * PI + (TAU - 5.6) / 3.0 * b;
        let seen = albedo(a, b, wo.z);
        let lost = (1.0 - average).max(0.0);
        let missing = if multiscatter { average / lost.max(1e-6) * (1.0 - seen).max(0.0) } else { 0.0 };
        // The value is multiplied by the color once more. The paper has one factor of the color here; Cycles has two,
        // which takes 6 % from a gray of 0.4 of roughness 1 seen from above.
        let color = color.map(|c| c.clamp(0.0, 1.0));
        let several = color.map(|c| FRAC_1_PI * sqr(c) * missing / (1.0 - c * lost));
        let albedo = several.map(|s| seen + s * PI * lost);
        Self { a, b, several, albedo }
    }
}

/// ∫ f cos over the hemisphere for single scattering, towards a direction of cosine `cos`.
fn albedo(a: f32, b: f32, cos: f32) -> f32 {
    a * PI + b * g(cos)
}

/// Fujii's G.
fn g(cos: f32) -> f32 {
    if cos < 1e-6 {
        return FRAC_PI_2 - 2.0 / 3.0 - cos;
    }
    let sin = safe_sqrt(1.0 - cos * cos);
    sin * (safe_acos(cos) - 2.0 / 3.0 - sin * cos) + 2.0 / 3.0 * (sin / cos) * (1.0 - sqr(sin) * sin)
}

impl Scatter for OrenNayar {
    fn albedo(&self) -> Sides {
        Sides::above(self.albedo)
    }

    fn color(&self) -> Sides {
        Sides::above(Rgb::WHITE)
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Value {
        if wi.z <= 0.0 {
            return Value::default();
        }
        let along = wi.dot(wo) - wi.z * wo.z;
        let t = if along > 0.0 { along / wi.z.max(wo.z) } else { along };
        let single = self.a + self.b * t;
        let lost = 1.0 - albedo(self.a, self.b, wi.z);
        let f_cos = self.several.map(|several| wi.z * (single + several * lost).max(0.0));
        Value { f_cos, pdf: pdf_cosine_hemisphere(wi.z) }
    }

    fn sample(&self, _wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        Some(Drawn::plain(sample_cosine_hemisphere(u)))
    }
}
