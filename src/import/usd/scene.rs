//! Puts the scene together.

use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;

use openusd::sdf;

use super::images::Images;
use super::light::{Profiles, ShapeLight};
use super::material::Materials;
use super::shapes::{self, Look, Shapes};
use super::stage::Reading;
use super::walk::{Shown, Walked};
use super::{bindings, camera, light, render, units, variants, walk};
use crate::desc::{InstanceDesc, LightLinks, Motion, SceneDesc, Visibility};
use crate::error::{Place, Result};
use crate::math::DAffine3;

/// The whole stage as a scene.
pub(super) fn build(reading: &Reading<'_>) -> Result<SceneDesc> {
    let mut scene = SceneDesc {
        place: reading.place.clone(),
        render: render::read(reading),
        variants: offered(reading),
        ..SceneDesc::default()
    };
    let walked = walk::walk(reading);
    let mut images = Images::default();
    let geometry = lights_and_cameras(reading, &walked, &mut images, &mut scene);
    let mut materials = Materials::new(reading, images);
    let bound = walked.shown.iter().map(|shown| {
        bindings::bound(reading, shown.leaf.bindings.as_ref(), shown.scope.as_ref(), shown.leaf.prim.path())
    });
    let bound: std::collections::BTreeSet<sdf::Path> = bound.flatten().collect();
    materials.preload(&bound);
    let aside = |kind: &str| kind == "Camera" || light::is_light(kind);
    let shapes = shapes::read(reading, &walked, &mut materials, aside);
    materials.finish(&mut scene);
    place(reading, &walked, shapes, &geometry, &mut scene);
    if walked.shown.iter().any(|shown| shown.leaf.linked) {
        light::link(reading, &mut scene);
    }
    if moves(&scene) {
        let what = "something moves while the shutter is open; motion blur is not rendered yet, all stands still";
        reading.warnings.borrow_mut().push(&reading.place, what);
    }
    units::warn_of_layers(reading);
    reading.warn_of_composition();
    Ok(scene)
}

/// Variants of the prims in the root, as `--variant` takes them.
fn offered(reading: &Reading<'_>) -> Vec<String> {
    let root = reading.stage.prim(sdf::Path::abs_root()).and_then(|root| Ok(root.children().unwrap_or_default()));
    let mut offered = Vec::new();
    for prim in root.unwrap_or_default() {
        for (set, choices) in variants::sets(&prim) {
            offered.extend(choices.into_iter().map(|choice| format!("{}{{{set}={choice}}}", prim.path())));
        }
    }
    offered
}

/// Adds lamps and cameras; gives the shapes that GeometryLights make shine, by their path.
fn lights_and_cameras(
    reading: &Reading<'_>,
    walked: &Walked,
    images: &mut Images,
    scene: &mut SceneDesc,
) -> HashMap<sdf::Path, ShapeLight> {
    let mut profiles = Profiles::default();
    let mut geometry = HashMap::new();
    for shown in &walked.shown {
        match &*shown.leaf.kind {
            "Camera" => scene.cameras.extend(camera::read(reading, &walked.placed(reading, shown))),
            "GeometryLight" => geometry.extend(light::geometry_light(reading, &walked.placed(reading, shown))),
            kind if light::is_light(kind) => {
                let placed = walked.placed(reading, shown);
                scene.lights.extend(light::read(reading, &placed, images, &mut profiles));
            }
            _ => {}
        }
    }
    scene.ies = profiles.list;
    geometry
}

