//! What accuracy costs: error against seconds, of a scene rendered in many ways, against a reference.
//!
//! Each way is rendered with several seeds, and looked at whenever its samples have doubled, so that one render gives
//! a whole curve. What differs between seeds is noise; what the mean of them is off the reference by, beyond the noise
//! of both, is bias. See `docs/converge.md`.

mod configurations;
mod curve;
mod reference;
mod watch;

pub use configurations::{Configuration, Kind, configurations};
pub use curve::{Curve, Point};
pub use reference::Reference;

use crate::denoise::Denoiser;
use crate::error::{Error, Place, Result};
use crate::render;
use crate::scene::Scene;
use crate::settings::Settings;
use watch::Watch;

/// A way of rendering the scene and what came of it.
#[derive(Clone, Debug)]
pub struct Measured {
    /// What it is.
    pub configuration: Configuration,
    /// Error against seconds.
    pub curve: Curve,
    /// True where its first picture is bit for bit that of the base: the scene does not call for what it changes.
    pub is_base: bool,
}

/// What all ways have in common.
pub struct Task<'a> {
    /// Layer that is looked at, as "Combined"; its first three channels.
    pub layer: &'a str,
    /// What it should be.
    pub reference: &'a Reference,
    /// Renders of each way, 2 at least.
    pub seeds: u32,
    /// Denoises, where it is installed.
    pub denoiser: Option<&'a Denoiser>,
}

/// A picture that was taken while a way was rendered.
#[derive(Clone, Debug)]
struct Shot {
    spp: f64,
    /// Since the first ray, without what looking took.
    seconds: f64,
    /// The layer, three numbers per pixel.
    values: Vec<f32>,
}

impl Task<'_> {
    /// Renders `scene` as `settings` have it, `seeds` times; the curve, and the first picture of the first seed.
    ///
    /// # Errors
    /// What a render gives; a layer that the scene does not have; the denoiser's.
    pub fn measure(&self, scene: &Scene, settings: &Settings, denoise: bool) -> Result<(Curve, Vec<f32>)> {
        let mut runs: Vec<Vec<Shot>> = Vec::new();
        for seed in 0..self.seeds {
            let settings = Settings { seed: settings.seed.wrapping_add(1 + u64::from(seed)), ..settings.clone() };
            let denoiser = self.denoiser.filter(|_| denoise);
            let watch = Watch::new(self.layer, denoiser, settings.threads);
            let rendered = render::render(scene, &settings, &watch)?;
            runs.push(watch.shots(&rendered.film).map_err(|what| Error::unsupported(&Place::default(), what))?);
        }
        let first = runs.first().and_then(|run| run.first()).map(|shot| shot.values.clone()).unwrap_or_default();
        Ok((Curve::of(&runs, self.reference), first))
    }
}
