//! Textures computed from a position: pure functions of their sockets.
//!
//! Each is the picture that Cycles draws for the node of the same name (`docs/procedural.md` lists the
//! agreement, measured). A struct holds what an artist picks from menus; a method takes what can be
//! linked. Nothing allocates and nothing panics: a position that is not finite gives a value that may
//! not be finite either, and numbers of octaves are bounded.

mod brick;
mod checker;
mod fractal;
mod gabor;
mod gradient;
mod hash;
mod magic;
mod noise;
mod perlin;
mod round;
mod vector_noise;
mod voronoi;
mod wave;
mod white_noise;
mod worley;

pub use brick::{Brick, BrickSockets, BrickValue};
pub use checker::checker;
pub use gabor::{Gabor, GaborSockets, GaborValue};
pub use gradient::Gradient;
pub use magic::Magic;
pub use noise::{Noise, NoiseKind, NoiseSockets};
pub use vector_noise::vector_noise;
pub use voronoi::{Scatter, Voronoi, VoronoiFeature, VoronoiMetric, VoronoiSockets, VoronoiValue};
pub use wave::{Wave, WaveDirection, WaveProfile, WaveSockets};
pub use white_noise::{WhiteNoise, cell};
pub use worley::{Worley, worley};

/// How many coordinates a texture reads: `w`; `x, y`; `x, y, z`; or `x, y, z, w`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimensions {
    /// `w` alone.
    One,
    /// `x` and `y`.
    Two,
    /// The position.
    Three,
    /// The position and `w`.
    Four,
}
