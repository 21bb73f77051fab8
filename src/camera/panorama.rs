//! All directions: longitude across the picture, latitude up.

use super::{CameraRay, View};
use crate::math::{Ray, Vec3};

/// Cycles' equirectangular panorama.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panorama {
    /// Where it stands; its clip planes are spheres.
    pub view: View,
    /// Longitudes of the left and right edge; 0 is ahead, to the right is positive.
    pub longitude: [f32; 2],
    /// Latitudes of the lower and upper edge.
    pub latitude: [f32; 2],
    /// Size of the picture in pixels.
    pub size: [f32; 2],
}

impl Panorama {
    /// See [`super::Camera::ray`].
    pub fn ray(&self, x: f32, y: f32) -> CameraRay {
        let view = &self.view;
        let along = |[from, to]: [f32; 2], t: f32| from + (to - from) * t;
        let (sin_lon, cos_lon) = along(self.longitude, x / self.size[0]).sin_cos();
        let (sin_lat, cos_lat) = along(self.latitude, 1.0 - y / self.size[1]).sin_cos();
        let d = (view.forward * cos_lon + view.right * sin_lon) * cos_lat + view.up * sin_lat;
        let ray = Ray { t_max: view.clip_far - view.clip_near, ..Ray::new(view.origin + d * view.clip_near, d) };
        let spread = (self.latitude[1] - self.latitude[0]).abs() / self.size[1];
        CameraRay { ray, width: spread * view.clip_near, spread }
    }

    /// See [`super::Camera::window`].
    pub fn window(&self, p: Vec3) -> [f32; 2] {
        let (view, d) = (&self.view, (p - self.view.origin).normalize_or_zero());
        let longitude = d.dot(view.right).atan2(d.dot(view.forward));
        let latitude = d.dot(view.up).clamp(-1.0, 1.0).asin();
        let share = |[from, to]: [f32; 2], x: f32| if from == to { 0.0 } else { (x - from) / (to - from) };
        [share(self.longitude, longitude), share(self.latitude, latitude)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn the_middle_is_ahead_and_the_edges_are_behind() {
        let view = View {
            origin: Vec3::ZERO,
            right: Vec3::X,
            up: Vec3::Y,
            forward: Vec3::NEG_Z,
            clip_near: 0.5,
            clip_far: 10.0,
        };
        let camera = Panorama { view, longitude: [-PI, PI], latitude: [-0.5 * PI, 0.5 * PI], size: [200.0, 100.0] };
        let d = |x: f32, y: f32| camera.ray(x, y).ray.d;
        assert!((d(100.0, 50.0) - Vec3::NEG_Z).length() < 1e-6);
        assert!((d(150.0, 50.0) - Vec3::X).length() < 1e-6);
        assert!((d(0.0, 50.0) - Vec3::Z).length() < 1e-6);
        assert!((d(37.0, 0.0) - Vec3::Y).length() < 1e-6);
        let [x, y] = camera.window(camera.ray(20.0, 70.0).ray.at(3.0));
        assert!((x - 0.1).abs() < 1e-5 && (y - 0.3).abs() < 1e-5);
        let ray = camera.ray(20.0, 70.0).ray;
        assert!((ray.o.length() - 0.5).abs() < 1e-6 && (ray.at(ray.t_max).length() - 10.0).abs() < 1e-5);
    }
}
