//! Points moved from one space to another, with the bound of their rounding error.

use super::{Affine3A, Vec3, gamma};

/// `p` moved by `m`, with the half-width of the box in which rounding has left it: `p_err`, which it
/// had before, grown by what the transform adds.
///
/// Matt Pharr, Wenzel Jakob, Greg Humphreys: *Physically Based Rendering*, 4th edition, 6.8.1.
pub fn place_point(m: &Affine3A, p: Vec3, p_err: Vec3) -> (Vec3, Vec3) {
    let magnitude = |v: Vec3| {
        Vec3::from(m.matrix3.x_axis.abs() * v.x + m.matrix3.y_axis.abs() * v.y + m.matrix3.z_axis.abs() * v.z)
    };
    let p_err = magnitude(p_err) * (1.0 + gamma(3)) + (magnitude(p.abs()) + Vec3::from(m.translation).abs()) * gamma(8);
    (m.transform_point3(p), p_err)
}
