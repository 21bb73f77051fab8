//! What a material gives as AOVs.

use super::{Builder, Inputs};
use crate::film::{Aov, AovKind};
use crate::scene::material::AovInput;

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
