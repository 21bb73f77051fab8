//! Noise: a fractal of gradient noise, optionally bent by noise.

use crate::math::Vec3;

use super::Dimensions;
use super::fractal::Octaves;
use super::hash::unit;
use super::perlin::signed;

/// How octaves are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseKind {
    /// Fractional Brownian motion: a sum.
    Fbm,
    /// A product.
    Multifractal,
    /// Sum and product, smooth in the valleys.
    HybridMultifractal,
    /// Ridges where the noise crosses 0.
    RidgedMultifractal,
    /// Roughness grows with height.
    HeteroTerrain,
}

/// What is picked for a noise texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Noise {
    /// Coordinates read.
    pub dimensions: Dimensions,
    /// How octaves are put together.
    pub kind: NoiseKind,
    /// Maps [`NoiseKind::Fbm`] to about 0 to 1; the others do not heed it.
    pub normalize: bool,
}

/// What can be linked to a noise texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseSockets {
    /// Frequency of the first octave, along `w` too.
    pub scale: f32,
    /// Octaves beyond the first, held in 0 to 15.
    pub detail: f32,
    /// Amplitude of an octave relative to the one before, held above 0.
    pub roughness: f32,
    /// Frequency of an octave relative to the one before.
    pub lacunarity: f32,
    /// Added to the octaves of hybrid, ridged and hetero terrain.
    pub offset: f32,
    /// Weight of finer octaves in hybrid and ridged.
    pub gain: f32,
    /// How far noise displaces the position.
    pub distortion: f32,
}

impl Noise {
    /// The factor at a position.
    pub fn factor(&self, p: Vec3, w: f32, sockets: &NoiseSockets) -> f32 {
        self.evaluate::<1>(p, w, sockets)[0]
    }

    /// The colour at a position; its red is the factor.
    pub fn color(&self, p: Vec3, w: f32, sockets: &NoiseSockets) -> [f32; 3] {
        self.evaluate::<3>(p, w, sockets)
    }

    fn evaluate<const C: usize>(&self, p: Vec3, w: f32, sockets: &NoiseSockets) -> [f32; C] {
        let (p, w) = (p * sockets.scale, w * sockets.scale);
        match self.dimensions {
            Dimensions::One => self.channels([w], sockets),
            Dimensions::Two => self.channels([p.x, p.y], sockets),
            Dimensions::Three => self.channels([p.x, p.y, p.z], sockets),
            Dimensions::Four => self.channels([p.x, p.y, p.z, w], sockets),
        }
    }

    /// Channels read the same noise at places far from each other.
    fn channels<const N: usize, const C: usize>(&self, p: [f32; N], sockets: &NoiseSockets) -> [f32; C] {
        let octaves = Octaves::new(sockets.detail.min(15.0), sockets.roughness.max(0.0), sockets.lacunarity);
        let p = distorted(p, sockets.distortion);
        std::array::from_fn(|channel| {
            let at = if channel == 0 { p } else { moved(p, N + channel - 1) };
            match self.kind {
                NoiseKind::Fbm => octaves.fbm(at, self.normalize),
                NoiseKind::Multifractal => octaves.multifractal(at),
                NoiseKind::HybridMultifractal => octaves.hybrid_multifractal(at, sockets.offset, sockets.gain),
                NoiseKind::RidgedMultifractal => octaves.ridged_multifractal(at, sockets.offset, sockets.gain),
                NoiseKind::HeteroTerrain => octaves.hetero_terrain(at, sockets.offset),
            }
        })
    }
}

/// `p` displaced along each axis by another noise.
fn distorted<const N: usize>(p: [f32; N], distortion: f32) -> [f32; N] {
    if distortion == 0.0 {
        return p;
    }
    std::array::from_fn(|axis| p[axis] + signed(moved(p, axis)) * distortion)
}

/// Offsets between 100 and 200 that make other noises of the one: by seed and axis.
const OFFSETS: [[f32; 4]; 6] = {
    let mut offsets = [[0.0; 4]; 6];
    let mut seed = 0;
    while seed < 6 {
        let mut axis = 0;
        while axis < 4 {
            offsets[seed][axis] = 100.0 + unit([seed as f32, axis as f32]) * 100.0;
            axis += 1;
        }
        seed += 1;
    }
    offsets
};

/// The same on a line.
const OFFSETS_1D: [f32; 3] = [100.0 + unit([0.0]) * 100.0, 100.0 + unit([1.0]) * 100.0, 100.0 + unit([2.0]) * 100.0];

fn moved<const N: usize>(p: [f32; N], seed: usize) -> [f32; N] {
    std::array::from_fn(|axis| p[axis] + if N == 1 { OFFSETS_1D[seed] } else { OFFSETS[seed][axis] })
}
