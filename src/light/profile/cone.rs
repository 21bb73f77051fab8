//! The edge of a cone of light: how much of it is left at an angle off the axis.
//!
//! Narrow cones need care: within a degree the cosine has lost half of its digits, so that edges
//! given in the cosine are compared by `h = 1 − cos θ`, from the sine.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::math::{DMat3, DVec3};

/// A cone of light around the axis, with its edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    measure: Measure,
    curve: Curve,
    /// Up to here all light is there.
    full: f64,
    /// From here on there is none.
    none: f64,
    /// Half angle beyond which there is none, radians.
    half: f64,
}

/// In what the edge is a ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Measure {
    /// `1 − cos θ`.
    Height,
    /// `θ`.
    Angle,
}

/// What becomes of the ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve {
    Square,
    Smooth,
}

/// Angle of a direction off a light's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OffAxis {
    /// Sine.
    pub sin: f64,
    /// Cosine.
    pub cos: f64,
}

/// `1 − cos θ` without cancellation.
fn height(theta: f64) -> f64 {
    2.0 * (0.5 * theta).sin().powi(2)
}

/// The angle whose `1 − cos` is `h`.
fn angle(h: f64) -> f64 {
    2.0 * (0.5 * h).clamp(0.0, 1.0).sqrt().asin()
}

impl OffAxis {
    /// Of a direction, unit or not, in a space where the axis is −z.
    pub fn new(local: DVec3) -> Self {
        let length = local.length();
        Self { sin: local.x.hypot(local.y) / length, cos: -local.z / length }
    }

    /// In radians.
    pub fn theta(self) -> f64 {
        self.sin.atan2(self.cos)
    }

    fn height(self) -> f64 {
        if self.cos > 0.0 { self.sin * self.sin / (1.0 + self.cos) } else { 1.0 - self.cos }
    }
}

impl Cone {
    /// KHR_lights_punctual: the square of a linear ramp in the cosine, 1 within the half angle `inner`
    /// and 0 beyond `outer`, radians, `0 ≤ inner ≤ outer ≤ π`.
    pub fn ramp(inner: f64, outer: f64) -> Self {
        Self::new(Measure::Height, Curve::Square, height(inner.min(outer)), height(outer), outer)
    }

    /// Cycles' spot of half angle `half` in radians: `smoothstep((cos θ − cos half) / ((1 − cos half) ·
    /// blend))`, `blend` 0 (a hard edge) to 1.
    pub fn blend(half: f64, blend: f64) -> Self {
        let h = height(half);
        Self::new(Measure::Height, Curve::Smooth, h * (1.0 - blend), h, half)
    }

    /// UsdLux ShapingAPI: `1 − smoothstep(half · (1 − softness), half, θ)`, `half` in radians,
    /// `softness` 0 (a hard edge) to 1.
    pub fn soft(half: f64, softness: f64) -> Self {
        Self::new(Measure::Angle, Curve::Smooth, half * (1.0 - softness), half, half)
    }

    fn new(measure: Measure, curve: Curve, full: f64, none: f64, half: f64) -> Self {
        // A hard edge behind the light is none.
        let whole = half >= PI && full >= none;
        let (full, none) = if whole { (f64::INFINITY, f64::INFINITY) } else { (full, none) };
        Self { measure, curve, full, none, half: half.clamp(0.0, PI) }
    }

    /// Share of light that is left, 0 to 1.
    pub(super) fn factor(&self, off_axis: OffAxis) -> f64 {
        let at = match self.measure {
            Measure::Height => off_axis.height(),
            Measure::Angle => off_axis.theta(),
        };
        if at <= self.full && self.none > 0.0 {
            return 1.0;
        }
        if at >= self.none {
            return 0.0;
        }
        let t = (self.none - at) / (self.none - self.full);
        match self.curve {
            Curve::Square => t * t,
            Curve::Smooth => t * t * (3.0 - 2.0 * t),
        }
    }

    /// Half angle of the cone that holds all the light, radians.
    pub(super) fn half(&self) -> f64 {
        self.half
    }

    /// The angles at which the factor is not smooth, radians.
    pub(super) fn edges(&self) -> [f64; 2] {
        let full = match self.measure {
            Measure::Height => angle(self.full.min(2.0)),
            Measure::Angle => self.full.min(PI),
        };
        [full, self.half]
    }
}

/// True where `stretch` keeps angles: a turn, a reflection, the same scale along all axes.
pub(super) fn keeps_angles(stretch: DMat3) -> bool {
    let (x, y, z) = (stretch.x_axis, stretch.y_axis, stretch.z_axis);
    let squared = [x, y, z].map(DVec3::length_squared);
    let (least, most) =
        (squared.iter().copied().fold(f64::INFINITY, f64::min), squared.iter().copied().fold(0.0, f64::max));
    let skew = x.dot(y).abs().max(x.dot(z).abs()).max(y.dot(z).abs());
    (most - least).max(skew) <= 1e-9 * most
}

