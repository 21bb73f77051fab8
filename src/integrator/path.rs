//! Path tracing with next-event estimation, multiple importance sampling and Russian roulette.
//!
//! James Kajiya: *The Rendering Equation*, SIGGRAPH 1986. Eric Veach: *Robust Monte Carlo Methods
//! for Light Transport Simulation*, 1997, chapters 9 and 10.

use super::direct::Shading;
use super::first_hit::{describe, describe_shape};
use super::limits::Limits;
use super::media::Media;
use super::scattering::{Scattering, seen};
use super::shadow::{emitters_along, mesh_weight};
use super::shadow_pass;
use super::split::{add_direct, add_indirect, add_unscattered, shares, to_film};
use super::{ao, catcher, subsurface};
use crate::bsdf::{Beneath, BsdfSample, ByLobe, Closure, Inside, Lobe};
use crate::film::PixelSample;
use crate::light::{Emitter, Rules};
use crate::math::{Ray, Rgb, Vec3};
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{Blur, Coverage, Interaction, PathState, RayCone, RayKind, Scene, mask};
use crate::settings::Settings;

/// Scatterings before roulette begins.
const ROULETTE_AFTER: u32 = 3;

/// Angle of the cone of a scattered ray, as a share of the root of the solid angle it stands for.
const SCATTERED_SPREAD: f32 = 0.25;

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
    /// Solids that the path is inside of.
    media: Media,
    /// Surfaces met so far, passed ones included: the index of random decisions.
    vertex: u32,
    /// Density of the least likely direction taken so far, deltas left out.
    min_pdf: f32,
    /// The last scattering; `None` for rays from the camera.
    last: Option<Scattering>,
    /// What limits and graphs ask of it.
    state: PathState,
    /// Where `ray` would have begun had it passed no surface since, and how far it has come.
    start: Vec3,
    travelled: f32,
}

