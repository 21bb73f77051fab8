//! The mean of what a filter of stored values gives over each texel, for the first level of a pyramid.
//!
//! Decoding bends the values between texels downwards, so that this mean lies below that of the texels. It is taken by
//! Gauss's rule of two points along both axes between each four texels, whose points count for the texels that they lie
//! in. Only how far what is bent is from the texel goes by a polynomial that stands for the curve: a texel among its like
//! keeps its light.

use super::blend::{divided, finish, kernel, multiplied};
use super::texel::{Format, Level, Reader};
use crate::desc::{Blending, Filter};

/// Where the rule has its points within a texel, from its centre.
const POINTS: [f32; 2] = [-0.211_324_87, 0.211_324_87];

/// Coefficients from the first power on of a polynomial that bends as sRGB's curve does. Means of noise come out within
/// 0.2 % by it, and within 1.5 % where all of it is below 0.05.
const CURVE: [f32; 5] = [0.055_996_8, 0.346_738_9, 1.177_726_7, -0.944_385_4, 0.366_781_7];

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
        let (width, last) = (level.width as usize, level.height as i32 - 1);
        let row = |y: i32| -> Vec<[f32; 4]> {
            (0..width).map(|x| texel(level.offset(x, y.clamp(0, last) as usize))).collect()
        };
        let (associated, filter) = (blending.associated, blending.encoded.unwrap_or(Filter::Linear));
        // Taps of each point, relative to the texel that it lies in.
        let taps = POINTS.map(|point| kernel(point, filter));
        let reach = if filter == Filter::Cubic { 2 } else { 1 };
        let rows: Vec<Vec<[f32; 4]>> = (-reach..=reach).map(|dy| row(y as i32 + dy)).collect();
        let own = &rows[reach as usize];
        let mut means: Vec<[f32; 4]> = own.iter().map(|&value| lit(value, blending)).collect();
        for (first, weights, count) in taps {
            let mut line = vec![[0.0_f32; 4]; width];
            for (k, &weight) in weights.iter().enumerate().take(count) {
                let from = &rows[(reach + first) as usize + k];
                line.iter_mut().zip(from).for_each(|(sum, value)| add(sum, weight, *value));
            }
            for (first, weights, count) in taps {
                for (x, mean) in means.iter_mut().enumerate() {
                    let mut value = [0.0; 4];
                    for (k, &weight) in weights.iter().enumerate().take(count) {
                        let column = (x as i32 + first + k as i32).clamp(0, width as i32 - 1) as usize;
                        add(&mut value, weight, line[column]);
                    }
                    add(mean, 0.25, bent(value, associated));
                }
            }
        }
        means.iter_mut().zip(own).for_each(|(mean, own)| add(mean, -1.0, bent(*own, associated)));
        means.iter_mut().for_each(|mean| *mean = mean.map(|value| value.max(0.0)));
        means
    }
}

/// Light of a stored value, times alpha where colours are.
fn lit(value: [f32; 4], blending: Blending) -> [f32; 4] {
    let light = finish(value, blending);
    if blending.associated { multiplied(light) } else { light }
}

/// The same by the polynomial.
#[inline(always)]
fn bent(value: [f32; 4], associated: bool) -> [f32; 4] {
    let [a, b, c, d, e] = CURVE;
    let value = if associated { divided(value) } else { value };
    let alpha = value[3];
    let mut light = value.map(|x| x * (a + x * (b + x * (c + x * (d + x * e)))));
    light[3] = alpha;
    if associated { multiplied(light) } else { light }
}

#[inline(always)]
fn add(sum: &mut [f32; 4], weight: f32, value: [f32; 4]) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += weight * value;
    }
}
