//! Emitters along a sampled direction whatever stands before them.
//!
//! Direct light is the sum of two strategies with MIS weights. Light sampling knows what would arrive
//! without occluders anyway; for a ray that the surface has sampled, every emitter along it counts as
//! if it stood there alone. So Diffuse Direct = Shadow × Unshadowed holds for both strategies, and
//! lights with shadow rules of their own have them in both.

use super::scattering::Scattering;
use crate::light::{Emitter, EmitterHit, Rules};
use crate::math::{Ray, Rgb};
use crate::scene::{Media, PathState, RayCone, Scene, mask};

/// Triangles of emissive objects that one ray may pass before the rest is left out.
const MAX_EMITTERS: u32 = 1024;

/// Light of one emitter along a ray.
pub struct Found<'a> {
    /// Radiance, MIS-weighted.
    pub le: Rgb,
    /// Where the emitter is along the ray; infinite in the background.
    pub dist: f32,
    /// Its rules.
    pub rules: &'a Rules,
}

impl Found<'_> {
    /// Share of it that arrives at the origin of `ray`, within `media`, on a path that has passed so many surfaces
    /// unscattered.
    pub fn visibility(&self, scene: &Scene, ray: &Ray, media: &Media, passed: u16) -> Rgb {
        // Ends before the emitter, which may itself be something that stops light.
        let t_max = self.dist * (1.0 - 1e-5);
        scene.arriving(&Ray { t_max, ..*ray }, self.rules, media, passed)
    }
}

/// Calls `visit` with every emitter that `ray` from `last` would meet, in the state of the path then; if `all` is false only with
/// those that have shadows of their own.
pub fn emitters_along(
    scene: &Scene,
    last: &Scattering,
    state: &PathState,
    ray: &Ray,
    mut cone: RayCone,
    all: bool,
    mut visit: impl FnMut(Found<'_>),
) {
    let asked = |rules: &Rules| (all || !rules.stops_like_rays()) && rules.lights(last.from.class);
    for (i, light, le) in scene.background(ray.d).filter(|(_, light, _)| asked(&light.rules)) {
        let le = le * last.mis_weight(scene, i, ray.d, None);
        visit(Found { le, dist: f32::INFINITY, rules: &light.rules });
    }
    if scene.effects.lamps {
        scene.lights.lamps_along(last.from.p, ray.d, [0.0, f32::INFINITY], |i, light, hit| {
            if asked(&light.rules) {
                let le = light.emitter.le(ray.d, Some(hit)) * last.mis_weight(scene, i, ray.d, Some(hit));
                visit(Found { le, dist: hit.dist, rules: &light.rules });
            }
        });
    }
    if !scene.effects.emissive {
        return;
    }
    let mut rest = *ray;
    let mut travelled = 0.0;
    for _ in 0..MAX_EMITTERS {
        let Some(hit) = scene.closest_hit(&rest, mask::EMITTER) else { break };
        travelled += hit.t;
        let mut it = scene.interaction(&rest, &hit, cone);
        if scene.effects.light_path {
            it.path = PathState { length: travelled, ..*state };
        }
        cone.width = cone.at(hit.t);
        let rules = scene.instance(it.instance).rules.as_deref().unwrap_or(&Rules::NONE);
        if asked(rules) {
            let le = scene.emission(&it) * (scene.coverage(&it).opacity * mesh_weight(scene, last, &it));
            visit(Found { le, dist: travelled, rules });
        }
        rest = it.continued(&rest, hit.t);
    }
}

/// MIS weight of the emission of the surface at `it`, which the ray from `last` has met.
pub fn mesh_weight(scene: &Scene, last: &Scattering, it: &crate::scene::Interaction) -> f32 {
    let Some(light) = scene.instance(it.instance).light else { return 1.0 };
    let wi = -it.wo;
    let dist = (it.p - last.from.p).dot(wi);
    let hit = EmitterHit { dist, ng: it.ng, triangle: it.primitive, uv: it.at };
    last.mis_weight(scene, light, wi, Some(&hit))
}
