//! The camera: Blender's lens, sensor and shift.

use std::f64::consts::PI;

use super::document::{CameraData, DofData, PanoramaData, RenderData};
use super::motion;
use super::transform::affine;
use crate::desc::{CameraDesc, LensDesc, Motion, ProjectionDesc};
use crate::error::{Place, Warnings};

/// The camera as it frames a picture of `render`'s size.
pub fn camera(data: &CameraData, render: &RenderData, place: &Place, warnings: &mut Warnings) -> CameraDesc {
    let place = place.at(&data.name);
    let (projection, frame) = projection(data, render, &place, warnings);
    let zoom = zoom(data, render, &place);
    let transform = affine(&data.matrix);
    let is_flat = data.r#type == "ORTHO";
    let lens = data.dof.map(|dof| lens(&dof, data.lens, is_flat));
    CameraDesc {
        name: data.name.as_str().into(),
        place,
        transform,
        projection,
        clip_near: if is_flat { data.clip_start.max(0.0) } else { data.clip_start },
        clip_far: data.clip_end,
        shift: [data.shift_x / frame[0], data.shift_y / frame[1]],
        lens,
        shutter: render.shutter,
        shutter_curve: render.shutter_curve.clone(),
        rolling_shutter: render.rolling_shutter,
        exposure: render.exposure,
        zoom,
        motion: motion::keys(&transform, data.motion.iter().map(|(time, matrix)| (*time, affine(matrix)))),
    }
}

/// How the camera projects, and the sizes of its frame, the fitted side being 1.
fn projection(
    data: &CameraData,
    render: &RenderData,
    place: &Place,
    warnings: &mut Warnings,
) -> (ProjectionDesc, [f64; 2]) {
    let [width, height] = [0, 1].map(|i| f64::from(render.size[i].max(1)) * render.pixel_aspect[i].max(1e-6));
    let fits_x = match data.sensor_fit.as_str() {
        "HORIZONTAL" => true,
        "VERTICAL" => false,
        _ => width >= height,
    };
    // Only an explicit vertical fit measures the sensor's height.
    let sensor = if data.sensor_fit == "VERTICAL" { data.sensor_height } else { data.sensor_width };
    let frame = if fits_x { [1.0, height / width] } else { [width / height, 1.0] };
    let orthographic = ProjectionDesc::Orthographic {
        half_width: 0.5 * data.ortho_scale * frame[0],
        half_height: 0.5 * data.ortho_scale * frame[1],
    };
    let perspective = || {
        let tan_y = 0.5 * sensor / data.lens * frame[1];
        ProjectionDesc::Perspective { fov_y: 2.0 * tan_y.atan(), aspect: Some(frame[0] / frame[1]) }
    };
    let projection = match data.r#type.as_str() {
        "ORTHO" => orthographic,
        "PERSP" => perspective(),
        "PANO" => {
            let (longitude, latitude) = equirectangular(&data.panorama).unwrap_or_else(|| {
                let kind = &data.panorama.panorama_type;
                warnings.push(place, format!("{kind} panoramas are not supported: taken as equirectangular"));
                ALL_AROUND
            });
            ProjectionDesc::Equirectangular { longitude, latitude }
        }
        other => {
            warnings.push(place, format!("a camera of the unknown type {other}: taken as a perspective one"));
            perspective()
        }
    };
    (projection, frame)
}

/// Longitudes and latitudes of all directions.
pub(super) const ALL_AROUND: ([f64; 2], [f64; 2]) = ([-PI, PI], [-0.5 * PI, 0.5 * PI]);

/// Longitudes and latitudes of a panorama; `None` for other kinds of it.
pub(super) fn equirectangular(data: &PanoramaData) -> Option<([f64; 2], [f64; 2])> {
    let edges = ([data.longitude_min, data.longitude_max], [data.latitude_min, data.latitude_max]);
    (data.panorama_type == "EQUIRECTANGULAR").then_some(edges)
}

/// How it projects at other frames.
fn zoom(data: &CameraData, render: &RenderData, place: &Place) -> Vec<Motion<ProjectionDesc>> {
    // What is wrong with its projection was told for the frame.
    let at = |then: &CameraData| projection(then, render, place, &mut Warnings::new()).0;
    data.zoom.iter().map(|(time, then)| Motion { time: *time, value: at(then) }).collect()
}

/// Cycles takes no lens to be wider open.
const LEAST_FSTOP: f64 = 1e-5;

/// The lens of a focal length in millimetres; parallel rays have that of a metre.
pub(super) fn lens(dof: &DofData, focal: f64, orthographic: bool) -> LensDesc {
    let focal = if orthographic { 1.0 } else { 1e-3 * focal };
    LensDesc {
        aperture_radius: focal / (2.0 * dof.fstop.max(LEAST_FSTOP)),
        focus_distance: dof.distance,
        blades: dof.blades,
        rotation: dof.rotation,
        ratio: dof.ratio,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(data: CameraData, size: [u32; 2]) -> CameraDesc {
        let render = RenderData { size, ..RenderData::default() };
        camera(&data, &render, &Place::default(), &mut Warnings::new())
    }

    fn fov(camera: &CameraDesc) -> [f64; 2] {
        let ProjectionDesc::Perspective { fov_y, aspect } = camera.projection else { panic!() };
        let tan = (0.5 * fov_y).tan();
        [tan * aspect.unwrap(), tan]
    }

    /// `Camera.angle_x` and `angle_y` of Blender: 36 mm at 50 mm see 39.6°.
    #[test]
    fn the_sensor_fits_as_in_blender() {
        let wide = fov(&made(CameraData::default(), [1920, 1080]));
        assert!((wide[0] - 0.36).abs() < 1e-12 && (wide[1] - 0.36 * 9.0 / 16.0).abs() < 1e-12);
        let tall = fov(&made(CameraData::default(), [1080, 1920]));
        assert!((tall[1] - 0.36).abs() < 1e-12);
        let vertical = CameraData { sensor_fit: "VERTICAL".into(), ..CameraData::default() };
        assert!((fov(&made(vertical, [1920, 1080]))[1] - 0.24).abs() < 1e-12);
    }

    #[test]
    fn shift_is_in_sizes_of_the_fitted_side() {
        let shifted = CameraData { shift_x: 0.1, shift_y: 0.1, ..CameraData::default() };
        let camera = made(shifted, [200, 100]);
        assert_eq!(camera.shift, [0.1, 0.2]);
    }

    /// Measured: a blur of a lens of 50 mm at f/2.8.
    #[test]
    fn the_aperture_is_that_of_the_lens() {
        let dof = Some(DofData { distance: 3.0, fstop: 2.8, ..DofData::default() });
        let lens = made(CameraData { dof, ..CameraData::default() }, [100, 100]).lens.unwrap();
        assert!((lens.aperture_radius - 0.05 / 5.6).abs() < 1e-12);
        assert_eq!(lens.focus_distance, 3.0);
        let open = Some(DofData { distance: 3.0, fstop: 0.0, ..DofData::default() });
        let lens = made(CameraData { dof: open, ..CameraData::default() }, [100, 100]).lens.unwrap();
        assert!((lens.aperture_radius - 2500.0).abs() < 1e-6);
    }
}
