//! What Blender's exporter means by its values, where that is not what UsdLux says; measured against
//! Cycles with Blender 4.2 to 5.0. Applied to files that Blender wrote only (`Reading::blender`).
//!
//! * Its intensities are for areas in Blender's units, whatever unit the stage has.
//! * Cycles ignores the scale of the object of a point light.
//! * A sun's intensity is a quarter of its irradiance, its angle half of its diameter.
//! * A lamp without radius has the intensity W/sr where it isn't normalised.
//! * Colour temperature is always enabled: 6500 K, what every lamp has from the start, is none.
//! * A world without Mapping node is not turned (5.0), though its stage is z up.
//!
//! Properties of the lamp that have no place in UsdLux are lost, unless something stamped them on the
//! lamp or its object as custom properties under their own names.

use std::f64::consts::FRAC_PI_2;

use openusd::sdf::{self, Value};
use openusd::usd::Prim;
use openusd_schemas::geom::XformQuery;

use super::super::stage::Reading;
use super::super::stamp;
use super::super::values::Values;
use super::super::walk::Placed;
use crate::math::{DMat3, DVec3};

/// A custom property of the lamp, or of its object.
pub(super) fn property(values: &Values<'_>, name: &str) -> Option<f64> {
    if !values.reading.blender {
        return None;
    }
    let name = format!("userProperties:{name}");
    let of_object = || {
        let prim = values.prim.parent()?;
        Values { prim: &prim, ..*values }.loose(&name)
    };
    values.loose(&name).or_else(of_object)
}

