//! Where a light is and where it shines: what the choice among lights goes by.
//!
//! Alejandro Conty Estevez and Christopher Kulla, *Importance Sampling of Many Lights with Adaptive
//! Tree Splitting*, HPG 2018, section 4.

use super::Receiver;
use crate::math::{Bounds, Vec3, safe_sqrt};

/// A box of emitters, a cone of their normals, and how far around those each of them shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Box, render space.
    pub bounds: Bounds,
    /// Unit axis of the cone of normals.
    pub axis: Vec3,
    /// Cosine of the half angle of the cone of normals; −1 for emitters that face everywhere.
    pub cos_normals: f32,
    /// Cosine of the angle around each normal into which light is emitted: 0 for a surface.
    pub cos_emission: f32,
    /// Largest radiant intensity, W·sr⁻¹, luminance: for a surface radiance times area.
    pub intensity: f32,
    /// True where the other side emits as well.
    pub two_sided: bool,
}

impl LightBounds {
    /// Upper bound, roughly, of the irradiance at `at`: 0 only where no light can arrive.
    pub fn importance(&self, at: &Receiver) -> f32 {
        let to_light = self.bounds.center() - at.p;
        let radius = self.bounds.radius();
        let dist_squared = to_light.length_squared();
        // Inside of the sphere around the box nothing is known of directions.
        let clamped = dist_squared.max(radius * radius).max(f32::MIN_POSITIVE);
        let inside = dist_squared <= radius * radius;
        let bound = self.intensity / clamped;
        if inside {
            return bound;
        }
        let dist = dist_squared.sqrt();
        let wi = to_light / dist;
        let sin_box = (radius / dist).min(1.0);
        let cos_box = safe_sqrt(1.0 - sin_box * sin_box);
        // Angle between the axis and the direction back to the receiver, less those of box and normals.
        let mut cos_axis = -self.axis.dot(wi);
        if self.two_sided {
            cos_axis = cos_axis.abs();
        }
        let sin_axis = safe_sqrt(1.0 - cos_axis * cos_axis);
        let sin_normals = safe_sqrt(1.0 - self.cos_normals * self.cos_normals);
        let (cos, sin) = less(cos_axis, sin_axis, self.cos_normals, sin_normals);
        let (cos, _) = less(cos, sin, cos_box, sin_box);
        if cos <= self.cos_emission {
            return 0.0;
        }
        // Lights that shine the same all around, as points do, have no cosine.
        let emitted = if self.cos_normals <= -1.0 { 1.0 } else { cos };
        let received = at.n.map_or(1.0, |n| {
            let cos_n = n.dot(wi);
            less(cos_n, safe_sqrt(1.0 - cos_n * cos_n), cos_box, sin_box).0.max(0.0)
        });
        bound * emitted.max(0.0) * received
    }
}

/// Cosine and sine of `max(a − b, 0)`, both angles given by theirs.
fn less(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> (f32, f32) {
    if cos_a >= cos_b { (1.0, 0.0) } else { (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b) }
}
