//! The world.

use serde::Deserialize;

use super::VisibilityData;
use crate::import::blender::nodes::TreeData;

/// The world.
#[derive(Clone, Debug, Deserialize)]
#[serde(default)]
pub struct WorldData {
    /// Its name.
    pub name: String,
    /// `World.color`, which a world without nodes has.
    pub color: [f64; 3],
    /// Its nodes; `None` where `use_nodes` is off.
    pub nodes: Option<TreeData>,
    /// Light group.
    pub lightgroup: String,
    /// Which rays see it.
    pub visibility: VisibilityData,
}

impl Default for WorldData {
    fn default() -> Self {
        Self {
            name: "World".into(),
            color: [0.05; 3],
            nodes: None,
            lightgroup: String::new(),
            visibility: VisibilityData::default(),
        }
    }
}
