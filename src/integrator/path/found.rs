//! What rays find: lamps on their way, the background, surfaces that emit.

use super::Path;
use crate::film::PixelSample;
use crate::integrator::scattering::{Scattering, seen};
use crate::integrator::shadow::mesh_weight;
use crate::integrator::split::{add_direct, add_indirect, add_unscattered};
use crate::light::{Emitter, Rules};
use crate::math::Rgb;
use crate::scene::{Interaction, Scene};

/// Lamps on a stretch of the way; they stop nothing.
pub(super) fn add_lamps(scene: &Scene, path: &Path<'_>, segment: [f32; 2], sample: &mut PixelSample) {
    let wi = path.ray.d;
    scene.lights.lamps_along(path.start, wi, segment, |i, light, hit| {
        let mut le = light.emitter.le(wi, Some(hit));
        if scene.effects.absorption {
            le *= path.media.transmitted(hit.dist - segment[0]);
        }
        match &path.last {
            None if light.rules.seen.camera => {
                let l = path.unscattered(le);
                sample.emission += l;
                path.tell_denoiser(l, sample);
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
pub(super) fn add_background(scene: &Scene, path: &Path<'_>, sample: &mut PixelSample) {
    if path.sees_film && path.scatterings > 0 {
        sample.alpha = (sample.alpha - path.beta.mean()).max(0.0);
        return;
    }
    if path.scatterings == 0 && scene.background_visible {
        sample.alpha = path.alpha;
    } else if path.scatterings == 0 && path.left != Rgb::WHITE {
        // What absorbs covers as much as it takes.
        sample.alpha = (path.alpha - path.beta.mean()).max(0.0);
    }
    if !scene.effects.radiance {
        return;
    }
    for (i, light, le) in scene.background(path.ray.d) {
        match &path.last {
            None if light.rules.seen.camera => {
                let l = path.unscattered(le);
                sample.environment += l;
                path.tell_denoiser(l, sample);
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
pub(super) fn add_emission(scene: &Scene, path: &Path<'_>, it: &Interaction, opacity: f32, sample: &mut PixelSample) {
    let le = scene.emission(it) * opacity;
    if le.is_black() || (path.last.is_none() && scene.is_holdout(it)) {
        return;
    }
    let rules = scene.instance(it.instance).rules.as_deref().unwrap_or(&Rules::NONE);
    match &path.last {
        None => {
            let l = path.unscattered(le);
            sample.emission += l;
            path.tell_denoiser(l, sample);
            add_unscattered(sample, rules, l);
        }
        Some(last) => path.add_found(last, rules, le * mesh_weight(scene, last, it), sample),
    }
}

impl Path<'_> {
    /// What the camera sees of radiance `le` that nothing has scattered.
    fn unscattered(&self, le: Rgb) -> Rgb {
        self.limits.clamp(self.beta * le, 0)
    }

    /// What shines where a denoiser's albedo is still looked for, with radiance `l` in the picture, is part of it.
    fn tell_denoiser(&self, l: Rgb, sample: &mut PixelSample) {
        if let Some(look) = &self.look {
            sample.denoising_albedo += look.throughput * l;
        }
    }

    /// Adds radiance `le` of an emitter with `rules` that the ray from `last` has found, with its MIS
    /// weight. Lights with shadow rules of their own are counted where the ray begins. How often light may have been
    /// scattered before a lamp counts holds for light sampling alone, as in Cycles.
    fn add_found(&self, last: &Scattering, rules: &Rules, le: Rgb, sample: &mut PixelSample) {
        if !rules.stops_like_rays() || !rules.lights(last.from.class) {
            return;
        }
        let l = seen(last.shares, rules) * (self.beta * le);
        let l = l * self.limits.factor(l.sum(), self.scatterings);
        self.tell_denoiser(l.sum(), sample);
        if self.scatterings == 1 {
            add_direct(sample, rules, l);
        } else {
            add_indirect(sample, rules, self.shares, l.sum());
        }
    }
}
