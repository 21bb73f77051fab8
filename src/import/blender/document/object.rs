//! Objects, and who sees and lights whom.

use serde::Deserialize;

/// Objects of a light linking collection.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct LinkData {
    /// Indices into [`Document::objects`].
    pub objects: Vec<u32>,
    /// True where the set is all but these.
    pub exclude: bool,
}

/// An object with a shape.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct ObjectData {
    /// Its name.
    pub name: String,
    /// Name of the topmost parent.
    pub asset: String,
    /// Key of its mesh, strands or points.
    pub mesh: u64,
    /// Index into [`Document::materials`] of each slot.
    pub materials: Vec<Option<u32>>,
    /// `pass_index`.
    pub pass_index: u32,
    /// `Object.color`.
    pub color: [f64; 4],
    /// Which rays see it.
    pub visibility: VisibilityData,
    /// `holdout_get`: it, or a collection that it is in, is a hole in the picture.
    pub holdout: bool,
    /// `is_shadow_catcher`.
    pub shadow_catcher: bool,
    /// The shadow terminator of its Shading panel.
    pub terminator: TerminatorData,
    /// Light group of what it emits.
    pub lightgroup: String,
    /// Attributes of it, of what instances it and of the view layer that materials ask for: type and name, and four
    /// numbers.
    pub attributes: Vec<(String, [f64; 4])>,
    /// Whom its light falls on (light linking).
    pub receivers: Option<LinkData>,
    /// What stops its light (shadow linking).
    pub blockers: Option<LinkData>,
}

impl Default for ObjectData {
    fn default() -> Self {
        Self {
            name: String::new(),
            asset: String::new(),
            mesh: 0,
            materials: Vec::new(),
            pass_index: 0,
            color: [1.0; 4],
            visibility: VisibilityData::default(),
            holdout: false,
            shadow_catcher: false,
            terminator: TerminatorData::default(),
            lightgroup: String::new(),
            attributes: Vec::new(),
            receivers: None,
            blockers: None,
        }
    }
}

/// `shadow_terminator_geometry_offset` and `shadow_terminator_shading_offset`.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub struct TerminatorData {
    /// Of the geometry.
    pub geometry: f64,
    /// Of the shading.
    pub shading: f64,
}

impl Default for TerminatorData {
    fn default() -> Self {
        Self { geometry: 0.1, shading: 0.0 }
    }
}

impl From<TerminatorData> for crate::desc::TerminatorDesc {
    fn from(TerminatorData { geometry, shading }: TerminatorData) -> Self {
        Self { geometry, shading }
    }
}

/// Which kinds of ray see something, by Blender's names.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(default)]
pub struct VisibilityData {
    /// `visible_camera`.
    pub camera: bool,
    /// `visible_diffuse`.
    pub diffuse: bool,
    /// `visible_glossy`.
    pub glossy: bool,
    /// `visible_transmission`.
    pub transmission: bool,
    /// `visible_shadow`.
    pub shadow: bool,
}

impl Default for VisibilityData {
    fn default() -> Self {
        Self { camera: true, diffuse: true, glossy: true, transmission: true, shadow: true }
    }
}

impl From<VisibilityData> for crate::desc::Visibility {
    fn from(data: VisibilityData) -> Self {
        let VisibilityData { camera, diffuse, glossy, transmission, shadow } = data;
        Self { camera, diffuse, glossy, transmission, shadow }
    }
}
