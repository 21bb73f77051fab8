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
    pub fn for_sample(&self, x: u32, y: u32, index: u64) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        let mut seed = mix64(mix64(self.seed ^ GOLDEN).wrapping_add(pixel.wrapping_mul(GOLDEN)));
        let run = index >> 32;
        if run != 0 {
            seed = mix64(seed ^ run.wrapping_mul(GOLDEN));
        }
        Self { point: Point::new(seed, index as u32), ..*self }
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
