//! The sun's disc.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use super::{Atmosphere, Scattering, ToRgb, multiple, single};
use crate::math::{Frame, Rgb, Vec3, safe_acos, safe_sqrt};

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

/// A sun's disc in the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunDisk {
    /// Unit direction to its middle.
    pub direction: Vec3,
    /// Full angle in radians, above 0.
    pub diameter: f32,
    /// Linear, mean over the disc, what lies below the horizon counted as black.
    pub radiance: Rgb,
    /// True where it takes the place of the sky; else it is added.
    pub covers: bool,
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

    /// The disc in the mean; `None` where nothing of it is seen.
    pub fn disk(&self, to_rgb: ToRgb) -> Option<SunDisk> {
        /// Rings of the same area, and points on each.
        const RINGS: [usize; 2] = [32, 64];
        let frame = Frame::from_z(self.direction);
        let mut sum = Vec3::ZERO;
        for ring in 0..RINGS[0] {
            let angle = 0.5 * self.diameter * ((ring as f32 + 0.5) / RINGS[0] as f32).sqrt();
            for point in 0..RINGS[1] {
                let (sin, cos) = (TAU * (point as f32 + 0.5) / RINGS[1] as f32).sin_cos();
                let local = Vec3::new(angle.sin() * cos, angle.sin() * sin, angle.cos());
                sum += self.radiance(frame.to_world(local)).unwrap_or(Vec3::ZERO);
            }
        }
        let radiance = to_rgb.convert(sum / (RINGS[0] * RINGS[1]) as f32);
        let (direction, diameter) = (self.direction, self.diameter);
        let covers = self.scattering == Scattering::Nishita;
        let seen = diameter > 0.0 && radiance.is_finite() && !radiance.is_black();
        seen.then_some(SunDisk { direction, diameter, radiance, covers })
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
