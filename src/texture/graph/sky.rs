//! Skies of graphs: what is worked out once for each.

use std::sync::{Arc, Mutex, PoisonError};

use crate::desc::graph as desc;
use crate::math::{Rgb, Vec3};
use crate::texture::sky::{
    Atmosphere, AtmosphereSky, Hosek, HosekSky, Preetham, PreethamSky, Scattering, SunDisk, ToRgb,
};

/// A sky that directions can be looked up in.
#[derive(Clone)]
pub struct Sky(Arc<Made>);

enum Made {
    Preetham(PreethamSky),
    Hosek(HosekSky),
    Atmosphere(AtmosphereSky),
}

/// The skies that were made last: an atmosphere takes about a second, and a viewport asks for the same one
/// after each edit.
static LAST: Mutex<Vec<(desc::Sky, Sky)>> = Mutex::new(Vec::new());

/// How many of them are kept.
const KEPT: usize = 4;

impl Sky {
    /// The sky of `desc`.
    pub fn new(desc: &desc::Sky) -> Self {
        let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, sky)) = last().iter().find(|(known, _)| known == desc) {
            return sky.clone();
        }
        let made = match desc {
            desc::Sky::Preetham { sun, turbidity, before_5 } => Made::Preetham(
                Preetham {
                    sun_direction: vector(*sun),
                    turbidity: *turbidity as f32,
                    to_rgb: if *before_5 { ToRgb::Blender4 } else { ToRgb::Blender5 },
                }
                .prepare(),
            ),
            desc::Sky::Hosek { sun, turbidity, ground_albedo } => Made::Hosek(
                Hosek {
                    sun_direction: vector(*sun),
                    turbidity: *turbidity as f32,
                    ground_albedo: *ground_albedo as f32,
                }
                .prepare(),
            ),
            desc::Sky::Atmosphere(atmosphere) => Made::Atmosphere(of_texture(atmosphere).prepare()),
        };
        let sky = Self(Arc::new(made));
        let mut last = last();
        last.truncate(KEPT - 1);
        last.insert(0, (*desc, sky.clone()));
        sky
    }

    /// Radiance from a direction of any length, that of a sun's disk included.
    pub fn radiance(&self, [x, y, z, _]: desc::Value) -> Rgb {
        let direction = Vec3::new(x as f32, y as f32, z as f32).normalize_or(Vec3::Z);
        match &*self.0 {
            Made::Preetham(sky) => sky.radiance(direction),
            Made::Hosek(sky) => sky.radiance(direction),
            Made::Atmosphere(sky) => sky.radiance(direction),
        }
    }
}

fn vector(v: [f64; 3]) -> Vec3 {
    Vec3::from(v.map(|x| x as f32))
}

/// The disk of an atmosphere's sun, where it has one.
pub fn sun_disk(atmosphere: &desc::Atmosphere) -> Option<SunDisk> {
    of_texture(atmosphere).sun_disk()
}

/// Numbers that are not finite count as 0.
fn of_texture(desc: &desc::Atmosphere) -> Atmosphere {
    let number = |x: f64| if x.is_finite() { x as f32 } else { 0.0 };
    Atmosphere {
        scattering: match desc.scattering {
            desc::Scattering::Nishita => Scattering::Nishita,
            desc::Scattering::Single => Scattering::Single,
            desc::Scattering::Multiple => Scattering::Multiple,
        },
        sun_elevation: number(desc.sun_elevation),
        sun_rotation: number(desc.sun_rotation),
        sun_size: desc.sun_size.map(number),
        sun_intensity: number(desc.sun_intensity),
        altitude: number(desc.altitude),
        air: number(desc.air),
        aerosol: number(desc.aerosol),
        ozone: number(desc.ozone),
    }
}

impl PartialEq for Sky {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl std::fmt::Debug for Sky {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Sky")
    }
}
