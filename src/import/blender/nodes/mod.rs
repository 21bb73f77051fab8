//! Node trees: what the add-on sends of them (`tree.rs`), and what they compute.
//!
//! `flow.rs` walks from the output back through links, groups, reroutes and muted nodes and builds the
//! engine's graph; each value node is a line in the table of `values.rs` and a function in the file of its
//! menu. Shaders become a weighted sum (`closure.rs`), which is a surface (`surface.rs`), a volume (`volume.rs`), a world or a lamp.

mod aov;
mod closure;
mod color;
mod displacement;
mod flow;
mod ies;
mod input;
mod lamp;
mod math;
mod principled;
mod procedural;
mod sky;
mod surface;
mod tables;
mod texture;
mod tree;
mod values;
mod vector;
mod volume;
mod world;

pub use tree::{NodeData, SocketData, TreeData, Value};

use super::image::Images;
use super::layers::UvSets;
use super::light::LampShader;
use super::world::WorldPart;
use crate::desc::{BackgroundAovs, MaterialDesc};
use crate::error::{Place, Warnings};
use flow::Flow;

/// What the nodes of a lamp emit.
pub fn lamp(tree: &TreeData, images: &mut Images<'_>, place: Place, warnings: &mut Warnings) -> LampShader {
    let version = images.version();
    let uv_sets = UvSets::default();
    lamp::lamp(&mut Flow::new(tree, images, &uv_sets, version, place, warnings))
}

/// What the nodes of a world emit.
pub fn world(tree: &TreeData, images: &mut Images<'_>, place: Place, warnings: &mut Warnings) -> Vec<WorldPart> {
    let version = images.version();
    let uv_sets = UvSets::default();
    world::world(&mut Flow::new(tree, images, &uv_sets, version, place, warnings))
}

/// What the AOV Output nodes of a world give.
pub fn background_aovs(
    tree: &TreeData,
    images: &mut Images<'_>,
    place: Place,
    warnings: &mut Warnings,
) -> BackgroundAovs {
    let version = images.version();
    aov::background(Flow::new(tree, images, &UvSets::default(), version, place, warnings))
}

/// `base` with what the nodes of a material make of its surface; `displacement` is its `displacement_method`.
pub fn surface(
    tree: &TreeData,
    base: MaterialDesc,
    images: &mut Images<'_>,
    uv_sets: &UvSets,
    displacement: &str,
    warnings: &mut Warnings,
) -> MaterialDesc {
    let (version, place) = (images.version(), base.place.clone());
    surface::surface(&mut Flow::new(tree, images, uv_sets, version, place, warnings), base, displacement)
}