impl<'a> Path<'a> {
    fn from_camera(ray: Ray, cone: RayCone, limits: &'a Limits) -> Self {
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
            media: Media::default(),
            vertex: 0,
            min_pdf: f32::INFINITY,
            last: None,
            state: PathState::CAMERA,
            start: ray.o,
            travelled: 0.0,
        }
    }

    /// True where the path looks for emitters alone.
    fn is_exhausted(&self) -> bool {
        self.limits.exhausted(self.scatterings, &self.state)
    }

    /// What the camera sees of radiance `le` that nothing has scattered.
    fn unscattered(&self, le: Rgb) -> Rgb {
        self.limits.clamp(self.beta * le, 0)
    }

    /// Adds radiance `le` of an emitter with `rules` that the ray from `last` has found, with its MIS
    /// weight. Lights with shadow rules of their own are counted where the ray begins.
    fn add_found(&self, last: &Scattering, rules: &Rules, le: Rgb, sample: &mut PixelSample) {
        if !rules.stops_like_rays() || !rules.lights(last.from.class) {
            return;
        }
        let l = seen(last.shares, rules) * (self.beta * le);
        let l = l * self.limits.factor(l.sum(), self.scatterings);
        if self.scatterings == 1 {
            add_direct(sample, rules, l);
        } else {
            add_indirect(sample, rules, self.shares, l.sum());
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
    let limits = Limits::of(settings, if scene.effects.indirect { max_bounces } else { 0 });
    let mut sample = PixelSample::of(&scene.passes);
    let mut path = Path::from_camera(ray, cone, &limits);
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
                add_emission(scene, path, it, coverage.opacity, &mut sample);
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
        let frame = scene.shading_frame(&it);
        let bsdf = scene.bsdf(&it, &frame, path.share, Blur::of_path(settings, path.min_pdf, path.mask == mask::DIFFUSE));
        let shading = Shading { it: &it, frame: &frame, bsdf: &bsdf, vertex: path.vertex };
        if path.scatterings == 0 {
            // Of a catcher the camera sees no light, but what it is.
            if in_front.is_none() {
                describe_first(scene, sampler, &path, &shading, settings, &mut sample);
            }
            if scene.effects.catchers && scene.instance(it.instance).catcher {
                let samples = settings.light_samples;
                in_front
                    .get_or_insert_with(|| catcher::meet(scene, sampler, &shading, path.alpha, samples, &mut sample));
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
    let Shading { it, frame, bsdf, vertex } = shading;
    describe(scene, it, frame, sample);
    if scene.effects.ao {
        sample.ao = ao::openness(scene, sampler, *vertex, it, frame, settings) * path.alpha;
    }
    if scene.effects.color {
        let color = bsdf.color() * path.beta;
        sample.color = to_film(color);
        sample.denoising_albedo += color.sum();
    }
}

/// What a path meets on its way to the next surface that scatters.
enum Met<'a> {
    /// A stretch between two distances.
    Stretch([f32; 2]),
    /// A surface and how much of it is there, whether the path then passes it or not.
    Surface(&'a Interaction, Coverage),
}

/// The next surface that scatters, or `None` for the background. Surfaces that let the path pass
/// are passed by the odds of their opacity, up to so many on the whole path: the next one is black. `visit` is called with everything on the way.
fn next_surface(
    scene: &Scene,
    sampler: &Sampler,
    path: &mut Path<'_>,
    mut visit: impl FnMut(&Path<'_>, Met<'_>),
) -> Option<Interaction> {
    loop {
        let Some(hit) = scene.closest_hit(&path.ray, path.mask) else {
            visit(path, Met::Stretch([path.travelled, f32::INFINITY]));
            return None;
        };
        visit(path, Met::Stretch([path.travelled, path.travelled + hit.t]));
        let mut it = scene.interaction(&path.ray, &hit, path.cone);
        path.vertex += 1;
        path.travelled += hit.t;
        if scene.effects.light_path {
            it.path = PathState { length: path.travelled, ..path.state };
        }
        it.path.transparent = path.state.transparent;
        if scene.effects.absorption {
            path.beta *= transmitted(&path.media, hit.t);
        }
        path.cone.width = path.cone.at(hit.t);
        let coverage = if scene.effects.cutouts { scene.coverage(&it) } else { Coverage::OPAQUE };
        visit(path, Met::Surface(&it, coverage));
        let Coverage { opacity, passes, p_stop } = coverage;
        if path.state.transparent > 0 && u32::from(path.state.transparent) >= scene.max_transparent {
            path.beta = Rgb::BLACK;
            return Some(it);
        }
        if p_stop == 1.0 || sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::Opacity)) < p_stop {
            path.alpha *= coverage.alpha() / p_stop;
            path.share = opacity / p_stop;
            return Some(it);
        }
        path.beta *= passes * (1.0 / (1.0 - p_stop));
        path.alpha *= (1.0 - coverage.alpha()) / (1.0 - p_stop);
        path.state.transparent = path.state.transparent.saturating_add(1);
        path.ray = it.continued(&path.ray, hit.t);
    }
}

/// What a stretch of `dist` metres inside `media` lets through.
fn transmitted(media: &Media, dist: f32) -> Rgb {
    media.current().map(|sigma| (-sigma * dist).exp())
}

/// The first surface that a ray from the camera does not pass, and its index of decisions; what it has met is
/// told to `sample`.
pub fn first_surface(
    scene: &Scene,
    sampler: &Sampler,
    ray: Ray,
    cone: RayCone,
    settings: &Settings,
    sample: &mut PixelSample,
) -> Option<(Interaction, u32)> {
    let limits = Limits::of(settings, 0);
    let mut path = Path::from_camera(ray, cone, &limits);
    let mut described = !(scene.effects.geometry || scene.effects.aovs);
    let surface = next_surface(scene, sampler, &mut path, |_, met| match met {
        Met::Surface(it, coverage) if !described => described = describe_shape(scene, it, coverage.alpha(), sample),
        _ => {}
    });
    if surface.is_none() && !described {
        scene.add_background_aovs(path.ray.d, &mut sample.aovs);
    }
    surface.filter(|it| !scene.is_holdout(it)).map(|it| (it, path.vertex))
}

/// Lamps on a stretch of the way; they stop nothing.
fn add_lamps(scene: &Scene, path: &Path<'_>, segment: [f32; 2], sample: &mut PixelSample) {
    let wi = path.ray.d;
    scene.lights.lamps_along(path.start, wi, segment, |i, light, hit| {
        let mut le = light.emitter.le(wi, Some(hit));
        if scene.effects.absorption {
            le *= transmitted(&path.media, hit.dist - segment[0]);
        }
        match &path.last {
            None if light.rules.seen.camera => {
                let l = path.unscattered(le);
                sample.emission += l;
                sample.denoising_albedo += le;
                add_unscattered(sample, &light.rules, l);
            }
            None => {}
            Some(last) => {
                let le = le * last.mis_weight(scene, i, wi, Some(hit));
                path.add_found(last, &light.rules, le, sample);
            }
        }
    });
}

/// What lies behind everything.
fn add_background(scene: &Scene, path: &Path<'_>, sample: &mut PixelSample) {
    if path.scatterings == 0 && scene.background_visible {
        sample.alpha = path.alpha;
    }
    for (i, light, le) in scene.background(path.ray.d) {
        match &path.last {
            None if light.rules.seen.camera => {
                let l = path.unscattered(le);
                sample.environment += l;
                if !scene.film_transparent {
                    add_unscattered(sample, &light.rules, l);
                }
            }
            None => {}
            Some(last) => {
                let le = le * last.mis_weight(scene, i, path.ray.d, None);
                path.add_found(last, &light.rules, le, sample);
            }
        }
    }
}

/// What the surface at `it` emits towards the path. Of one that is partly open it is the mean, whether
/// the path stops there or not, as light sampling and the shadow passes have it.
fn add_emission(scene: &Scene, path: &Path<'_>, it: &Interaction, opacity: f32, sample: &mut PixelSample) {
    let le = scene.emission(it) * opacity;
    if le.is_black() || (path.last.is_none() && scene.is_holdout(it)) {
        return;
    }
    let rules = scene.instance(it.instance).rules.as_deref().unwrap_or(&Rules::NONE);
    match &path.last {
        None => {
            let l = path.unscattered(le);
            sample.emission += l;
            sample.denoising_albedo += le;
            add_unscattered(sample, rules, l);
        }
        Some(last) => path.add_found(last, rules, le * mesh_weight(scene, last, it), sample),
    }
}

/// Direct light at a surface by `light_samples` samples, and what light groups have of their own.
fn add_lights(
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

/// Chooses where the path goes from a surface where `light_samples` were taken; false where it ends.
fn scatter(
    scene: &Scene,
    sampler: &Sampler,
    path: &mut Path<'_>,
    shading: &Shading<'_>,
    light_samples: u32,
    sample: &mut PixelSample,
) -> bool {
    let it = shading.it;
    let uc = sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::BsdfLobe));
    let u = sampler.get_2d(Dimension::at_bounce(path.vertex, Decision::BsdfDirection));
    let Some(scattered) = shading.bsdf.sample(uc, u) else { return false };
    if let Some(beneath) = scattered.beneath {
        return go_beneath(scene, sampler, path, shading, (&scattered, beneath), light_samples, sample);
    }
    let wi = shading.frame.to_world(scattered.wi);
    path.ray = it.spawn(wi);
    path.start = it.p;
    path.travelled = 0.0;
    if !scattered.delta {
        // A sample stands for the solid angle 1/pdf; textures seen by it need no finer detail.
        path.min_pdf = path.min_pdf.min(scattered.pdf);
        path.cone.spread = path.cone.spread.max(SCATTERED_SPREAD / scattered.pdf.sqrt());
    }
    path.state = path.state.scattered(kind_of(scattered.lobe), scattered.delta);
    let last = Scattering {
        from: shading.receiver(scene),
        pdf: if scattered.delta { f32::INFINITY } else { scattered.pdf },
        light_samples: light_samples as f32,
        shares: shares(scattered.weight),
    };
    path.last = Some(last);
    let first = path.scatterings == 0;
    let beta = path.beta;
    path.beta *= scattered.weight.sum();
    path.scatterings += 1;
    if first {
        path.shares = last.shares;
    }
    let unshadowed = first && scene.effects.shadow && scattered.weight.diffuse != Rgb::BLACK;
    if unshadowed || scene.effects.own_shadows {
        emitters_along(scene, &last, &path.state, &path.ray, path.cone, unshadowed, |found| {
            let weight = seen(scattered.weight, found.rules);
            if unshadowed {
                let l = weight * (beta * found.le);
                sample.unshadowed += l.diffuse * path.limits.factor(l.sum(), 1);
            }
            if !found.rules.stops_like_rays() {
                let l = weight * (beta * found.le * found.visibility(scene, &path.ray, path.state.transparent));
                let l = l * path.limits.factor(l.sum(), path.scatterings);
                if first {
                    add_direct(sample, found.rules, l);
                } else {
                    add_indirect(sample, found.rules, path.shares, l.sum());
                }
            }
        });
    }
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

/// Walks beneath the surface to where light comes out, which it does by Lambert's law: what arrives there counts as if
/// it arrived at `shading`. False where the path ends.
// Out of line, so that other surfaces have no part in it.
#[cold]
fn go_beneath(
    scene: &Scene,
    sampler: &Sampler,
    path: &mut Path<'_>,
    shading: &Shading<'_>,
    (scattered, beneath): (&BsdfSample, u8),
    light_samples: u32,
    sample: &mut PixelSample,
) -> bool {
    let Shading { it, frame, bsdf, vertex } = *shading;
    let Some(Beneath { inside, shallow }) = bsdf.beneath(beneath) else { return false };
    let entry = subsurface::Entry { it, n: frame.n, wi: frame.to_world(scattered.wi), vertex, cone: path.cone };
    let beta = path.beta * scattered.weight.sum();
    let came_out = match inside {
        _ if shallow && path.state.diffuse > 0 => Some((*it, beta)),
        Inside::Medium(medium) => entry.walk(scene, sampler, &medium, beta),
        Inside::Profile(profile) => entry.probe(scene, sampler, &profile, beta),
    };
    let Some((it, beta)) = came_out else { return false };
    path.beta = beta;
    path.vertex += 1;
    let frame = scene.shading_frame(&it);
    let mut builder = scene.builder(&it, &frame);
    builder.add(Rgb::WHITE, &Closure::Diffuse { color: Rgb::WHITE, roughness: 0.0, multiscatter: false });
    let bsdf = builder.finish();
    let shading = Shading { it: &it, frame: &frame, bsdf: &bsdf, vertex: path.vertex };
    add_lights(scene, sampler, path, &shading, light_samples, sample);
    scatter(scene, sampler, path, &shading, light_samples, sample)
}

/// What graphs call a ray from a lobe of this class.
fn kind_of(lobe: Lobe) -> RayKind {
    match lobe {
        Lobe::Diffuse => RayKind::Diffuse,
        Lobe::Glossy => RayKind::Glossy,
        Lobe::Transmission => RayKind::Transmission,
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
