//! What a material and the background give as AOVs.

use super::{Builder, Inputs, graphs};
use crate::desc::MaterialDesc;
use crate::film::{Aov, AovKind};
use crate::scene::material::AovInput;
use crate::texture::graph::Program;

/// The inputs of the AOVs that the render keeps, in their order; empty where the material gives none of them.
pub fn inputs(builder: &mut Builder<'_>, inputs: &mut Inputs<'_>) -> Box<[AovInput]> {
    let given = &inputs.desc.aovs;
    if given.is_empty() {
        return Box::default();
    }
    let wanted = builder.aovs;
    let input = |aov: &Aov| match (given.iter().find(|output| output.name == aov.name), aov.kind) {
        (Some(output), AovKind::Color) => AovInput::Color(builder.color(inputs, &output.color)),
        (Some(output), AovKind::Value) => AovInput::Value(builder.scalar(inputs, &output.value)),
        (None, _) => AovInput::No,
    };
    wanted.iter().map(input).collect()
}

/// A program for what the background gives, and the index of the AOV that each of its values is.
pub fn background(builder: &mut Builder<'_>) -> Option<(Program, Vec<usize>)> {
    let given = &builder.desc.background_aovs;
    let kept = builder.aovs.iter().enumerate().filter_map(|(index, aov)| {
        let (_, [color, value]) = given.outputs.iter().find(|(name, _)| *name == aov.name)?;
        Some((index, if aov.kind == AovKind::Color { *color } else { *value }))
    });
    let (indices, values): (Vec<_>, Vec<_>) = kept.unzip();
    if values.is_empty() {
        return None;
    }
    let none = MaterialDesc::default();
    let program = graphs::program(&none, &given.graph, &values, &mut builder.textures, &mut builder.names);
    Some((program, indices))
}
