//! The mean of what a filter of stored values gives over each texel, for the first level of a pyramid.
//!
//! Decoding bends the values between texels downwards, so that this mean lies below that of the texels. It is taken by
//! Gauss's rule of two points over each half of a texel along both axes.

use super::blend::{finish, kernel, multiplied};
use super::texel::{Format, Level, Reader};
use crate::desc::{Blending, Filter};

/// Where the rule has its points within a texel: in both halves alike, at equal weights.
const POINTS: [f32; 4] = {
    let (near, far) = (0.105_662_43, 0.394_337_57);
    [near, far, 0.5 + near, 0.5 + far]
};

/// Reads the means of one row of texels.
pub(super) struct Row<'a> {
    pub level: &'a Level,
    pub y: usize,
    pub format: Format,
    pub blending: Blending,
}

impl Row<'_> {
    /// Light times alpha and alpha where colours are associated, else light and alpha.
    pub(super) fn means(&self) -> Vec<[f32; 4]> {
        self.format.stored(self.blending).read(&self.level.pixels, self)
    }
}

impl Reader<Vec<[f32; 4]>> for &Row<'_> {
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> Vec<[f32; 4]> {
        let Row { level, y, blending, .. } = *self;
        let filter = blending.encoded.unwrap_or(Filter::Linear);
        let (width, last) = (level.width as usize, level.height as i32 - 1);
        let mut means = vec![[0.0; 4]; width];
        // Taps of each point, relative to the texel that it lies in.
        let taps = POINTS.map(|point| kernel(point - 0.5, filter));
        let mut line = vec![[0.0_f32; 4]; width];
        for (first, weights, count) in taps {
            line.fill([0.0; 4]);
            for (k, weight) in weights.iter().enumerate().take(count) {
                let row = (y as i32 + first + k as i32).clamp(0, last) as usize;
                for (x, sum) in line.iter_mut().enumerate() {
                    add(sum, *weight, texel(level.offset(x, row)));
                }
            }
            for (x, mean) in means.iter_mut().enumerate() {
                for (first, weights, count) in taps {
                    let mut value = [0.0; 4];
                    for (k, weight) in weights.iter().enumerate().take(count) {
                        let column = (x as i32 + first + k as i32).clamp(0, width as i32 - 1) as usize;
                        add(&mut value, *weight, line[column]);
                    }
                    let value = finish(value, blending);
                    add(mean, 1.0 / 16.0, if blending.associated { multiplied(value) } else { value });
                }
            }
        }
        means
    }
}

#[inline(always)]
fn add(sum: &mut [f32; 4], weight: f32, value: [f32; 4]) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += weight * value;
    }
}
