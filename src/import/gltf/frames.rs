//! Where things are a frame before and a frame after: what the vector pass asks.

use std::collections::HashMap;

use crate::desc::{InstanceDesc, MeshDesc, Motion, SceneDesc, ShapeRef};
use crate::error::Place;
use crate::math::DAffine3;

/// Gives `scene` the motion to and from `others`, which are the same file at other frames: how many after it, and what
/// the file is then. What is not there at one of them stands still.
pub(super) fn add(scene: &mut SceneDesc, others: &[(f64, SceneDesc)]) {
    let found: Vec<Vec<Option<&InstanceDesc>>> = others.iter().map(|(_, other)| partners(scene, other)).collect();
    // Of meshes that deform, those at the other frames: nodes may share one at the frame itself alone.
    let mut taken: HashMap<(u32, Vec<u32>), u32> = HashMap::new();
    let mut is_taken = vec![false; scene.meshes.len()];
    for i in 0..scene.instances.len() {
        let Some(then) = found.iter().map(|found| found[i]).collect::<Option<Vec<_>>>() else { continue };
        let instance = &mut scene.instances[i];
        let times = others.iter().map(|(time, _)| *time);
        instance.motion = keys(&instance.transform, times.zip(then.iter().map(|then| then.transform)));
        let ShapeRef::Mesh(mesh) = instance.shape else { continue };
        let meshes: Vec<u32> = then.iter().filter_map(|then| mesh_of(then)).collect();
        let own = *taken.entry((mesh, meshes.clone())).or_insert_with(|| {
            if !std::mem::replace(&mut is_taken[mesh as usize], true) {
                return mesh;
            }
            let own = MeshDesc { motion: Vec::new(), ..MeshDesc::clone(&scene.meshes[mesh as usize]) };
            scene.meshes.push(own.into());
            scene.meshes.len() as u32 - 1
        });
        instance.shape = ShapeRef::Mesh(own);
        let count = scene.meshes[own as usize].points.len();
        let points = others.iter().zip(&meshes).map(|((time, other), &m)| (*time, &other.meshes[m as usize].points));
        let points: Vec<_> = points.filter(|(_, points)| points.len() == count).collect();
        if points.len() == others.len() && points.iter().any(|(_, then)| **then != scene.meshes[own as usize].points) {
            let mesh = std::sync::Arc::make_mut(&mut scene.meshes[own as usize]);
            mesh.motion = keys(&mesh.points, points.into_iter().map(|(time, points)| (time, points.clone())));
        }
    }
    let cameras: Vec<HashMap<_, _>> =
        others.iter().map(|(_, other)| other.cameras.iter().map(|camera| (&camera.place, camera)).collect()).collect();
    for camera in &mut scene.cameras {
        let then = cameras.iter().map(|cameras| cameras.get(&camera.place).map(|camera| camera.transform));
        let Some(then) = then.collect::<Option<Vec<DAffine3>>>() else { continue };
        camera.motion = keys(&camera.transform, others.iter().map(|(time, _)| *time).zip(then));
    }
}

/// For each instance of `scene` that of the same node and primitive in `other`.
fn partners<'a>(scene: &SceneDesc, other: &'a SceneDesc) -> Vec<Option<&'a InstanceDesc>> {
    let there: HashMap<_, _> = numbered(other).collect();
    numbered(scene).map(|(number, _)| there.get(&number).copied()).collect()
}

/// Each instance, by its node and which one of it it is.
fn numbered(scene: &SceneDesc) -> impl Iterator<Item = ((&Place, u32), &InstanceDesc)> {
    let mut counts = HashMap::new();
    scene.instances.iter().map(move |instance| {
        let count = counts.entry(&instance.place).or_insert(0);
        *count += 1;
        ((&instance.place, *count), instance)
    })
}

fn mesh_of(instance: &InstanceDesc) -> Option<u32> {
    match instance.shape {
        ShapeRef::Mesh(mesh) => Some(mesh),
        ShapeRef::Rounds(_) => None,
    }
}

/// Keys in the order of time, with that of the frame; none for what stays as it is.
fn keys<T: Clone + PartialEq>(now: &T, then: impl Iterator<Item = (f64, T)>) -> Vec<Motion<T>> {
    let mut keys: Vec<_> = then.map(|(time, value)| Motion { time, value }).collect();
    if keys.iter().all(|key| key.value == *now) {
        return Vec::new();
    }
    keys.push(Motion { time: 0.0, value: now.clone() });
    keys.sort_by(|a, b| a.time.total_cmp(&b.time));
    keys
}
