//! Cameras: from a point of the picture to a ray.

mod lens;
mod motion;
mod orthographic;
mod panorama;
mod perspective;
mod shutter;

pub use lens::Lens;
pub use motion::{CameraMotion, Zoom};
pub use orthographic::Orthographic;
pub use panorama::Panorama;
pub use perspective::Perspective;
pub use shutter::Exposure;

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
        Ray { t_max: self.clip_far / per_t - start, ..Ray::new(o + d * start, d) }
    }
}

/// How a camera projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// See [`Perspective`].
    Perspective(Perspective),
    /// See [`Orthographic`].
    Orthographic(Orthographic),
    /// See [`Panorama`].
    Panorama(Panorama),
}

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// How it projects.
    pub projection: Projection,
    /// Its lens; `None` for a pinhole.
    pub lens: Option<Lens>,
    /// Left upper corner of what is rendered, in pixels of the whole picture.
    pub corner: [f32; 2],
}

impl Camera {
    /// The ray through `(x, y)`, in pixels from the top left corner of what is rendered, from the middle
    /// of the lens.
    pub fn ray(&self, x: f32, y: f32) -> CameraRay {
        let (x, y) = (x + self.corner[0], y + self.corner[1]);
        match &self.projection {
            Projection::Perspective(camera) => camera.ray(x, y),
            Projection::Orthographic(camera) => camera.ray(x, y),
            Projection::Panorama(camera) => camera.ray(x, y),
        }
    }

    /// The same from a point of the lens; `u` is asked only where there is one.
    pub fn lens_ray(&self, x: f32, y: f32, u: impl FnOnce() -> [f32; 2]) -> CameraRay {
        let straight = self.ray(x, y);
        let Some(lens) = &self.lens else { return straight };
        let view = self.view();
        let [right, up] = lens.sample(u());
        let d = straight.ray.d;
        let per_t = d.dot(view.forward);
        let aside = view.right * right + view.up * up;
        // Where the straight ray leaves the plane of the lens, and from there to where it is sharp, over that distance:
        // it may be infinite.
        let start = straight.ray.o - d * (view.clip_near / per_t);
        let through = (d / per_t - aside / lens.focus).normalize();
        CameraRay { ray: view.clipped(start + aside, through), ..straight }
    }

    /// What the depth pass holds of `p`: its distance along the axis, or from a panorama.
    pub fn depth(&self, p: Vec3) -> f32 {
        match &self.projection {
            Projection::Panorama(camera) => (p - camera.view.origin).length(),
            _ => self.view().depth(p),
        }
    }

    /// How far `p` is from the camera; along the axis where rays are parallel.
    pub fn distance(&self, p: Vec3) -> f32 {
        match &self.projection {
            Projection::Orthographic(camera) => camera.view.depth(p).abs(),
            _ => (p - self.view().origin).length(),
        }
    }

    /// Where `p` stands in the whole picture: pixels from the left and from below.
    pub fn raster(&self, p: Vec3) -> [f32; 2] {
        let ([x, y], [width, height]) = (self.window(p), self.size());
        [x * width, y * height]
    }

    /// How far `y`, in pixels from the top of what is rendered, is down the whole picture: 0 to 1.
    pub fn down(&self, y: f32) -> f32 {
        (y + self.corner[1]) / self.size()[1]
    }

    /// Size of the whole picture in pixels.
    fn size(&self) -> [f32; 2] {
        match &self.projection {
            Projection::Perspective(camera) => camera.size,
            Projection::Orthographic(camera) => camera.size,
            Projection::Panorama(camera) => camera.size,
        }
    }

    /// Where `p` stands in the picture: 0 to 1 from the left and from below.
    pub fn window(&self, p: Vec3) -> [f32; 2] {
        match &self.projection {
            Projection::Perspective(camera) => camera.window(p),
            Projection::Orthographic(camera) => camera.window(p),
            Projection::Panorama(camera) => camera.window(p),
        }
    }

    /// Where it stands.
    pub fn view(&self) -> &View {
        match &self.projection {
            Projection::Perspective(camera) => &camera.view,
            Projection::Orthographic(camera) => &camera.view,
            Projection::Panorama(camera) => &camera.view,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All rays of a pixel meet at the distance in focus, and start on the lens.
    #[test]
    fn rays_meet_where_it_is_sharp() {
        let view = View {
            origin: Vec3::new(0.0, 0.0, 5.0),
            right: Vec3::X,
            up: Vec3::Y,
            forward: Vec3::NEG_Z,
            clip_near: 0.0,
            clip_far: 100.0,
        };
        let perspective =
            Perspective { view, tan_half_x: 1.0, tan_half_y: 0.5, center: [0.1, 0.0], size: [200.0, 100.0] };
        let orthographic =
            Orthographic { view, half_width: 2.0, half_height: 1.0, center: [0.0; 2], size: [200.0, 100.0] };
        let lens = Some(Lens { radius: 0.25, focus: 3.0, blades: 0, rotation: 0.0, ratio: 1.0 });
        for projection in [Projection::Perspective(perspective), Projection::Orthographic(orthographic)] {
            let camera = Camera { projection, lens, corner: [10.0, 20.0] };
            let pinhole = camera.ray(30.0, 7.0).ray;
            let sharp = pinhole.at(3.0 / pinhole.d.dot(view.forward));
            for u in [[0.1, 0.9], [0.5, 0.2], [0.99, 0.01]] {
                let ray = camera.lens_ray(30.0, 7.0, || u).ray;
                assert!((ray.o - pinhole.o).length() <= 0.2501);
                let t = (sharp - ray.o).dot(ray.d);
                assert!((ray.at(t) - sharp).length() < 1e-5);
            }
            let without = Camera { lens: None, ..camera };
            assert_eq!(without.lens_ray(30.0, 7.0, || panic!("no lens, no sample")).ray, pinhole);
            assert_eq!(Camera { corner: [0.0; 2], ..without }.ray(40.0, 27.0).ray, pinhole);
        }
    }
}
