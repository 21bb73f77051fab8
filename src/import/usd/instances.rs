//! Meshes and instances of the scene.

use std::cell::Cell;
use std::collections::HashMap;
use std::sync::Arc;

use openusd::sdf::Path;

use super::gather::Found;
use super::inherit::moving;
use super::light::{self, ShapeLight};
use super::shapes::{Dressed, Shapes};
use super::stage::Reading;
use crate::desc::{InstanceDesc, LightLinks, Motion, ObjectInfo, SceneDesc, Visibility};
use crate::error::Place;
use crate::math::DAffine3;

/// Adds the meshes of `shapes`, and an instance for everything that was found and shows one.
pub(super) fn place(
    reading: &Reading<'_>,
    found: &[Found],
    times: &[f64],
    shapes: Shapes,
    geometry: &HashMap<Path, ShapeLight>,
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
    for (number, found) in found.iter().enumerate() {
        let Some(dressed) = shapes.by_look.get(&found.key()) else { continue };
        let Some(Some((mesh, copies))) = meshes.get(dressed.shape) else { continue };
        if !usable(&found.pose.world) {
            reading.warn(&found.path, "its transform is singular or not finite; it is left out");
            continue;
        }
        let own = found.look.shape.as_ref().and_then(|shape| shape.light.as_ref());
        let light = own.or_else(|| geometry.get(&found.path));
        let materials = match light {
            Some(light) => shine(reading, found, dressed, light, *mesh, &mut shining, scene),
            None => dressed.materials.clone(),
        };
        let (name, place, asset) = names.of(reading, found);
        let takes_color = dressed.takes_color && scene.meshes[*mesh as usize].colors.is_none();
        let instance = InstanceDesc {
            name,
            place,
            asset,
            mesh: *mesh,
            transform: found.pose.world,
            motion: moving(times, &found.pose),
            materials,
            color: found.color.filter(|_| takes_color),
            object_index: number as u32 + 1,
            info: ObjectInfo::default(),
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
    found: &Found,
    dressed: &Dressed,
    light: &ShapeLight,
    mesh: u32,
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
        let material = light.material(bound, || {
            sized.set(true);
            scene.meshes.get(mesh as usize).map_or(0.0, |mesh| light::area(reading, mesh, &found.pose.world))
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

/// True where `world` is finite, also in single precision, and has an inverse.
fn usable(world: &DAffine3) -> bool {
    let m = world.matrix3;
    let size = m.x_axis.length() * m.y_axis.length() * m.z_axis.length();
    let in_range = world.to_cols_array().iter().all(|v| v.abs() < 1e30);
    in_range && size > 1e-60 && m.determinant().abs() > 1e-12 * size
}
