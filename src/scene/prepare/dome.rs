//! Domes: the image's texels as radiance, cleaned.

use crate::desc::{ColorSpace, ImageDesc, LightDesc, SceneDesc};
use crate::error::Warnings;
use crate::light::{Dome, DomeImage};
use crate::math::{Mat3, Rgb};
use crate::texture::srgb_to_linear;

/// The dome of `radiance`, with the image of that index; `orientation` turns the image's space into
/// render space.
pub fn prepare(
    desc: &SceneDesc,
    light: &LightDesc,
    radiance: Rgb,
    image: Option<u32>,
    orientation: Mat3,
    warnings: &mut Warnings,
) -> Option<Dome> {
    let Some(image) = image else { return Some(Dome::new(radiance, None)) };
    let source = &desc.images[image as usize];
    let texels = radiance_texels(source, warnings);
    let image = DomeImage::new(source.width as usize, source.height as usize, texels, orientation);
    if image.is_none() {
        warnings.push(&light.place, "the environment image is black: it lights nothing");
    }
    image.map(|image| Dome::new(radiance, Some(image)))
}

/// The texels of an environment image as linear radiance; what can't be radiance becomes 0.
fn radiance_texels(image: &ImageDesc, warnings: &mut Warnings) -> Vec<Rgb> {
    let channels = usize::from(image.channels);
    let linear = |v: f32| match image.color_space {
        ColorSpace::Srgb => srgb_to_linear(v),
        ColorSpace::Linear => v,
    };
    let mut bad = 0_usize;
    let texels = (0..image.width as usize * image.height as usize)
        .map(|i| {
            let at = |c: usize| linear(image.pixels.get(i * channels + if channels < 3 { 0 } else { c }));
            let rgb = Rgb::new(at(0), at(1), at(2));
            let clean = rgb.map(|v| if v.is_finite() && v >= 0.0 { v } else { 0.0 });
            bad += usize::from(clean != rgb);
            clean
        })
        .collect();
    if bad > 0 {
        warnings.push(
            &image.place,
            format!("{bad} pixels of image \"{}\" are negative, infinite or NaN: taken as 0", image.name),
        );
    }
    texels
}
