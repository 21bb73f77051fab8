//! Shaders: what a tree of Mix and Add nodes comes to, a sum of weighted parts.

use super::flow::{At, Flow, Source};
use crate::desc::graph::ValueId;

/// One shader of the sum.
#[derive(Clone, Copy)]
pub struct Part<'a> {
    /// Its share, a number.
    pub weight: ValueId,
    /// The node that it is.
    pub at: At<'a>,
    /// What it emits, where the node is no shader: Blender makes an emission of any color or number in a shader's place.
    pub emitted: Option<ValueId>,
}

impl Part<'_> {
    /// True for what emits and does nothing else.
    pub fn emits(&self) -> bool {
        self.emitted.is_some() || matches!(self.at.node.r#type.as_str(), "ShaderNodeEmission" | "ShaderNodeBackground")
    }
}

/// Most parts that one surface may have.
const MOST: usize = 256;

/// The parts behind an input that takes a shader.
pub fn parts<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, input: usize) -> Vec<Part<'a>> {
    let weight = flow.graph.number(1.0);
    let mut parts = Vec::new();
    collect(flow, at, input, weight, 0, &mut parts);
    if parts.len() > MOST {
        flow.warn(format!("the surface is a sum of {} shaders; the first {MOST} are taken", parts.len()));
        parts.truncate(MOST);
    }
    parts
}

fn collect<'a>(
    flow: &mut Flow<'a, '_>,
    at: At<'a>,
    input: usize,
    weight: ValueId,
    depth: u32,
    parts: &mut Vec<Part<'a>>,
) {
    let nothing = flow.graph.known(weight).is_some_and(|w| w[0] == 0.0);
    // Trees are shared: twice the depth may be many times the parts.
    if nothing || depth > 100 || parts.len() > MOST {
        return;
    }
    let Source::Output(at, output) = flow.source(at, input) else { return };
    if at.node.outputs.get(output).is_some_and(|socket| !matches!(socket.r#type.as_str(), "" | "SHADER")) {
        let emitted = Some(flow.color_of(at, output));
        return parts.push(Part { weight, at, emitted });
    }
    let shader = |name: &str| at.node.input(name);
    match at.node.r#type.as_str() {
        "ShaderNodeMixShader" => {
            let factor = flow.input(at, "Fac");
            let factor = flow.clamped(factor);
            let one = flow.graph.number(1.0);
            let rest = flow.graph.subtract(one, factor);
            for (name, share) in [("Shader", rest), ("Shader_001", factor)] {
                let Some(input) = shader(name) else { continue };
                let weight = flow.graph.multiply(weight, share);
                collect(flow, at, input, weight, depth + 1, parts);
            }
        }
        "ShaderNodeAddShader" => {
            for name in ["Shader", "Shader_001"] {
                let Some(input) = shader(name) else { continue };
                collect(flow, at, input, weight, depth + 1, parts);
            }
        }
        _ => parts.push(Part { weight, at, emitted: None }),
    }
}
