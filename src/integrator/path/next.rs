//! The next surface on a path's way, and what is passed before.

use super::Path;
use crate::film::PixelSample;
use crate::integrator::first_hit::{add_mist, describe_shape};
use crate::integrator::limits::Limits;
use crate::math::{Ray, Rgb};
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{Coverage, Interaction, Media, PathState, RayCone, Scene};

/// What a path meets on its way to the next surface that scatters.
pub(super) enum Met<'a> {
    /// A stretch between two distances.
    Stretch([f32; 2]),
    /// A surface and how much of it is there, whether the path then passes it or not.
    Surface(&'a Interaction, Coverage),
}

/// The next surface that scatters, or `None` for the background. Surfaces that let the path pass
/// are passed by the odds of their opacity, unless so many were that the path may pass no
/// more. `visit` is called with everything on the way.
pub(super) fn next_surface(
    scene: &Scene,
    sampler: &Sampler,
    path: &mut Path<'_>,
    mut visit: impl FnMut(&mut Path<'_>, Met<'_>),
) -> Option<Interaction> {
    loop {
        let Some(hit) = scene.closest_hit(&path.ray, path.mask) else {
            visit(path, Met::Stretch([path.travelled, f32::INFINITY]));
            if scene.effects.absorption {
                path.absorb(f32::INFINITY);
            }
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
            path.absorb(hit.t);
        }
        path.cone.width = path.cone.at(hit.t);
        let coverage = if scene.effects.cutouts { scene.coverage(&it) } else { Coverage::OPAQUE };
        visit(path, Met::Surface(&it, coverage));
        let Coverage { opacity, passes, p_stop } = coverage;
        if path.has_passed_all(scene) {
            return Some(it);
        }
        if p_stop == 1.0 || sampler.get_1d(Dimension::at_bounce(path.vertex, Decision::Opacity)) < p_stop {
            path.alpha *= coverage.alpha() / p_stop;
            path.share = opacity / p_stop;
            return Some(it);
        }
        path.beta *= passes * (1.0 / (1.0 - p_stop));
        path.alpha *= (1.0 - coverage.alpha()) / (1.0 - p_stop);
        if scene.effects.absorption {
            scene.pass_boundary(&mut path.media, &it, path.ray.d);
        }
        path.state.transparent = path.state.transparent.saturating_add(1);
        path.ray = it.continued(&path.ray, hit.t);
    }
}

/// The first surface that a ray from the camera does not pass.
pub struct First {
    /// The point.
    pub it: Interaction,
    /// Index of its random decisions.
    pub vertex: u32,
    /// What is before it.
    pub media: Media,
    /// What is left there of light, by what has absorbed it on the way.
    pub left: Rgb,
    /// How far it is from where the ray begins.
    pub travelled: f32,
}

/// The first surface; what the ray has met is told to `sample`.
pub fn first_surface(
    scene: &Scene,
    sampler: &Sampler,
    ray: Ray,
    cone: RayCone,
    sample: &mut PixelSample,
) -> Option<First> {
    let mut path = Path::from_camera(scene, ray, cone, &Limits::NONE);
    let mut described = !(scene.effects.geometry || scene.effects.aovs);
    let surface = next_surface(scene, sampler, &mut path, |path, met| {
        let Met::Surface(it, coverage) = met else { return };
        if scene.effects.mist {
            add_mist(scene, it, path.beta.mean(), coverage.alpha(), sample);
        }
        if !described {
            described = describe_shape(scene, it, coverage.alpha(), sample);
        }
    });
    if surface.is_none() && !described {
        scene.add_background_aovs(path.ray.d, &mut sample.aovs);
    }
    surface.filter(|it| !scene.is_holdout(it)).map(|it| First {
        it,
        vertex: path.vertex,
        media: path.media,
        left: path.left,
        travelled: path.travelled,
    })
}
