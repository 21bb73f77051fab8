//! Path tracing with next-event estimation, multiple importance sampling and Russian roulette.
//!
//! James Kajiya: *The Rendering Equation*, SIGGRAPH 1986. Eric Veach: *Robust Monte Carlo Methods
//! for Light Transport Simulation*, 1997, chapters 9 and 10.

mod features;
mod found;
mod lights;
mod next;
mod scatter;

pub use features::tell_of_first;
pub use next::{First, first_surface};

use super::direct::Shading;
use super::first_hit::{add_mist, describe, describe_shape};
use super::limits::Limits;
use super::scattering::Scattering;
use super::split::to_film;
use super::{ao, catcher, shadow_pass};
use crate::bsdf::{Bsdf, ByLobe};
use crate::film::PixelSample;
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{Blur, Media, PathState, RayCone, Scene, mask};
use crate::settings::Settings;
use features::Look;
use found::{add_background, add_emission, add_lamps};
use lights::add_lights;
use next::{Met, next_surface};
use scatter::scatter;

/// Scatterings before roulette begins.
const ROULETTE_AFTER: u32 = 3;

/// Where a path stands.
struct Path<'a> {
    limits: &'a Limits,
    ray: Ray,
    cone: RayCone,
    mask: u64,
    /// Throughput so far.
    beta: Rgb,
    /// Share of the picture's alpha that what comes next stands for.
    alpha: f32,
    /// Factor of what the surface at which the path has stopped scatters: what is there over the odds of stopping.
    share: f32,
    /// Applied to `beta` once the light that arrives directly has been counted.
    occlusion: f32,
    /// Share of each class in the first scattering.
    shares: ByLobe,
    scatterings: u32,
    /// Factor of `beta` by what has absorbed light on the way.
    left: Rgb,
    /// What the path is inside of.
    media: Media,
    /// Surfaces met so far, passed ones included: the index of random decisions.
    vertex: u32,
    /// Density of the least likely direction taken so far, deltas left out.
    min_pdf: f32,
    /// The last scattering; `None` for rays from the camera.
    last: Option<Scattering>,
    /// True while it has met nothing but glass through which a transparent film is seen.
    sees_film: bool,
    /// What limits and graphs ask of it.
    state: PathState,
    /// What a denoiser is told is still looked for.
    look: Option<Look>,
    /// Where `ray` would have begun had it passed no surface since, and how far it has come.
    start: Vec3,
    travelled: f32,
}

impl<'a> Path<'a> {
    fn from_camera(scene: &Scene, ray: Ray, cone: RayCone, limits: &'a Limits) -> Self {
        Self {
            limits,
            ray,
            cone,
            mask: mask::CAMERA,
            beta: Rgb::WHITE,
            alpha: 1.0,
            share: 1.0,
            occlusion: 1.0,
            shares: ByLobe::BLACK,
            scatterings: 0,
            left: Rgb::WHITE,
            media: if scene.effects.absorption { scene.media_around(&ray) } else { Media::NONE },
            vertex: 0,
            min_pdf: f32::INFINITY,
            last: None,
            sees_film: scene.transparent_glass.is_some(),
            state: PathState::CAMERA,
            look: scene.effects.denoising.then_some(Look::FIRST),
            start: ray.o,
            travelled: 0.0,
        }
    }

    /// Goes on for `dist` metres through what absorbs there.
    fn absorb(&mut self, dist: f32) {
        let left = self.media.transmitted(dist);
        self.left *= left;
        self.beta *= left;
    }

    /// True where the path looks for emitters alone.
    fn is_exhausted(&self) -> bool {
        self.limits.exhausted(self.scatterings, &self.state)
    }

