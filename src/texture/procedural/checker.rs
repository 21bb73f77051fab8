//! Checker: unit cubes of two colours by turns.

use crate::math::Vec3;

use super::round::cell;

/// 1 where the first colour shows, 0 where the second does.
pub fn checker(p: Vec3, scale: f32) -> f32 {
    // Whole coordinates are moved off the edges of cubes, lest rounding make noise of a flat face.
    let p = (p * scale + 0.000_001) * 0.999_999;
    ((cell(p.x) ^ cell(p.y) ^ cell(p.z)) & 1) as f32
}
