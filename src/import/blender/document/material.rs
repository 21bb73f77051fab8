//! Materials and the images that their nodes name.

use serde::Deserialize;

use crate::import::blender::nodes::TreeData;

/// A material.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct MaterialData {
    /// Its name.
    pub name: String,
    /// `pass_index`.
    pub pass_index: u32,
    /// `diffuse_color`, which a material without nodes has.
    pub diffuse_color: [f64; 4],
    /// `cycles.use_bump_map_correction`.
    pub bump_correction: bool,
    /// `displacement_method`: `BUMP`, `DISPLACEMENT` or `BOTH`.
    pub displacement_method: String,
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
}

impl Default for MaterialData {
    fn default() -> Self {
        Self {
            name: "Material".into(),
            pass_index: 0,
            diffuse_color: [0.8, 0.8, 0.8, 1.0],
            bump_correction: true,
            displacement_method: "BUMP".into(),
            nodes: None,
        }
    }
}

/// An image data-block.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct ImageData {
    /// Absolute path; `<UDIM>` stands for the tile's number.
    pub path: String,
    /// `colorspace_settings.name`.
    pub colorspace: String,
    /// `STRAIGHT`, `PREMUL`, `CHANNEL_PACKED` or `NONE`.
    pub alpha_mode: String,
    /// Numbers of the tiles of a UDIM image.
    pub tiles: Vec<u32>,
    /// Its bytes or pixels are handed over beside the document: packed, generated or painted.
    pub in_memory: bool,
}

impl Default for ImageData {
    fn default() -> Self {
        Self {
            path: String::new(),
            colorspace: "sRGB".into(),
            alpha_mode: "STRAIGHT".into(),
            tiles: Vec::new(),
            in_memory: false,
        }
    }
}
