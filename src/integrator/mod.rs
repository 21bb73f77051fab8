//! Radiance of one sample: the integrator's one entry is [`sample`].

mod ao;
mod catcher;
mod direct;
mod disk;
mod first_hit;
mod guide;
mod limits;
mod path;
mod scattering;
mod shadow;
mod shadow_pass;
mod split;
mod subsurface;

pub use first_hit::first_hit;

use crate::film::PixelSample;
use crate::sampling::{Dimension, Sampler};
use crate::scene::{RayCone, Scene};
use crate::settings::{Integrator, Settings};

/// One sample of the pixel in column `x` and row `y`, counted from the top left, and the weight that
/// the pixel filter gives it.
pub fn sample(scene: &Scene, settings: &Settings, sampler: &Sampler, x: u32, y: u32) -> (PixelSample, f32) {
    let (dx, dy, weight) = settings.filter.sample(sampler.get_2d(Dimension::PIXEL));
    let on_lens = || sampler.get_2d(Dimension::LENS);
    let time = if scene.effects.motion_blur { scene.time_of_row(y, sampler.get_1d(Dimension::TIME)) } else { 0.0 };
    let camera_ray = scene.camera_ray(x as f32 + 0.5 + dx, y as f32 + 0.5 + dy, time, on_lens);
    let cone = RayCone { width: camera_ray.width, spread: camera_ray.spread };
    let mut sample = match settings.integrator {
        Integrator::Path => path::trace(scene, sampler, camera_ray.ray, cone, settings, settings.max_bounces),
        Integrator::Direct => path::trace(scene, sampler, camera_ray.ray, cone, settings, 0),
        Integrator::Ao => ao::trace(scene, sampler, camera_ray.ray, cone, settings),
    };
    if scene.exposure != 1.0 && settings.integrator != Integrator::Ao {
        sample.expose(scene.exposure);
    }
    (sample, weight)
}
