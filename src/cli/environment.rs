//! `--environment`: a dome from an image file, for any scene.

use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::{Arg, ArgMatches, value_parser};

use penumbra::desc::{ColorSpace, ImageDesc, LightDesc, LightKind, SceneDesc};
use penumbra::error::Place;
use penumbra::import::image::load_image;
use penumbra::math::{DAffine3, DMat3};

pub fn args() -> [Arg; 3] {
    let number =
        |name: &'static str| Arg::new(name).long(name).value_parser(value_parser!(f64)).allow_negative_numbers(true);
    [
        Arg::new("environment")
            .long("environment")
            .value_name("FILE")
            .value_parser(value_parser!(PathBuf))
            .help("Light the scene by this lat-long image (.hdr, .exr, ...) instead of its own domes"),
        number("environment-rotation")
            .value_name("DEG")
            .requires("environment")
            .help("Turn it about the up axis, counter-clockwise seen from above"),
        number("environment-strength").value_name("S").requires("environment").help("Multiply its radiance"),
    ]
}

/// Replaces the domes of `scene` as `args` ask.
pub fn apply(args: &ArgMatches, scene: &mut SceneDesc) -> anyhow::Result<()> {
    let Some(path) = args.get_one::<PathBuf>("environment") else { return Ok(()) };
    let number = |name: &str, default: f64| args.get_one::<f64>(name).copied().unwrap_or(default);
    let (rotation, strength) = (number("environment-rotation", 0.0), number("environment-strength", 1.0));
    if !rotation.is_finite() {
        bail!("--environment-rotation must be finite");
    }
    if !(strength.is_finite() && strength >= 0.0) {
        bail!("--environment-strength must be finite and not negative");
    }
    let image: ImageDesc = load_image(path, color_space(path)).context("can't use --environment")?;
    scene.images.push(image.into());
    scene.lights.retain(|light| !light.kind.is_dome());
    let transform = DAffine3::from_mat3(DMat3::from_rotation_y(rotation.to_radians()));
    let kind = LightKind::Dome { radiance: [strength; 3], image: Some(scene.images.len() as u32 - 1) };
    scene.lights.push(LightDesc::new("environment", Place::file(path.clone()), transform, kind));
    Ok(())
}

/// Float formats hold linear radiance, the others what a screen shows.
fn color_space(path: &std::path::Path) -> ColorSpace {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match extension.as_deref() {
        Some("hdr" | "pic" | "exr") => ColorSpace::Linear,
        _ => ColorSpace::Srgb,
    }
}
