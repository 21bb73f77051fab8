//! Checker: unit cubes of two colours by turns.

use crate::math::Vec3;

use super::round::{cell, off_edges};

/// 1 where the first colour shows, 0 where the second does.
pub fn checker(p: Vec3, scale: f32) -> f32 {
    let p = off_edges(p, scale);
    ((cell(p.x) ^ cell(p.y) ^ cell(p.z)) & 1) as f32
}
