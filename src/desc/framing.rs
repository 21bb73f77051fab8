//! How a picture frames a scene.

use std::sync::Arc;

use super::CameraDesc;

/// What of a scene a picture shows, as authored; what is `None` is not authored.
#[derive(Clone, Debug, PartialEq)]
pub struct FramingDesc {
    /// Path or name of the camera.
    pub camera: Option<Arc<str>>,
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
    /// What a picture of another shape than the camera's frame shows.
    pub conform: Conform,
    /// The part of the picture that is wanted, in shares of it: left, top, right and lower edge, 0 to 1 in the frame and
    /// beyond it where more is to be seen. The pixels are those whose centres are within.
    pub window: Option<[f64; 4]>,
    /// What the camera has and the picture does not show.
    pub off: EffectsOff,
}

impl Default for FramingDesc {
    fn default() -> Self {
        Self {
            camera: None,
            resolution: None,
            pixel_aspect: 1.0,
            conform: Conform::Expand,
            window: None,
            off: EffectsOff::default(),
        }
    }
}

/// What a picture of another shape than the camera's frame shows (UsdRender's `aspectRatioConformPolicy`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conform {
    /// All of the frame, and more on two sides.
    #[default]
    Expand,
    /// Nothing but the frame, less of it on two sides.
    Crop,
    /// The frame's height, and the width that follows.
    Width,
    /// The frame's width, and the height that follows.
    Height,
    /// The frame, with pixels of another shape.
    Pixels,
}

/// Effects of the camera that are off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EffectsOff {
    /// The shutter is open at the frame alone.
    pub motion_blur: bool,
    /// The shutter closes when it opens.
    pub shutter: bool,
    /// All is sharp.
    pub depth_of_field: bool,
}

impl EffectsOff {
    /// True where nothing is seen to move.
    pub const fn stands_still(self) -> bool {
        self.motion_blur || self.shutter
    }

    /// Turns off what is off.
    pub fn apply(self, camera: &mut CameraDesc) {
        if self.depth_of_field {
            camera.lens = None;
        }
        if self.motion_blur {
            camera.shutter = [0.0; 2];
        } else if self.shutter {
            camera.shutter[1] = camera.shutter[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{LensDesc, ProjectionDesc};
    use crate::error::Place;
    use crate::math::DAffine3;

    #[test]
    fn effects_of_cameras_are_turned_off() {
        let camera = |off: EffectsOff| {
            let mut camera = CameraDesc {
                name: "camera".into(),
                place: Place::default(),
                transform: DAffine3::IDENTITY,
                projection: ProjectionDesc::Perspective { fov_y: 1.0, aspect: None },
                clip_near: 0.0,
                clip_far: f64::INFINITY,
                shift: [0.0; 2],
                lens: Some(LensDesc::round(0.1, 5.0)),
                shutter: [-0.25, 0.5],
                exposure: 1.0,
                shutter_curve: Vec::new(),
                rolling_shutter: None,
                zoom: Vec::new(),
                motion: Vec::new(),
            };
            off.apply(&mut camera);
            (camera.shutter, camera.lens.is_some())
        };
        let none = EffectsOff::default();
        assert_eq!(camera(none), ([-0.25, 0.5], true));
        assert_eq!(camera(EffectsOff { depth_of_field: true, ..none }), ([-0.25, 0.5], false));
        assert_eq!(camera(EffectsOff { motion_blur: true, ..none }), ([0.0, 0.0], true));
        assert_eq!(camera(EffectsOff { shutter: true, ..none }), ([-0.25, -0.25], true));
    }
}
