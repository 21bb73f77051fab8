//! Irradiances in f64 to hold lights against.

use std::f64::consts::{FRAC_PI_2, PI};

use penumbra::math::DVec3;

/// The integral of `f` from `from` to `to` by the midpoint rule.
pub fn midpoints(from: f64, to: f64, n: u32, f: impl Fn(f64) -> f64) -> f64 {
    let h = (to - from) / f64::from(n);
    (0..n).map(|i| f(from + h * (f64::from(i) + 0.5))).sum::<f64>() * h
}

/// Irradiance from constant radiance 1 over the cone of directions of `half` radians, its axis at the
/// angle `tilt` from the normal: exact in azimuth, by quadrature in the angle from the axis.
pub fn cap(half: f64, tilt: f64) -> f64 {
    let ring = |alpha: f64| {
        let (a, b) = (alpha.cos() * tilt.cos(), alpha.sin() * tilt.sin());
        if a >= b {
            2.0 * PI * a
        } else if a <= -b {
            0.0
        } else {
            let phi = (-a / b).acos();
            2.0 * (a * phi + b * phi.sin())
        }
    };
    midpoints(0.0, half, 20_000, |alpha| ring(alpha) * alpha.sin())
}

/// Irradiance on the normal `n` from radiance `le(wi)` within `half` radians of `axis`.
pub fn cone(axis: DVec3, half: f64, n: DVec3, le: impl Fn(DVec3) -> f64) -> f64 {
    let (s, t) = axis.any_orthonormal_pair();
    let steps = 1000;
    midpoints(0.0, half, steps, |alpha| {
        midpoints(0.0, 2.0 * PI, steps, |phi| {
            let wi = (s * phi.cos() + t * phi.sin()) * alpha.sin() + axis * alpha.cos();
            le(wi) * n.dot(wi).max(0.0)
        }) * alpha.sin()
    })
}

/// A tube: centre, unit axis, radius and length.
#[derive(Clone, Copy, Debug)]
pub struct Tube {
    pub center: DVec3,
    pub axis: DVec3,
    pub radius: f64,
    pub length: f64,
}

impl Tube {
    /// Irradiance at `p` from radiance 1: exact along the tube, by quadrature around it.
    pub fn irradiance(&self, p: DVec3, n: DVec3) -> f64 {
        let x = (p - self.center).dot(self.axis);
        let out = p - self.center - self.axis * x;
        let (rho, r) = (out.length(), self.radius);
        let (e, f) = (-out / rho, self.axis.cross(-out / rho));
        let ends = [-0.5 * self.length - x, 0.5 * self.length - x];
        // ρ sin φ = r sin t takes the root at the tangents away.
        midpoints(-FRAC_PI_2, FRAC_PI_2, 200_000, |t| {
            let sin = r / rho * t.sin();
            let cos = (1.0 - sin * sin).sqrt();
            let s = (rho - r) * (rho + r) / (rho * cos + r * t.cos());
            let (along, across) = (n.dot(self.axis), n.dot(e * cos + f * sin));
            // The part of the line above the horizon.
            let top = along.atan2(across);
            let from = ends[0].atan2(s).max(top - FRAC_PI_2);
            let to = ends[1].atan2(s).min(top + FRAC_PI_2);
            let integral = |psi: f64| 0.5 * along * psi.sin().powi(2) + across * (0.5 * psi + 0.25 * (2.0 * psi).sin());
            let line = if from < to { integral(to) - integral(from) } else { 0.0 };
            line * r * t.cos() / (rho * cos)
        })
    }

    /// The same from radiance `le(point)`, by quadrature over the surface.
    pub fn irradiance_of(&self, p: DVec3, n: DVec3, le: impl Fn(DVec3) -> f64) -> f64 {
        let (s, t) = self.axis.any_orthonormal_pair();
        midpoints(-0.5 * self.length, 0.5 * self.length, 2000, |x| {
            midpoints(0.0, 2.0 * PI, 2000, |alpha| {
                let normal = s * alpha.cos() + t * alpha.sin();
                let to_light = self.center + self.axis * x + normal * self.radius - p;
                let d = to_light.length();
                let wi = to_light / d;
                le(self.center + self.axis * x + normal * self.radius)
                    * n.dot(wi).max(0.0)
                    * (-normal.dot(wi)).max(0.0)
                    * self.radius
                    / (d * d)
            })
        })
    }
}

#[test]
fn ways_to_the_same_irradiance_agree() {
    for (half, tilt) in [(0.3, 0.5), (1.2, 1.0), (0.7, 1.9)] {
        let n = DVec3::new(f64::sin(tilt), f64::cos(tilt), 0.0);
        assert!((cap(half, tilt) - cone(DVec3::Y, half, n, |_| 1.0)).abs() < 1e-5, "{half} {tilt}");
    }
    // Wholly above the horizon: π sin² cos.
    assert!((cap(0.4, 0.6) / (PI * f64::sin(0.4).powi(2) * f64::cos(0.6)) - 1.0).abs() < 1e-8);
    let tube = Tube { center: DVec3::new(0.1, 0.2, -0.3), axis: DVec3::new(0.6, 0.0, 0.8), radius: 0.4, length: 1.7 };
    for (p, n) in [
        (DVec3::new(1.0, 1.5, -0.5), DVec3::new(-0.6, -0.8, 0.0)),
        (DVec3::new(3.0, 0.3, 2.0), DVec3::new(0.0, 0.6, -0.8)),
        (DVec3::new(0.1, 0.8, -0.3), DVec3::new(0.8, 0.0, 0.6)),
    ] {
        let (by_angles, by_area) = (tube.irradiance(p, n), tube.irradiance_of(p, n, |_| 1.0));
        assert!((by_angles / by_area - 1.0).abs() < 1e-4, "{p}: {by_angles} {by_area}");
    }
}
