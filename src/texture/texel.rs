//! Texels of one level in their stored size, read as linear color and alpha.

use std::sync::LazyLock;

use half::f16;

use super::srgb;
use crate::desc::{Blending, ColorSpace, PixelData};

/// Linear value of each 16-bit sRGB code.
static DECODE_U16: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|code| srgb::decode(f32::from(code) / 65535.0)).collect());

/// Linear value of each 8-bit code that carries no transfer function.
static UNIT_U8: LazyLock<[f32; 256]> = LazyLock::new(|| std::array::from_fn(|code| code as f32 / 255.0));

/// One level of a pyramid.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Values from one texel to the next, and from one row to the next; both 0 where every texel is the
    /// same and one stands for all.
    pub(super) strides: [usize; 2],
    pub(super) pixels: PixelData,
}

impl Level {
    pub(super) fn new(width: u32, height: u32, channels: usize, pixels: PixelData) -> Self {
        Self { width, height, strides: [channels, channels * width as usize], pixels }
    }

    /// Index of the first value of a texel.
    pub(super) fn offset(&self, x: usize, y: usize) -> usize {
        x * self.strides[0] + y * self.strides[1]
    }
}

/// How the values of an image become linear color and alpha. Float images are linear by the time they
/// stand in a level ([`linearize`]).
#[derive(Clone, Copy, Debug)]
pub(super) struct Format {
    pub(super) channels: usize,
    pub(super) space: ColorSpace,
}

impl Format {
    /// True for the channel that holds alpha.
    pub(super) fn is_alpha(self, channel: usize) -> bool {
        self.channels.is_multiple_of(2) && channel == self.channels - 1
    }

    /// How to read what texels of this `blending` are blended as.
    pub(super) fn stored(self, blending: Blending) -> Self {
        Self { space: if blending.encoded.is_some() { ColorSpace::Linear } else { self.space }, ..self }
    }

    /// Calls `with` with a function from the index of a texel's first value to color and alpha; the
    /// match on the storage happens once for all the texels that `with` reads.
    #[inline(always)]
    pub(super) fn read<R>(self, pixels: &PixelData, with: impl Reader<R>) -> R {
        let n = self.channels;
        match (pixels, self.space) {
            (PixelData::U8(v), ColorSpace::Srgb) => {
                let table = &*srgb::DECODE_U8;
                with.read(|at| expand(&v[at..at + n], |c| table[usize::from(c)], |a| f32::from(a) / 255.0))
            }
            (PixelData::U8(v), ColorSpace::Linear) => {
                let table = &*UNIT_U8;
                with.read(|at| expand(&v[at..at + n], |c| table[usize::from(c)], |a| table[usize::from(a)]))
            }
            (PixelData::U16(v), ColorSpace::Srgb) => {
                let table = &**DECODE_U16;
                with.read(|at| expand(&v[at..at + n], |c| table[usize::from(c)], unit_u16))
            }
            (PixelData::U16(v), ColorSpace::Linear) => with.read(|at| expand(&v[at..at + n], unit_u16, unit_u16)),
            (PixelData::F16(v), _) => with.read(|at| expand(&v[at..at + n], f16::to_f32, f16::to_f32)),
            (PixelData::F32(v), _) => with.read(|at| expand(&v[at..at + n], |c| c, |a| a)),
        }
    }

    /// Values `channels` to a texel, linear, back into the storage of `like`.
    pub(super) fn store(self, linear: &[f32], like: &PixelData) -> PixelData {
        let n = self.channels;
        let encoded = |i: usize, value: f32| match self.space {
            ColorSpace::Srgb if !self.is_alpha(i % n) => srgb::encode(value),
            _ => value,
        };
        let values = linear.iter().copied().enumerate();
        match like {
            PixelData::U8(_) => PixelData::U8(
                values
                    .map(|(i, value)| match self.space {
                        ColorSpace::Srgb if !self.is_alpha(i % n) => srgb::encode_u8(value),
                        _ => (value * 255.0 + 0.5) as u8,
                    })
                    .collect(),
            ),
            PixelData::U16(_) => {
                PixelData::U16(values.map(|(i, value)| (encoded(i, value) * 65535.0 + 0.5) as u16).collect())
            }
            PixelData::F16(_) => PixelData::F16(linear.iter().map(|&value| f16::from_f32(value)).collect()),
            PixelData::F32(_) => PixelData::F32(linear.to_vec()),
        }
    }
}

fn unit_u16(value: u16) -> f32 {
    f32::from(value) / 65535.0
}

/// Grey, grey and alpha, RGB or RGBA to RGBA.
#[inline(always)]
fn expand<T: Copy>(texel: &[T], color: impl Fn(T) -> f32, alpha: impl Fn(T) -> f32) -> [f32; 4] {
    match *texel {
        [r, g, b, a] => [color(r), color(g), color(b), alpha(a)],
        [r, g, b] => [color(r), color(g), color(b), 1.0],
        [y, a] => [color(y), color(y), color(y), alpha(a)],
        [y, ..] => [color(y), color(y), color(y), 1.0],
        [] => [0.0; 4],
    }
}

/// Something that reads texels, whatever their storage.
pub(super) trait Reader<R> {
    /// `texel` maps the index of a texel's first value to linear color and alpha.
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> R;
}

/// Differences of two texels stay finite up to here.
const HUGE: f32 = 0.5 * f32::MAX;

/// Makes float images linear and finite: NaN and infinities become 0. Returns how many values were
/// replaced.
pub(super) fn linearize(pixels: &mut PixelData, format: Format) -> u64 {
    let mut replaced = 0;
    let mut fix = |i: usize, value: f32| {
        if !value.is_finite() {
            replaced += 1;
            0.0
        } else if format.space == ColorSpace::Srgb && !format.is_alpha(i % format.channels) {
            srgb::decode(value).clamp(-HUGE, HUGE)
        } else {
            value.clamp(-HUGE, HUGE)
        }
    };
    match pixels {
        PixelData::U8(_) | PixelData::U16(_) => {}
        PixelData::F16(values) => {
            for (i, value) in values.iter_mut().enumerate() {
                *value = f16::from_f32(fix(i, value.to_f32()));
            }
        }
        PixelData::F32(values) => {
            for (i, value) in values.iter_mut().enumerate() {
                *value = fix(i, *value);
            }
        }
    }
    replaced
}
