//! Domes: their image as lat-long, and how it lies in the world.

use std::f64::consts::FRAC_PI_2;

use super::super::images::Images;
use super::{Light, blender, color, layout};
use crate::desc::{ColorSpace, LightKind};
use crate::math::{DAffine3, DMat3, DVec3};

/// The dome, and its transform: from the space of our domes to the world.
pub(super) fn read(light: &Light<'_>, images: &mut Images) -> (LightKind, DAffine3) {
    let values = &light.values;
    let radiance = color::emission(values);
    let file = values.asset("inputs:texture:file");
    let image = file.and_then(|file| images.load(values.reading, &light.path, &file, ColorSpace::Srgb));
    let image = image.map(|image| lat_long(light, image, images));
    let turn = DAffine3::from_mat3(pole(light) * from_ours());
    (LightKind::Dome { radiance, image }, light.world * turn)
}

/// From the space of our domes, whose image has its centre at +x, to that of UsdLux: OpenEXR's lat-long
/// maps, the centre at +z, the left quarter at +x, the top at +y.
fn from_ours() -> DMat3 {
    DMat3::from_cols(DVec3::Z, DVec3::Y, DVec3::NEG_X)
}

/// How the image is turned in the light's own space. A DomeLight's top is always +y; that of a DomeLight_1
/// is `poleAxis`, and where that is z the image's centre is −y.
fn pole(light: &Light<'_>) -> DMat3 {
    let reading = light.values.reading;
    if &*light.kind == "DomeLight" {
        return blender::dome_turn(reading, &light.prim);
    }
    let up_is_z = reading.to_world.matrix3.z_axis.y > 0.0;
    let z = match light.values.token("poleAxis").as_deref() {
        Some("Y") => false,
        Some("Z") => true,
        None | Some("scene") => up_is_z,
        Some(other) => {
            light.values.warn(format!("poleAxis \"{other}\" is not known: taken as \"scene\""));
            up_is_z
        }
    };
    if z { DMat3::from_rotation_x(FRAC_PI_2) } else { DMat3::IDENTITY }
}

/// The image of index `image`, or one made of it that is lat-long.
fn lat_long(light: &Light<'_>, image: u32, images: &mut Images) -> u32 {
    let format = light.values.token("inputs:texture:format").unwrap_or_default();
    let layout = match format.as_str() {
        "" | "automatic" | "latlong" => return image,
        "mirroredBall" => layout::Layout::MirroredBall,
        "angular" => layout::Layout::Angular,
        "cubeMapVerticalCross" => layout::Layout::VerticalCross,
        other => {
            light.values.warn(format!("texture format \"{other}\" is not known: taken as latlong"));
            return image;
        }
    };
    let Some(source) = images.images.get(image as usize) else { return image };
    let converted = layout::to_lat_long(source, layout);
    images.images.push(converted.into());
    (images.images.len() - 1) as u32
}

#[cfg(test)]
mod tests {
    use super::super::super::images::Images;
    use super::super::testing::Stage;
    use super::super::{Profiles, read};
    use crate::desc::LightKind;
    use crate::math::DVec3;

    /// Where the light's image has the point `(u, v)`, v from the top, in our world: y up.
    fn direction(stage: &Stage, path: &str, u: f64, v: f64) -> DVec3 {
        let light = stage.with(path, |reading, placed| {
            read(reading, placed, &mut Images::default(), &mut Profiles::default()).unwrap()
        });
        assert!(matches!(light.kind, LightKind::Dome { .. }) && light.visibility.camera);
        // `LightKind::Dome`: centre +x, u grows clockwise seen from above, top +y.
        let (sin, cos) = (std::f64::consts::TAU * (u - 0.5)).sin_cos();
        let (height, ring) = (std::f64::consts::PI * (0.5 - v)).sin_cos();
        light.transform.transform_vector3(DVec3::new(ring * cos, height, ring * sin)).normalize()
    }

