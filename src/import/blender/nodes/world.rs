//! Worlds: a constant radiance, or a lat-long image turned.

use super::super::world::WorldShader;
use super::closure;
use super::flow::Flow;
use super::lamp::emission;
use crate::desc::graph::{Function, Leaf, Mapping, Math, Op, ValueId};
use crate::math::{DMat3, DVec3};

/// What the nodes of a world emit; `None` for nothing.
pub fn world(flow: &mut Flow<'_, '_>) -> Option<WorldShader> {
    let output = flow.output_node("ShaderNodeOutputWorld")?;
    let parts = closure::parts(flow, output, output.node.input("Surface")?);
    let mut sum = flow.graph.number(0.0);
    for part in parts {
        if !matches!(part.at.node.r#type.as_str(), "ShaderNodeBackground" | "ShaderNodeEmission") {
            let (name, kind) = (&part.at.node.name, &part.at.node.r#type);
            flow.warn(format!("the shader \"{name}\" ({kind}) of a world is not supported; it is left out"));
            continue;
        }
        let emitted = emission(flow, part.at, part.weight);
        sum = flow.graph.add(sum, emitted);
    }
    let mut factor = [1.0; 3];
    let rest = factored(flow, sum, &mut factor);
    if let Some([r, g, b, _]) = flow.graph.known(rest) {
        let radiance = [r * factor[0], g * factor[1], b * factor[2]];
        return Some(WorldShader { radiance, image: None, turn: DMat3::IDENTITY });
    }
    if let Some((texture, turn)) = equirectangular(flow, rest) {
        return Some(WorldShader { radiance: factor, image: Some(flow.images.image_of(texture)), turn });
    }
    flow.warn(
        "the world's nodes are more than an environment texture times a color, which is not supported yet: black",
    );
    None
}

/// Takes constant factors off a product.
fn factored(flow: &Flow<'_, '_>, value: ValueId, factor: &mut [f64; 3]) -> ValueId {
    let mut value = value;
    loop {
        let Op::Apply(Function::Math(math), args) = flow.graph.op(value) else { return value };
        let (constant, other) = match (flow.graph.known(args[0]), flow.graph.known(args[1])) {
            (Some(constant), None) => (constant, args[1]),
            (None, Some(constant)) => (constant, args[0]),
            _ => return value,
        };
        match math {
            Math::Multiply => (0..3).for_each(|i| factor[i] *= constant[i]),
            Math::Add if constant[..3] == [0.0; 3] => {}
            _ => return value,
        }
        value = other;
    }
}

/// An image looked up at a turned direction: the texture, and from the direction to what it is looked up
/// at.
fn equirectangular(flow: &Flow<'_, '_>, value: ValueId) -> Option<(u32, DMat3)> {
    let graph = &flow.graph;
    // A color that alpha multiplies where nothing is transparent.
    let image = |value: ValueId| match graph.op(value) {
        Op::Image { texture, uv } => Some((*texture, *uv)),
        _ => None,
    };
    let (texture, uv) = image(value).or_else(|| match graph.op(value) {
        Op::Apply(Function::Math(Math::Multiply), args) => image(args[0]),
        _ => None,
    })?;
    let Op::Apply(Function::Affine(_), args) = graph.op(uv) else { return None };
    let Op::Apply(Function::Equirectangular, args) = graph.op(args[0]) else { return None };
    let direction = args[0];
    let turn = match graph.op(direction) {
        Op::Leaf(Leaf::Position | Leaf::Generated) => DMat3::IDENTITY,
        Op::Apply(Function::Mapping(mapping), args) => {
            if !matches!(graph.op(args[0]), Op::Leaf(Leaf::Position | Leaf::Generated)) {
                return None;
            }
            let [location, rotation, scale] = [1, 2, 3].map(|i| graph.known(args[i]));
            let (location, rotation, scale) = (location?, rotation?, scale?);
            let moves = location[..3] != [0.0; 3] || scale[..3] != [1.0; 3];
            let euler = DMat3::from_rotation_z(rotation[2])
                * DMat3::from_rotation_y(rotation[1])
                * DMat3::from_rotation_x(rotation[0]);
            match mapping {
                _ if moves => return None,
                Mapping::Texture => euler.transpose(),
                _ => euler,
            }
        }
        _ => return None,
    };
    (turn * DVec3::X).is_finite().then_some((texture, turn))
}
