//! The points of one sample of one pixel.

use super::Dimension;
use super::hash::{GOLDEN, mix64};
use super::pattern::{Pattern, Point, independent, sobol};

/// Draws the random decisions of one sample. A small value without state: the same question has
/// the same answer, in any order and on any thread.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    pattern: Pattern,
    seed: u64,
    point: Point,
}

impl Sampler {
    /// A sampler for the whole image; [`Sampler::for_sample`] makes one for a pixel.
    pub fn new(pattern: Pattern, seed: u64) -> Self {
        Self { pattern, seed, point: Point::new(mix64(seed ^ GOLDEN), 0) }
    }

    /// The sampler of sample `index` of pixel (`x`, `y`). Any index below 2⁶⁴ works; each run of
    /// 2³² is a sequence of its own.
    #[inline]
    pub fn for_sample(&self, x: u32, y: u32, index: u64) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        let seed = mix64(mix64(self.seed ^ GOLDEN).wrapping_add(pixel.wrapping_mul(GOLDEN)));
        Self { point: at_index(seed, index), ..*self }
    }

    /// The sampler of the `k`-th of `n` parts of this sample, for decisions that are made several
    /// times a sample, as the directions of ambient occlusion: the parts of all samples together
    /// are one sequence. A decision must be drawn either in parts or whole, and always in as many.
    #[inline]
    pub fn part(&self, k: u32, n: u32) -> Self {
        let index = u64::from(self.point.index) * u64::from(n) + u64::from(k);
        Self { point: at_index(self.point.seed, index), ..*self }
    }

    /// A number in [0, 1).
    #[inline]
    pub fn get_1d(&self, dimension: Dimension) -> f32 {
        match self.pattern {
            Pattern::Sobol => sobol::draw_1d(&self.point, dimension),
            Pattern::Independent => independent::draw_1d(&self.point, dimension),
        }
    }

    /// A point in [0, 1)².
    #[inline]
    pub fn get_2d(&self, dimension: Dimension) -> [f32; 2] {
        match self.pattern {
            Pattern::Sobol => sobol::draw_2d(&self.point, dimension),
            Pattern::Independent => independent::draw_2d(&self.point, dimension),
        }
    }
}

/// The upper half of the index chooses another sequence.
#[inline]
fn at_index(seed: u64, index: u64) -> Point {
    let run = index >> 32;
    let seed = if run == 0 { seed } else { mix64(seed ^ run.wrapping_mul(GOLDEN)) };
    Point::new(seed, index as u32)
}
