//! Decoded images in their own size: 8, 16 or 32 bit, one to four channels.

use std::fmt;
use std::sync::Arc;

use half::f16;

use super::texture::Filter;
use crate::error::Place;

/// How stored values become linear Rec.709.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// Colour channels carry the sRGB transfer function (IEC 61966-2-1); alpha is linear.
    Srgb,
    /// Values are what they are: linear colour, or data such as normals and roughness.
    Linear,
}

/// Texels, row by row from the top, channels interleaved.
#[derive(Clone, PartialEq)]
pub enum PixelData {
    /// 8 bit, 0 to 255 is 0 to 1.
    U8(Vec<u8>),
    /// 16 bit, 0 to 65535 is 0 to 1.
    U16(Vec<u16>),
    /// Half float.
    F16(Vec<f16>),
    /// Float.
    F32(Vec<f32>),
}

impl PixelData {
    /// How many values (texels × channels).
    pub fn len(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::F16(v) => v.len(),
            Self::F32(v) => v.len(),
        }
    }

    /// True where there is no texel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Size in memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::U8(v) => v.len(),
            Self::U16(v) => 2 * v.len(),
            Self::F16(v) => 2 * v.len(),
            Self::F32(v) => 4 * v.len(),
        }
    }

    /// Value `i` as stored, integers scaled to 0 to 1.
    pub fn get(&self, i: usize) -> f32 {
        match self {
            Self::U8(v) => f32::from(v[i]) * (1.0 / 255.0),
            Self::U16(v) => f32::from(v[i]) * (1.0 / 65535.0),
            Self::F16(v) => v[i].to_f32(),
            Self::F32(v) => v[i],
        }
    }
}

impl fmt::Debug for PixelData {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self {
            Self::U8(_) => "U8",
            Self::U16(_) => "U16",
            Self::F16(_) => "F16",
            Self::F32(_) => "F32",
        };
        write!(f, "{kind}[{}]", self.len())
    }
}

/// Which values of neighbouring texels are blended where an image is looked up between them.
///
/// The default is linear light of straight colours, as GPUs do and as glTF and USD mean it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blending {
    /// Values as they are stored, by this filter; what comes out is decoded. That is darker between texels of unlike
    /// values, so that the image is that much darker from afar, too.
    pub encoded: Option<Filter>,
    /// Colours are stored times alpha; what comes out is divided by the blended alpha, so that what is transparent
    /// gives its neighbours no colour.
    pub associated: bool,
}

/// A decoded image.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageDesc {
    /// Name or file name.
    pub name: Arc<str>,
    /// Where it came from.
    pub place: Place,
    /// Texels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values per texel: 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha (straight).
    pub channels: u8,
    /// Transfer function.
    pub color_space: ColorSpace,
    /// What is blended between texels.
    pub blending: Blending,
    /// The texels.
    pub pixels: PixelData,
}
