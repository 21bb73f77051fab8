//! The camera that was asked for, moved to render space.

use super::View;
use crate::camera::{self, Camera, CameraMotion, Lens, Orthographic, Panorama, Perspective, Projection, Zoom};
use crate::desc::{CameraDesc, Conform, LensDesc, ProjectionDesc, RenderDesc, SceneDesc};
use crate::error::{Error, Result, Warnings};
use crate::math::{DAffine3, DMat3, DVec3, MovingTransform};
use crate::scene::framing::framing_camera;
use crate::scene::shutter::Shutter;

/// Width of a picture that nobody gave a size.
const DEFAULT_WIDTH: u32 = 960;
/// Aspect of a picture that nobody gave one.
const DEFAULT_ASPECT: f64 = 16.0 / 9.0;
/// Largest number of pixels; the film of one pass alone would be 64 GiB beyond it.
pub(super) const MAX_PIXELS: u64 = 1 << 32;

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
    let mut camera = usable(camera, desc, size, warnings);
    desc.render.framing.off.apply(&mut camera);
    if let Some(lens) = camera.lens
        && lens.aperture_radius > 0.0
        && usable_lens(&lens).is_none()
    {
        let LensDesc { aperture_radius, focus_distance, .. } = lens;
        let what = format!("a lens of radius {aperture_radius} m in focus at {focus_distance} m: taken for a pinhole");
        warnings.push(&camera.place, what);
    }
    Ok((camera, size))
}

fn aspect_of(camera: &CameraDesc) -> Option<f64> {
    let aspect = match camera.projection {
        ProjectionDesc::Perspective { aspect, .. } => aspect?,
        ProjectionDesc::Orthographic { half_width, half_height } => half_width / half_height,
        ProjectionDesc::Equirectangular { longitude, latitude } => {
            (longitude[1] - longitude[0]) / (latitude[1] - latitude[0])
        }
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
        ProjectionDesc::Equirectangular { longitude: [west, east], latitude: [south, north] } => {
            (west + east + south + north).is_finite()
        }
    };
    let shifted = camera.shift.iter().all(|shift| shift.is_finite());
    if finite && projects && shifted && camera.clip_near >= 0.0 && camera.clip_far > camera.clip_near {
        return camera;
    }
    let what = "camera with a singular transform, an impossible field of view or empty clip range: \
                using one that frames the scene";
    warnings.push(&camera.place, what);
    framing_camera(desc, f64::from(size[0]) / f64::from(size[1]))
}

/// `transform` without scale and shear: axes by Gram-Schmidt from the direction of view.
fn rigid(transform: &DAffine3) -> DAffine3 {
    let m = transform.matrix3;
    let forward = -m.z_axis.normalize();
    let up = (m.y_axis - forward * m.y_axis.dot(forward)).normalize_or(forward.any_orthonormal_vector());
    let right = forward.cross(up);
    let mirror = if right.dot(m.x_axis) < 0.0 { -1.0 } else { 1.0 };
    DAffine3 { matrix3: DMat3::from_cols(right * mirror, up, -forward), translation: transform.translation }
}

/// `desc` in render space, in the middle of `shutter` if it moves then, and how it does; `size` is that of the whole
/// picture, of which `render` may want a part.
pub fn prepare(
    desc: &CameraDesc,
    render: &RenderDesc,
    size: [u32; 2],
    origin: DVec3,
    shutter: Option<Shutter>,
) -> (Camera, Option<CameraMotion>) {
    let camera = still(desc, render, size, origin);
    let to_render = shutter.and_then(|shutter| shutter.keys(&desc.transform, &desc.motion)).and_then(|keys| {
        let rigid: Vec<_> = keys.into_iter().map(|(time, key)| (time, rigid(key))).collect();
        Some(MovingTransform::new(&rigid)?.rebased(DVec3::ZERO, origin))
    });
    let zoom = shutter.and_then(|shutter| shutter.zoom(desc)).and_then(|keys| {
        let at = |projection| still(&CameraDesc { projection, ..desc.clone() }, render, size, origin).projection;
        let keys = keys.into_iter().map(|(time, key)| match at(*key) {
            Projection::Perspective(perspective) => Some((time, perspective)),
            _ => None,
        });
        Zoom::new(&keys.collect::<Option<Vec<_>>>()?)
    });
    let moving = (to_render.is_some() || zoom.is_some()).then_some(CameraMotion { to_render, zoom });
    (moving.as_ref().map_or(camera, |motion| motion.at(&camera, 0.5)), moving)
}

