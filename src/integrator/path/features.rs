//! What a denoiser is told of a sample: normal, albedo and distance of what is seen, in mirrors and through glass too.
//!
//! As in Cycles: a surface most of which is a mirror hands on to the next one; distances add up on the way. Of the
//! first that is none the albedo counts, but for its mirrors, and what shines before or there.

use super::Path;
use crate::bsdf::{Bsdf, Features};
use crate::film::PixelSample;
use crate::math::{Frame, Rgb, Vec3};
use crate::scene::{Blur, Coverage, Interaction, Scene, mask};
use crate::settings::Settings;

/// Microfacets of a smaller width are mirrors: Cycles' threshold.
const MIRROR: f32 = 0.075;

/// How far a path has come in looking.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Share of what is found that counts.
    pub throughput: Rgb,
    /// How far the path's ray has been followed since it scattered, and how often it had.
    travelled: f32,
    scatterings: u32,
}

impl Look {
    /// From the camera.
    pub const FIRST: Self = Self { throughput: Rgb::WHITE, travelled: 0.0, scatterings: 0 };
}

/// Looks at the surface at `it`, of which `coverage` is there, as far as nothing before it has ended the search.
pub(super) fn look(
    scene: &Scene,
    path: &mut Path<'_>,
    it: &Interaction,
    coverage: Coverage,
    settings: &Settings,
    sample: &mut PixelSample,
) {
    let Some(mut look) = path.look else { return };
    if path.scatterings == 0 && scene.is_holdout(it) {
        path.look = None;
        return;
    }
    if look.scatterings != path.scatterings {
        (look.travelled, look.scatterings) = (0.0, path.scatterings);
    }
    sample.denoising_depth += look.throughput.mean() * (path.travelled - look.travelled);
    look.travelled = path.travelled;
    let frame = scene.shading_frame(it);
    let mut bsdf = Bsdf::none();
    if !scene.material(it).unlit {
        let blur = Blur::of_path(settings, path.min_pdf, path.mask == mask::DIFFUSE);
        scene.fill_bsdf(&mut bsdf, it, &frame, coverage.opacity, blur);
    }
    let Features { rough, mirror, normal, rough_weight, weight } = bsdf.features(MIRROR);
    // What passes unscattered is seen as in a mirror.
    let (passes, all) = (coverage.passes, weight + coverage.passes.mean());
    if all > 0.0 && 4.0 * rough_weight <= all {
        look.throughput *= mirror + passes;
        path.look = Some(look);
        return;
    }
    path.look = None;
    sample.denoising_albedo += look.throughput * rough;
    if all > 0.0 {
        let n = frame.to_world(normal) + frame.n * passes.mean();
        sample.denoising_normal = in_camera(scene, n * (1.0 / all));
    }
}

/// `n` to the right, up and ahead of the camera.
fn in_camera(scene: &Scene, n: Vec3) -> Vec3 {
    let view = scene.camera.view();
    Vec3::new(n.dot(view.right), n.dot(view.up), n.dot(view.forward))
}

/// Normal and distance of the first surface, whatever it is made of, `distance` from where the ray begins.
pub fn tell_of_first(scene: &Scene, frame: &Frame, distance: f32, sample: &mut PixelSample) {
    sample.denoising_normal = in_camera(scene, frame.n);
    sample.denoising_depth = distance;
}
