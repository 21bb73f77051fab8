//! Gradient: ramps along an axis, an angle or a radius.

use std::f32::consts::TAU;

use crate::math::Vec3;

use super::round::saturate;

/// The ramp, held in 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gradient {
    /// `x`.
    Linear,
    /// `x²`.
    Quadratic,
    /// Hermite step of `x`.
    Easing,
    /// Mean of `x` and `y`.
    Diagonal,
    /// Angle around `z`, a full turn from 0 to 1, starting at `-x`.
    Radial,
    /// The square of [`Gradient::Spherical`].
    QuadraticSphere,
    /// 1 at the origin, 0 from radius 1 on.
    Spherical,
}

impl Gradient {
    /// The ramp at a position.
    pub fn factor(self, p: Vec3) -> f32 {
        // A unit vector gets exactly 0, whatever rounding did to its length.
        let closeness = || (0.999_999 - p.length()).max(0.0);
        saturate(match self {
            Self::Linear => p.x,
            Self::Quadratic => p.x.max(0.0) * p.x.max(0.0),
            Self::Easing => super::round::smoothstep(p.x),
            Self::Diagonal => (p.x + p.y) * 0.5,
            Self::Radial => p.y.atan2(p.x) / TAU + 0.5,
            Self::QuadraticSphere => closeness() * closeness(),
            Self::Spherical => closeness(),
        })
    }
}
