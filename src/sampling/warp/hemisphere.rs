//! The upper hemisphere, by cosine and uniformly, and the sphere.

use std::f32::consts::FRAC_1_PI;

use super::{sample_cone, sample_disk};
use crate::math::{ONE_MINUS_EPSILON, Vec3};

/// Density of [`sample_uniform_hemisphere`]: 1/(2π).
pub const PDF_UNIFORM_HEMISPHERE: f32 = 0.5 * FRAC_1_PI;

/// Density of [`sample_uniform_sphere`]: 1/(4π).
pub const PDF_UNIFORM_SPHERE: f32 = 0.25 * FRAC_1_PI;

/// A direction with density cos θ/π: the disk projected up (Malley's method). Its z is positive,
/// never 0.
#[inline]
pub fn sample_cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let [x, y] = sample_disk(u);
    let z_squared = 1.0 - (x * x + y * y).min(ONE_MINUS_EPSILON);
    Vec3::new(x, y, z_squared.sqrt())
}

/// Density of [`sample_cosine_hemisphere`]; 0 below the horizon.
#[inline]
pub fn pdf_cosine_hemisphere(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// A uniform direction with z ≥ 0.
#[inline]
pub fn sample_uniform_hemisphere(u: [f32; 2]) -> Vec3 {
    sample_cone(u, 1.0)
}

/// A uniform direction.
#[inline]
pub fn sample_uniform_sphere(u: [f32; 2]) -> Vec3 {
    sample_cone(u, 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_and_above() {
        for i in 0..=64 {
            for j in 0..=64 {
                let u = [i as f32 / 64.0, j as f32 / 64.0];
                let w = sample_cosine_hemisphere(u);
                assert!(w.z > 0.0 && (w.length() - 1.0).abs() < 1e-6);
                assert!((sample_uniform_sphere(u).length() - 1.0).abs() < 1e-6);
                assert!(sample_uniform_hemisphere(u).z >= 0.0);
            }
        }
    }
}
