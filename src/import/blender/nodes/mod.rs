//! Node trees: what the add-on sends of them, and what they compute.

mod tree;

pub use tree::{NodeData, SocketData, TreeData, Value};

use super::document::LightData;
use super::image::Images;
use super::light::LampShader;
use super::world::WorldShader;
use crate::desc::MaterialDesc;
use crate::error::{Place, Warnings};
use crate::math::DMat3;

/// What the nodes of a lamp emit.
pub fn lamp(_data: &LightData, _images: &mut Images<'_>, _place: &Place, _warnings: &mut Warnings) -> LampShader {
    LampShader::default()
}

/// What the nodes of a world emit; `None` for nothing.
pub fn world(_tree: &TreeData, _images: &mut Images<'_>, _place: &Place, _warnings: &mut Warnings) -> Option<WorldShader> {
    Some(WorldShader { radiance: [0.05; 3], image: None, turn: DMat3::IDENTITY })
}

/// `base` with what the nodes of a material make of its surface.
pub fn surface(
    _tree: &TreeData,
    base: MaterialDesc,
    _images: &mut Images<'_>,
    _warnings: &mut Warnings,
) -> MaterialDesc {
    base
}