/// What Blender's own exporter lost of the light at `placed`, as far as it matters and nothing says it.
pub(in super::super) fn lost(reading: &Reading<'_>, placed: &Placed) -> Vec<&'static str> {
    let values = Values { reading, prim: &placed.prim, path: &placed.path };
    let stamped = || {
        reading
            .names(&placed.prim.parent().unwrap_or_else(|| placed.prim.clone()))
            .iter()
            .chain(reading.names(&placed.prim).iter())
            .any(|name| name.as_str() == stamp::LIGHT)
    };
    if !reading.blender || !placed.visible || stamped() {
        return Vec::new();
    }
    let unsaid = |name: &'static str, what: &'static str| property(&values, name).is_none().then_some(what);
    let mut lost = Vec::new();
    match &*placed.kind {
        "DomeLight" => lost.push("the sky and the strength of the world"),
        "SphereLight" => lost.extend(unsaid("use_soft_falloff", "soft falloff")),
        "RectLight" => lost.extend(unsaid("spread", "spread")),
        "DiskLight" => {
            lost.extend(unsaid("spread", "spread"));
            lost.push("the shape of an ellipse");
        }
        _ => {}
    }
    if &*placed.kind != "DomeLight" {
        lost.extend(unsaid("use_shadow", "the shadow switch"));
        lost.push("nodes");
    }
    lost
}

/// The colour temperature in kelvin, where it is in use.
pub(super) fn temperature(values: &Values<'_>, kelvin: f64) -> Option<f64> {
    let in_use = property(values, "use_temperature").map_or(kelvin != 6500.0, |used| used != 0.0);
    (in_use && values.flag("inputs:enableColorTemperature").unwrap_or(false)).then_some(kelvin)
}

/// Metres per unit of the sizes that no scale of an object changes: that of the stage, times the scale
/// by which the exporter's root turns Blender's unit into that of the stage.
pub(super) fn meters_per_unit(reading: &Reading<'_>, path: &sdf::Path) -> f64 {
    let first = path.as_str().trim_start_matches('/').split('/').next().unwrap_or_default();
    let root = reading.stage.prim(format!("/{first}").as_str()).ok();
    let scale = root.filter(is_generated).and_then(|prim| {
        let scale = local(reading, &prim)?.x_axis.length();
        (scale > 0.0 && scale.is_finite()).then_some(scale)
    });
    reading.meters * scale.unwrap_or(1.0)
}

/// True for a prim that stands for no object of Blender's.
fn is_generated(prim: &Prim) -> bool {
    let data = prim.custom_data().ok().flatten();
    matches!(data, Some(Value::Dictionary(data)) if data.iter().any(|(key, _)| key == "Blender"))
}

/// The linear part of a prim's own transform.
fn local(reading: &Reading<'_>, prim: &Prim) -> Option<DMat3> {
    let matrix = XformQuery::for_prim(prim).ok()?.local_transformation(reading.time).ok()?.0;
    let row = |i: usize| DVec3::new(matrix[4 * i], matrix[4 * i + 1], matrix[4 * i + 2]);
    Some(DMat3::from_cols(row(0), row(1), row(2)))
}

/// How the dome of `prim` is turned in its own space where Blender 5.0 did not write it: as 4.5 did, about
/// x and then z by 90 degrees.
pub(super) fn dome_turn(reading: &Reading<'_>, prim: &Prim) -> DMat3 {
    let bare = local(reading, prim).is_some_and(|turn| turn.abs_diff_eq(DMat3::IDENTITY, 1e-6));
    if reading.blender && bare {
        DMat3::from_rotation_z(FRAC_PI_2) * DMat3::from_rotation_x(FRAC_PI_2)
    } else {
        DMat3::IDENTITY
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::testing::Stage;
    use crate::desc::{ConeDesc, LightKind};

    /// The lamps of a file of Blender 5.0.1: P = 100 W, S = 3 W/m², in the units of `meters`.
    fn stage(doc: &str, meters: f64) -> Stage {
        let scale = 1.0 / meters;
        Stage::new(
            &format!("doc = \"{doc}\"\nupAxis = \"Z\"\nmetersPerUnit = {meters}"),
            &format!(
                r#"def Xform "root" (customData = {{ dictionary Blender = {{ bool generated = 1 }} }}) {{
                float3 xformOp:scale = ({scale}, {scale}, {scale})
                uniform token[] xformOpOrder = ["xformOp:scale"]
                def Xform "pt" {{
                    float3 xformOp:scale = (2, 2, 2)
                    uniform token[] xformOpOrder = ["xformOp:scale"]
                    custom bool userProperties:use_shadow = 0
                    def SphereLight "pt" {{
                        bool inputs:enableColorTemperature = 1
                        float inputs:intensity = 31.830988
                        bool inputs:normalize = 1
                        float inputs:radius = 0.3
                        custom bool userProperties:use_soft_falloff = 1
                    }}
                }}
                def SphereLight "warm" {{
                    bool inputs:enableColorTemperature = 1
                    float inputs:colorTemperature = 3000
                    bool inputs:normalize = 1
                }}
                def SphereLight "cold" (references = </root/warm>) {{ custom bool userProperties:use_temperature = 0 }}
                def SphereLight "pt0" {{
                    float inputs:intensity = 31.830988
                    bool inputs:normalize = 1
                    float inputs:radius = 0
                    bool treatAsPoint = 1
                }}
                def SphereLight "pt1" (references = </root/pt0>) {{ bool inputs:normalize = 0 }}
                def SphereLight "sp" (prepend apiSchemas = ["ShapingAPI"]) {{
                    float inputs:shaping:cone:angle = 28.64789
                    float inputs:shaping:cone:softness = 0.3
                }}
                def DistantLight "sun" {{
                    float inputs:angle = 5.729578
                    float inputs:intensity = 0.75
                    bool inputs:normalize = 1
                }}
                def DistantLight "sun1" (references = </root/sun>) {{ bool inputs:normalize = 0 }}
                def RectLight "ar" {{
                    float3 xformOp:scale = (1, 2, 1)
                    uniform token[] xformOpOrder = ["xformOp:scale"]
                    float inputs:height = 0.5
                    float inputs:intensity = 6.3661976
                    bool inputs:normalize = 1
                    float inputs:width = 2
                    custom double userProperties:spread = 1
                }}
            }}"#
            ),
        )
    }

    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} is not {expected}");
    }

    /// Cycles' own formulas (facts: point L = P / (4 π² r²), I = P / (4 π); sun E = S; area L = P / (π A)).
    #[test]
    fn lamps_come_back_as_cycles_has_them() {
        for meters in [1.0, 0.01] {
            let stage = stage("Blender v5.0.1", meters);
            let light = |name: &str| stage.light(&format!("/root/{name}")).unwrap();
            let point = light("pt/pt");
            let LightKind::Sphere { radius, radiance, facing } = point.kind else { panic!("{point:?}") };
            near(radius, 0.3);
            near(radiance[1], 100.0 / (4.0 * PI * PI * 0.09));
            assert!(facing && !point.links.cast_shadow && !point.visibility.camera);
            near(light("pt0").kind.color()[0], 100.0 / (4.0 * PI));
            near(light("pt1").kind.color()[0], 100.0 / PI);
            let LightKind::Distant { irradiance, angle } = light("sun").kind else { panic!() };
            near(irradiance[0], 3.0);
            near(angle, 0.2);
            // L = S over a disk of that angle.
            near(light("sun1").kind.color()[0], 3.0 * PI * 0.1_f64.sin().powi(2));
            let LightKind::Rect { width, height, radiance, spread, .. } = light("ar").kind else { panic!() };
            near(width, 2.0);
            near(height, 1.0);
            near(radiance[0], 20.0 / (PI * 2.0));
            near(spread, 1.0);
            let Some(ConeDesc::Blend { angle, blend }) = light("sp").shaping.cone else { panic!() };
            near(angle, 0.5);
            near(blend, f64::from(0.3_f32));
            // Enabled for all lamps; 6500 K is what they have where it is not in use.
            let warm = light("warm").kind.color();
            near(warm[0] / warm[1], 1.7710284 / 0.84429353);
            let cold = light("cold").kind.color();
            near(cold[0] / cold[2], 1.0);
            assert_eq!(stage.said(), "");
        }
    }

    #[test]
    fn other_programs_mean_what_usdlux_says() {
        let stage = stage("Made with love", 1.0);
        let light = |name: &str| stage.light(&format!("/root/{name}")).unwrap();
        let LightKind::Sphere { radius, facing, .. } = light("pt/pt").kind else { panic!() };
        near(radius, 0.6);
        assert!(!facing);
        let LightKind::Distant { irradiance, angle } = light("sun").kind else { panic!() };
        near(irradiance[0], 0.75);
        near(angle, 0.1);
        assert!(matches!(light("sp").shaping.cone, Some(ConeDesc::Soft { .. })));
        let LightKind::Rect { spread, .. } = light("ar").kind else { panic!() };
        near(spread, PI);
    }
}
