//! Light scattered once by molecules and drops, absorbed by ozone.
//!
//! Tomoyuki Nishita et al.: *Display of The Earth Taking into Account Atmospheric Scattering*, SIGGRAPH
//! 1993; phase function of drops by William Cornette and Joseph Shanks, 1992. The optical depth to the
//! sun is integrated by Gauss-Laguerre quadrature of order 8, since densities fall exponentially.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use rayon::prelude::*;

use super::spectrum::{COUNT, OZONE, RAYLEIGH, SUN, to_xyz};
use super::table::{Table, WIDTH};
use super::{Atmosphere, Scattering};
use crate::math::Vec3;

/// Metres.
const EARTH: f32 = 6_360e3;
const TOP: f32 = 6_420e3;
/// Heights over which densities fall by e.
const AIR_HEIGHT: f32 = 8e3;
const DROPS_HEIGHT: f32 = 1.2e3;
/// Scattering of drops at sea level, m⁻¹, and what they take away per what they scatter.
const DROPS: f32 = 2e-5;
const DROPS_EXTINCTION: f32 = 1.11;
/// Mean cosine of what drops scatter.
const ANISOTROPY: f32 = 0.76;
const STEPS: u32 = 32;

/// Nodes, over the last one's place at 25 of the exponential's lengths, and weights with the exponential
/// taken out.
const QUADRATURE: [(f32, f32); 8] = [
    (0.006_811_185_3, 0.017_508_936),
    (0.036_148_07, 0.041_354_775),
    (0.090_043_46, 0.066_788_39),
    (0.170_668, 0.095_076_99),
    (0.281_836_2, 0.128_341_64),
    (0.430_340_65, 0.170_743_02),
    (0.629_627_17, 0.232_723_33),
    (0.914_525_3, 0.356_249_06),
];

/// The sky up to Blender 4.5: from the horizon up, its last row just past the zenith.
pub fn table_to_horizon(atmosphere: &Atmosphere) -> Table {
    const HEIGHT: usize = 128;
    let most = FRAC_PI_2 + FRAC_PI_2 / HEIGHT as f32 / 2.0;
    Table::new(HEIGHT, |x, y| {
        let up = y as f32 / HEIGHT as f32;
        scattered(atmosphere, direction(most * (up * up), azimuth(x)))
    })
}

/// The sky from Blender 5.0: all around, the horizon fading out below itself.
pub fn table(atmosphere: &Atmosphere) -> Table {
    const HEIGHT: usize = 256;
    let horizon: Vec<Vec3> =
        (0..WIDTH / 2).into_par_iter().map(|x| scattered(atmosphere, direction(0.0, azimuth(x)))).collect();
    Table::new(HEIGHT, |x, y| {
        let up = y as f32 / (HEIGHT / 2) as f32 - 1.0;
        let elevation = FRAC_PI_2 * (up * up);
        if up >= 0.0 { scattered(atmosphere, direction(elevation, azimuth(x))) } else { horizon[x] * fade(elevation) }
    })
}

/// How much of the horizon shows that far below it.
pub fn fade(below: f32) -> f32 {
    let left = (1.0 - below.sin() * 2.5).max(0.0);
    left * left * left
}

/// XYZ of the sun's lowest and highest point.
pub fn sun(atmosphere: &Atmosphere, diameter: f32) -> (Vec3, Vec3) {
    let (radius, elevation) = (diameter / 2.0, atmosphere.sun_elevation);
    if elevation + radius <= 0.0 && atmosphere.scattering == Scattering::Single {
        return (Vec3::ZERO, Vec3::ZERO);
    }
    let solid_angle = TAU * (1.0 - radius.cos());
    let at = |elevation: f32| {
        let depth = depth_to_sun(viewer(atmosphere), direction(elevation.max(0.0), 0.0));
        // Ozone has no part here, as in Cycles.
        to_xyz(&std::array::from_fn(|i| {
            let air = RAYLEIGH[i] * depth.x * atmosphere.air;
            let drops = DROPS_EXTINCTION * DROPS * depth.y * atmosphere.aerosol;
            SUN[i] * (-(air + drops)).exp() / solid_angle
        }))
    };
    (at(elevation - radius), at(elevation + radius))
}

