//! Ways to look an image up, as authored.

use crate::error::Place;

/// What lies outside of 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The image, every other time mirrored.
    Mirror,
    /// The nearest edge texel.
    Clamp,
    /// Nothing: transparent black.
    Black,
}

/// How texels are blended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Bilinear within a mip level, linear between levels, the level chosen by the ray's footprint.
    #[default]
    Linear,
    /// The one texel that holds the point, at the finest level.
    Nearest,
    /// As linear, but with a cubic B-spline over 4 × 4 texels in the finest level: smooth, and softer.
    Cubic,
}

/// An image with its wrap modes.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureDesc {
    /// Where it stands in the file.
    pub place: Place,
    /// Index into `SceneDesc::images`.
    pub image: u32,
    /// Outside of 0 to 1 along u.
    pub wrap_u: Wrap,
    /// Outside of 0 to 1 along v.
    pub wrap_v: Wrap,
    /// Magnification and mip filter.
    pub filter: Filter,
}

/// A texture as one input of a material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into `SceneDesc::textures`.
    pub texture: u32,
    /// Which UV set of the mesh.
    pub uv_set: u32,
    /// Applied to the UV before the lookup.
    pub transform: TextureTransform,
}

/// An affine map of UV: rows of a 2×3 matrix, `u' = m[0]·(u, v, 1)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureTransform(
    /// The two rows.
    pub [[f64; 3]; 2],
);

impl TextureTransform {
    /// UV as it is.
    pub const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
}