    fn is(found: DVec3, expected: [f64; 3]) {
        assert!((found - DVec3::from(expected)).length() < 1e-6, "{found} is not {expected:?}");
    }

    const DOMES: &str = r#"def DomeLight "Dome" {}
        def DomeLight "Turned" { float xformOp:rotateY = 90; uniform token[] xformOpOrder = ["xformOp:rotateY"] }
        def DomeLight_1 "Scene" {}
        def DomeLight_1 "Y" { uniform token poleAxis = "Y" }
        def DomeLight_1 "Z" { uniform token poleAxis = "Z" }"#;

    /// OpenEXR: longitude 0 (the centre) is +z, π/2 (the left quarter) is +x, latitude π/2 is +y.
    #[test]
    fn the_image_lies_as_openexr_says() {
        let stage = Stage::new(r#"upAxis = "Y""#, DOMES);
        for path in ["/Dome", "/Scene", "/Y"] {
            is(direction(&stage, path, 0.5, 0.5), [0.0, 0.0, 1.0]);
            is(direction(&stage, path, 0.25, 0.5), [1.0, 0.0, 0.0]);
            is(direction(&stage, path, 0.75, 0.5), [-1.0, 0.0, 0.0]);
            is(direction(&stage, path, 0.3, 0.0), [0.0, 1.0, 0.0]);
        }
        // z to x.
        is(direction(&stage, "/Turned", 0.5, 0.5), [1.0, 0.0, 0.0]);
        // "Z": latitude π/2 is +z, longitude 0 is −y; longitude π/2 stays +x.
        is(direction(&stage, "/Z", 0.5, 0.0), [0.0, 0.0, 1.0]);
        is(direction(&stage, "/Z", 0.5, 0.5), [0.0, -1.0, 0.0]);
        is(direction(&stage, "/Z", 0.25, 0.5), [1.0, 0.0, 0.0]);
    }

    /// In a stage that is z up, (x, y, z) is (x, z, −y) of ours.
    #[test]
    fn a_stage_that_is_z_up_turns_its_own_poles_only() {
        let stage = Stage::new(r#"upAxis = "Z""#, DOMES);
        for path in ["/Dome", "/Y"] {
            is(direction(&stage, path, 0.5, 0.0), [0.0, 0.0, -1.0]);
            is(direction(&stage, path, 0.5, 0.5), [0.0, 1.0, 0.0]);
        }
        for path in ["/Scene", "/Z"] {
            is(direction(&stage, path, 0.5, 0.0), [0.0, 1.0, 0.0]);
            is(direction(&stage, path, 0.5, 0.5), [0.0, 0.0, 1.0]);
        }
    }

    /// Cycles: the image's centre is Blender's +x, u = 0.25 its +y, the top row +z; in our world +x, −z, +y.
    #[test]
    fn blender_domes_lie_as_cycles_has_them() {
        let root = |turn: &str| {
            format!(
                r#"def Xform "root" (customData = {{ dictionary Blender = {{ bool generated = 1 }} }}) {{
                    def DomeLight "env" {{
                        float3 xformOp:rotateXYZ = {turn}
                        uniform token[] xformOpOrder = ["xformOp:rotateXYZ"]
                    }}
                }}"#
            )
        };
        // 5.0 did not write the turn that 4.5 wrote.
        for turn in ["(0, -0, 0)", "(90, 0, 90)"] {
            let stage = Stage::new("doc = \"Blender v5.0.1\"\nupAxis = \"Z\"", &root(turn));
            is(direction(&stage, "/root/env", 0.5, 0.5), [1.0, 0.0, 0.0]);
            is(direction(&stage, "/root/env", 0.25, 0.5), [0.0, 0.0, -1.0]);
            is(direction(&stage, "/root/env", 0.5, 0.0), [0.0, 1.0, 0.0]);
        }
        // The same file of another program.
        let stage = Stage::new(r#"upAxis = "Z""#, &root("(0, 0, 0)"));
        is(direction(&stage, "/root/env", 0.5, 0.5), [0.0, 1.0, 0.0]);
    }
}
