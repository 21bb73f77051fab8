//! Path tracing with next-event estimation, multiple importance sampling and Russian roulette.
//!
//! James Kajiya: *The Rendering Equation*, SIGGRAPH 1986. Eric Veach: *Robust Monte Carlo Methods
//! for Light Transport Simulation*, 1997, chapters 9 and 10.

use super::ao;
use super::direct::{leaks, receiver, sample_light};
use super::first_hit::describe;
use super::media::Media;
use super::shadow::{emission_weight, unoccluded_emission};
use super::split::{add_scattered, shares, to_film};
use crate::bsdf::{Bsdf, ByLobe, Lobe, View};
use crate::film::PixelSample;
use crate::light::Receiver;
use crate::math::{Frame, Ray, Rgb};
use crate::sampling::{Decision, Dimension, Sampler, power_heuristic};
use crate::scene::{Interaction, MAX_TRANSPARENT, RayCone, Scene, mask};
use crate::settings::Settings;

/// Scatterings before roulette begins.
const ROULETTE_AFTER: u32 = 3;

/// Angle of the cone of a scattered ray, as a share of the root of the solid angle it stands for.
const SCATTERED_SPREAD: f32 = 0.25;

/// Where a path stands.
struct Path {
    ray: Ray,
    cone: RayCone,
    mask: u64,
    /// Throughput so far.
    beta: Rgb,
    /// Applied to `beta` once the light that arrives directly has been counted.
    occlusion: f32,
    /// Share of each class in the first scattering.
    shares: ByLobe,
    scatterings: u32,
    /// Solids that the path is inside of.
    media: Media,
    /// Surfaces met so far, passed ones included: the index of random decisions.
    vertex: u32,
    /// The last scattering's place and density, infinite for a delta: for MIS.
    from: Receiver,
    pdf: f32,
}

impl Path {
    fn from_camera(ray: Ray, cone: RayCone) -> Self {
        Self {
            ray,
            cone,
            mask: mask::CAMERA,
            beta: Rgb::WHITE,
            occlusion: 1.0,
            shares: ByLobe::BLACK,
            scatterings: 0,
            media: Media::default(),
            vertex: 0,
            from: Receiver::everywhere(ray.o),
            pdf: f32::INFINITY,
        }
    }
}

/// One path from the camera along `ray`.
pub fn trace(
    scene: &Scene,
    sampler: &Sampler,
    ray: Ray,
    cone: RayCone,
    settings: &Settings,
    max_bounces: u32,
) -> PixelSample {
    let max_bounces = if scene.effects.indirect { max_bounces } else { 0 };
    let mut sample = PixelSample::default();
    let mut path = Path::from_camera(ray, cone);
    loop {
        let Some(it) = next_surface(scene, sampler, &mut path) else {
            add_background(scene, &path, &mut sample);
            break;
        };
        let frame = scene.shading_frame(&it);
        if path.scatterings == 0 {
            sample.alpha = 1.0;
            describe(scene, &it, &frame, &mut sample);
            if scene.effects.ao {
                let open = ao::openness(scene, sampler, path.vertex, &it, &frame, ao::distance(settings));
                sample.ao = Rgb::splat(open);
            }
        }
        add_emission(scene, &path, &it, &mut sample);
        if scene.material(&it).unlit || path.scatterings > max_bounces {
            break;
        }
        path.beta *= path.occlusion;

        let surface = Bsdf::new(&scene.surface(&it), it.front);
        let bsdf = surface.view(frame.to_local(it.wo));
        if path.scatterings == 0 && scene.effects.color {
            let color = bsdf.albedo();
            sample.color = to_film(color);
            sample.denoising_albedo += color.sum();
        }
        if !scene.effects.light {
            break;
        }
        if !surface.is_delta_only() || (scene.effects.shadow && path.scatterings == 0) {
            add_direct(scene, sampler, &path, &it, &frame, &bsdf, &mut sample);
        }
        if !scatter(scene, sampler, &mut path, &it, &frame, &bsdf, &mut sample) || !survives(sampler, &mut path) {
            break;
        }
    }
    sample
}

/// The next surface that scatters, or `None` for the background. Surfaces that let the path pass
/// are passed by the odds of their opacity.
fn next_surface(scene: &Scene, sampler: &Sampler, path: &mut Path) -> Option<Interaction> {
    for _ in 0..MAX_TRANSPARENT {
        let hit = scene.closest_hit(&path.ray, path.mask)?;
        let it = scene.interaction(&path.ray, &hit, path.cone);
        path.vertex += 1;
        if scene.effects.absorption {
            path.beta *= path.media.current().map(|sigma| (-sigma * hit.t).exp());
        }
        path.cone.width = path.cone.at(hit.t);
        if !scene.effects.cutouts || !scene.material(&it).is_cutout() {
            return Some(it);
        }
        let u = sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::Opacity));
        if u < scene.opacity(&it) {
            return Some(it);
        }
        path.ray = it.continued(&path.ray, hit.t);
    }
    // Too many layers: stopped, as a shadow ray is.
    path.beta = Rgb::BLACK;
    None
}

