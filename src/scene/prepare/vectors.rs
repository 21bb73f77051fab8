//! What the vector pass compares the frame with: everything a frame before and a frame after.

use super::camera::still;
use super::geometry::{Geometry, moving};
use crate::camera::Camera;
use crate::desc::{CameraDesc, RenderDesc, SceneDesc, ShapeRef};
use crate::math::{DAffine3, DVec3, MovingTransform, Times, Vec3};
use crate::scene::shutter::Shutter;
use crate::scene::vectors::Vectors;

/// From the frame before to the frame after; in its times the one is 0 and the other 1.
const FRAMES: [f64; 2] = [-1.0, 1.0];

/// What `geometry`, which was prepared of `desc`, and the camera are at the frames before and after.
pub fn prepare(desc: &SceneDesc, camera: &CameraDesc, size: [u32; 2], origin: DVec3, geometry: &Geometry) -> Vectors {
    let frames = Shutter::between(FRAMES);
    let placed = geometry.placed.iter().zip(&geometry.instances).map(|(&i, instance)| {
        let keys = frames.and_then(|frames| frames.transform(&desc.instances[i as usize]))?;
        let keys: Vec<_> = keys.into_iter().map(|(time, key)| (time, *key)).collect();
        let center = geometry.shapes[instance.shape as usize].center();
        let moving = MovingTransform::new(&keys)?.rebased(center, origin);
        Some([moving.at(0.0), moving.at(1.0)])
    });
    let mut used = vec![false; geometry.shapes.len()];
    geometry.instances.iter().for_each(|instance| used[instance.shape as usize] = true);
    let shapes = geometry.shapes.iter().zip(&used).enumerate().map(|(i, (shape, used))| {
        let points = frames.filter(|_| *used).and_then(|frames| match shape_of(desc, i) {
            ShapeRef::Mesh(i) => {
                let mesh = &desc.meshes[i as usize];
                moving(frames.keys(&mesh.points, &mesh.motion), shape.center())
            }
            ShapeRef::Rounds(i) => {
                let rounds = &desc.rounds[i as usize];
                moving(frames.keys(&rounds.points, &rounds.motion), shape.center())
            }
        })?;
        Some([0.0, 1.0].map(|time| points_at(&points, time)))
    });
    let (placed, shapes) = (placed.collect(), shapes.collect());
    Vectors { cameras: cameras(camera, &desc.render, size, origin), placed, shapes }
}

/// The camera at the frames before and after.
pub fn cameras(desc: &CameraDesc, render: &RenderDesc, size: [u32; 2], origin: DVec3) -> [Camera; 2] {
    let keys = Shutter::between(FRAMES).and_then(|frames| frames.keys(&desc.transform, &desc.motion));
    let moving = keys.and_then(|keys| {
        MovingTransform::new(&keys.into_iter().map(|(time, key)| (time, *key)).collect::<Vec<(f32, DAffine3)>>())
    });
    [0.0, 1.0].map(|time| {
        let transform = moving.as_ref().map_or(desc.transform, |moving| moving.at(time));
        let zoomed = desc.zoom.iter().find(|zoom| zoom.time == FRAMES[time as usize]);
        let projection = zoomed.map_or(desc.projection, |zoom| zoom.value);
        still(&CameraDesc { transform, projection, ..desc.clone() }, render, size, origin)
    })
}

/// Meshes come first, as in [`Geometry::shapes`].
fn shape_of(desc: &SceneDesc, i: usize) -> ShapeRef {
    match i.checked_sub(desc.meshes.len()) {
        None => ShapeRef::Mesh(i as u32),
        Some(i) => ShapeRef::Rounds(i as u32),
    }
}

fn points_at((times, keys): &(Times, Vec<Vec<Vec3>>), time: f32) -> Vec<Vec3> {
    let (stretch, share) = times.at(time);
    keys[stretch].iter().zip(&keys[stretch + 1]).map(|(&from, &to)| from + (to - from) * share).collect()
}
