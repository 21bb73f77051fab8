//! Skies, those of Blender's Sky Texture. Up is +z; a rotation of 0 puts the sun over +y, and grows clockwise
//! seen from above.

/// A sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sky {
    /// A formula of daylight.
    Preetham {
        /// Direction to the sun.
        sun: [f64; 3],
        /// How hazy the air is, 2 for a clear day.
        turbidity: f64,
        /// True for the color space matrix of Blender up to 4.5.
        before_5: bool,
    },
    /// Another one, with the light of the ground.
    Hosek {
        /// Direction to the sun.
        sun: [f64; 3],
        /// How hazy the air is, 2 for a clear day.
        turbidity: f64,
        /// Share of light that the ground reflects.
        ground_albedo: f64,
    },
    /// An atmosphere.
    Atmosphere(Atmosphere),
}

/// What an atmosphere depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atmosphere {
    /// How light is scattered.
    pub scattering: Scattering,
    /// Sun above the horizon, radians.
    pub sun_elevation: f64,
    /// Sun around the zenith, radians.
    pub sun_rotation: f64,
    /// The sun's diameter, radians; `None` for a sky without its disk.
    pub sun_size: Option<f64>,
    /// Factor of the disk's radiance.
    pub sun_intensity: f64,
    /// Height above the sea, metres.
    pub altitude: f64,
    /// Density of molecules, 1 for a clear day.
    pub air: f64,
    /// Density of dust and drops, 1 for an urban day.
    pub aerosol: f64,
    /// Density of ozone, 1 for a city's.
    pub ozone: f64,
}

/// How light is scattered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scattering {
    /// Once, as in Blender up to 4.5.
    Nishita,
    /// Once, as in Blender from 5.0 on.
    Single,
    /// Often, and by the ground.
    Multiple,
}
