//! How the emission of a local light varies with direction and distance: cone, focus, measured
//! distribution, decay.

use crate::math::{Rgb, Vec3};

/// Shaping and decay of one light; lights that have neither hold none.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// No light farther than this (KHR_lights_punctual's window); infinite for none.
    pub range: f32,
}

impl Profile {
    /// The factor of what leaves the light along the unit direction `w` and arrives after `dist`.
    pub fn factor(&self, _w: Vec3, dist: f32) -> Rgb {
        let window = if self.range.is_finite() { (1.0 - (dist / self.range).powi(4)).clamp(0.0, 1.0) } else { 1.0 };
        Rgb::splat(window)
    }
}
