//! A point light with a cone: `I(θ) = I · clamp((cos θ − cos outer) / (cos inner − cos outer))²`.
//!
//! KHR_lights_punctual, "Inner and Outer Cone Angles".

use std::f32::consts::PI;

use super::{Emitter, EmitterHit, LightSample, Point};
use crate::math::{Bounds, Vec3, sqr};

/// A spot light, a delta in position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The light without its cone.
    pub point: Point,
    /// Unit axis of the cone.
    pub axis: Vec3,
    /// Cosine of the half angle of full intensity.
    pub cos_inner: f32,
    /// Cosine of the half angle where the light ends.
    pub cos_outer: f32,
}

impl Spot {
    /// The cone's factor towards the unit direction `w`, which leaves the light.
    fn falloff(&self, w: Vec3) -> f32 {
        let cos = self.axis.dot(w);
        if cos >= self.cos_inner {
            1.0
        } else if cos <= self.cos_outer {
            0.0
        } else {
            sqr((cos - self.cos_outer) / (self.cos_inner - self.cos_outer))
        }
    }
}

impl Emitter for Spot {
    fn sample_li(&self, p: Vec3, uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let sample = self.point.sample_li(p, uc, u)?;
        let li = sample.li * self.falloff(-sample.wi);
        (!li.is_black()).then_some(LightSample { li, ..sample })
    }

    fn pdf_li(&self, _p: Vec3, _wi: Vec3, _at: Option<&EmitterHit>) -> f32 {
        0.0
    }

    fn importance(&self, p: Vec3) -> f32 {
        let w = (p - self.point.p).normalize_or(self.axis);
        if self.axis.dot(w) <= self.cos_outer { 0.0 } else { self.point.importance(p) }
    }

    fn power(&self, _scene: Bounds) -> f32 {
        // ∫ over the cone; the ramp's mean of its square is 1/3.
        let solid_angle = 2.0 * PI * ((1.0 - self.cos_inner) + (self.cos_inner - self.cos_outer) / 3.0);
        self.point.intensity.luminance() * solid_angle
    }
}
