//! A camera that moves while its shutter is open.

use super::{Camera, Projection, View};
use crate::math::{DAffine3, MovingTransform};

/// Where a camera stands at each time.
#[derive(Clone, Debug)]
pub struct CameraMotion {
    /// From the camera, which looks along −z, to render space; without scale.
    pub to_render: MovingTransform,
}

impl CameraMotion {
    /// `camera` as it stands at `time`, 0 to 1 within the shutter.
    pub fn at(&self, camera: &Camera, time: f32) -> Camera {
        let to_render = self.to_render.at(time);
        let moved = |view: View| view_of(&to_render, view);
        let mut camera = *camera;
        match &mut camera.projection {
            Projection::Perspective(perspective) => perspective.view = moved(perspective.view),
            Projection::Orthographic(orthographic) => orthographic.view = moved(orthographic.view),
            Projection::Panorama(panorama) => panorama.view = moved(panorama.view),
        }
        camera
    }
}

/// `view` from where `to_render` puts the camera.
fn view_of(to_render: &DAffine3, view: View) -> View {
    let m = to_render.matrix3;
    View {
        origin: to_render.translation.as_vec3(),
        right: m.x_axis.as_vec3(),
        up: m.y_axis.as_vec3(),
        forward: -m.z_axis.as_vec3(),
        ..view
    }
}
