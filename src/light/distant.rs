//! Light from infinitely far away: a direction, or a disk of directions with constant radiance
//! `L = E / (π sin²(angle / 2))`, so that `E cos θ` arrives as long as all of the disk is above the
//! horizon (UsdLux `sizeFactor`, Cycles).

use std::f32::consts::PI;

use super::{Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Frame, Rgb, Vec3, sqr};
use crate::sampling::warp;

/// Half angles below this are a single direction: the rounding of an `f32` direction would be more
/// than 1% of the disk.
const MIN_HALF_ANGLE: f64 = 1e-5;

/// More than rounding takes from a cosine.
const SLACK: f32 = 1e-6;

/// A sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distant {
    frame: Frame,
    irradiance: Rgb,
    /// Radiance of the disk; unused for a single direction.
    radiance: Rgb,
    /// Sine of the half angle; 0 for a single direction.
    sin_half: f32,
    cos_half: f32,
    /// `1 − cos` of the half angle.
    height: f32,
}

impl Distant {
    /// A sun in the unit direction `to_light`, `angle` the full angle of its disk in radians (0 for
    /// a delta, at most π), `irradiance` on a surface that faces it.
    pub fn new(to_light: Vec3, angle: f32, irradiance: Rgb) -> Self {
        let half = f64::from(angle.clamp(0.0, PI)) * 0.5;
        let half = if half >= MIN_HALF_ANGLE { half.min(0.5 * std::f64::consts::PI) } else { 0.0 };
        // In f64: squares of small sines lose nothing, and bright suns stay finite as long as they can.
        let disk = std::f64::consts::PI * half.sin() * half.sin();
        let of_disk = |e: f32| (f64::from(e) / disk).min(f64::from(f32::MAX)) as f32;
        let radiance = if half > 0.0 { irradiance.map(of_disk) } else { Rgb::BLACK };
        let height = (2.0 * (0.5 * half).sin().powi(2)) as f32;
        Self {
            frame: Frame::from_z(to_light),
            irradiance,
            radiance,
            sin_half: half.sin() as f32,
            cos_half: half.cos() as f32,
            height,
        }
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

    /// The largest that a direction of the disk can bring, so that none above the horizon is lost.
    fn importance(&self, at: &Receiver) -> f32 {
        let cos = at.n.map_or(1.0, |n| {
            let cos = n.dot(self.frame.n);
            let sin = n.cross(self.frame.n).length();
            let largest = if cos >= self.cos_half { 1.0 } else { cos * self.cos_half + sin * self.sin_half };
            (largest + SLACK).clamp(0.0, 1.0)
        });
        self.irradiance.luminance() * cos
    }

    fn power(&self, scene: Bounds) -> f32 {
        (PI * sqr(scene.radius()) * self.irradiance.luminance()).min(f32::MAX)
    }
}