fn azimuth(column: usize) -> f32 {
    TAU / WIDTH as f32 * column as f32 - PI
}

fn direction(elevation: f32, azimuth: f32) -> Vec3 {
    Vec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin())
}

/// From the earth's centre.
fn viewer(atmosphere: &Atmosphere) -> Vec3 {
    // Inside the atmosphere and off the ground.
    let altitude = atmosphere.altitude.clamp(1.0, 59_999.0);
    Vec3::new(0.0, 0.0, EARTH + altitude)
}

/// XYZ of what is scattered toward the viewer along a direction.
fn scattered(atmosphere: &Atmosphere, direction_to_sky: Vec3) -> Vec3 {
    let (from, sun) = (viewer(atmosphere), direction(atmosphere.sun_elevation, 0.0));
    let densities = Vec3::new(atmosphere.air, atmosphere.aerosol, atmosphere.ozone);
    let length = to_top(from, direction_to_sky) / STEPS as f32;
    let step = direction_to_sky * length;
    let (air_phase, drops_phase) = phases(direction_to_sky.dot(sun));
    let mut spectrum = [0.0; COUNT];
    let mut depth = Vec3::ZERO;
    let mut p = from + step * 0.5;
    for _ in 0..STEPS {
        let density = densities * density_at(p);
        depth += density * length;
        if !meets_ground(p, sun) {
            let all = depth + densities * depth_to_sun(p, sun);
            for (i, s) in spectrum.iter_mut().enumerate() {
                let extinction = all.x * RAYLEIGH[i] + all.y * (DROPS_EXTINCTION * DROPS) + all.z * OZONE[i];
                let scattering = air_phase * (density.x * RAYLEIGH[i]) + drops_phase * (density.y * DROPS);
                *s += (-extinction).exp() * scattering * SUN[i] * length;
            }
        }
        p += step;
    }
    to_xyz(&spectrum)
}

/// Densities of air, drops and ozone, relative to their greatest.
fn density_at(p: Vec3) -> Vec3 {
    let height = p.length() - EARTH;
    let ozone = (1.0 - (height - 25_000.0).abs() / 15_000.0).max(0.0);
    Vec3::new((-height / AIR_HEIGHT).exp(), (-height / DROPS_HEIGHT).exp(), ozone)
}

/// Lengths at full density that pass as much matter as the way to the sun.
fn depth_to_sun(p: Vec3, sun: Vec3) -> Vec3 {
    let length = to_top(p, sun);
    let sum: Vec3 = QUADRATURE.iter().map(|(node, weight)| density_at(p + sun * (node * length)) * *weight).sum();
    sum * length
}

/// Rayleigh's phase function and Cornette's and Shanks', by the cosine.
fn phases(cosine: f32) -> (f32, f32) {
    let (square, g2) = (1.0 + cosine * cosine, ANISOTROPY * ANISOTROPY);
    let air = 3.0 / (16.0 * PI) * square;
    let drops = 3.0 * (1.0 - g2) * square / (8.0 * PI * (2.0 + g2) * (1.0 + g2 - 2.0 * ANISOTROPY * cosine).powf(1.5));
    (air, drops)
}

/// Distance to the atmosphere's top from inside.
fn to_top(p: Vec3, direction: Vec3) -> f32 {
    let b = 2.0 * direction.dot(p);
    let c = p.length_squared() - TOP * TOP;
    (-b + (b * b - 4.0 * c).max(0.0).sqrt()) / 2.0
}

fn meets_ground(p: Vec3, direction: Vec3) -> bool {
    let b = 2.0 * direction.dot(p);
    direction.z < 0.0 && b * b - 4.0 * (p.length_squared() - EARTH * EARTH) >= 0.0
}