    /// True where it has passed all that it may: the next surface stops it.
    fn has_passed_all(&self, scene: &Scene) -> bool {
        self.state.transparent > 0 && u32::from(self.state.transparent) >= scene.max_transparent
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
    let limits = Limits::of(settings, if scene.effects.indirect { max_bounces } else { 0 });
    let mut sample = PixelSample::of(&scene.passes);
    let mut path = Path::from_camera(scene, ray, cone, &limits);
    let mut described = !(scene.effects.geometry || scene.effects.aovs);
    let mut in_front = None;
    loop {
        let surface = next_surface(scene, sampler, &mut path, |path, met| match met {
            Met::Stretch(segment) if scene.effects.lamps => add_lamps(scene, path, segment, &mut sample),
            Met::Stretch(_) => {}
            Met::Surface(it, coverage) => {
                if !described && path.scatterings == 0 {
                    described = describe_shape(scene, it, coverage.alpha(), &mut sample);
                }
                if scene.effects.mist && path.scatterings == 0 && in_front.is_none() {
                    add_mist(scene, it, path.beta.mean(), coverage.alpha(), &mut sample);
                }
                if scene.effects.radiance {
                    add_emission(scene, path, it, coverage.opacity, &mut sample);
                }
                if path.look.is_some() {
                    features::look(scene, path, it, coverage, settings, &mut sample);
                }
            }
        });
        let Some(it) = surface else {
            if !described && path.scatterings == 0 {
                scene.add_background_aovs(path.ray.d, &mut sample.aovs);
            }
            add_background(scene, &path, &mut sample);
            break;
        };
        if path.is_exhausted() {
            break;
        }
        if path.scatterings == 0 && scene.is_holdout(&it) {
            break;
        }
        if path.has_passed_all(scene) {
            if path.scatterings == 0 {
                sample.alpha = path.alpha;
            }
            break;
        }
        let frame = scene.shading_frame(&it);
        let mut bsdf = Bsdf::none();
        if scene.effects.scattering {
            let blur = Blur::of_path(settings, path.min_pdf, path.mask == mask::DIFFUSE);
            scene.fill_bsdf(&mut bsdf, &it, &frame, path.share, blur);
        }
        let around;
        let media = if scene.effects.absorption {
            around = path.media;
            &around
        } else {
            &Media::NONE
        };
        let shading = Shading { it: &it, frame: &frame, bsdf: &bsdf, vertex: path.vertex, media };
        if path.scatterings == 0 {
            // Of a catcher the camera sees no light, but what it is.
            if in_front.is_none() {
                describe_first(scene, sampler, &path, &shading, settings, &mut sample);
            }
            if scene.effects.catchers && scene.instance(it.instance).catcher {
                let samples = settings.light_samples;
                in_front
                    .get_or_insert_with(|| catcher::meet(scene, sampler, &shading, path.alpha, samples, &mut sample));
                if scene.effects.absorption {
                    scene.pass_boundary(&mut path.media, &it, path.ray.d);
                }
                path.ray = it.spawn(path.ray.d);
                continue;
            }
            sample.alpha = path.alpha;
        }
        if scene.material(&it).unlit {
            break;
        }
        path.beta *= path.occlusion;

        let light_samples = if path.scatterings == 0 { settings.light_samples } else { 1 };
        add_lights(scene, sampler, &path, &shading, light_samples, &mut sample);
        if !scene.effects.light {
            break;
        }
        if path.scatterings == 0 && scene.effects.irradiance && bsdf.lacks_diffuse() {
            shadow_pass::add_irradiance(scene, sampler, &shading, &mut sample);
        }
        if !scatter(scene, sampler, &mut path, &shading, light_samples, &mut sample) {
            break;
        }
        if (path.is_exhausted() && !scene.effects.found_by_rays) || !survives(sampler, &mut path) {
            break;
        }
    }
    if let Some(in_front) = in_front {
        catcher::set_apart(in_front, &mut sample);
    }
    sample
}

/// What the first surface is, as far as passes ask for it.
fn describe_first(
    scene: &Scene,
    sampler: &Sampler,
    path: &Path<'_>,
    shading: &Shading<'_>,
    settings: &Settings,
    sample: &mut PixelSample,
) {
    let Shading { it, frame, bsdf, vertex, media } = shading;
    describe(scene, it, sample);
    if scene.effects.ao {
        sample.ao = ao::openness(scene, sampler, *vertex, it, frame, settings, media) * (path.left * path.alpha);
    }
    if scene.effects.color {
        let color = bsdf.color() * path.beta;
        sample.color = to_film(color);
    }
}

/// Russian roulette by the throughput; false where the path ends.
fn survives(sampler: &Sampler, path: &mut Path<'_>) -> bool {
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
