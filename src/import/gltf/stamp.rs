//! PENUMBRA_blender: what *Export for Penumbra* adds to nodes and the scene of Blender's glTF files, since glTF
//! has no area lamps, no world, no lens and no sizes of lamps. Other programs ignore it.

use std::path::Path;

use serde_json::Value;

use super::super::ImportOptions;
use super::super::blender::{Moment, Stamp};
use super::node::PlacedNode;
use crate::desc::{CameraDesc, LightDesc, RenderDesc, SceneDesc};
use crate::error::{Place, Warnings};
use crate::math::{DMat3, DVec3};

/// Its name.
pub(super) const NAME: &str = "PENUMBRA_blender";

/// Reads `json`, the extension at `place`; one that can't be read is told, and is none.
pub(super) fn read(
    json: Option<&Value>,
    base: Option<&Path>,
    options: &ImportOptions,
    place: &Place,
    warnings: &mut Warnings,
) -> Option<Stamp> {
    let json = json?.clone();
    let moment = options.frame.map_or(Moment::Authored, |frame| Moment::Seconds(frame / options.fps));
    let stamp = Stamp::read(json, moment, base.unwrap_or(Path::new("")));
    stamp.map_err(|what| warnings.push(place, format!("{NAME} is left out, plain glTF counts: {what}"))).ok()
}

/// The light of a stamped node: `Some(None)` for one that emits nothing, `None` where there is no stamp.
pub(super) fn light(
    stamp: &Stamp,
    placed: &PlacedNode,
    scene: &mut SceneDesc,
    warnings: &mut Warnings,
) -> Option<Option<LightDesc>> {
    let mut lamp = stamp.light.clone()?;
    lamp.name = placed.place.node.as_deref().unwrap_or_default().to_owned();
    let light = stamp.light(&lamp, &placed.world, &placed.place, &mut scene.images, warnings);
    Some(light.map(|light| LightDesc { name: placed.name.clone(), place: placed.place.clone(), ..light }))
}

/// The camera of a stamped node, and what the scene's settings say of its picture.
pub(super) fn camera(
    stamp: &Stamp,
    placed: &PlacedNode,
    warnings: &mut Warnings,
) -> Option<(CameraDesc, Option<RenderDesc>)> {
    let data = stamp.camera.as_ref()?;
    let camera = stamp.camera(data, &placed.world, &placed.place, warnings);
    let camera = camera.map_err(|what| warnings.push(&placed.place, format!("{NAME} is left out: {what}"))).ok()?;
    let camera = CameraDesc { name: placed.name.clone(), place: placed.place.clone(), ..camera };
    let mut render = stamp.render();
    if let Some(render) = &mut render {
        render.framing.camera = placed.place.node.clone();
    }
    Some((camera, render))
}

/// The dome of the scene's world.
pub(super) fn world(stamp: &Stamp, scene: &mut SceneDesc, warnings: &mut Warnings) -> Option<LightDesc> {
    let world = stamp.world.as_ref()?;
    // Blender's z is glTF's y.
    let turn = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    stamp.dome(world, turn, &scene.place.clone(), &mut scene.images, warnings)
}
