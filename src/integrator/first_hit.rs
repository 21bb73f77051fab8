//! What is known of the first surface: data passes, by every sample or by one ray through the
//! pixel's centre.

use crate::film::{CryptoSample, FirstHit, PixelSample};
use crate::math::Ray;
use crate::scene::{Interaction, RayCone, Scene, mask};

/// When the one ray is sent, as it comes from the middle of the pixel and of the lens.
const MIDDLE: f32 = 0.5;

/// Depth, position and indices of what the ray through the centre of pixel (`x`, `y`) meets first, in the middle of
/// the shutter, or of what of it the pixel's row has.
pub fn first_hit(scene: &Scene, x: u32, y: u32) -> FirstHit {
    let (at_x, at_y) = (x as f32 + 0.5, y as f32 + 0.5);
    let ray = match &scene.camera_motion {
        Some(motion) if scene.times.is_rolling() => {
            let time = scene.time_of_row(y, MIDDLE);
            Ray { time, ..motion.at(&scene.camera, time).ray(at_x, at_y).ray }
        }
        _ if scene.times.is_rolling() => Ray { time: scene.time_of_row(y, MIDDLE), ..scene.camera.ray(at_x, at_y).ray },
        _ => Ray { time: MIDDLE, ..scene.camera.ray(at_x, at_y).ray },
    };
    let Some(it) = first_opaque(scene, ray) else { return FirstHit::BACKGROUND };
    FirstHit {
        depth: scene.camera.depth(it.p),
        position: (it.p.as_dvec3() + scene.origin).as_vec3(),
        object_index: scene.ids.objects[it.instance as usize].index as f32,
        material_index: scene.ids.materials[it.material as usize].index as f32,
    }
}

/// What the passes of one ray show along `ray`: the first surface that is opaque enough, else the last one, as
/// in Cycles. A hole in the picture ends it.
fn first_opaque(scene: &Scene, mut ray: Ray) -> Option<Interaction> {
    let mut last = None;
    for _ in 0..=scene.max_transparent {
        let Some(hit) = scene.closest_hit(&ray, mask::CAMERA) else { break };
        let it = scene.interaction(&ray, &hit, RayCone { width: 0.0, spread: 0.0 });
        if scene.is_holdout(&it) {
            break;
        }
        if scene.alpha(&it) >= scene.pass_alpha_threshold {
            return Some(it);
        }
        ray = it.continued(&ray, hit.t);
        last = Some(it);
    }
    last
}

/// Normal, texture coordinates and AOVs of what a ray from the camera has met with an opacity of `opacity`, whether
/// it then passes it or not; false where it is too thin to be shown. As in Cycles, what is thin or a hole in the
/// picture has given its AOVs all the same, and what lies behind a thin surface adds its own.
pub fn describe_shape(scene: &Scene, it: &Interaction, opacity: f32, sample: &mut PixelSample) -> bool {
    if scene.effects.aovs {
        scene.add_aovs(it, &mut sample.aovs);
    }
    if opacity < scene.pass_alpha_threshold || scene.is_holdout(it) {
        return false;
    }
    if !scene.effects.geometry {
        return true;
    }
    if let Some(vectors) = &scene.vectors {
        (sample.vector, sample.vector_share) = (vectors.at(scene, it), 1.0);
    }
    sample.normal = scene.shading_frame(it).n;
    let shape = scene.shape(scene.instance(it.instance));
    if let Some(uv) = shape.uv(0, it.primitive, it.at) {
        // v grows upwards in Blender's passes and downwards in glTF.
        sample.uv = [uv.x, 1.0 - uv.y, 1.0];
    }
    true
}

/// Adds what is clear of mist before the surface at `it`, of which the share `alpha` is there and that is seen in the
/// share `seen` of the sample.
pub fn add_mist(scene: &Scene, it: &Interaction, seen: f32, alpha: f32, sample: &mut PixelSample) {
    if !scene.is_holdout(it) {
        sample.mist += scene.clear_of_mist(it.p) * seen * alpha;
    }
}

/// Names the surface that has stopped the ray, as far as they are asked for.
pub fn describe(scene: &Scene, it: &Interaction, sample: &mut PixelSample) {
    if scene.effects.cryptomatte {
        let object = &scene.ids.objects[it.instance as usize];
        let material = &scene.ids.materials[it.material as usize];
        sample.crypto =
            CryptoSample { object: object.object, material: material.material, asset: object.asset, coverage: 1.0 };
    }
}
