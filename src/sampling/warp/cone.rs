//! Directions within a cone about z, from a laser's width to the whole sphere.
//!
//! With h = 1 − cos θ, solid angle is 2πh, so h is uniform; sin²θ = h(2 − h) holds without
//! cancellation however narrow the cone. The azimuth comes from the concentric disk.

use std::f32::consts::TAU;

use super::sample_disk;
use crate::math::{Vec3, safe_sqrt};

/// 1 − cos θ of an angle θ ≤ 90° given by its sin²θ, exact for small angles:
/// sin²/(1 + √(1 − sin²)).
#[inline]
pub fn one_minus_cos(sin_squared: f32) -> f32 {
    sin_squared / (1.0 + safe_sqrt(1.0 - sin_squared))
}

/// A uniform direction of the cone whose half angle θ has the given 1 − cos θ, in (0, 2].
#[inline]
pub fn sample_cone(u: [f32; 2], one_minus_cos_max: f32) -> Vec3 {
    let [x, y] = sample_disk(u);
    let h = (x * x + y * y).min(1.0) * one_minus_cos_max;
    let stretch = safe_sqrt(one_minus_cos_max * (2.0 - h));
    Vec3::new(x * stretch, y * stretch, 1.0 - h)
}

/// Density of [`sample_cone`] within the cone, in solid angle.
#[inline]
pub fn pdf_cone(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_cones_keep_their_width() {
        for sin in [1e-7_f32, 1e-4, 1e-2, 0.5, 0.999] {
            let h = one_minus_cos(sin * sin);
            let exact = 1.0 - (1.0 - f64::from(sin * sin)).sqrt();
            let exact = if sin < 1e-3 { f64::from(sin * sin) / 2.0 } else { exact };
            assert!((f64::from(h) / exact - 1.0).abs() < 1e-5, "{sin}");
            let w = sample_cone([0.0, 0.3], h);
            assert!(((w.x * w.x + w.y * w.y).sqrt() / sin - 1.0).abs() < 1e-5, "{sin} {w}");
        }
    }
}
