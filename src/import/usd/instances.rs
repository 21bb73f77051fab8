//! Shapes and instances of the scene.

use std::cell::Cell;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use openusd::sdf::Path;

use super::gather::Found;
use super::inherit::moving;
use super::light::{self, GeometryLight, Profiles, ShapeLight, Shaped};
use super::per_instance;
use super::shape::Built;
use super::shapes::{Dressed, Shapes};
use super::stage::Reading;
use crate::desc::{InstanceDesc, LightLinks, ObjectInfo, SceneDesc, ShapeRef, Visibility};
use crate::error::Place;
use crate::math::DAffine3;

/// What makes shapes shine beside their looks.
#[derive(Default)]
pub(super) struct ShapeLights {
    /// By the shape that each of them names.
    pub geometry: HashMap<Path, GeometryLight>,
    /// By the prim whose properties say it.
    shaping: HashMap<Path, Option<Shaped>>,
}

impl ShapeLights {
    /// Tells of GeometryLights whose shapes are not among those that were `found`.
    pub fn tell_of_missing(&self, reading: &Reading<'_>, found: &[Found]) {
        let shapes = found.iter().filter(|found| found.look.shape.is_some()).map(|found| &found.path);
        let shown: HashSet<&Path> = if self.geometry.is_empty() { HashSet::new() } else { shapes.collect() };
        let mut missing: Vec<_> = self.geometry.iter().filter(|(target, _)| !shown.contains(target)).collect();
        missing.sort_by_key(|(_, light)| &light.path);
        for (target, light) in missing {
            reading.warn(&light.path, format!("its geometry {target} is no shape that is shown: it does not shine"));
        }
    }

    /// Keeps how the shape at `path` shines, a light with the properties of `prim`.
    pub fn read_shaping(
        &mut self,
        reading: &Reading<'_>,
        light: &ShapeLight,
        prim: &Path,
        path: &Path,
        profiles: &mut Profiles,
    ) {
        if !self.shaping.contains_key(prim) {
            self.shaping.insert(prim.clone(), light.shaping(reading, prim, path, profiles));
        }
    }
}

/// Adds the shapes of `shapes`, and an instance for everything that was found and shows one.
pub(super) fn place(
    reading: &Reading<'_>,
    found: &[Found],
    times: &[f64],
    shapes: Shapes,
    shape_lights: &ShapeLights,
    scene: &mut SceneDesc,
) {
    let mut refs: Vec<Option<ShapeRef>> = Vec::new();
    for built in shapes.built {
        refs.push(built.map(|built| match built {
            Built::Mesh(mesh) => {
                scene.meshes.push(mesh.into());
                ShapeRef::Mesh(scene.meshes.len() as u32 - 1)
            }
            Built::Rounds(rounds) => {
                scene.rounds.push(rounds.into());
                ShapeRef::Rounds(scene.rounds.len() as u32 - 1)
            }
        }));
    }
    let mut names = Names::default();
    let mut values = per_instance::Known::default();
    let mut shining = HashMap::new();
    for (number, found) in found.iter().enumerate() {
        let Some(dressed) = shapes.by_look.get(&found.key()) else { continue };
        let Some(Some(shape)) = refs.get(dressed.shape) else { continue };
        if !in_range(&found.pose.world) {
            reading.warn(&found.path, "its transform is not finite, or beyond 1e30; it is left out");
            continue;
        }
        let own = found.look.shape.as_ref().and_then(|shape| shape.light.as_ref());
        let (light, shaped) = match (own, shape_lights.geometry.get(&found.path)) {
            (Some(own), _) => (Some(own), shape_lights.shaping.get(&found.look.prim).and_then(Option::as_ref)),
            (None, Some(geometry)) => (Some(&geometry.light), geometry.shaped.as_ref()),
            (None, None) => (None, None),
        };
        let materials = match light {
            Some(light) => shine(reading, found, dressed, (light, shaped), *shape, &mut shining, scene),
            None => dressed.materials.clone(),
        };
        let (name, place, asset) = names.of(reading, found);
        let has_colors = match *shape {
            ShapeRef::Mesh(i) => scene.meshes[i as usize].colors.is_some(),
            ShapeRef::Rounds(i) => scene.rounds[i as usize].colors.is_some(),
        };
        let takes_color = dressed.takes_color && !has_colors;
        scene.instances.push(InstanceDesc {
            name,
            place,
            asset,
            shape: *shape,
            transform: found.pose.world,
            motion: moving(times, &found.pose),
            materials,
            color: found.color.filter(|_| takes_color),
            object_index: number as u32 + 1,
            info: ObjectInfo { attributes: values.of(reading, found, &dressed.named), ..ObjectInfo::default() },
            visibility: Visibility::ALL,
            links: light.map_or_else(LightLinks::default, |light| light.links.clone()),
            shaped: shaped.map(|shaped| shaped.placed(&found.pose.world).into()),
            holdout: false,
            catcher: false,
            terminator: None,
        });
    }
}

/// Materials that make the shape shine; those of one look are made once, unless they depend on its size.
fn shine(
    reading: &Reading<'_>,
    found: &Found,
    dressed: &Dressed,
    (light, shaped): (&ShapeLight, Option<&Shaped>),
    shape: ShapeRef,
    known: &mut HashMap<(*const Dressed, *const ShapeLight), Vec<Option<u32>>>,
    scene: &mut SceneDesc,
) -> Vec<Option<u32>> {
    let key = (std::ptr::from_ref(dressed), std::ptr::from_ref(light));
    if let Some(known) = known.get(&key) {
        return known.clone();
    }
    let sized = Cell::new(false);
    let mut materials = Vec::new();
    for slot in &dressed.materials {
        let bound = slot.and_then(|slot| scene.materials.get(slot as usize));
        let material = light.material(bound, shaped.map_or(1.0, |shaped| shaped.factor), || {
            sized.set(true);
            light::area(reading, shape, scene, &found.pose.world)
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
    last: Option<(Path, Place)>,
}

impl Names {
    /// Name, place and asset of a prim.
    fn of(&mut self, reading: &Reading<'_>, found: &Found) -> (Arc<str>, Place, Arc<str>) {
        let place = match &self.last {
            Some((path, place)) if *path == found.path => place.clone(),
            _ => {
                let place = reading.place_of(&found.path);
                self.last = Some((found.path.clone(), place.clone()));
                place
            }
        };
        let name = self.shared(found.path.name().unwrap_or_default());
        let asset = match &found.asset {
            Some(asset) => asset.clone(),
            None => self.shared(found.path.root_prim_name().unwrap_or_default()),
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

/// What leaves it has no room in single precision.
fn in_range(world: &DAffine3) -> bool {
    world.to_cols_array().iter().all(|v| v.abs() < 1e30)
}