/// The half angle around the image of the axis into which `stretch` (columns: the images of x, y and
/// z) maps all directions within `half` of −z; a bound from above.
pub(super) fn stretched_half(stretch: DMat3, half: f64) -> f64 {
    const STEPS: usize = 256;
    let axis = -stretch.z_axis.normalize();
    // The image of a cone beyond a right angle is not convex; of one at a right angle, a half-space.
    if half > FRAC_PI_2 {
        return PI;
    }
    let rim = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / STEPS as f64).sin_cos();
        (stretch * DVec3::new(half.sin() * cos, half.sin() * sin, -half.cos())).normalize()
    };
    let (widest, step) = (0..STEPS).fold((0.0_f64, 0.0_f64), |(widest, step), i| {
        let (here, next) = (rim(i), rim(i + 1));
        (widest.max(axis.angle_between(here)), step.max(here.angle_between(next)))
    });
    // Between two steps the rim can be off by no more than the way from one to the other.
    (widest + step).min(PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(cone: &Cone, theta: f64) -> f64 {
        cone.factor(OffAxis { sin: theta.sin(), cos: theta.cos() })
    }

    #[test]
    fn each_kind_follows_its_formula() {
        let smooth = |t: f64| t.clamp(0.0, 1.0).powi(2) * (3.0 - 2.0 * t.clamp(0.0, 1.0));
        for i in 0..=180 {
            let theta = f64::from(i).to_radians();
            let (inner, outer) = (0.3_f64, 0.9_f64);
            let ramp = ((theta.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0).powi(2);
            assert!((at(&Cone::ramp(inner, outer), theta) - ramp).abs() < 1e-12, "{i}");
            let blend = smooth((theta.cos() - outer.cos()) / ((1.0 - outer.cos()) * 0.4));
            assert!((at(&Cone::blend(outer, 0.4), theta) - blend).abs() < 1e-12, "{i}");
            let soft = 1.0 - smooth((theta - outer * 0.75) / (outer * 0.25));
            assert!((at(&Cone::soft(outer, 0.25), theta) - soft).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn narrow_cones_keep_their_edge() {
        for half in [1e-7, 1e-4, 0.01] {
            // Half way down in 1 − cos, which is θ²/2 there.
            let cone = Cone::blend(half, 1.0);
            assert!((at(&cone, half * 0.5_f64.sqrt()) - 0.5).abs() < 1e-4, "{half}");
            assert_eq!((at(&cone, 0.0), at(&cone, half * 1.001)), (1.0, 0.0));
            let hard = Cone::blend(half, 0.0);
            assert_eq!((at(&hard, half * 0.999), at(&hard, half * 1.001)), (1.0, 0.0));
        }
    }

    #[test]
    fn no_cone_and_the_whole_sphere() {
        let cones = |half: f64| [Cone::ramp(half, half), Cone::blend(half, 0.0), Cone::soft(half, 0.0)];
        for theta in [0.0, 1e-9, 0.5, PI - 1e-9, PI] {
            assert!(cones(0.0).iter().all(|cone| at(cone, theta) == 0.0), "{theta}");
            assert!(cones(PI).iter().all(|cone| at(cone, theta) == 1.0), "{theta}");
        }
        for soft in [Cone::ramp(0.0, 0.0), Cone::blend(0.0, 1.0), Cone::soft(0.0, 1.0)] {
            assert_eq!((at(&soft, 0.0), at(&soft, 0.1)), (0.0, 0.0));
        }
        let half_way = Cone::soft(PI, 1.0);
        assert!((at(&half_way, FRAC_PI_2) - 0.5).abs() < 1e-12 && at(&half_way, PI) == 0.0);
    }

    #[test]
    fn a_stretched_cone_is_held() {
        let turned = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(-0.4);
        assert!(keeps_angles(turned * 3.0) && keeps_angles(turned * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0))));
        let sheared = DMat3::from_cols(DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::Z);
        assert!(!keeps_angles(sheared) && !keeps_angles(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.001))));
        // Twice as wide along x: the tangent doubles.
        let wide = turned * DMat3::from_diagonal(DVec3::new(2.0, 1.0, 1.0));
        let half = stretched_half(wide, 0.5);
        let exact = (2.0 * 0.5_f64.tan()).atan();
        assert!(half >= exact && half < exact + 0.05, "{half} {exact}");
    }
}
