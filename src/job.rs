//! From a description to a picture that tells of its making: what the command line and Python share.

pub mod denoise;
pub mod resume;

pub use resume::identity;

use std::time::{Duration, SystemTime};

use crate::desc::{CameraDesc, SceneDesc};
use crate::error::Warnings;
use crate::film::{Doubt, Figure, Film};
use crate::output::Metadata;
use crate::output::state::Head;
use crate::render::Rendered;
use crate::scene::{Prepared, View};
use crate::settings::{SETTINGS, Settings};

/// Camera and size: what the user asked for, or what the file asks for.
pub fn view(camera: Option<String>, size: Option<[u32; 2]>, desc: &SceneDesc, warnings: &mut Warnings) -> View {
    let own = &desc.render.framing;
    let camera = camera.or_else(|| {
        let name = own.camera.as_deref()?;
        let is_it = |c: &CameraDesc| *c.name == *name || c.place.node.as_deref() == Some(name);
        if !desc.cameras.iter().any(is_it) {
            warnings.push(&desc.place, format!("asks for the camera {name}, which does not exist; another is taken"));
            return None;
        }
        Some(name.to_owned())
    });
    View { camera, size: size.or(own.resolution) }
}

/// `settings` with the passes that the file asks for, where there are any.
pub fn with_own_passes(settings: &Settings, desc: &SceneDesc, warnings: &mut Warnings) -> Settings {
    let mut settings = settings.clone();
    let own = desc.render.passes.join(",");
    let passes = SETTINGS.iter().find(|def| def.name == "passes" && !own.is_empty());
    if let Some(Err(what)) = passes.map(|def| def.set(&mut settings, &own)) {
        warnings.push(&desc.place, format!("asks for passes that can't be rendered: {what}; left out"));
    }
    settings
}

/// Samples per pixel so far, the mean.
pub fn samples_per_pixel(film: &Film) -> f64 {
    film.samples() as f64 / (f64::from(film.width()) * f64::from(film.height()))
}

/// The noise of a picture in units of the display's range, as a phrase; `None` where it was not asked for.
pub fn error_sentence(rendered: &Rendered) -> Option<String> {
    Some(match rendered.accuracy?.display {
        Ok(Figure { value, low, high }) => format!("error {value:.3e} ({low:.3e} to {high:.3e})"),
        Err(doubt) => format!("error not estimable yet: {doubt}"),
    })
}

/// What of the errors that `settings` ask for a render that was not interrupted fell short of, a sentence each.
pub fn shortfalls(rendered: &Rendered, settings: &Settings) -> Vec<String> {
    let mut list = Vec::new();
    let Some(accuracy) = rendered.accuracy.filter(|_| !rendered.interrupted) else { return list };
    if accuracy.rmse == Err(Doubt::TooFewSamples) && rendered.film.passes().iter().any(|chosen| chosen.pass.is_error())
    {
        list.push("errors are not known before 16 samples in every pixel: the error passes are 0".to_owned());
    }
    let Some(target) = settings.error else { return list };
    if accuracy.display.is_err() || accuracy.display.is_ok_and(|figure| figure.value > target) {
        let spp = samples_per_pixel(&rendered.film);
        let error = error_sentence(rendered).unwrap_or_default();
        list.push(format!("an error of {target} was not reached with {spp:.0} samples per pixel: {error}"));
    }
    list
}

/// Seconds by what took them: reading, which the caller has timed, building, rendering.
pub fn times(import: Duration, prepared: &Prepared, rendered: &Rendered) -> Vec<(String, f64)> {
    let looked = rendered.looked;
    let rest = [("samples", rendered.elapsed.saturating_sub(looked)), ("errors", looked)];
    let all = [("import", import)].into_iter().chain(prepared.times.iter().copied()).chain(rest);
    all.map(|(name, time)| (name.to_owned(), time.as_secs_f64())).collect()
}

/// What the picture of `rendered` says about its making; `warnings` are all that were told, `identity` is
/// [what it is made of](identity).
pub fn metadata(
    scene: String,
    frame: Option<f64>,
    prepared: &Prepared,
    rendered: &Rendered,
    settings: &Settings,
    identity: Head,
    warnings: &Warnings,
) -> Metadata {
    let bad = rendered.film.non_finite();
    let spp = samples_per_pixel(&rendered.film);
    Metadata {
        scene,
        camera: prepared.camera.to_string(),
        frame,
        samples: spp,
        seed: settings.seed,
        seconds: rendered.elapsed.as_secs_f64(),
        accuracy: rendered.accuracy,
        date: Some(SystemTime::now()),
        non_finite: bad.count,
        non_finite_first: bad.first,
        warnings: warnings.iter().map(ToString::to_string).collect(),
        settings: SETTINGS
            .iter()
            .filter(|def| def.name != "spp" || settings.spp != Settings::NO_LIMIT)
            .map(|def| (def.name.to_owned(), def.get(settings)))
            .collect(),
        effects: prepared.scene.effects.names(),
        identity,
        ended_by: resume::name(rendered.ended).to_owned(),
        comments: rendered.interrupted.then(|| format!("interrupted at {spp:.1} samples per pixel")),
        manifests: prepared.scene.ids.manifests(),
        ..Metadata::default()
    }
}
