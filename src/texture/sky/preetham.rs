//! The analytic daylight of A. J. Preetham, Peter Shirley, Brian Smits: *A Practical Analytic Model for
//! Daylight*, SIGGRAPH 1999, appendix A.2: Perez' five-parameter distribution for each of Y, x and y.

use std::f32::consts::{FRAC_PI_2, PI};

use super::color::ToRgb;
use crate::math::{Rgb, Vec3, safe_acos};

/// Cycles' scale of luminance.
const SCALE: f32 = 0.06;

/// What is picked for a Preetham sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preetham {
    /// To the sun, a unit vector.
    pub sun_direction: Vec3,
    /// Haze: 2 clear, 10 thick.
    pub turbidity: f32,
    /// From XYZ, by Blender's version.
    pub to_rgb: ToRgb,
}

/// A Preetham sky by direction.
pub struct PreethamSky {
    sun: Vec3,
    /// Of x, y and Y: Perez' parameters, and the value at the zenith over Perez' function there.
    channels: [([f32; 5], f32); 3],
    to_rgb: ToRgb,
}

impl Preetham {
    /// Works the parameters out.
    pub fn prepare(&self) -> PreethamSky {
        let sun = self.sun_direction.normalize_or(Vec3::Z);
        let theta = safe_acos(sun.z);
        let t = self.turbidity;
        let chi = (4.0 / 9.0 - t / 120.0) * (PI - 2.0 * theta);
        let cubic = |[a, b, c, d]: [f32; 4]| ((a * theta + b) * theta + c) * theta + d;
        let zenith = |t2, t1, t0| cubic(t2) * t * t + cubic(t1) * t + cubic(t0);
        let luminance = ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192) * SCALE;
        let x = zenith(
            [0.00166, -0.00375, 0.00209, 0.0],
            [-0.02903, 0.06377, -0.03202, 0.00394],
            [0.11693, -0.21196, 0.06052, 0.25886],
        );
        let y = zenith(
            [0.00275, -0.00610, 0.00317, 0.0],
            [-0.04214, 0.08970, -0.04153, 0.00516],
            [0.15346, -0.26756, 0.06670, 0.26688],
        );
        let linear = |slopes: [f32; 5], at_0: [f32; 5]| std::array::from_fn(|i| slopes[i] * t + at_0[i]);
        let channel = |perez_of: [f32; 5], zenith: f32| (perez_of, zenith / perez(&perez_of, 1.0, theta));
        PreethamSky {
            sun,
            channels: [
                channel(
                    linear([-0.0193, -0.0665, -0.0004, -0.0641, -0.0033], [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452]),
                    x,
                ),
                channel(
                    linear([-0.0167, -0.0950, -0.0079, -0.0441, -0.0109], [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529]),
                    y,
                ),
                channel(
                    linear([0.1787, -0.3554, -0.0227, 0.1206, -0.0670], [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703]),
                    luminance,
                ),
            ],
            to_rgb: self.to_rgb,
        }
    }
}

impl PreethamSky {
    /// Radiance from a unit direction; below the horizon that of the horizon, seen from the true angle to
    /// the sun.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let gamma = safe_acos(direction.dot(self.sun));
        let cos_theta = safe_acos(direction.z).min(FRAC_PI_2 - 0.001).cos();
        let [x, y, luminance] = self.channels.map(|(parameters, scale)| scale * perez(&parameters, cos_theta, gamma));
        // xyY to XYZ; Cycles' guards against chromaticities of 0.
        let z = if y == 0.0 { 0.0 } else { (1.0 - x - y) / y * luminance };
        let x = if y == 0.0 { 0.0 } else { x / y * luminance };
        self.to_rgb.convert(Vec3::new(x, luminance, z))
    }
}

/// Perez' distribution at an angle from the zenith and an angle from the sun.
fn perez([a, b, c, d, e]: &[f32; 5], cos_theta: f32, gamma: f32) -> f32 {
    let cos_gamma = gamma.cos();
    (1.0 + a * (b / cos_theta).exp()) * (1.0 + c * (d * gamma).exp() + e * cos_gamma * cos_gamma)
}
