//! What is known of the first surface: data passes, by every sample or by one ray through the
//! pixel's centre.

use crate::film::{CryptoSample, FirstHit, PixelSample};
use crate::math::{Frame, Ray, Vec3};
use crate::scene::{Interaction, MAX_TRANSPARENT, RayCone, Scene, mask};

/// Depth, position and indices of what the ray through the centre of pixel (`x`, `y`) meets first.
pub fn first_hit(scene: &Scene, x: u32, y: u32) -> FirstHit {
    let camera_ray = scene.camera.ray(x as f32 + 0.5, y as f32 + 0.5);
    let Some(it) = first_opaque(scene, camera_ray.ray) else { return FirstHit::BACKGROUND };
    FirstHit {
        depth: scene.camera.depth(it.p),
        position: (it.p.as_dvec3() + scene.origin).as_vec3(),
        object_index: scene.ids.objects[it.instance as usize].index as f32,
        material_index: scene.ids.materials[it.material as usize].index as f32,
    }
}

/// The first surface along `ray` whose opacity is at least a half, which is where Cycles draws the
/// line for these passes.
fn first_opaque(scene: &Scene, mut ray: Ray) -> Option<Interaction> {
    for _ in 0..MAX_TRANSPARENT {
        let hit = scene.closest_hit(&ray, mask::CAMERA)?;
        let it = scene.interaction(&ray, &hit, RayCone { width: 0.0, spread: 0.0 });
        if scene.opacity(&it) >= 0.5 {
            return Some(it);
        }
        ray = it.continued(&ray, hit.t);
    }
    None
}

/// Fills the data that passes average over samples, as far as they are asked for.
pub fn describe(scene: &Scene, it: &Interaction, frame: &Frame, sample: &mut PixelSample) {
    if scene.effects.geometry {
        let view = scene.camera.view();
        sample.normal = frame.n;
        sample.denoising_normal = Vec3::new(frame.n.dot(view.right), frame.n.dot(view.up), frame.n.dot(view.forward));
        sample.denoising_depth = view.depth(it.p);
        let shape = scene.shape(scene.instance(it.instance));
        if let Some(uv) = shape.uv(0, it.primitive, it.at) {
            // v grows upwards in Blender's passes and downwards in glTF.
            sample.uv = [uv.x, 1.0 - uv.y, 1.0];
        }
    }
    if scene.effects.cryptomatte {
        let object = &scene.ids.objects[it.instance as usize];
        let material = &scene.ids.materials[it.material as usize];
        sample.crypto =
            CryptoSample { object: object.object, material: material.material, asset: object.asset, coverage: 1.0 };
    }
}
