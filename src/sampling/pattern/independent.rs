//! Independent random numbers: a hash of pixel, decision and sample index.
//!
//! A counter-based generator in the sense of Salmon et al., *Parallel Random Numbers: As Easy as 1,
//! 2, 3* (SC 2011), with SplitMix64's finalizer in place of a cipher.

use super::Point;
use crate::sampling::Dimension;
use crate::sampling::hash::{GOLDEN, mix64, unit_f32};

#[inline]
fn bits(point: &Point, dimension: Dimension) -> u64 {
    mix64(point.hash(dimension).wrapping_add(u64::from(point.index).wrapping_mul(GOLDEN)))
}

#[inline]
pub(in crate::sampling) fn draw_1d(point: &Point, dimension: Dimension) -> f32 {
    unit_f32((bits(point, dimension) >> 32) as u32)
}

#[inline]
pub(in crate::sampling) fn draw_2d(point: &Point, dimension: Dimension) -> [f32; 2] {
    let bits = bits(point, dimension);
    [unit_f32((bits >> 32) as u32), unit_f32(bits as u32)]
}
