//! What is blended between the texels of an image: as Cycles' image manager and its kernel do.

use half::f16;
use rayon::prelude::*;

use crate::desc::{ColorSpace, Filter, ImageDesc, PixelData};

/// What a node makes of an image's alpha.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AlphaUse {
    /// Colours don't know of it: data, and images whose alpha is ignored or a channel of its own.
    Apart,
    /// Colours are multiplied by it, and stay so.
    Multiplied,
    /// Colours are multiplied by it, blended, and divided again: where the node's alpha is used, too.
    Divided,
}

/// How the texels of an image are made ready for a look at it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Reading {
    /// What is made of alpha.
    pub alpha: AlphaUse,
    /// True for a look that blends by a cubic B-spline.
    pub cubic: bool,
}

impl Reading {
    /// The texels made ready. `straight` tells that their colours are not multiplied by alpha yet, which is so for integers;
    /// floats come multiplied.
    pub fn applied(self, mut image: ImageDesc, straight: bool) -> ImageDesc {
        let channels = usize::from(image.channels);
        let alpha = channels.is_multiple_of(2) && self.alpha != AlphaUse::Apart && !is_opaque(&image.pixels, channels);
        if alpha && straight {
            multiply(&mut image.pixels, channels);
        }
        image.blending.associated = alpha && self.alpha == AlphaUse::Divided;
        let integers = matches!(image.pixels, PixelData::U8(_) | PixelData::U16(_));
        if integers && image.color_space == ColorSpace::Srgb {
            image.blending.encoded = Some(if self.cubic { Filter::Cubic } else { Filter::Linear });
        }
        image
    }
}

/// True where two readings of one image are the same: what the alpha is used for makes no difference to an opaque one.
pub fn same(a: &ImageDesc, b: &ImageDesc) -> bool {
    a.blending == b.blending && a.pixels == b.pixels
}

fn is_opaque(pixels: &PixelData, channels: usize) -> bool {
    fn all<T: Copy + PartialEq + Sync>(values: &[T], channels: usize, one: T) -> bool {
        values.par_chunks_exact(channels).all(|texel| texel[channels - 1] == one)
    }
    match pixels {
        PixelData::U8(v) => all(v, channels, u8::MAX),
        PixelData::U16(v) => all(v, channels, u16::MAX),
        PixelData::F16(v) => all(v, channels, f16::ONE),
        PixelData::F32(v) => all(v, channels, 1.0),
    }
}

/// Multiplies colours by alpha as they are stored, integers rounded down.
fn multiply(pixels: &mut PixelData, channels: usize) {
    fn each<T: Copy + Send>(values: &mut [T], channels: usize, product: impl Fn(T, T) -> T + Sync) {
        values.par_chunks_exact_mut(channels).for_each(|texel| {
            let (alpha, color) = texel.split_last_mut().expect("texels have an alpha");
            color.iter_mut().for_each(|value| *value = product(*value, *alpha));
        });
    }
    match pixels {
        PixelData::U8(v) => each(v, channels, |a, b| (u32::from(a) * u32::from(b) / 255) as u8),
        PixelData::U16(v) => each(v, channels, |a, b| (u32::from(a) * u32::from(b) / 65535) as u16),
        PixelData::F16(v) => each(v, channels, |a, b| f16::from_f32(a.to_f32() * b.to_f32())),
        PixelData::F32(v) => each(v, channels, |a, b| a * b),
    }
}
