//! Direct light at a surface, by light sampling.

use super::Path;
use crate::bsdf::ByLobe;
use crate::film::PixelSample;
use crate::integrator::direct::Shading;
use crate::integrator::shadow_pass;
use crate::integrator::split::{add_direct, add_indirect};
use crate::sampling::Sampler;
use crate::scene::Scene;

/// Direct light at a surface by `light_samples` samples, and what light groups have of their own.
pub(super) fn add_lights(
    scene: &Scene,
    sampler: &Sampler,
    path: &Path<'_>,
    shading: &Shading<'_>,
    light_samples: u32,
    sample: &mut PixelSample,
) {
    if path.scatterings == 0 && scene.effects.group_shadows {
        shadow_pass::add_of_groups(scene, sampler, shading, path.beta, light_samples, sample);
    }
    if !scene.effects.light || shading.bsdf.is_delta_only() {
        return;
    }
    for k in 0..light_samples {
        let sampler = if light_samples > 1 { sampler.part(k, light_samples) } else { *sampler };
        add_light(scene, &sampler, path, shading, light_samples as f32, sample);
    }
}

/// Direct light by light sampling, and its part of the shadow passes.
fn add_light(
    scene: &Scene,
    sampler: &Sampler,
    path: &Path<'_>,
    shading: &Shading<'_>,
    samples: f32,
    sample: &mut PixelSample,
) {
    let Some(light) = shading.sample_light(scene, sampler, samples) else { return };
    if path.scatterings > light.rules.max_bounces {
        return;
    }
    let unoccluded = light.unoccluded * (path.beta * (1.0 / samples));
    let arrives = unoccluded * light.visibility;
    let dimmed = |l: ByLobe| l * path.limits.factor(l.sum(), path.scatterings + 1);
    if path.scatterings > 0 {
        return add_indirect(sample, light.rules, path.shares, dimmed(arrives).sum());
    }
    add_direct(sample, light.rules, dimmed(arrives));
    if scene.effects.shadow {
        sample.unshadowed += dimmed(unoccluded).diffuse;
    }
}
