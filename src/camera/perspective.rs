//! Straight lines through one point.

use super::{CameraRay, View};
use crate::math::Vec3;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perspective {
    /// Where it stands.
    pub view: View,
    /// Tangent of half the field of view across the picture.
    pub tan_half_x: f32,
    /// Tangent of half the field of view from bottom to top.
    pub tan_half_y: f32,
    /// How far the picture's centre is off the axis, right and up, as tangents (lens shift).
    pub center: [f32; 2],
    /// Size of the picture in pixels.
    pub size: [f32; 2],
}

impl Perspective {
    /// See [`super::Camera::ray`].
    pub fn ray(&self, x: f32, y: f32) -> CameraRay {
        let view = &self.view;
        let sx = (2.0 * x / self.size[0] - 1.0) * self.tan_half_x + self.center[0];
        let sy = (1.0 - 2.0 * y / self.size[1]) * self.tan_half_y + self.center[1];
        let d = (view.forward + view.right * sx + view.up * sy).normalize();
        let ray = view.clipped(view.origin, d);
        let spread = 2.0 * self.tan_half_y / self.size[1] * d.dot(view.forward);
        CameraRay { ray, width: spread * (ray.o - view.origin).length(), spread }
    }

    /// See [`super::Camera::window`]; what is beside the camera is nowhere.
    pub fn window(&self, p: Vec3) -> [f32; 2] {
        let (view, p) = (&self.view, p - self.view.origin);
        let ahead = p.dot(view.forward);
        if ahead == 0.0 {
            return [0.0; 2];
        }
        let x = (p.dot(view.right) / ahead - self.center[0]) / self.tan_half_x;
        let y = (p.dot(view.up) / ahead - self.center[1]) / self.tan_half_y;
        [0.5 * (x + 1.0), 0.5 * (y + 1.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Perspective {
        let view = View {
            origin: Vec3::new(0.0, 0.0, 5.0),
            right: Vec3::X,
            up: Vec3::Y,
            forward: Vec3::NEG_Z,
            clip_near: 0.5,
            clip_far: 10.0,
        };
        Perspective { view, tan_half_x: 1.0, tan_half_y: 0.5, center: [0.0; 2], size: [200.0, 100.0] }
    }

    #[test]
    fn the_corners_of_the_picture_are_those_of_the_field_of_view() {
        let camera = camera();
        let middle = camera.ray(100.0, 50.0).ray;
        assert_eq!((middle.d, middle.o), (Vec3::NEG_Z, Vec3::new(0.0, 0.0, 4.5)));
        let corner = camera.ray(0.0, 0.0).ray.d;
        assert!((corner / -corner.z - Vec3::new(-1.0, 0.5, -1.0)).length() < 1e-6);
    }

    #[test]
    fn a_shifted_lens_moves_the_frame_and_nothing_else() {
        let straight = camera();
        let shifted = Perspective { center: [0.5, -0.25], ..straight };
        // A quarter of the frame's width (2) to the right, a quarter of its height (1) down.
        for (x, y) in [(0.0, 0.0), (100.0, 50.0), (163.0, 21.0)] {
            let (ray, same) = (shifted.ray(x, y).ray.d, straight.ray(x + 50.0, y + 25.0).ray.d);
            assert!((ray - same).length() < 1e-6);
        }
        assert!((shifted.view.depth(shifted.ray(7.0, 9.0).ray.o) - 0.5).abs() < 1e-5);
    }

    #[test]
    fn points_stand_where_their_rays_come_from() {
        let camera = Perspective { center: [0.5, -0.25], ..camera() };
        for (x, y) in [(0.0, 0.0), (100.0, 50.0), (163.0, 21.0)] {
            let [u, v] = camera.window(camera.ray(x, y).ray.at(3.0));
            assert!((u - x / 200.0).abs() < 1e-5 && (v - (1.0 - y / 100.0)).abs() < 1e-5, "{u} {v}");
        }
        assert_eq!(camera.window(camera.view.origin), [0.0; 2]);
    }

    #[test]
    fn clip_planes_are_planes() {
        let camera = camera();
        let ray = camera.ray(13.0, 81.0).ray;
        assert!((camera.view.depth(ray.o) - 0.5).abs() < 1e-5);
        assert!((camera.view.depth(ray.at(ray.t_max)) - 10.0).abs() < 1e-4);
    }
}
