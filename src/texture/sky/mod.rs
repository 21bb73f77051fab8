//! Skies by direction, as Blender's Sky Texture has them: pure functions behind a table that is made
//! once. Up is +z; a rotation of 0 puts the sun over +y, and grows clockwise seen from above.

mod color;
mod hosek;
mod multiple;
mod preetham;
mod single;
mod spectrum;
mod sun;
mod table;

use crate::math::{Rgb, Vec3};

pub use color::ToRgb;
pub use hosek::{Hosek, HosekSky};
pub use preetham::{Preetham, PreethamSky};

use sun::Sun;
pub use sun::SunDisk;
use table::Table;

/// Which atmosphere is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattering {
    /// Blender up to 4.5: light scattered once (its menu says Nishita).
    Nishita,
    /// Blender from 5.0: light scattered once, in a finer table.
    Single,
    /// Blender from 5.0: light scattered often, with the ground.
    Multiple,
}

/// What is picked for an atmosphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atmosphere {
    /// Which atmosphere.
    pub scattering: Scattering,
    /// Sun above the horizon, in radians.
    pub sun_elevation: f32,
    /// Sun around the zenith, in radians.
    pub sun_rotation: f32,
    /// The sun's diameter in radians; `None` for a sky without its disc.
    pub sun_size: Option<f32>,
    /// Scale of the disc's radiance.
    pub sun_intensity: f32,
    /// Height above the sea, in metres.
    pub altitude: f32,
    /// Density of molecules, 1 for a clear day.
    pub air: f32,
    /// Density of dust and drops, 1 for an urban day.
    pub aerosol: f32,
    /// Density of ozone, 1 for a city's.
    pub ozone: f32,
}

/// A sky by direction.
pub struct AtmosphereSky {
    table: Table,
    scattering: Scattering,
    rotation: f32,
    sun: Option<Sun>,
}

impl Atmosphere {
    /// Computes the sky's table, which takes a moment on all threads.
    pub fn prepare(&self) -> AtmosphereSky {
        let mut this = *self;
        (this.sun_elevation, this.sun_rotation) = sun::wrapped(self.sun_elevation, self.sun_rotation);
        let table = match self.scattering {
            Scattering::Nishita => single::table_to_horizon(&this),
            Scattering::Single => single::table(&this),
            Scattering::Multiple => multiple::table(&this),
        };
        AtmosphereSky { table, scattering: self.scattering, rotation: this.sun_rotation, sun: Sun::new(&this) }
    }
}

impl Atmosphere {
    /// The sun's disc in the mean; `None` for a sky without one.
    pub fn sun_disk(&self) -> Option<SunDisk> {
        let mut this = *self;
        (this.sun_elevation, this.sun_rotation) = sun::wrapped(self.sun_elevation, self.sun_rotation);
        Sun::new(&this)?.disk(self.scattering.to_rgb())
    }
}

impl Scattering {
    fn to_rgb(self) -> ToRgb {
        match self {
            Self::Nishita => ToRgb::Blender4,
            Self::Single | Self::Multiple => ToRgb::Blender5,
        }
    }
}

impl AtmosphereSky {
    /// Radiance from a unit direction, the sun's disc included.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let disc = self.sun.as_ref().and_then(|sun| sun.radiance(direction));
        let xyz = match (disc, self.scattering) {
            (Some(disc), Scattering::Nishita) => disc,
            (Some(disc), _) => disc + self.xyz(direction),
            (None, _) => self.xyz(direction),
        };
        self.to_rgb(xyz)
    }

    /// Radiance from a unit direction without the sun's disc.
    pub fn background(&self, direction: Vec3) -> Rgb {
        self.to_rgb(self.xyz(direction))
    }

    fn to_rgb(&self, xyz: Vec3) -> Rgb {
        self.scattering.to_rgb().convert(xyz)
    }

    fn xyz(&self, direction: Vec3) -> Vec3 {
        use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, TAU};
        let elevation = FRAC_PI_2 - crate::math::safe_acos(direction.z);
        let turn = (self.rotation - direction.y.atan2(direction.x) - FRAC_PI_2) / TAU;
        let x = turn - turn.floor();
        if self.scattering != Scattering::Nishita {
            let y = (elevation.abs() * FRAC_2_PI).sqrt().copysign(elevation) * 0.5 + 0.5;
            return self.table.lookup(x, y);
        }
        if direction.z >= 0.0 {
            self.table.lookup(x, (elevation * FRAC_2_PI).max(0.0).sqrt())
        } else {
            self.table.lookup(x, 0.0) * single::fade(-elevation)
        }
    }
}
