//! The layer Denoised beside a picture's Combined.

use crate::denoise::{Denoiser, Noisy};
use crate::film::{Layer, Picture, Storage};
use crate::settings::{SETTINGS, Settings};

/// What the denoiser goes by.
const NEEDS: [&str; 3] = ["combined", "denoising_albedo", "denoising_normal"];

/// Name of the layer.
pub const LAYER: &str = "Denoised";

/// `settings` with the passes that denoising goes by, which are written, too.
///
/// # Errors
/// Those of the passes.
pub fn with_passes(settings: &Settings) -> Result<Settings, String> {
    let mut settings = settings.clone();
    let passes = settings.passes.to_string();
    let lacking = NEEDS.iter().filter(|need| !passes.split(',').any(|own| own == **need || own == "all"));
    let all: Vec<&str> =
        std::iter::once(passes.as_str()).filter(|own| !own.is_empty()).chain(lacking.copied()).collect();
    if let Some(def) = SETTINGS.iter().find(|def| def.name == "passes") {
        def.set(&mut settings, &all.join(","))?;
    }
    Ok(settings)
}

/// Adds the layer behind Combined, with Combined's alpha. Pictures that lack what it takes stay as they are.
///
/// # Errors
/// What the denoiser complains of.
pub fn add(denoiser: &Denoiser, picture: &mut Picture, threads: u32) -> Result<(), String> {
    let three = |name: &str| -> Option<Vec<f32>> {
        let layer = picture.layer(name)?;
        let n = layer.channels.len();
        Some(layer.data.chunks_exact(n).flat_map(|pixel| pixel[..3].to_vec()).collect())
    };
    let inputs = three("Combined").zip(three("Denoising Albedo")).zip(three("Denoising Normal"));
    let Some(((color, albedo), normal)) = inputs else { return Ok(()) };
    let noisy = Noisy { width: picture.width as usize, color: &color, albedo: &albedo, normal: &normal };
    let clean = denoiser.denoised(&noisy, threads)?;
    let Some(at) = picture.layers.iter().position(|layer| layer.name == "Combined") else { return Ok(()) };
    let combined = &picture.layers[at];
    let pixels = combined.data.chunks_exact(4).zip(clean.chunks_exact(3));
    let data = pixels.flat_map(|(own, clean)| [clean[0], clean[1], clean[2], own[3]]).collect();
    let layer = Layer { name: LAYER.to_owned(), channels: combined.channels.clone(), data, storage: Storage::Color };
    picture.layers.insert(at + 1, layer);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_added_once() {
        let mut settings = Settings::default();
        let def = SETTINGS.iter().find(|def| def.name == "passes").unwrap();
        def.set(&mut settings, "ao,denoising_normal").unwrap();
        let passes = with_passes(&settings).unwrap().passes.to_string();
        for need in NEEDS.iter().chain(&["ao"]) {
            assert_eq!(passes.split(',').filter(|own| own == need).count(), 1, "{passes}");
        }
        def.set(&mut settings, "all").unwrap();
        assert!(with_passes(&settings).is_ok());
    }
}
