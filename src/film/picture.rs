//! A developed picture: named layers of floats, row by row from the top.

use std::collections::BTreeSet;

use super::pass::Storage;

/// One pass of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// As in the file, without the view layer ("Diffuse Direct"); pictures read from a file keep full names.
    pub name: String,
    /// Names of the channels ("R", "G", "B").
    pub channels: Vec<String>,
    /// Values, channels interleaved; `width × height × channels.len()`.
    pub data: Vec<f32>,
    /// What a file may do to it.
    pub storage: Storage,
}

impl Layer {
    /// The values of the pixel in column `x` of row `y` of a picture `width` wide.
    pub fn pixel(&self, width: u32, x: u32, y: u32) -> &[f32] {
        let n = self.channels.len();
        let start = (y as usize * width as usize + x as usize) * n;
        &self.data[start..start + n]
    }
}

/// A picture of several passes.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The passes.
    pub layers: Vec<Layer>,
}

impl Picture {
    /// The same with the layers of some names alone.
    pub fn part(&self, names: &BTreeSet<String>) -> Self {
        let layers = self.layers.iter().filter(|layer| names.contains(&layer.name)).cloned().collect();
        Self { layers, ..*self }
    }

    /// The layer of this name, or of this name after a view layer's ("ViewLayer.Combined").
    pub fn layer(&self, name: &str) -> Option<&Layer> {
        let matches = |layer: &&Layer| {
            layer.name == name || layer.name.strip_suffix(name).is_some_and(|prefix| prefix.ends_with('.'))
        };
        self.layers.iter().find(matches)
    }
}
