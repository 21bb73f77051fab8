//! Radiance that varies over a light.

use crate::math::{Rgb, Vec3};

/// How a surface emits.
pub trait Emission: Send + Sync + std::fmt::Debug {
    /// Emitted radiance, W·sr⁻¹·m⁻². On a mesh light, at `(1 − u − v) p0 + u p1 + v p2` of `triangle`, on a
    /// round one at the coordinates `uv` of that segment;
    /// on a rectangle, whose triangle is 0, at texture coordinates `uv`, v down from the top.
    fn radiance(&self, triangle: u32, uv: [f32; 2]) -> Rgb;

    /// The same towards `wo`, a unit direction in render space, at `time`, 0 to 1 within the shutter, where it is
    /// not the same towards all and at all times.
    fn radiance_towards(&self, triangle: u32, uv: [f32; 2], wo: Vec3, time: f32) -> Rgb {
        let _ = (wo, time);
        self.radiance(triangle, uv)
    }

    /// Mean radiance of `triangle`, by which it is chosen: 0 only where it is dark all over.
    fn mean(&self, triangle: u32) -> Rgb;
}