/// `desc` as it stands at the frame.
pub(super) fn still(desc: &CameraDesc, render: &RenderDesc, size: [u32; 2], origin: DVec3) -> Camera {
    let rigid = rigid(&desc.transform);
    let axes = rigid.matrix3;
    let view = camera::View {
        origin: (rigid.translation - origin).as_vec3(),
        right: axes.x_axis.as_vec3(),
        up: axes.y_axis.as_vec3(),
        forward: -axes.z_axis.as_vec3(),
        clip_near: desc.clip_near as f32,
        clip_far: desc.clip_far as f32,
    };
    let aspect = f64::from(size[0]) / f64::from(size[1]) * render.framing.pixel_aspect;
    let corner = render.part(size).map_or([0.0; 2], |(corner, _)| corner.map(|n| n as f32));
    let projection = projection(desc, view, size.map(|n| n as f32), aspect, render.framing.conform);
    let lens = desc.lens.and_then(|lens| usable_lens(&lens));
    let lens = lens.filter(|_| !matches!(projection, Projection::Panorama(_)));
    Camera { projection, lens, corner }
}

fn projection(desc: &CameraDesc, view: camera::View, size: [f32; 2], aspect: f64, conform: Conform) -> Projection {
    match desc.projection {
        ProjectionDesc::Perspective { fov_y, aspect: framed } => {
            let tan_y = (0.5 * fov_y).tan();
            let tan_x = tan_y * framed.unwrap_or(aspect);
            let (x, y) = fit([tan_x, tan_y], aspect, conform);
            let center = center(desc.shift, [tan_x, tan_y]);
            Projection::Perspective(Perspective { view, tan_half_x: x, tan_half_y: y, center, size })
        }
        ProjectionDesc::Orthographic { half_width, half_height } => {
            let (x, y) = fit([half_width, half_height], aspect, conform);
            let center = center(desc.shift, [half_width, half_height]);
            Projection::Orthographic(Orthographic { view, half_width: x, half_height: y, center, size })
        }
        ProjectionDesc::Equirectangular { longitude, latitude } => {
            let edges = |edges: [f64; 2]| edges.map(|edge| edge as f32);
            Projection::Panorama(Panorama { view, longitude: edges(longitude), latitude: edges(latitude), size })
        }
    }
}

/// A lens; `None` for one that blurs nothing.
fn usable_lens(desc: &LensDesc) -> Option<Lens> {
    let positive = |x: f64| x.is_finite() && x > 0.0;
    (positive(desc.aperture_radius) && desc.focus_distance > 0.0).then(|| Lens {
        radius: desc.aperture_radius as f32,
        focus: desc.focus_distance as f32,
        blades: desc.blades,
        rotation: if desc.rotation.is_finite() { desc.rotation as f32 } else { 0.0 },
        ratio: if positive(desc.ratio) { desc.ratio as f32 } else { 1.0 },
    })
}

/// Where the picture's centre is, given half of the authored frame.
fn center(shift: [f64; 2], half: [f64; 2]) -> [f32; 2] {
    [0, 1].map(|i| (2.0 * shift[i] * half[i]) as f32)
}

/// Factor of the picture's radiance.
pub fn exposure(desc: &CameraDesc) -> f32 {
    let exposure = desc.exposure as f32;
    if exposure.is_finite() && exposure >= 0.0 { exposure } else { 1.0 }
}

