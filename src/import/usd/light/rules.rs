//! Whom a light lights, and what UsdLux adds to that and is not rendered.

use super::super::values::Values;
use super::blender;
use crate::desc::{LightLinks, Visibility};

/// Which rays see the light. UsdLux says nothing of the camera: it sees domes only, as in Cycles' Hydra
/// delegate, unless that delegate's `visibleInPrimaryRay` says otherwise.
pub(super) fn visibility(values: &Values<'_>, is_dome: bool) -> Visibility {
    let lit = |name: &str| {
        let factor = values.number(name).unwrap_or(1.0);
        if factor != 1.0 && factor != 0.0 {
            values.warn(format!("{name} is {factor}: other values than 0 and 1 are not rendered; it is taken as 1"));
        }
        factor != 0.0
    };
    let (diffuse, specular) = (lit("inputs:diffuse"), lit("inputs:specular"));
    let camera = values.loose("inputs:visibleInPrimaryRay").map_or(is_dome, |visible| visible != 0.0);
    Visibility { camera, diffuse, glossy: specular, transmission: specular, ..Visibility::ALL }
}

/// Rules that don't need to know the other prims; [`link`](super::link) knows those.
pub(super) fn links(values: &Values<'_>) -> LightLinks {
    if values.color("inputs:shadow:color").is_some_and(|color| color != [0.0; 3]) {
        values.warn("inputs:shadow:color is not rendered: shadows are black");
    }
    if values.number("inputs:shadow:distance").is_some_and(|distance| distance >= 0.0) {
        values.warn("inputs:shadow:distance is not rendered: shadows reach everywhere");
    }
    if !values.targets("light:filters").is_empty() {
        values.warn("light filters are not rendered");
    }
    let stamped = blender::property(values, "use_shadow").is_none_or(|cast| cast != 0.0);
    let cast_shadow = values.flag("inputs:shadow:enable").unwrap_or(true) && stamped;
    LightLinks { cast_shadow, ..LightLinks::default() }
}
