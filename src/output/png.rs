//! An 8-bit sRGB picture to look at: one layer under Blender's Standard view.
//!
//! Display value = OETF of IEC 61966-2-1, `1.055 x^(1/2.4) - 0.055`, linear below 0.0031308; clipped to
//! 0 to 1. Alpha is straight, as PNG has it.

use std::io::Write;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::file;
use crate::error::{Error, Place, Result};
use crate::film::{Layer, Picture};

/// Writes one layer of the picture, in full or not at all. Layers of one channel come out grey, the
/// fourth channel is alpha; without transparent pixels there is no alpha in the file.
///
/// # Errors
/// [`Error::Io`] that names the file where it can't be written; [`Error::Invalid`] where the picture
/// has no such layer.
pub fn write(path: &Path, picture: &Picture, layer: &str) -> Result<()> {
    let Some(layer) = picture.layer(layer) else {
        return Err(Error::invalid(&Place::file(path), format!("the picture has no layer '{layer}' to preview")));
    };
    let bytes = bytes(layer, picture.width, picture.height)?;
    file::replace(path, |mut file| file.write_all(&bytes))
}

/// The same in memory.
///
/// # Errors
/// [`Error::Unsupported`] for a picture that is too large for the format.
pub fn bytes(layer: &Layer, width: u32, height: u32) -> Result<Vec<u8>> {
    let (pixels, color) = encode(layer);
    let mut bytes = Vec::new();
    let written = PngEncoder::new(&mut bytes).write_image(&pixels, width, height, color);
    written.map_err(|error| Error::unsupported(&Place::default(), format!("PNG: {error}")))?;
    Ok(bytes)
}

fn encode(layer: &Layer) -> (Vec<u8>, ExtendedColorType) {
    let n = layer.channels.len().max(1);
    let pixels = layer.data.chunks_exact(n);
    let opaque = n < 4 || pixels.clone().all(|pixel| pixel[3] >= 1.0);
    let mut bytes = Vec::with_capacity(pixels.len() * if opaque { 3 } else { 4 });
    for pixel in pixels {
        let alpha = if opaque { 1.0 } else { pixel[3].clamp(0.0, 1.0) };
        // Premultiplied to straight; light without coverage stays as it is.
        let scale = if alpha > 0.0 { alpha.recip() } else { 1.0 };
        let color: [f32; 3] = std::array::from_fn(|i| if n < 3 { pixel[0] } else { pixel[i] * scale });
        bytes.extend(color.map(|value| quantize(srgb_oetf(value))));
        if !opaque {
            bytes.push(quantize(alpha));
        }
    }
    (bytes, if opaque { ExtendedColorType::Rgb8 } else { ExtendedColorType::Rgba8 })
}

/// Nearest of 256 steps; NaN is 0.
fn quantize(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn srgb_oetf(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Storage;

    fn layer(channels: &str, data: Vec<f32>) -> Layer {
        let channels = channels.chars().map(String::from).collect();
        Layer { name: "Combined".to_owned(), channels, data, storage: Storage::Color }
    }

    #[test]
    fn known_values_of_srgb() {
        // 0.18, photographic grey, is code 117.7.
        let (bytes, color) =
            encode(&layer("RGB", vec![0.0, 0.18, 1.0, 0.003, 7.0, -1.0, f32::NAN, f32::INFINITY, 0.5]));
        assert_eq!(bytes, [0, 118, 255, 10, 255, 0, 0, 255, 188]);
        assert_eq!(color, ExtendedColorType::Rgb8);
    }

    #[test]
    fn alpha_is_made_straight() {
        let (bytes, color) = encode(&layer("RGBA", vec![0.5, 0.25, 0.0, 0.5, 0.5, 0.5, 0.5, 0.0]));
        assert_eq!(color, ExtendedColorType::Rgba8);
        assert_eq!(bytes, [255, 188, 0, 128, 188, 188, 188, 0]);
    }

    #[test]
    fn opaque_pictures_have_no_alpha_and_single_channels_are_grey() {
        assert_eq!(encode(&layer("RGBA", vec![1.0, 0.0, 0.0, 1.0])).0, [255, 0, 0]);
        assert_eq!(encode(&layer("X", vec![1.0, 0.0])).0, [255, 255, 255, 0, 0, 0]);
    }
}
