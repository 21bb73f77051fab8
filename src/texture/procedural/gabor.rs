//! Gabor: a sum of oriented ripples, each under a bell.
//!
//! Ares Lagae et al.: *Procedural Noise using Sparse Gabor Convolution*, SIGGRAPH 2009; Vincent Tavernier
//! et al.: *Making Gabor Noise Fast and Normalized*, Eurographics 2019 (a fixed number of impulses per
//! cell, weights of ±1); Thibault Tricard et al.: *Procedural Phasor Noise*, SIGGRAPH 2019, equations 8
//! and 9 (phase and intensity).

use std::f32::consts::{FRAC_1_SQRT_2, PI, TAU};

use crate::math::{Vec2, Vec3};

use super::hash::unit;
use super::round::{floor, saturate};

/// Ripples per cell.
const IMPULSES: u8 = 8;

/// What is picked for a Gabor texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gabor {
    /// In the plane of `x` and `y`.
    Two,
    /// In space.
    Three,
}

/// What can be linked to a Gabor texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaborSockets {
    /// Cells per unit.
    pub scale: f32,
    /// Ripples per cell, at least 0.001.
    pub frequency: f32,
    /// 1 for one orientation, 0 for all.
    pub anisotropy: f32,
    /// Orientation in the plane, in radians.
    pub orientation_2d: f32,
    /// Orientation in space, of any length.
    pub orientation_3d: Vec3,
}

/// A Gabor texture at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaborValue {
    /// The noise, about 0 to 1.
    pub value: f32,
    /// Its phase, 0 to 1.
    pub phase: f32,
    /// Its strength without the ripples.
    pub intensity: f32,
}

impl Gabor {
    /// All outputs at a position.
    pub fn value(self, p: Vec3, sockets: &GaborSockets) -> GaborValue {
        let p = p * sockets.scale;
        let isotropy = 1.0 - saturate(sockets.anisotropy);
        let frequency = sockets.frequency.max(0.001);
        // Mean square of a ripple under its bell, in the limit of high frequency; weights have 1/2.
        let (phasor, mean_square) = match self {
            Self::Two => (plane([p.x, p.y], frequency, isotropy, sockets.orientation_2d), 0.25),
            Self::Three => {
                let orientation = sockets.orientation_3d / sockets.orientation_3d.length();
                (space(p.to_array(), frequency, isotropy, orientation), 0.25 * FRAC_1_SQRT_2)
            }
        };
        let range = 6.0 * (f32::from(IMPULSES) * 0.5 * mean_square).sqrt();
        GaborValue {
            value: phasor.y / range * 0.5 + 0.5,
            phase: (phasor.y.atan2(phasor.x) + PI) / TAU,
            intensity: phasor.length() / range,
        }
    }
}

/// One ripple's phasor `turns` along it, under the windowed bell at that distance.
fn ripple(distance_squared: f32, turns: f32) -> Vec2 {
    let window = 0.5 + 0.5 * (PI * distance_squared).cos();
    let bell = (-PI * distance_squared).exp() * window;
    let (sin, cos) = (TAU * turns).sin_cos();
    bell * Vec2::new(cos, sin)
}

fn plane(p: [f32; 2], frequency: f32, isotropy: f32, orientation: f32) -> Vec2 {
    let corner = p.map(floor);
    let mut sum = Vec2::ZERO;
    for y in [-1.0, 0.0, 1.0] {
        for x in [-1.0, 0.0, 1.0] {
            let cell = [corner[0] + x, corner[1] + y];
            let inside = Vec2::new(p[0] - corner[0] - x, p[1] - corner[1] - y);
            for impulse in 0..IMPULSES {
                let seed = |which: u8| [cell[0], cell[1], f32::from(3 * impulse + which)];
                let [cx, cy, cz] = seed(1);
                let from_center = inside - Vec2::new(unit([cx, cy, cz]), unit([cz, cx, cy]));
                let distance_squared = from_center.length_squared();
                if distance_squared >= 1.0 {
                    continue;
                }
                let angle = orientation + (unit(seed(0)) - 0.5) * PI * isotropy;
                let along = Vec2::from_angle(angle) * frequency;
                let phasor = ripple(distance_squared, from_center.dot(along));
                sum += if unit(seed(2)) < 0.5 { -phasor } else { phasor };
            }
        }
    }
    sum
}

fn space(p: [f32; 3], frequency: f32, isotropy: f32, orientation: Vec3) -> Vec2 {
    let corner = p.map(floor);
    let mut sum = Vec2::ZERO;
    for z in [-1.0, 0.0, 1.0] {
        for y in [-1.0, 0.0, 1.0] {
            for x in [-1.0, 0.0, 1.0] {
                let cell = [corner[0] + x, corner[1] + y, corner[2] + z];
                let inside = Vec3::new(p[0] - corner[0] - x, p[1] - corner[1] - y, p[2] - corner[2] - z);
                for impulse in 0..IMPULSES {
                    let seed = |which: u8| [cell[0], cell[1], cell[2], f32::from(3 * impulse + which)];
                    let [cx, cy, cz, cw] = seed(1);
                    let center = Vec3::new(unit([cx, cy, cz, cw]), unit([cz, cx, cw, cy]), unit([cw, cz, cy, cx]));
                    let from_center = inside - center;
                    let distance_squared = from_center.length_squared();
                    if distance_squared >= 1.0 {
                        continue;
                    }
                    let along = turned(orientation, isotropy, seed(0)) * frequency;
                    let phasor = ripple(distance_squared, from_center.dot(along));
                    sum += if unit(seed(2)) < 0.5 { -phasor } else { phasor };
                }
            }
        }
    }
    sum
}

/// The orientation turned at random, by as much as `isotropy` lets it.
fn turned(orientation: Vec3, isotropy: f32, [x, y, z, w]: [f32; 4]) -> Vec3 {
    if isotropy == 0.0 {
        return orientation;
    }
    let azimuth = (orientation.x / orientation.truncate().length()).acos();
    let azimuth = if orientation.y < 0.0 { -azimuth } else { azimuth };
    let inclination = orientation.z.acos() + unit([x, y, z, w]) * PI * isotropy;
    let azimuth = azimuth + unit([z, x, w, y]) * PI * isotropy;
    let (sin, cos) = inclination.sin_cos();
    Vec3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos)
}