/// The first surface that a ray from the camera does not pass, and its index of decisions.
pub fn first_surface(scene: &Scene, sampler: &Sampler, ray: Ray, cone: RayCone) -> Option<(Interaction, u32)> {
    let mut path = Path::from_camera(ray, cone);
    next_surface(scene, sampler, &mut path).map(|it| (it, path.vertex))
}

/// What lies behind everything.
fn add_background(scene: &Scene, path: &Path, sample: &mut PixelSample) {
    if path.scatterings == 0 {
        if scene.background_visible {
            let le: Rgb = scene.background(path.ray.d).map(|(.., le)| le).sum();
            sample.environment += path.beta * le;
            sample.combined += path.beta * le;
            sample.alpha = 1.0;
        }
        return;
    }
    for (i, _, le) in scene.background(path.ray.d) {
        let weight = if path.pdf.is_finite() {
            power_heuristic(path.pdf, scene.lights.pdf_li(&path.from, i, path.ray.d, None))
        } else {
            1.0
        };
        add_scattered(sample, path.shares, path.beta * le * weight, path.scatterings);
    }
}

/// What the surface at `it` emits towards the path.
fn add_emission(scene: &Scene, path: &Path, it: &Interaction, sample: &mut PixelSample) {
    let le = scene.emission(it);
    if le.is_black() {
        return;
    }
    if path.scatterings == 0 {
        sample.emission += path.beta * le;
        sample.combined += path.beta * le;
        sample.denoising_albedo += le;
        return;
    }
    let weight = if path.pdf.is_finite() { emission_weight(scene, &path.from, it, path.pdf) } else { 1.0 };
    add_scattered(sample, path.shares, path.beta * le * weight, path.scatterings);
}

/// Direct light at `it` by light sampling, and its part of the shadow pass.
fn add_direct(
    scene: &Scene,
    sampler: &Sampler,
    path: &Path,
    it: &Interaction,
    frame: &Frame,
    bsdf: &View<'_>,
    sample: &mut PixelSample,
) {
    let first = path.scatterings == 0;
    let shadow = first && scene.effects.shadow;
    let Some(light) = sample_light(scene, sampler, path.vertex, it, frame, bsdf, shadow) else { return };
    let arrives = light.unoccluded * light.visibility;
    if first {
        let direct = arrives * path.beta;
        sample.combined += direct.sum();
        sample.direct += to_film(direct);
        if shadow {
            sample.unshadowed += light.unoccluded.diffuse * path.beta;
            sample.irradiance_unshadowed += light.irradiance;
            sample.irradiance_shadowed += light.irradiance * light.visibility;
        }
    } else {
        add_scattered(sample, path.shares, arrives.sum() * path.beta, path.scatterings + 1);
    }
}

/// Chooses where the path goes from `it`; false where it ends.
fn scatter(
    scene: &Scene,
    sampler: &Sampler,
    path: &mut Path,
    it: &Interaction,
    frame: &Frame,
    bsdf: &View<'_>,
    sample: &mut PixelSample,
) -> bool {
    let uc = sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::BsdfLobe));
    let u = sampler.get_2d(Dimension::at_bounce(path.vertex, Decision::BsdfDirection));
    let Some(scattered) = bsdf.sample(uc, u) else { return false };
    let wi = frame.to_world(scattered.wi);
    if leaks(it, wi, scattered.wi.z) {
        return false;
    }
    path.ray = it.spawn(wi);
    path.from = receiver(scene, it, frame, bsdf);
    path.pdf = if scattered.delta { f32::INFINITY } else { scattered.pdf };
    if !scattered.delta {
        // A sample stands for the solid angle 1/pdf; textures seen by it need no finer detail.
        path.cone.spread = path.cone.spread.max(SCATTERED_SPREAD / scattered.pdf.sqrt());
    }
    if path.scatterings == 0 {
        path.shares = shares(scattered.weight);
        if scene.effects.shadow && scattered.weight.diffuse != Rgb::BLACK {
            let emission = unoccluded_emission(scene, &path.from, &path.ray, path.cone, scattered.pdf);
            sample.unshadowed += scattered.weight.diffuse * path.beta * emission;
        }
    }
    path.beta *= scattered.weight.sum();
    path.scatterings += 1;
    if scene.effects.absorption && scattered.lobe == Lobe::Transmission && !scene.material(it).thin {
        path.media.cross(scene.material(it).absorption, it.front);
    }
    path.mask = match scattered.lobe {
        Lobe::Diffuse => mask::DIFFUSE,
        Lobe::Glossy => mask::GLOSSY,
        Lobe::Transmission => mask::TRANSMISSION,
    };
    path.occlusion = match scattered.lobe {
        Lobe::Diffuse if scene.effects.occlusion_maps => scene.occlusion(it),
        _ => 1.0,
    };
    !path.beta.is_black()
}

/// Russian roulette by the throughput; false where the path ends.
fn survives(sampler: &Sampler, path: &mut Path) -> bool {
    if path.scatterings <= ROULETTE_AFTER {
        return true;
    }
    let odds = path.beta.max_component().min(0.95);
    if odds >= 0.95 {
        return true;
    }
    let u = sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::Roulette));
    path.beta *= 1.0 / odds;
    u < odds
}
