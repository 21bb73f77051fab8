//! UsdGeomCamera to `CameraDesc`.

use openusd::gf::Vec4f;

use super::stage::Reading;
use super::stamp;
use super::values::Values;
use super::walk::Placed;
use crate::desc::{CameraDesc, LensDesc, ProjectionDesc, RenderDesc};

/// Apertures and focal length are in tenths of a unit of the stage.
const TENTH: f64 = 0.1;

/// The camera at `placed`; `None`, with a warning, for one that can't be looked through.
///
/// As in `GfCamera`, the scale of its transform means nothing: lengths are units of the stage.
pub(super) fn read(reading: &Reading<'_>, placed: &Placed) -> Option<CameraDesc> {
    let values = Values { reading, prim: &placed.prim, path: &placed.path };
    let number = |name: &str, otherwise: f64| values.number(name).unwrap_or(otherwise);
    let aperture = [number("horizontalAperture", 20.955), number("verticalAperture", 15.2908)];
    let focal_length = number("focalLength", 50.0);
    if !aperture.iter().all(|&size| size > 0.0) {
        values.warn(format!("an aperture of {} by {} sees nothing: it is left out", aperture[0], aperture[1]));
        return None;
    }
    let projection = match values.token("projection").as_deref() {
        Some("orthographic") => {
            let [half_width, half_height] = aperture.map(|size| 0.5 * size * TENTH * reading.meters);
            ProjectionDesc::Orthographic { half_width, half_height }
        }
        other => {
            if let Some(other) = other.filter(|projection| *projection != "perspective") {
                values.warn(format!("projection \"{other}\" is not known: taken as perspective"));
            }
            if focal_length <= 0.0 {
                values.warn(format!("a focal length of {focal_length} sees nothing: it is left out"));
                return None;
            }
            let fov_y = 2.0 * (0.5 * aperture[1] / focal_length).atan();
            ProjectionDesc::Perspective { fov_y, aspect: Some(aperture[0] / aperture[1]) }
        }
    };
    let offset = [number("horizontalApertureOffset", 0.0), number("verticalApertureOffset", 0.0)];
    let (clip_near, clip_far) = clips(&values);
    tell_what_is_not_rendered(&values);
    Some(CameraDesc {
        name: placed.path.name().unwrap_or_default().into(),
        place: reading.place_of(&placed.path),
        transform: placed.world,
        projection,
        clip_near,
        clip_far,
        shift: [offset[0] / aperture[0], offset[1] / aperture[1]],
        lens: lens(&values, focal_length),
        shutter: shutter(&values),
        shutter_curve: Vec::new(),
        rolling_shutter: None,
        zoom: Vec::new(),
        exposure: exposure(&values),
        motion: placed.motion.clone(),
    })
}

/// The camera at `placed` as *Export for Penumbra* stamped it, and what the scene's settings say of its
/// picture. UsdGeom's camera counts where there is one, so that edits of it count.
pub(super) fn stamped(reading: &Reading<'_>, placed: &Placed) -> Option<(CameraDesc, Option<RenderDesc>)> {
    let values = Values { reading, prim: &placed.prim, path: &placed.path };
    let stamp = stamp::read(&values, stamp::CAMERA)?;
    let data = stamp.camera.as_ref()?;
    let is_prim = &*placed.kind == "Camera";
    // The prim that holds UsdGeom's is the one that is asked.
    if !is_prim && data.r#type == "PERSP" {
        return None;
    }
    let own = stamp.camera(data, &placed.world, &reading.place, &mut reading.warnings.borrow_mut());
    let own = own.map_err(|what| values.warn(format!("{} is left out: {what}", stamp::CAMERA))).ok()?;
    let plain = if is_prim { read(reading, placed) } else { None };
    let place = reading.place_of(&placed.path);
    let camera = match plain {
        Some(plain) => CameraDesc {
            exposure: plain.exposure * own.exposure,
            lens: plain.lens.map(|lens| match own.lens {
                Some(LensDesc { blades, rotation, ratio, .. }) => LensDesc { blades, rotation, ratio, ..lens },
                None => lens,
            }),
            ..plain
        },
        None => CameraDesc {
            name: placed.path.name().unwrap_or_default().into(),
            place: place.clone(),
            motion: placed.motion.clone(),
            ..own
        },
    };
    let mut render = stamp.render();
    if let Some(render) = &mut render {
        render.framing.camera = place.node.clone();
    }
    Some((camera, render))
}

