//! Whom a light lights and how much, and what UsdLux adds to that and is not rendered.

use super::super::values::Values;
use super::blender;
use crate::desc::{LightLinks, Visibility};

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
    if values.color("inputs:shadow:color").is_some_and(|color| color != [0.0; 3]) {
        values.warn("inputs:shadow:color is not rendered: shadows are black");
    }
    // Without a distance nothing falls off.
    if values.number("inputs:shadow:distance").is_some_and(|distance| distance >= 0.0) {
        values.warn("inputs:shadow:distance is not rendered: shadows reach everywhere");
        if values.number("inputs:shadow:falloff").is_some_and(|falloff| falloff > 0.0) {
            values.warn("inputs:shadow:falloff and falloffGamma are not rendered: shadows do not fade");
        }
    }
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
    LightLinks { cast_shadow, response, ..LightLinks::default() }
}