/// The frame of `aspect` for one of `x` × `y`.
fn fit([x, y]: [f64; 2], aspect: f64, conform: Conform) -> (f32, f32) {
    let (wider, higher) = ((y * aspect, y), (x, x / aspect));
    let (x, y) = match conform {
        Conform::Expand if x / y <= aspect => wider,
        Conform::Expand => higher,
        Conform::Crop if x / y <= aspect => higher,
        Conform::Crop => wider,
        Conform::Width => wider,
        Conform::Height => higher,
        Conform::Pixels => (x, y),
    };
    (x as f32, y as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::FramingDesc;
    use crate::error::Place;
    use crate::math::{DAffine3, Vec3};

    fn desc(projection: ProjectionDesc, shift: [f64; 2]) -> CameraDesc {
        CameraDesc {
            name: "a".into(),
            place: Place::default(),
            transform: DAffine3::IDENTITY,
            projection,
            clip_near: 0.0,
            clip_far: f64::INFINITY,
            shift,
            lens: None,
            shutter: [0.0; 2],
            shutter_curve: Vec::new(),
            rolling_shutter: None,
            zoom: Vec::new(),
            exposure: 1.0,
            motion: Vec::new(),
        }
    }

    /// usd-core: an aperture of 20.955 by 15.2908 shifted by 5 is seen from −0.10955 to 0.30955 at 1 from
    /// the lens of 50 (`GfCamera().frustum.window`).
    #[test]
    fn the_shifted_frame_is_that_of_usd() {
        let fov_y = 2.0 * (0.5 * 15.2908_f64 / 50.0).atan();
        let projection = ProjectionDesc::Perspective { fov_y, aspect: Some(20.955 / 15.2908) };
        let at = |size: [u32; 2], x: f32, y: f32| {
            let d = still(&desc(projection, [5.0 / 20.955, 0.0]), &RenderDesc::default(), size, DVec3::ZERO)
                .ray(x, y)
                .ray
                .d;
            [d.x / -d.z, d.y / -d.z]
        };
        let near = |found: [f32; 2], x: f32, y: f32| {
            assert!((found[0] - x).abs() < 3e-6 && (found[1] - y).abs() < 3e-6, "{found:?}");
        };
        near(at([20_955, 15_291], 0.0, 0.0), -0.10955, 0.152_908);
        near(at([20_955, 15_291], 20_955.0, 15_291.0), 0.30955, -0.152_908);
        // A wider picture shows more to both sides of the same centre.
        near(at([200, 100], 100.0, 50.0), 0.1, 0.0);
        near(at([200, 100], 0.0, 0.0), 0.1 - 0.305_816, 0.152_908);
    }

    /// A frame of 2 by 1 shown in a square: half of its width and height, as UsdRender's policies have it.
    #[test]
    fn pictures_of_another_shape_show_what_the_policy_says() {
        let seen = |half: [f64; 2], conform| {
            let [half_width, half_height] = half;
            let projection = ProjectionDesc::Orthographic { half_width, half_height };
            let framing = FramingDesc { conform, ..FramingDesc::default() };
            let render = RenderDesc { framing, ..RenderDesc::default() };
            let camera = still(&desc(projection, [0.0; 2]), &render, [100, 100], DVec3::ZERO);
            let o = camera.ray(100.0, 0.0).ray.o;
            [o.x, o.y]
        };
        for (conform, wide, high) in [
            (Conform::Expand, [2.0, 2.0], [2.0, 2.0]),
            (Conform::Crop, [1.0, 1.0], [1.0, 1.0]),
            (Conform::Width, [1.0, 1.0], [2.0, 2.0]),
            (Conform::Height, [2.0, 2.0], [1.0, 1.0]),
            (Conform::Pixels, [2.0, 1.0], [1.0, 2.0]),
        ] {
            assert_eq!((seen([2.0, 1.0], conform), seen([1.0, 2.0], conform)), (wide, high), "{conform:?}");
        }
    }

    #[test]
    fn parallel_rays_are_shifted_by_the_frame() {
        let projection = ProjectionDesc::Orthographic { half_width: 2.0, half_height: 1.0 };
        let ray = still(&desc(projection, [0.25, -0.5]), &RenderDesc::default(), [400, 200], DVec3::ZERO)
            .ray(200.0, 100.0)
            .ray;
        assert_eq!((ray.o, ray.d), (Vec3::new(1.0, -1.0, 0.0), Vec3::NEG_Z));
    }
}
