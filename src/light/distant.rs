//! Light from infinitely far away: a direction, or a disk of directions with constant radiance
//! `L = E / (π sin²(angle / 2))`.

use std::f32::consts::PI;

use super::{Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Frame, Rgb, Vec3, sqr};
use crate::sampling::warp;

/// Half angles below this are a single direction: the rounding of an `f32` direction would be more
/// than 1% of the disk.
const MIN_HALF_ANGLE: f64 = 1e-5;

/// A sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distant {
    frame: Frame,
    irradiance: Rgb,
    /// Radiance of the disk; unused for a single direction.
    radiance: Rgb,
    /// Sine of the half angle; 0 for a single direction.
    sin_half: f32,
    /// `1 − cos` of the half angle.
    height: f32,
}

impl Distant {
    /// A sun in the unit direction `to_light`, `angle` the full angle of its disk in radians (0 for
    /// a delta, at most π), `irradiance` on a surface that faces it.
    pub fn new(to_light: Vec3, angle: f32, irradiance: Rgb) -> Self {
        let half = f64::from(angle.clamp(0.0, std::f32::consts::PI)) * 0.5;
        let half = if half < MIN_HALF_ANGLE { 0.0 } else { half };
        let radiance = if half > 0.0 { irradiance / (PI * sqr(half.sin() as f32)) } else { Rgb::BLACK };
        let sin_half = half.sin() as f32;
        let height = warp::one_minus_cos(sqr(sin_half));
        Self { frame: Frame::from_z(to_light), irradiance, radiance, sin_half, height }
    }

    fn is_delta(&self) -> bool {
        self.sin_half == 0.0
    }

    /// Stable for small angles: compares sines, since `1 − cos` cancels.
    fn contains(&self, wi: Vec3) -> bool {
        self.frame.n.dot(wi) > 0.0 && self.frame.n.cross(wi).length_squared() <= sqr(self.sin_half)
    }
}

impl Emitter for Distant {
    fn sample_li(&self, _at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        if self.is_delta() {
            let sample = LightSample { li: self.irradiance, wi: self.frame.n, end: None, pdf: 1.0, delta: true };
            return Some(sample);
        }
        let wi = self.frame.to_world(warp::sample_cone(u, self.height));
        let pdf = warp::pdf_cone(self.height);
        Some(LightSample { li: self.radiance, wi, end: None, pdf, delta: false })
    }

    fn pdf_li(&self, _at: &Receiver, wi: Vec3, _hit: Option<&EmitterHit>) -> f32 {
        if !self.is_delta() && self.contains(wi) { warp::pdf_cone(self.height) } else { 0.0 }
    }

    fn le(&self, wi: Vec3, _hit: Option<&EmitterHit>) -> Rgb {
        if !self.is_delta() && self.contains(wi) { self.radiance } else { Rgb::BLACK }
    }

    fn in_background(&self) -> bool {
        !self.is_delta()
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn importance(&self, _at: &Receiver) -> f32 {
        self.irradiance.luminance()
    }

    fn power(&self, scene: Bounds) -> f32 {
        PI * sqr(scene.radius()) * self.irradiance.luminance()
    }
}
