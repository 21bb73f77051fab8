//! Wave: bands or rings of sines, saws or triangles, shaken by noise.

use std::f32::consts::{FRAC_PI_2, TAU};

use crate::math::Vec3;

use super::fractal::Octaves;
use super::round::{floor, fused, off_edges};

/// Where a wave runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveDirection {
    /// Bands along x.
    BandsX,
    /// Bands along y.
    BandsY,
    /// Bands along z.
    BandsZ,
    /// Bands along the diagonal.
    BandsDiagonal,
    /// Rings around the x axis.
    RingsX,
    /// Rings around the y axis.
    RingsY,
    /// Rings around the z axis.
    RingsZ,
    /// Shells around the origin.
    RingsSpherical,
}

/// What a period looks like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveProfile {
    /// A sine.
    Sine,
    /// A ramp.
    Saw,
    /// Up and down.
    Triangle,
}

/// What is picked for a wave texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wave {
    /// Where the wave runs.
    pub direction: WaveDirection,
    /// What a period looks like.
    pub profile: WaveProfile,
}

/// What can be linked to a wave texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveSockets {
    /// Periods per unit, times π/10.
    pub scale: f32,
    /// How far noise shifts the phase, in radians.
    pub distortion: f32,
    /// Octaves of that noise beyond the first.
    pub detail: f32,
    /// Frequency of that noise.
    pub detail_scale: f32,
    /// Amplitude of an octave relative to the one before.
    pub detail_roughness: f32,
    /// Shift of the phase in radians.
    pub phase: f32,
}

impl Wave {
    /// The wave at a position, 0 to 1.
    pub fn factor(&self, p: Vec3, sockets: &WaveSockets) -> f32 {
        let p = off_edges(p, sockets.scale);
        let (distance, frequency) = match self.direction {
            WaveDirection::BandsX => (p.x, 20.0),
            WaveDirection::BandsY => (p.y, 20.0),
            WaveDirection::BandsZ => (p.z, 20.0),
            WaveDirection::BandsDiagonal => (p.x + p.y + p.z, 10.0),
            WaveDirection::RingsX => (Vec3::new(0.0, p.y, p.z).length(), 20.0),
            WaveDirection::RingsY => (Vec3::new(p.x, 0.0, p.z).length(), 20.0),
            WaveDirection::RingsZ => (Vec3::new(p.x, p.y, 0.0).length(), 20.0),
            WaveDirection::RingsSpherical => (p.length(), 20.0),
        };
        let mut angle = fused(distance, frequency, sockets.phase);
        if sockets.distortion != 0.0 {
            let octaves = Octaves::new(sockets.detail, sockets.detail_roughness, 2.0);
            let noise = octaves.fbm((p * sockets.detail_scale).to_array(), true);
            angle = fused(sockets.distortion, noise * 2.0 - 1.0, angle);
        }
        match self.profile {
            WaveProfile::Sine => 0.5 + 0.5 * (angle - FRAC_PI_2).sin(),
            WaveProfile::Saw => angle / TAU - floor(angle / TAU),
            WaveProfile::Triangle => (angle / TAU - floor(angle / TAU + 0.5)).abs() * 2.0,
        }
    }
}