/// Near and far plane in metres.
fn clips(values: &Values<'_>) -> (f64, f64) {
    let range = values.reading.value::<[f32; 2]>(values.prim, "clippingRange").unwrap_or([1.0, 1e6]);
    let [near, far] = range.map(|distance| f64::from(distance) * values.reading.meters);
    let near = if near > 0.0 { near } else { 0.0 };
    if far > near {
        return (near, far);
    }
    values.warn(format!("clippingRange ({}, {}) is empty: the far plane is not used", range[0], range[1]));
    (if near.is_finite() { near } else { 0.0 }, f64::INFINITY)
}

/// The lens; `None` where depth of field is off.
fn lens(values: &Values<'_>, focal_length: f64) -> Option<LensDesc> {
    let f_stop = values.number("fStop").unwrap_or(0.0);
    let focus = values.number("focusDistance").unwrap_or(0.0);
    if f_stop <= 0.0 || focus <= 0.0 || focal_length <= 0.0 {
        return None;
    }
    let meters = values.reading.meters;
    let aperture_radius = 0.5 * focal_length * TENTH * meters / f_stop;
    Some(LensDesc::round(aperture_radius, focus * meters))
}

/// When the shutter opens and closes.
fn shutter(values: &Values<'_>) -> [f64; 2] {
    let [open, close] = ["shutter:open", "shutter:close"].map(|name| values.double(name).unwrap_or(0.0));
    if close >= open {
        return [open, close];
    }
    values.warn(format!("the shutter closes at {close} before it opens at {open}: taken as an instant"));
    [open, open]
}

/// `UsdGeomCamera::ComputeLinearExposureScale`.
fn exposure(values: &Values<'_>) -> f64 {
    let number = |name: &str, otherwise: f64| values.number(name).unwrap_or(otherwise);
    let time = number("exposure:time", 1.0);
    let iso = number("exposure:iso", 100.0);
    let f_stop = number("exposure:fStop", 1.0);
    let scale = number("exposure:responsivity", 1.0) * time * (iso / 100.0) * number("exposure", 0.0).exp2()
        / (f_stop * f_stop);
    if scale.is_finite() && scale >= 0.0 {
        return scale;
    }
    values.warn(format!("its exposure is a factor of {scale}: taken as 1"));
    1.0
}

fn tell_what_is_not_rendered(values: &Values<'_>) {
    let planes = values.reading.value::<Vec<Vec4f>>(values.prim, "clippingPlanes");
    if planes.is_some_and(|planes| !planes.is_empty()) {
        values.warn("clippingPlanes are not rendered");
    }
}

#[cfg(test)]
mod tests {
    use super::super::light::testing::Stage;
    use super::*;

    fn camera(metadata: &str, attributes: &str) -> (Option<CameraDesc>, String) {
        let stage = Stage::new(metadata, &format!("def Camera \"Cam\" {{\n{attributes}\n}}"));
        let camera = stage.with("/Cam", read);
        (camera, stage.said())
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{found} is not {expected}");
    }

    /// `UsdGeom.Camera(prim).GetCamera()` of usd-core 26.11: the vertical field of view of the fallbacks is
    /// 17.387291 degrees, the aspect 1.3704319.
    #[test]
    fn what_is_not_authored_has_the_fallback() {
        let (camera, said) = camera("metersPerUnit = 0.01", "");
        let camera = camera.unwrap();
        let ProjectionDesc::Perspective { fov_y, aspect } = camera.projection else { panic!() };
        near(fov_y.to_degrees(), 17.387_290_954_589_844);
        near(aspect.unwrap(), 1.370_431_900_024_414);
        near(camera.clip_near, 0.01);
        near(camera.clip_far, 10_000.0);
        assert_eq!((camera.shift, camera.lens, camera.shutter, camera.exposure), ([0.0; 2], None, [0.0; 2], 1.0));
        assert_eq!((&*camera.name, camera.place.node.as_deref(), said.as_str()), ("Cam", Some("/Cam"), ""));
    }

