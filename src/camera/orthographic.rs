//! Parallel rays.

use super::{CameraRay, View};
use crate::math::Vec3;

/// A camera infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthographic {
    /// Where it stands.
    pub view: View,
    /// Half of the width that is seen.
    pub half_width: f32,
    /// Half of the height that is seen.
    pub half_height: f32,
    /// How far the picture's centre is off the axis, right and up (lens shift).
    pub center: [f32; 2],
    /// Size of the picture in pixels.
    pub size: [f32; 2],
}

impl Orthographic {
    /// See [`super::Camera::ray`].
    pub fn ray(&self, x: f32, y: f32) -> CameraRay {
        let view = &self.view;
        let sx = (2.0 * x / self.size[0] - 1.0) * self.half_width + self.center[0];
        let sy = (1.0 - 2.0 * y / self.size[1]) * self.half_height + self.center[1];
        let ray = view.clipped(view.origin + view.right * sx + view.up * sy, view.forward);
        CameraRay { ray, width: 2.0 * self.half_height / self.size[1], spread: 0.0 }
    }

    /// See [`super::Camera::window`].
    pub fn window(&self, p: Vec3) -> [f32; 2] {
        let (view, p) = (&self.view, p - self.view.origin);
        let x = (p.dot(view.right) - self.center[0]) / self.half_width;
        let y = (p.dot(view.up) - self.center[1]) / self.half_height;
        [0.5 * (x + 1.0), 0.5 * (y + 1.0)]
    }
}
