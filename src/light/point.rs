//! A point without size: `E = I cos θ / d²`.

use std::f32::consts::PI;

use super::{Emitter, EmitterHit, LightSample, range_window};
use crate::math::{Bounds, Rgb, Vec3};

/// A point light, a delta in position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Render space.
    pub p: Vec3,
    /// Radiant intensity, W·sr⁻¹.
    pub intensity: Rgb,
    /// No light farther than this; infinite for none.
    pub range: f32,
}

impl Emitter for Point {
    fn sample_li(&self, p: Vec3, _uc: f32, _u: [f32; 2]) -> Option<LightSample> {
        let to_light = self.p - p;
        let dist = to_light.length();
        let li = self.intensity * (range_window(dist, self.range) / (dist * dist));
        (dist > 0.0 && li.is_finite() && !li.is_black()).then(|| LightSample {
            li,
            wi: to_light / dist,
            end: Some(self.p),
            pdf: 1.0,
            delta: true,
        })
    }

    fn pdf_li(&self, _p: Vec3, _wi: Vec3, _at: Option<&EmitterHit>) -> f32 {
        0.0
    }

    fn importance(&self, p: Vec3) -> f32 {
        self.intensity.luminance() / self.p.distance_squared(p).max(f32::MIN_POSITIVE)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        4.0 * PI * self.intensity.luminance()
    }
}
