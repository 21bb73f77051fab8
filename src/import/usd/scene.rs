//! Puts the scene together.

use super::images::Images;
use super::material::Materials;
use super::stage::Reading;
use super::{camera, light, render, walk};
use crate::desc::SceneDesc;
use crate::error::Result;

/// The whole stage as a scene.
pub(super) fn build(reading: &Reading<'_>) -> Result<SceneDesc> {
    let mut scene = SceneDesc { place: reading.place.clone(), render: render::read(reading), ..SceneDesc::default() };
    let mut images = Images::default();
    let mut profiles = light::Profiles::default();
    let placed = walk::walk(reading);
    for prim in &placed {
        if &*prim.kind == "Camera" {
            scene.cameras.extend(camera::read(reading, prim));
        } else if light::is_light(&prim.kind) {
            scene.lights.extend(light::read(reading, prim, &mut images, &mut profiles));
        }
    }
    let materials = Materials::new(reading, images);
    materials.finish(&mut scene);
    scene.ies = profiles.list;
    light::link(reading, &mut scene);
    Ok(scene)
}
