//! Shadow catchers: the camera sees through them, what lies behind is darkened by the shadows on them.
//!
//! S = mean of the direct irradiance that arrives / mean of what would without the objects that are no catchers
//! themselves; the film forms the ratio. Approximation: bounced light that objects take from a catcher or give to it
//! does not count.

use super::direct::Shading;
use crate::film::PixelSample;
use crate::math::Rgb;
use crate::sampling::Sampler;
use crate::scene::Scene;

/// What was gathered before the catcher: from then on all is behind it.
#[derive(Clone, Copy, Debug)]
pub struct InFront {
    combined: Rgb,
    alpha: f32,
}

/// Notes the light at the catcher of `shading`, which covers `share` of the sample.
pub fn meet(
    scene: &Scene,
    sampler: &Sampler,
    shading: &Shading<'_>,
    share: f32,
    samples: u32,
    sample: &mut PixelSample,
) -> InFront {
    sample.catcher.share = share;
    for k in 0..samples {
        let sampler = if samples > 1 { sampler.part(k, samples) } else { *sampler };
        if let Some([lit, unshadowed]) = shading.sample_catcher(scene, &sampler) {
            sample.catcher.lit += lit * (share / samples as f32);
            sample.catcher.unshadowed += unshadowed * (share / samples as f32);
        }
    }
    InFront { combined: sample.combined, alpha: sample.alpha }
}

/// Sets apart what was gathered since.
pub fn set_apart(in_front: InFront, sample: &mut PixelSample) {
    sample.catcher.behind = sample.combined - in_front.combined;
    sample.catcher.alpha = sample.alpha - in_front.alpha;
    sample.combined = in_front.combined;
    sample.alpha = in_front.alpha;
}