/// Adds meshes and instances.
fn place(
    reading: &Reading<'_>,
    walked: &Walked,
    shapes: Shapes,
    geometry: &HashMap<sdf::Path, ShapeLight>,
    scene: &mut SceneDesc,
) {
    let mut meshes: Vec<Option<(u32, Vec<DAffine3>)>> = Vec::new();
    for built in shapes.built {
        meshes.push(built.map(|built| {
            scene.meshes.push(built.mesh);
            (scene.meshes.len() as u32 - 1, built.copies)
        }));
    }
    let mut names = Names::default();
    let mut shining = HashMap::new();
    for (number, (shown, look)) in walked.shown.iter().zip(&shapes.by_shown).enumerate() {
        let Some(look) = look.and_then(|look| shapes.looks.get(look)) else { continue };
        let Some(Some((mesh, copies))) = meshes.get(look.shape) else { continue };
        if !usable(&shown.pose.world) {
            reading.warn(&shown.path, "its transform is singular or not finite; it is left out");
            continue;
        }
        let light = look.light.as_ref().or_else(|| geometry.get(&shown.path));
        let materials = match light {
            Some(light) => shine(reading, shown, look, light, *mesh, &mut shining, scene),
            None => look.materials.clone(),
        };
        let (name, place, asset) = names.of(reading, shown);
        let instance = InstanceDesc {
            name,
            place,
            asset,
            mesh: *mesh,
            transform: shown.pose.world,
            motion: walked.motion(shown),
            materials,
            object_index: number as u32 + 1,
            visibility: Visibility::ALL,
            links: light.map_or_else(LightLinks::default, |light| light.links.clone()),
        };
        if copies.is_empty() {
            scene.instances.push(instance);
            continue;
        }
        for copy in copies {
            let motion = instance.motion.iter().map(|m| Motion { time: m.time, value: m.value * *copy }).collect();
            let transform = instance.transform * *copy;
            scene.instances.push(InstanceDesc { transform, motion, ..instance.clone() });
        }
    }
}

/// Materials that make the shape shine; those of one look are made once, unless they depend on its size.
fn shine(
    reading: &Reading<'_>,
    shown: &Shown,
    look: &Look,
    light: &ShapeLight,
    mesh: u32,
    known: &mut HashMap<(*const Look, *const ShapeLight), Vec<Option<u32>>>,
    scene: &mut SceneDesc,
) -> Vec<Option<u32>> {
    let key = (std::ptr::from_ref(look), std::ptr::from_ref(light));
    if let Some(known) = known.get(&key) {
        return known.clone();
    }
    let sized = Cell::new(false);
    let mut materials = Vec::new();
    for slot in &look.materials {
        let bound = slot.and_then(|slot| scene.materials.get(slot as usize));
        let material = light.material(bound, || {
            sized.set(true);
            scene.meshes.get(mesh as usize).map_or(0.0, |mesh| light::area(reading, mesh, &shown.pose.world))
        });
        scene.materials.push(material);
        materials.push(Some(scene.materials.len() as u32 - 1));
    }
    if !sized.get() {
        known.insert(key, materials.clone());
    }
    materials
}

/// Texts that instances share.
#[derive(Default)]
struct Names {
    names: HashMap<String, Arc<str>>,
    last: Option<(sdf::Path, Place)>,
}

impl Names {
    /// Name, place and asset of a prim.
    fn of(&mut self, reading: &Reading<'_>, shown: &Shown) -> (Arc<str>, Place, Arc<str>) {
        let place = match &self.last {
            Some((path, place)) if *path == shown.path => place.clone(),
            _ => {
                let place = reading.place_of(&shown.path);
                self.last = Some((shown.path.clone(), place.clone()));
                place
            }
        };
        let name = self.shared(shown.path.name().unwrap_or_default());
        let asset = match &shown.asset {
            Some(asset) => asset.clone(),
            None => self.shared(shown.path.root_prim_name().unwrap_or_default()),
        };
        (name, place, asset)
    }

    fn shared(&mut self, text: &str) -> Arc<str> {
        if let Some(known) = self.names.get(text) {
            return known.clone();
        }
        let shared: Arc<str> = text.into();
        self.names.insert(text.to_owned(), shared.clone());
        shared
    }
}

/// True where something stands elsewhere at another time of the shutter.
fn moves(scene: &SceneDesc) -> bool {
    scene.instances.iter().any(|instance| !instance.motion.is_empty())
        || scene.meshes.iter().any(|mesh| !mesh.motion.is_empty())
        || scene.cameras.iter().any(|camera| !camera.motion.is_empty())
}

/// True where `world` is finite, also in single precision, and has an inverse.
fn usable(world: &DAffine3) -> bool {
    let m = world.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let in_range = world.to_cols_array().iter().all(|v| v.abs() < 1e30);
    in_range && size > 1e-60 && m.determinant().abs() > 1e-12 * size
}
