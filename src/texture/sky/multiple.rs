//! Light scattered often, at four wavelengths.
//!
//! Fernando García Liñán: *Spectral Sky Rendering*, master's thesis and article, 2024: four wavelengths
//! (630, 560, 490, 430 nm) fitted so that they make the colours of full spectra, and a fit of what other
//! scattering than the first adds. Integration along a step by Sébastien Hillaire: *Physically Based
//! Sky, Atmosphere and Cloud Rendering in Frostbite*, SIGGRAPH 2016 course.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use rayon::prelude::*;

use super::Atmosphere;
use super::table::{Table, WIDTH};
use crate::math::{Vec3, Vec4, safe_sqrt};

/// Kilometres.
const EARTH: f32 = 6_371.0;
const THICKNESS: f32 = 100.0;
const TOP: f32 = EARTH + THICKNESS;
const STEPS: u32 = 64;
/// Texels of transmittance to the sun, by the cosine of its zenith angle and by height.
const COSINES: usize = 256;
const HEIGHTS: usize = 64;

const GROUND_ALBEDO: f32 = 0.3;
/// Mean cosine of what drops scatter.
const ANISOTROPY: f32 = 0.8;
const SUN: Vec4 = Vec4::new(1.679, 1.828, 1.986, 1.307);
/// Molecules at sea level, km⁻¹.
const AIR: Vec4 = Vec4::new(6.605e-3, 1.067e-2, 1.842e-2, 3.156e-2);
/// Cross-sections per particle, and densities.
const OZONE: Vec4 = Vec4::new(3.472e-25, 3.914e-25, 1.349e-25, 11.03e-27);
const OZONE_DOBSON: f32 = 334.5;
const DROPS_ABSORB: Vec4 = Vec4::new(2.8722e-24, 4.6168e-24, 7.9706e-24, 1.3578e-23);
const DROPS_SCATTER: Vec4 = Vec4::new(1.5908e-22, 1.7711e-22, 2.0942e-22, 2.4033e-22);
const DROPS_DENSITY: f32 = 1.3681e20;
const DROPS_BACKGROUND: f32 = 2e6;
const DROPS_HEIGHT: f32 = 0.73;
/// What each wavelength adds to XYZ.
const TO_XYZ: [Vec3; 4] = [
    Vec3::new(53.386_917, 22.981_337, 0.0),
    Vec3::new(43.904_846, 71.347_79, 0.102_506_87),
    Vec3::new(1.613_727_8, 18.422_96, 31.742_92),
    Vec3::new(20.762_669, 2.361_421_3, 110.480_095),
];

/// The whole sphere, ground included.
pub fn table(atmosphere: &Atmosphere) -> Table {
    const HEIGHT: usize = 256;
    let light = Light::new(atmosphere);
    let sun = sun_direction((FRAC_PI_2 - atmosphere.sun_elevation).cos());
    let from = Vec3::new(0.0, 0.0, EARTH + altitude(atmosphere));
    Table::new(HEIGHT, |x, y| {
        let azimuth = TAU * (x as f32 + 0.5) / WIDTH as f32;
        // Rows crowd at the horizon.
        let up = (y as f32 + 0.5) / HEIGHT as f32 * 2.0 - 1.0;
        let elevation = (up * up).copysign(up) * FRAC_PI_2;
        let direction = Vec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin());
        let ground = to_sphere(from, direction, EARTH);
        let length = if ground < 0.0 { to_sphere(from, direction, TOP) } else { ground };
        to_xyz(light.scattered(from, direction, sun, length))
    })
}

/// XYZ of the sun's lowest and highest point.
pub fn sun(atmosphere: &Atmosphere, diameter: f32) -> (Vec3, Vec3) {
    let radius = diameter / 2.0;
    let solid_angle = TAU * (1.0 - radius.cos());
    let at = |elevation: f32| {
        let cosine = (FRAC_PI_2 - elevation).cos();
        let share = transmittance(atmosphere, cosine, altitude(atmosphere) / THICKNESS);
        to_xyz(SUN * share / solid_angle)
    };
    (at(atmosphere.sun_elevation - radius), at(atmosphere.sun_elevation + radius))
}

/// How far the horizon lies below eye level at an altitude in metres, in radians.
pub fn dip(altitude: f32) -> f32 {
    FRAC_PI_2 - (EARTH / (EARTH + altitude / 1000.0)).asin()
}

/// In kilometres, inside the atmosphere and off the ground.
fn altitude(atmosphere: &Atmosphere) -> f32 {
    atmosphere.altitude.clamp(1.0, 99_999.0) / 1000.0
}

fn to_xyz(light: Vec4) -> Vec3 {
    light.to_array().iter().zip(TO_XYZ).map(|(l, xyz)| xyz * *l).sum()
}

/// A sun at that cosine from the zenith, on the side of the table's first column.
fn sun_direction(cosine: f32) -> Vec3 {
    Vec3::new(-safe_sqrt(1.0 - cosine * cosine), 0.0, cosine)
}

/// What matter does to light at a height in km, per km.
struct Matter {
    air: Vec4,
    drops: Vec4,
    extinction: Vec4,
}

