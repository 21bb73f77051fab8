//! Cameras: from a point of the picture to a ray.

mod orthographic;
mod perspective;

pub use orthographic::Orthographic;
pub use perspective::Perspective;

use crate::math::{Frame, Ray, Vec3};

/// A camera's ray with its footprint: a cone of width `width + spread · t` around it.
///
/// Tomas Akenine-Möller, Cyril Crassin, Jakub Boksansky, Laurent Belcour, Alexey Panteleev, Oli
/// Wright: *Improved Shader and Texture Level of Detail Using Ray Cones*, JCGT 10(1), 2021.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraRay {
    /// Render space, unit direction.
    pub ray: Ray,
    /// Width of the cone at the ray's origin.
    pub width: f32,
    /// Growth of the width per unit of distance.
    pub spread: f32,
}

/// Where a camera stands in render space, and what it does not see.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Its position.
    pub origin: Vec3,
    /// Unit, to the right of the picture.
    pub right: Vec3,
    /// Unit, to its top.
    pub up: Vec3,
    /// Unit, into the scene.
    pub forward: Vec3,
    /// Nearest distance along `forward` that is seen.
    pub clip_near: f32,
    /// Farthest distance along `forward` that is seen; may be infinite.
    pub clip_far: f32,
}

impl View {
    /// Distance of `p` along the axis: what the depth pass holds.
    pub fn depth(&self, p: Vec3) -> f32 {
        (p - self.origin).dot(self.forward)
    }

    /// Its axes; z points at the viewer.
    pub fn frame(&self) -> Frame {
        Frame { s: self.right, t: self.up, n: -self.forward }
    }

    /// The part between the clip planes of the line from `o` along the unit direction `d`.
    fn clipped(&self, o: Vec3, d: Vec3) -> Ray {
        let per_t = d.dot(self.forward);
        let start = self.clip_near / per_t;
        Ray { o: o + d * start, d, t_max: self.clip_far / per_t - start }
    }
}

/// Any camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Camera {
    /// See [`Perspective`].
    Perspective(Perspective),
    /// See [`Orthographic`].
    Orthographic(Orthographic),
}

impl Camera {
    /// The ray through `(x, y)`, in pixels from the top left corner of the picture.
    pub fn ray(&self, x: f32, y: f32) -> CameraRay {
        match self {
            Self::Perspective(camera) => camera.ray(x, y),
            Self::Orthographic(camera) => camera.ray(x, y),
        }
    }

    /// Where `p` stands in the picture: 0 to 1 from the left and from below.
    pub fn window(&self, p: Vec3) -> [f32; 2] {
        match self {
            Self::Perspective(camera) => camera.window(p),
            Self::Orthographic(camera) => camera.window(p),
        }
    }

    /// Where it stands.
    pub fn view(&self) -> &View {
        match self {
            Self::Perspective(camera) => &camera.view,
            Self::Orthographic(camera) => &camera.view,
        }
    }
}
