//! Ambient occlusion: `A(p) = 1/π ∫ V(p, ω; distance) (n·ω) dω` about the shading normal.

use super::path::First;
use crate::film::PixelSample;
use crate::light::Shadow;
use crate::math::{Frame, Ray, Rgb};
use crate::sampling::{Decision, Dimension, Sampler, warp};
use crate::scene::{Interaction, Media, RayCone, Scene};
use crate::settings::Settings;

/// The openness at `it` by as many rays as the settings ask for, 1 where nothing is near. As in
/// Cycles there is no clipping at the geometric plane.
pub fn openness(
    scene: &Scene,
    sampler: &Sampler,
    vertex: u32,
    it: &Interaction,
    frame: &Frame,
    settings: &Settings,
    media: &Media,
) -> Rgb {
    let (rays, t_max) = (settings.ao_samples, distance(settings));
    let open: Rgb = (0..rays)
        .map(|k| {
            let sampler = if rays > 1 { sampler.part(k, rays) } else { *sampler };
            let u = sampler.get_2d(Dimension::at_bounce(vertex, Decision::Ao));
            let w = frame.to_world(warp::sample_cosine_hemisphere(u));
            scene.transmittance(
                &Ray { t_max, ..scene.shadow_ray(it, w, None) },
                Shadow::Cast,
                media,
                it.path.transparent,
            )
        })
        .sum();
    open * (1.0 / rays as f32)
}

/// The distance that the settings give; without end unless set.
fn distance(settings: &Settings) -> f32 {
    settings.ao_distance.map_or(f32::INFINITY, |d| d as f32)
}

/// The integrator that renders nothing else: Combined holds the ao pass.
pub fn trace(scene: &Scene, sampler: &Sampler, ray: Ray, cone: RayCone, settings: &Settings) -> PixelSample {
    let mut sample = PixelSample::of(&scene.passes);
    let Some(first) = super::path::first_surface(scene, sampler, ray, cone, &mut sample) else {
        return sample;
    };
    let First { it, vertex, media, left, travelled } = first;
    let frame = scene.shading_frame(&it);
    sample.ao = openness(scene, sampler, vertex, &it, &frame, settings, &media) * left;
    sample.combined = sample.ao;
    sample.alpha = 1.0;
    super::first_hit::describe(scene, &it, &mut sample);
    if scene.effects.denoising {
        super::path::tell_of_first(scene, &frame, travelled, &mut sample);
    }
    sample
}
