//! What the shadow passes draw beyond the picture's own light: pairs of sums whose ratio is a shadow.

use super::direct::Shading;
use crate::film::PixelSample;
use crate::math::Rgb;
use crate::sampling::Sampler;
use crate::scene::Scene;

/// Irradiance with and without shadows, for a surface without diffuse reflection.
pub fn add_irradiance(scene: &Scene, sampler: &Sampler, shading: &Shading<'_>, sample: &mut PixelSample) {
    let Some(light) = shading.sample_diffuse(scene, sampler, None) else { return };
    sample.irradiance_unshadowed += light.unoccluded;
    sample.irradiance_shadowed += light.unoccluded * light.visibility;
}

/// For each light group, `samples` of its lights alone: among all lights a dim group would hardly ever be
/// chosen, and its shadow not be known. `beta` is the path's throughput.
pub fn add_of_groups(
    scene: &Scene,
    sampler: &Sampler,
    shading: &Shading<'_>,
    beta: Rgb,
    samples: u32,
    sample: &mut PixelSample,
) {
    let bare = shading.bsdf.lacks_diffuse();
    for k in 0..samples {
        let sampler = if samples > 1 { sampler.part(k, samples) } else { *sampler };
        for (i, group) in sample.groups.iter_mut().enumerate() {
            let Some(light) = shading.sample_diffuse(scene, &sampler, Some(i)) else { continue };
            let unoccluded = light.unoccluded * (beta * (1.0 / samples as f32));
            let arrives = unoccluded * light.visibility;
            if bare {
                group.irradiance_unshadowed += unoccluded;
                group.irradiance_shadowed += arrives;
            } else {
                group.unshadowed += unoccluded;
                group.lit += arrives;
            }
        }
    }
}
