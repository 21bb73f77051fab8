//! Mip pyramids by area: every texel of a level is the mean of exactly the area that it covers.
//!
//! Sides halve, rounded down, never below 1. Where a side is odd, texels at the border of two coarse
//! ones are shared by area, so that the mean of every level is the mean of the image: Lance Williams:
//! *Pyramidal Parametrics*, SIGGRAPH 1983, with exact box filtering for sizes that are no powers of
//! two. Means are taken in linear light, straight (channel by channel) as glTF's samplers do, and are
//! carried from level to level in `f32`; each level is rounded to the stored size only once.

use rayon::prelude::*;

use super::area;
use super::texel::{Format, Level, Reader};
use crate::desc::{Blending, PixelData};

/// All levels, finest first, down to 1×1. A finest level with strides of 0 makes such levels.
///
/// Where texels are not blended in light, the finest level is as it is stored, and all others hold light, straight: means
/// of what the filter gives ([`area`]).
pub(super) fn build(finest: Level, format: Format, blending: Blending) -> Vec<Level> {
    let uniform = finest.strides == [0, 0];
    let mut levels = vec![finest];
    // The last level before it was rounded to the stored size.
    let mut exact: Option<PixelData> = None;
    loop {
        let above = &levels[levels.len() - 1];
        let (from, to) = ([above.width, above.height], [above.width, above.height].map(|n| (n / 2).max(1)));
        if from == to {
            return levels;
        }
        let next = if uniform {
            Level { width: to[0], height: to[1], strides: [0, 0], pixels: above.pixels.clone() }
        } else {
            let shrink = Shrink { from, to, channels: format.channels };
            let values = match &exact {
                None if blending.encoded.is_some() => {
                    shrink.lines(|y| area::Row { level: above, y, format, blending }.means())
                }
                None => format.read(&above.pixels, shrink),
                Some(exact) => format.read(exact, shrink),
            };
            let pixels = match blending.associated {
                true => format.store(&straight(&values, format.channels), &above.pixels),
                false => format.store(&values, &above.pixels),
            };
            exact = Some(PixelData::F32(values));
            Level::new(to[0], to[1], format.channels, pixels)
        };
        levels.push(next);
    }
}

/// Makes a level from the one above it.
struct Shrink {
    from: [u32; 2],
    to: [u32; 2],
    channels: usize,
}

impl Reader<Vec<f32>> for Shrink {
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> Vec<f32> {
        let (width, channels) = (self.from[0] as usize, self.channels);
        self.lines(|y| Texels { texel: &texel, start: y * width * channels, channels })
    }
}

/// A row of texels to be averaged.
trait Line {
    fn at(&self, x: usize) -> [f32; 4];
}

impl Line for Vec<[f32; 4]> {
    fn at(&self, x: usize) -> [f32; 4] {
        self[x]
    }
}

/// A row as it is stored.
struct Texels<'a, F> {
    texel: &'a F,
    start: usize,
    channels: usize,
}

impl<F: Fn(usize) -> [f32; 4]> Line for Texels<'_, F> {
    #[inline(always)]
    fn at(&self, x: usize) -> [f32; 4] {
        (self.texel)(self.start + x * self.channels)
    }
}

impl Shrink {
    fn lines<L: Line>(self, line: impl Fn(usize) -> L + Sync) -> Vec<f32> {
        let Self { from, to, channels } = self;
        let (columns, rows) = (spans(from[0], to[0]), spans(from[1], to[1]));
        let mut out = vec![0.0; to[0] as usize * to[1] as usize * channels];
        out.par_chunks_exact_mut(to[0] as usize * channels).zip(&rows).for_each(|(to, row)| {
            let from: Vec<(L, f32)> = row.texels().map(|(y, weight)| (line(y), weight)).collect();
            for (out, column) in to.chunks_exact_mut(channels).zip(&columns) {
                let mut sum = [0.0; 4];
                for (line, wy) in &from {
                    for (x, wx) in column.texels() {
                        let texel = line.at(x);
                        for (sum, value) in sum.iter_mut().zip(texel) {
                            *sum += f64::from(wx * wy) * f64::from(value);
                        }
                    }
                }
                let area = f64::from(row.sum() * column.sum());
                // Of two channels the second is alpha, which stands last in `texel`.
                let order = if channels == 2 { [0, 3, 0, 0] } else { [0, 1, 2, 3] };
                for (out, i) in out.iter_mut().zip(order) {
                    *out = (sum[i] / area) as f32;
                }
            }
        });
        out
    }
}

/// Colours divided by alpha, which is the last of `channels` values.
fn straight(values: &[f32], channels: usize) -> Vec<f32> {
    let mut values = values.to_vec();
    for texel in values.chunks_exact_mut(channels) {
        if let Some((alpha, color)) = texel.split_last_mut().filter(|(alpha, _)| **alpha > 0.0) {
            color.iter_mut().for_each(|value| *value /= *alpha);
        }
    }
    values
}

/// Which fine texels a coarse one covers along one axis, and how much of each.
struct Span {
    first: usize,
    weights: [f32; 4],
}

impl Span {
    fn texels(&self) -> impl Iterator<Item = (usize, f32)> {
        let taken = self.weights.iter().copied().enumerate().filter(|(_, weight)| *weight > 0.0);
        taken.map(|(i, weight)| (self.first + i, weight))
    }

    fn sum(&self) -> f32 {
        self.weights.iter().sum()
    }
}

/// Coarse texel i covers `[i, i + 1] · from / to`; weights are counted in units of `1 / to`, whole
/// numbers, so that nothing is rounded.
fn spans(from: u32, to: u32) -> Vec<Span> {
    let (from, to) = (u64::from(from), u64::from(to));
    let span = |i: u64| {
        let (start, end) = (i * from, (i + 1) * from);
        let first = start / to;
        let covered = |k: u64| {
            let (low, high) = ((first + k) * to, (first + k + 1) * to);
            high.min(end).saturating_sub(low.max(start)) as f32
        };
        Span { first: first as usize, weights: std::array::from_fn(|k| covered(k as u64)) }
    };
    (0..to).map(span).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_cover_every_texel_once() {
        for from in 2..200_u32 {
            let to = from / 2;
            let mut covered = vec![0.0; from as usize];
            for span in spans(from, to) {
                assert_eq!(span.sum(), from as f32, "each coarse texel covers from / to fine ones");
                for (x, weight) in span.texels() {
                    covered[x] += weight;
                }
            }
            assert!(covered.iter().all(|&weight| weight == to as f32), "{from}");
        }
    }
}
