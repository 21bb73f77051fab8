//! The camera that was asked for, moved to render space.

use super::View;
use crate::camera::{self, Camera, Orthographic, Perspective};
use crate::desc::{CameraDesc, ProjectionDesc, SceneDesc};
use crate::error::{Error, Result, Warnings};
use crate::math::DVec3;
use crate::scene::framing::framing_camera;

/// Width of a picture that nobody gave a size.
const DEFAULT_WIDTH: u32 = 960;
/// Aspect of a picture that nobody gave one.
const DEFAULT_ASPECT: f64 = 16.0 / 9.0;
/// Largest number of pixels; the film of one pass alone would be 64 GiB beyond it.
const MAX_PIXELS: u64 = 1 << 32;

/// The camera that `view` names, or the scene's first, or one that frames the scene; and the
/// picture's size.
pub fn choose(desc: &SceneDesc, view: &View, warnings: &mut Warnings) -> Result<(CameraDesc, [u32; 2])> {
    let named = |name: &str| {
        let found = desc.cameras.iter().find(|c| &*c.name == name || c.place.node.as_deref() == Some(name));
        found.ok_or_else(|| {
            let names: Vec<&str> = desc.cameras.iter().map(|c| &*c.name).collect();
            let have = if names.is_empty() { "none".into() } else { names.join(", ") };
            Error::invalid(&desc.place, format!("no camera named \"{name}\"; the file has: {have}"))
        })
    };
    let camera = match &view.camera {
        Some(name) => Some(named(name)?),
        None => desc.cameras.first(),
    };
    let size = view.size.unwrap_or_else(|| {
        let aspect = camera.and_then(aspect_of).unwrap_or(DEFAULT_ASPECT);
        [DEFAULT_WIDTH, ((f64::from(DEFAULT_WIDTH) / aspect).round() as u32).clamp(1, 16 * DEFAULT_WIDTH)]
    });
    if size.contains(&0) || u64::from(size[0]) * u64::from(size[1]) > MAX_PIXELS {
        return Err(Error::invalid(&desc.place, format!("can't render a picture of {}x{} pixels", size[0], size[1])));
    }
    let camera = camera.cloned().unwrap_or_else(|| {
        warnings.push(&desc.place, "no camera in the scene: using one that frames it");
        framing_camera(desc, f64::from(size[0]) / f64::from(size[1]))
    });
    Ok((usable(camera, desc, size, warnings), size))
}

fn aspect_of(camera: &CameraDesc) -> Option<f64> {
    let aspect = match camera.projection {
        ProjectionDesc::Perspective { aspect, .. } => aspect?,
        ProjectionDesc::Orthographic { half_width, half_height } => half_width / half_height,
    };
    (aspect.is_finite() && aspect > 0.0).then_some(aspect)
}

/// `camera`, or the framing one where its numbers make no picture.
fn usable(camera: CameraDesc, desc: &SceneDesc, size: [u32; 2], warnings: &mut Warnings) -> CameraDesc {
    let finite = camera.transform.is_finite() && camera.transform.matrix3.determinant() != 0.0;
    let projects = match camera.projection {
        ProjectionDesc::Perspective { fov_y, .. } => fov_y > 0.0 && fov_y < std::f64::consts::PI,
        ProjectionDesc::Orthographic { half_width, half_height } => {
            half_width > 0.0 && half_height > 0.0 && (half_width + half_height).is_finite()
        }
    };
    if finite && projects && camera.clip_near >= 0.0 && camera.clip_far > camera.clip_near {
        return camera;
    }
    let what = "camera with a singular transform, an impossible field of view or empty clip range: \
                using one that frames the scene";
    warnings.push(&camera.place, what);
    framing_camera(desc, f64::from(size[0]) / f64::from(size[1]))
}

/// `desc` in render space.
pub fn prepare(desc: &CameraDesc, size: [u32; 2], origin: DVec3) -> Camera {
    // Axes by Gram-Schmidt from the direction of view, so that scale and shear don't matter.
    let m = desc.transform.matrix3;
    let forward = -m.z_axis.normalize();
    let up = (m.y_axis - forward * m.y_axis.dot(forward)).normalize_or(forward.any_orthonormal_vector());
    let right = forward.cross(up);
    let mirror = if right.dot(m.x_axis) < 0.0 { -1.0 } else { 1.0 };
    let view = camera::View {
        origin: (desc.transform.translation - origin).as_vec3(),
        right: (right * mirror).as_vec3(),
        up: up.as_vec3(),
        forward: forward.as_vec3(),
        clip_near: desc.clip_near as f32,
        clip_far: desc.clip_far as f32,
    };
    let size_f = size.map(|n| n as f32);
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    match desc.projection {
        ProjectionDesc::Perspective { fov_y, aspect: framed } => {
            let tan_y = (0.5 * fov_y).tan();
            let (x, y) = fit(tan_y * framed.unwrap_or(aspect), tan_y, aspect);
            Camera::Perspective(Perspective { view, tan_half_x: x, tan_half_y: y, size: size_f })
        }
        ProjectionDesc::Orthographic { half_width, half_height } => {
            let (x, y) = fit(half_width, half_height, aspect);
            Camera::Orthographic(Orthographic { view, half_width: x, half_height: y, size: size_f })
        }
    }
}

/// The smallest frame of `aspect` around one of `x` × `y`.
fn fit(x: f64, y: f64, aspect: f64) -> (f32, f32) {
    let (x, y) = if x / y <= aspect { (y * aspect, y) } else { (x, x / aspect) };
    (x as f32, y as f32)
}
