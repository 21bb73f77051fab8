//! A point without size: `E = I cos θ / d²`.

use std::f32::consts::PI;
use std::sync::Arc;

use super::{Decay, Emitter, EmitterHit, LightBounds, LightSample, Profile, Receiver, profile};
use crate::math::{Bounds, Rgb, Vec3};

/// A point light, a delta in position; with a cone in its profile, a spot light.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Render space.
    pub p: Vec3,
    /// Radiant intensity, W·sr⁻¹.
    pub intensity: Rgb,
    /// Shaping and decay.
    pub profile: Option<Arc<Profile>>,
}

impl Point {
    fn light_bounds(&self) -> LightBounds {
        let bounds = LightBounds {
            bounds: Bounds { min: self.p, max: self.p },
            axis: Vec3::Z,
            cos_normals: -1.0,
            cos_emission: 0.0,
            intensity: self.intensity.luminance(),
            two_sided: false,
        };
        self.profile.as_ref().map_or(bounds, |profile| profile.bound(bounds))
    }
}

impl Emitter for Point {
    fn sample_li(&self, at: &Receiver, _uc: f32, _u: [f32; 2]) -> Option<LightSample> {
        let to_light = self.p - at.p;
        let dist = to_light.length();
        let wi = to_light / dist;
        let factor = self.profile.as_ref().map_or(Rgb::WHITE, |profile| profile.factor(-wi, dist));
        let li = self.intensity * factor * (1.0 / (dist * dist));
        // What overflows is left for the film to leave out and to count.
        let arrives = dist > 0.0 && !li.is_black();
        arrives.then_some(LightSample { li, wi, end: Some(self.p), pdf: 1.0, delta: true })
    }

    fn pdf_li(&self, _at: &Receiver, _wi: Vec3, _hit: Option<&EmitterHit>) -> f32 {
        0.0
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.light_bounds())
    }

    fn decay(&self) -> Decay {
        profile::decay(self.profile.as_deref())
    }

    fn importance(&self, at: &Receiver) -> f32 {
        profile::importance(&self.light_bounds(), self.profile.as_deref(), at)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        let mean = self.profile.as_ref().map_or(Rgb::WHITE, |profile| profile.mean());
        4.0 * PI * (self.intensity * mean).luminance()
    }
}
