//! What the add-on says of a scene: plain data, as Blender has it (z up, watts, its own names).
//!
//! Everything but the arrays of meshes comes as JSON, one document and one text for each material; the add-on
//! computes nothing, it copies properties by their names in Blender's Python. What is absent has Blender's own default.

mod camera;
mod light;
mod material;
mod object;
mod render;
mod world;

use std::collections::HashMap;
use std::sync::Arc;

use serde::Deserialize;

pub use camera::{CameraData, DofData, PanoramaData};
pub use light::LightData;
pub use material::{ImageData, MaterialData};
pub use object::{LinkData, ObjectData, VisibilityData};
pub use render::RenderData;
pub use world::WorldData;

/// A scene at one frame, for one view layer.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct Document {
    /// Path of the .blend file; empty for one that was never saved.
    pub file: String,
    /// `bpy.app.version`.
    pub version: [u32; 3],
    /// What of the scene's own settings shapes the picture.
    pub render: RenderData,
    /// The active camera.
    pub camera: Option<CameraData>,
    /// The world.
    pub world: Option<WorldData>,
    /// Lamps, placed.
    pub lights: Vec<LightData>,
    /// Materials; objects refer to them by index. They come one by one, so that an edit of one is that one's alone.
    #[serde(skip)]
    pub materials: Vec<Arc<MaterialData>>,
    /// Images by the name that nodes refer to them by.
    pub images: HashMap<String, ImageData>,
    /// Objects that have a shape; instances refer to them by index.
    pub objects: Vec<ObjectData>,
}

/// Those parts of a [`Document`] that an artist edits again and again; one that is absent stays as it is.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct DocumentEdit {
    /// The world.
    pub world: Option<WorldData>,
    /// All lamps.
    pub lights: Option<Vec<LightData>>,
    /// All images.
    pub images: Option<HashMap<String, ImageData>>,
}

impl DocumentEdit {
    /// Puts the parts in the place of those of `document`.
    pub fn apply(self, document: &mut Document) {
        if self.world.is_some() {
            document.world = self.world;
        }
        if let Some(lights) = self.lights {
            document.lights = lights;
        }
        if let Some(images) = self.images {
            document.images = images;
        }
    }
}

/// A matrix that changes nothing.
const IDENTITY: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