impl Matter {
    fn at(atmosphere: &Atmosphere, height: f32) -> Self {
        let density =
            DROPS_DENSITY * ((-height / DROPS_HEIGHT).exp() + DROPS_BACKGROUND / DROPS_DENSITY) * atmosphere.aerosol;
        let log = height.max(1e-4).ln();
        let ozone = 3.785_474e20 * (-(log - 3.222_61) * (log - 3.222_61) * 5.555_556 - log).exp();
        let air = AIR * (-0.077_719_71 * height.powf(1.163_642_4)).exp() * atmosphere.air;
        let drops = DROPS_SCATTER * density;
        let absorbed = DROPS_ABSORB * density + OZONE * OZONE_DOBSON * ozone * atmosphere.ozone;
        Self { air, drops, extinction: absorbed + drops + air }
    }
}

/// Share of sunlight that comes through to a height, 0 to 1 of the thickness.
fn transmittance(atmosphere: &Atmosphere, cosine: f32, height: f32) -> Vec4 {
    let direction = sun_direction(cosine);
    let from = Vec3::new(0.0, 0.0, EARTH + height * THICKNESS);
    let step = to_sphere(from, direction, TOP) / STEPS as f32;
    let mut depth = Vec4::ZERO;
    for i in 0..STEPS {
        let p = from + direction * ((i as f32 + 0.5) * step);
        depth += Matter::at(atmosphere, (p.length() - EARTH).max(0.0)).extinction * step;
    }
    (-depth).exp()
}

/// Sunlight throughout an atmosphere.
struct Light<'a> {
    atmosphere: &'a Atmosphere,
    /// Transmittance by height and cosine.
    to_sun: Vec<Vec4>,
}

impl<'a> Light<'a> {
    fn new(atmosphere: &'a Atmosphere) -> Self {
        let texel = |i: usize| {
            let (x, y) = (i % COSINES, i / COSINES);
            let (cosine, height) = (x as f32 / (COSINES - 1) as f32 * 2.0 - 1.0, y as f32 / (HEIGHTS - 1) as f32);
            transmittance(atmosphere, cosine, height)
        };
        Self { atmosphere, to_sun: (0..COSINES * HEIGHTS).into_par_iter().map(texel).collect() }
    }

    /// Transmittance between texels.
    fn to_sun(&self, cosine: f32, height: f32) -> Vec4 {
        let place = |x: f32, size: usize| {
            let x = x.clamp(0.0, 1.0) * (size - 1) as f32;
            (x as usize, (x as usize + 1).min(size - 1), x.fract())
        };
        let ((x0, x1, tx), (y0, y1, ty)) = (place(cosine * 0.5 + 0.5, COSINES), place(height, HEIGHTS));
        let row = |y: usize| self.to_sun[y * COSINES + x0].lerp(self.to_sun[y * COSINES + x1], tx);
        row(y0).lerp(row(y1), ty)
    }

    /// What arrives along `direction` from within `length`.
    fn scattered(&self, from: Vec3, direction: Vec3, sun: Vec3, length: f32) -> Vec4 {
        let (air_phase, drops_phase) = phases(direction.dot(sun));
        let step = length / STEPS as f32;
        let (mut sum, mut passed) = (Vec4::ZERO, Vec4::ONE);
        for i in 0..STEPS {
            let p = from + direction * ((i as f32 + 0.5) * step);
            let radius = p.length();
            let height = (radius - EARTH).max(0.0);
            let cosine = (p / radius).dot(sun);
            let matter = Matter::at(self.atmosphere, height);
            let direct = self.to_sun(cosine, height / THICKNESS);
            let often = self.scattered_often(cosine, height / THICKNESS, radius);
            let source =
                SUN * (matter.air * (air_phase * direct + often) + matter.drops * (drops_phase * direct + often));
            let through = (-step * matter.extinction).exp();
            sum += passed * ((source - source * through) / matter.extinction.max(Vec4::splat(1e-7)));
            passed *= through;
        }
        sum
    }

    /// Light that the ground or the air has scattered before: the thesis' fit.
    fn scattered_often(&self, cosine: f32, height: f32, radius: f32) -> Vec4 {
        let sine = EARTH / radius;
        let ground_angle = TAU * (1.0 - safe_sqrt(1.0 - sine * sine));
        let from_ground = self.to_sun(1.0, 0.0) / self.to_sun(1.0, height);
        let ground = self.to_sun(cosine, 0.0) * from_ground * (ground_angle / (4.0 * PI) * GROUND_ALBEDO / PI * cosine);
        let air = Vec4::new(0.217, 0.347, 0.594, 1.0) * (0.02 / (1.0 + 5.0 * (-17.92 * cosine).exp()));
        air + ground
    }
}

/// Phase functions of molecules (Rayleigh) and drops (Henyey, Greenstein), by the cosine of the angle
/// between the directions to the sky and to the sun.
fn phases(cosine: f32) -> (f32, f32) {
    let g = ANISOTROPY;
    let denominator = 1.0 + g * g - 2.0 * g * cosine;
    let air = 3.0 / (16.0 * PI) * (1.0 + cosine * cosine);
    (air, (1.0 - g * g) / (4.0 * PI * denominator * denominator.sqrt()))
}

/// Distance to a sphere around the earth's centre; negative if it is not met.
fn to_sphere(p: Vec3, direction: Vec3, radius: f32) -> f32 {
    let b = p.dot(direction);
    let c = p.length_squared() - radius * radius;
    let d = b * b - c;
    if d < 0.0 || (c > 0.0 && b > 0.0) {
        -1.0
    } else if c <= 0.0 {
        -b + d.sqrt()
    } else {
        -b - d.sqrt()
    }
}
