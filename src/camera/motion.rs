//! A camera that moves while its shutter is open.

use super::{Camera, Perspective, Projection, View};
use crate::math::{DAffine3, MovingTransform, Times};

/// Where a camera stands and how much it sees at each time.
#[derive(Clone, Debug)]
pub struct CameraMotion {
    /// From the camera, which looks along −z, to render space; without scale. `None` where it stands still.
    pub to_render: Option<MovingTransform>,
    /// `None` where it sees the same frame all the time.
    pub zoom: Option<Zoom>,
}

/// A perspective camera whose field of view changes: between two keys points of the picture go straight, as in Cycles.
#[derive(Clone, Debug)]
pub struct Zoom {
    times: Times,
    keys: Box<[Perspective]>,
}

impl Zoom {
    /// `None` for keys that don't follow one another.
    pub fn new(keys: &[(f32, Perspective)]) -> Option<Self> {
        let times = Times::new(keys.iter().map(|key| key.0).collect())?;
        Some(Self { times, keys: keys.iter().map(|key| key.1).collect() })
    }

    /// `camera` with the frame that it sees at `time`.
    fn at(&self, camera: Perspective, time: f32) -> Perspective {
        let (stretch, share) = self.times.at(time);
        let (from, to) = (&self.keys[stretch], &self.keys[stretch + 1]);
        let between = |from: f32, to: f32| from + (to - from) * share;
        Perspective {
            tan_half_x: between(from.tan_half_x, to.tan_half_x),
            tan_half_y: between(from.tan_half_y, to.tan_half_y),
            center: [0, 1].map(|i| between(from.center[i], to.center[i])),
            ..camera
        }
    }
}

impl CameraMotion {
    /// `camera` as it stands at `time`, 0 to 1 within the shutter.
    pub fn at(&self, camera: &Camera, time: f32) -> Camera {
        let to_render = self.to_render.as_ref().map(|moving| moving.at(time));
        let moved = |view: View| to_render.as_ref().map_or(view, |to_render| view_of(to_render, view));
        let mut camera = *camera;
        match &mut camera.projection {
            Projection::Perspective(perspective) => perspective.view = moved(perspective.view),
            Projection::Orthographic(orthographic) => orthographic.view = moved(orthographic.view),
            Projection::Panorama(panorama) => panorama.view = moved(panorama.view),
        }
        if let (Projection::Perspective(perspective), Some(zoom)) = (&mut camera.projection, &self.zoom) {
            *perspective = zoom.at(*perspective, time);
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
