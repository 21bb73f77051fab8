//! Where a path goes on: a direction of the surface, or beneath it to another place of it.

use super::Path;
use super::lights::add_lights;
use crate::bsdf::{Beneath, Bsdf, BsdfSample, Closure, Inside, Lobe};
use crate::film::PixelSample;
use crate::integrator::direct::Shading;
use crate::integrator::scattering::{Scattering, seen};
use crate::integrator::shadow::emitters_along;
use crate::integrator::split::{add_direct, add_indirect, shares};
use crate::integrator::subsurface;
use crate::math::Rgb;
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{RayKind, Scene, mask};

/// Angle of the cone of a scattered ray, as a share of the root of the solid angle it stands for.
const SCATTERED_SPREAD: f32 = 0.25;

/// Chooses where the path goes from a surface where `light_samples` were taken; false where it ends.
pub(super) fn scatter(
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
    if path.sees_film {
        path.sees_film = scattered.lobe == Lobe::Transmission
            && scene.transparent_glass.is_some_and(|widest| shading.bsdf.passage_width() <= widest);
    }
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
    if scene.effects.absorption {
        scene.pass_boundary(&mut path.media, it, wi);
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
                let l = weight
                    * (beta * found.le * found.visibility(scene, &path.ray, &path.media, path.state.transparent));
                let l = l * path.limits.factor(l.sum(), path.scatterings);
                if first {
                    add_direct(sample, found.rules, l);
                } else {
                    add_indirect(sample, found.rules, path.shares, l.sum());
                }
            }
        });
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
    let Shading { it, frame, bsdf, vertex, .. } = *shading;
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
    let mut bsdf = Bsdf::none();
    let mut builder = scene.builder(&mut bsdf, &it, &frame);
    builder.add(Rgb::WHITE, &Closure::Diffuse { color: Rgb::WHITE, roughness: 0.0, multiscatter: false });
    builder.finish();
    let media = path.media;
    let shading = Shading { it: &it, frame: &frame, bsdf: &bsdf, vertex: path.vertex, media: &media };
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
