//! Whom a light lights and how much, how its shadows look, and what UsdLux adds to that and is not rendered.

use super::super::values::Values;
use super::blender;
use crate::desc::{LightLinks, ShadowDesc, Visibility};

/// Factors of what a light does to diffuse and to other scattering.
const RESPONSE: [&str; 2] = ["inputs:diffuse", "inputs:specular"];

/// Which rays see the light. UsdLux says nothing of the camera: it sees domes only, as in Cycles' Hydra
/// delegate, unless that delegate's `visibleInPrimaryRay` says otherwise.
pub(super) fn visibility(values: &Values<'_>, is_dome: bool) -> Visibility {
    let [diffuse, specular] = RESPONSE.map(|name| values.number(name) != Some(0.0));
    let camera = values.loose("inputs:visibleInPrimaryRay").map_or(is_dome, |visible| visible != 0.0);
    Visibility { camera, diffuse, glossy: specular, transmission: specular, ..Visibility::ALL }
}

/// Rules that don't need to know the other prims; [`link`](super::link) knows those.
pub(super) fn links(values: &Values<'_>) -> LightLinks {
    if !values.targets("light:filters").is_empty() {
        values.warn("light filters are not rendered");
    }
    let stamped = blender::property(values, "use_shadow").is_none_or(|cast| cast != 0.0);
    let cast_shadow = values.flag("inputs:shadow:enable").unwrap_or(true) && stamped;
    let response = RESPONSE.map(|name| {
        let factor = values.number(name).unwrap_or(1.0);
        if factor < 0.0 {
            values.warn(format!("{name} is {factor}: taken as 0"));
        }
        factor.max(0.0)
    });
    LightLinks { cast_shadow, shadow: shadow(values), response, ..LightLinks::default() }
}

/// What ShadowAPI says of how shadows look: lengths in units of the stage, below 0 for none.
fn shadow(values: &Values<'_>) -> ShadowDesc {
    let otherwise = ShadowDesc::default();
    // What is no number is told where the scene is prepared.
    let length = |name: &str| {
        values.number(name).filter(|length| length.is_nan() || *length >= 0.0).map(|l| l * values.reading.meters)
    };
    let Some(distance) = length("inputs:shadow:distance") else {
        // Without a distance nothing falls off.
        return ShadowDesc { color: color(values), ..otherwise };
    };
    ShadowDesc {
        color: color(values),
        distance,
        falloff: length("inputs:shadow:falloff").unwrap_or(otherwise.falloff),
        gamma: values.number("inputs:shadow:falloffGamma").unwrap_or(otherwise.gamma),
    }
}

fn color(values: &Values<'_>) -> [f64; 3] {
    values.color("inputs:shadow:color").unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::super::testing::Stage;
    use super::*;

    #[test]
    fn shadows_look_as_shadow_api_says() {
        let stage = Stage::new(
            "metersPerUnit = 0.01",
            r#"def SphereLight "Plain" (prepend apiSchemas = ["ShadowAPI"]) {}
            def SphereLight "Bare" {}
            def RectLight "All" (prepend apiSchemas = ["ShadowAPI"]) {
                color3f inputs:shadow:color = (1, 0.5, 0)
                float inputs:shadow:distance = 300
                float inputs:shadow:falloff = 50
                float inputs:shadow:falloffGamma = 2
                float3 xformOp:scale = (7, 7, 7)
                uniform token[] xformOpOrder = ["xformOp:scale"]
            }
            def DistantLight "Endless" (prepend apiSchemas = ["ShadowAPI"]) {
                color3f inputs:shadow:color = (0, 0, 1)
                float inputs:shadow:falloff = 50
                float inputs:shadow:falloffGamma = 2
            }
            def DomeLight "Near" (prepend apiSchemas = ["ShadowAPI"]) { float inputs:shadow:distance = 0 }"#,
        );
        let shadow = |path: &str| stage.light(path).unwrap().links.shadow;
        assert_eq!((shadow("/Plain"), shadow("/Bare")), (ShadowDesc::default(), ShadowDesc::default()));
        // Lengths are those of the stage, whatever the scale of the light.
        let all = ShadowDesc { color: [1.0, 0.5, 0.0], distance: 3.0, falloff: 0.5, gamma: 2.0 };
        assert_eq!(shadow("/All"), all);
        assert_eq!(shadow("/Endless"), ShadowDesc { color: [0.0, 0.0, 1.0], ..ShadowDesc::default() });
        assert_eq!(shadow("/Near"), ShadowDesc { distance: 0.0, ..ShadowDesc::default() });
        assert_eq!(stage.said(), "");
    }
}
