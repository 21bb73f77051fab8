//! The sun's disc.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use super::{Atmosphere, Scattering, multiple, single};
use crate::math::{Vec3, safe_acos, safe_sqrt};

/// A disc that darkens toward its limb, its colour running from its lowest to its highest point.
pub struct Sun {
    direction: Vec3,
    elevation: f32,
    diameter: f32,
    bottom: Vec3,
    top: Vec3,
    intensity: f32,
    /// Below this the earth is in the way.
    horizon: f32,
    scattering: Scattering,
}

/// Elevation within a quarter turn of the horizon and rotation, counter-clockwise, within one turn, that
/// give the same place of the sun.
pub fn wrapped(elevation: f32, rotation: f32) -> (f32, f32) {
    let (mut elevation, mut rotation) = (elevation % TAU, rotation);
    if elevation.abs() >= PI {
        elevation -= TAU.copysign(elevation);
    }
    if elevation.abs() >= FRAC_PI_2 {
        elevation = PI.copysign(elevation) - elevation;
        rotation += PI;
    }
    (elevation, TAU - rotation.rem_euclid(TAU))
}

impl Sun {
    /// The disc of an atmosphere whose sun is wrapped, if it has one.
    pub fn new(atmosphere: &Atmosphere) -> Option<Self> {
        let diameter = atmosphere.sun_size.filter(|size| *size >= 0.0)?;
        let (bottom, top) = match atmosphere.scattering {
            Scattering::Nishita | Scattering::Single => single::sun(atmosphere, diameter),
            Scattering::Multiple => multiple::sun(atmosphere, diameter),
        };
        let (elevation, rotation) = (atmosphere.sun_elevation, atmosphere.sun_rotation);
        let horizon = match atmosphere.scattering {
            Scattering::Nishita => f32::NEG_INFINITY,
            Scattering::Single | Scattering::Multiple => -multiple::dip(atmosphere.altitude),
        };
        Some(Self {
            direction: Vec3::new(-elevation.cos() * rotation.sin(), elevation.cos() * rotation.cos(), elevation.sin()),
            elevation,
            diameter,
            bottom,
            top,
            intensity: atmosphere.sun_intensity,
            horizon,
            scattering: atmosphere.scattering,
        })
    }

    /// XYZ from a unit direction inside the disc.
    pub fn radiance(&self, direction: Vec3) -> Option<Vec3> {
        /// Hestroffer and Magnan's coefficient for visible light, by the linear law.
        const LIMB: f32 = 0.6;
        let radius = self.diameter * 0.5;
        let angle = 2.0 * (direction - self.direction).length().atan2((direction + self.direction).length());
        let height = FRAC_PI_2 - safe_acos(direction.z);
        let inside = angle < radius && height > self.horizon;
        if !inside || (self.scattering == Scattering::Nishita && direction.z < 0.0) {
            return None;
        }
        // The old sky squeezes the colours of a setting sun into what is left of it.
        let setting = self.scattering == Scattering::Nishita && self.elevation <= radius;
        let up =
            if setting { height / (self.elevation + radius) } else { (height - self.elevation) / self.diameter + 0.5 };
        let edge = angle / radius;
        let darkening = 1.0 - LIMB * (1.0 - safe_sqrt(1.0 - edge * edge));
        Some(self.bottom.lerp(self.top, up) * (self.intensity * darkening))
    }
}