    /// What Blender 5.0.1 writes for a 50 mm lens on 36 mm at f/2, shifted by 0.1 and 0.2 widths: metres.
    #[test]
    fn tenths_of_a_unit_are_lengths() {
        let (camera, said) = camera(
            "",
            "float2 clippingRange = (0.1, 1000)
            float focalLength = 0.5
            float focusDistance = 4
            float fStop = 2
            float horizontalAperture = 0.36
            float horizontalApertureOffset = 0.036000002
            float verticalAperture = 0.2025
            float verticalApertureOffset = 0.072000004
            double shutter:open = -0.25
            double shutter:close = 0.25",
        );
        let camera = camera.unwrap();
        let ProjectionDesc::Perspective { fov_y, aspect } = camera.projection else { panic!() };
        near(fov_y, 2.0 * (0.5_f64 * 20.25 / 50.0).atan());
        near(aspect.unwrap(), 16.0 / 9.0);
        near(camera.shift[0], 0.1);
        near(camera.shift[1], 0.2 * 16.0 / 9.0);
        let lens = camera.lens.unwrap();
        near(lens.aperture_radius, 0.0125);
        near(lens.focus_distance, 4.0);
        assert_eq!(camera.shutter, [-0.25, 0.25]);
        assert!(!said.contains("depth of field"), "{said}");
    }

    #[test]
    fn parallel_rays_have_the_size_of_the_aperture() {
        let (camera, said) = camera(
            "metersPerUnit = 0.01",
            "token projection = \"orthographic\"
            float horizontalAperture = 400
            float verticalAperture = 200
            float3 xformOp:scale = (3, 3, 3)
            uniform token[] xformOpOrder = [\"xformOp:scale\"]",
        );
        let ProjectionDesc::Orthographic { half_width, half_height } = camera.unwrap().projection else { panic!() };
        near(half_width, 0.2);
        near(half_height, 0.1);
        assert_eq!(said, "");
    }

    /// `ComputeLinearExposureScale` of usd-core 26.11 for these values: 0.078125.
    #[test]
    fn exposure_is_one_factor() {
        let (camera, _) = camera(
            "",
            "float exposure = -1
            float exposure:time = 0.02
            float exposure:iso = 800
            float exposure:fStop = 1.6
            float exposure:responsivity = 2.5",
        );
        near(camera.unwrap().exposure, 0.078_125);
    }

    #[test]
    fn what_sees_nothing_is_left_out_and_the_rest_mended() {
        for (attributes, what) in [
            ("float horizontalAperture = 0", "sees nothing"),
            ("float verticalAperture = -3", "sees nothing"),
            ("float focalLength = 0", "a focal length of 0"),
        ] {
            let (camera, said) = camera("", attributes);
            assert!(camera.is_none() && said.contains(what), "{said}");
        }
        let (camera, said) = camera(
            "",
            "float2 clippingRange = (5, 2)
            double shutter:open = 1
            float4[] clippingPlanes = [(1, 0, 0, 0)]
            token projection = \"fisheye\"
            float exposure:fStop = 0",
        );
        let camera = camera.unwrap();
        assert_eq!((camera.clip_near, camera.clip_far), (5.0, f64::INFINITY));
        assert_eq!((camera.shutter, camera.exposure), ([1.0, 1.0], 1.0));
        for what in ["clippingRange (5, 2) is empty", "the shutter closes", "clippingPlanes", "fisheye", "exposure"] {
            assert!(said.contains(what), "{what} is not in {said}");
        }
    }
}
