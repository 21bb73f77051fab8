//! Files in: each door fills a `SceneDesc` and `Warnings`, nothing else.

pub mod blender;
mod exr_image;
pub mod gltf;
pub mod ies;
pub mod image;
mod subdivision;
mod tangents;
pub mod usd;

use std::path::Path;

use crate::desc::SceneDesc;
use crate::error::{Error, Place, Result, Warnings};

pub use ies::{decode_ies, load_ies};
pub use image::{decode_image, load_image};

/// What the intensities of a glTF file's lights mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightUnits {
    /// Candela and lux, as the extension says; 1 W is 683 lm.
    #[default]
    Spec,
    /// W·sr⁻¹ and W·m⁻² (Blender's "Unitless").
    Compat,
    /// W for points and spots, W·m⁻² for the sun (Blender's "Raw").
    Raw,
}

/// How to read a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// The frame at which animation is evaluated, frame 0 at time 0. `None` for the pose that the
    /// file's nodes were authored in, without animation.
    pub frame: Option<f64>,
    /// Frames per second, for files that count time in seconds.
    pub fps: f64,
    /// Variants to show instead of the file's own choice: the name of a material variant of glTF, or
    /// `/Prim{set=choice}` of USD.
    pub variants: Vec<String>,
    /// Units of the lights of glTF files.
    pub light_units: LightUnits,
    /// How often subdivision surfaces are refined.
    pub subdivision: u32,
    /// Which of USD's purposes are shown beside `default`; `None` for those that the stage's own render
    /// settings include, `render` where they say nothing.
    pub purposes: Option<Vec<Purpose>>,
    /// What USD's time samples are between their times.
    pub interpolation: Interpolation,
    /// Where things are a frame before and a frame after is read, too: what the vector pass asks.
    pub vectors: bool,
}

/// What is between samples in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the sample before.
    Held,
    /// On a straight line, for numbers.
    #[default]
    Linear,
}

/// Purposes of USD prims that a render may show or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Full quality.
    Render,
    /// A stand-in for interactive work.
    Proxy,
    /// Helpers.
    Guide,
}

impl Default for ImportOptions {
    fn default() -> Self {
        Self {
            frame: None,
            fps: 24.0,
            variants: Vec::new(),
            light_units: LightUnits::Spec,
            subdivision: 2,
            purposes: None,
            interpolation: Interpolation::Linear,
            vectors: false,
        }
    }
}

/// Reads the scene at `path`, by its extension.
///
/// # Errors
/// [`Error::Unsupported`] for other extensions, and what the door for the extension says.
pub fn scene(path: &Path, options: &ImportOptions, warnings: &mut Warnings) -> Result<SceneDesc> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    match extension.as_str() {
        "gltf" | "glb" => gltf::load(path, options, warnings),
        "usd" | "usda" | "usdc" | "usdz" => usd::load(path, options, warnings),
        _ => {
            let what = "not a scene that can be read; .usd, .usda, .usdc, .usdz, .gltf and .glb files are";
            Err(Error::unsupported(&Place::file(path), what))
        }
    }
}
