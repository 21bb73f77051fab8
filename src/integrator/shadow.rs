//! The unshadowed half of the shadow pass that light sampling does not see.
//!
//! Direct light is the sum of two strategies with MIS weights. Light sampling knows what would
//! arrive without occluders anyway; for a ray that the surface has sampled, every emitter along it
//! counts, whatever stands before. So Diffuse Direct = Shadow × Unshadowed holds for both.

use crate::light::{EmitterHit, Receiver};
use crate::math::{Ray, Rgb};
use crate::sampling::power_heuristic;
use crate::scene::{RayCone, Scene, mask};

/// Triangles of emissive objects that one ray may pass before the rest is left out.
const MAX_EMITTERS: u32 = 1024;

/// Radiance along `ray` of all emitters as if each stood there alone, MIS-weighted for a direction
/// that a surface at `from` has sampled with density `pdf`.
pub fn unoccluded_emission(scene: &Scene, from: &Receiver, ray: &Ray, cone: RayCone, pdf: f32) -> Rgb {
    let mut sum = Rgb::BLACK;
    for (i, _, le) in scene.background(ray.d) {
        let pdf_light = scene.lights.pdf_li(from, i, ray.d, None);
        sum += le * power_heuristic(pdf, pdf_light);
    }
    let mut rest = *ray;
    for _ in 0..MAX_EMITTERS {
        let Some(hit) = scene.closest_hit(&rest, mask::EMITTER) else { break };
        let it = scene.interaction(&rest, &hit, cone);
        sum += scene.emission(&it) * scene.opacity(&it) * emission_weight(scene, from, &it, pdf);
        rest = it.continued(&rest, hit.t);
    }
    sum
}

/// MIS weight of the emission at `it`, found from `from` by a direction of density `pdf`.
pub fn emission_weight(scene: &Scene, from: &Receiver, it: &crate::scene::Interaction, pdf: f32) -> f32 {
    let Some(light) = scene.instance(it.instance).light else { return 1.0 };
    let wi = -it.wo;
    let hit = EmitterHit { dist: (it.p - from.p).dot(wi), ng: it.ng, triangle: it.triangle, uv: it.barycentrics };
    let pdf_light = scene.lights.pdf_li(from, light, wi, Some(&hit));
    power_heuristic(pdf, pdf_light)
}
