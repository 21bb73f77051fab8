//! Lamps: what they emit, and how it falls off.

use super::super::light::LampShader;
use super::closure::{self, Part};
use super::flow::{At, Flow};
use crate::desc::graph::ValueId;
use crate::desc::{DecayLaw, LampShaderDesc};

/// What the nodes of a lamp emit.
pub fn lamp(flow: &mut Flow<'_, '_>) -> LampShader {
    let black = LampShader { factor: [0.0; 3], ..LampShader::default() };
    let Some(output) = flow.output_node("ShaderNodeOutputLight") else { return black };
    let Some(surface) = output.node.input("Surface") else { return black };
    let mut sum = flow.graph.number(0.0);
    for part in closure::parts(flow, output, surface) {
        if !part.emits() {
            let (name, kind) = (&part.at.node.name, &part.at.node.r#type);
            flow.warn(format!("the shader \"{name}\" ({kind}) of a lamp is not supported; it is left out"));
            continue;
        }
        let emitted = emission(flow, part);
        sum = flow.graph.add(sum, emitted);
    }
    let decay = flow.falloff.unwrap_or_default();
    if let Some([r, g, b, _]) = flow.graph.known(sum) {
        return LampShader { factor: [r, g, b], varying: None, decay };
    }
    let varying = Some(LampShaderDesc { graph: std::mem::take(&mut flow.graph), factor: sum });
    LampShader { factor: [1.0; 3], varying, decay }
}

/// Color × strength × weight of a part that emits.
pub fn emission<'a>(flow: &mut Flow<'a, '_>, Part { weight, at, emitted }: Part<'a>) -> ValueId {
    let emitted = emitted.unwrap_or_else(|| {
        let (color, strength) = (flow.input(at, "Color"), flow.input(at, "Strength"));
        flow.graph.multiply(color, strength)
    });
    flow.graph.multiply(emitted, weight)
}

/// Light Falloff: of a lamp, its decay; the value is the strength alone.
pub fn falloff<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let (strength, smooth) = (flow.input(at, "Strength"), flow.input(at, "Smooth"));
    let law = match output {
        "Linear" => DecayLaw::Linear,
        "Constant" => DecayLaw::Constant,
        _ => DecayLaw::Quadratic,
    };
    let smooth = flow.graph.known(smooth).map_or(0.0, |smooth| smooth[0].max(0.0));
    let decay = crate::desc::DecayDesc { law, smooth, ..Default::default() };
    if flow.falloff.is_some_and(|other| other != decay) {
        flow.warn("the lamp has several kinds of falloff; the last one is taken");
    }
    flow.falloff = Some(decay);
    strength
}
