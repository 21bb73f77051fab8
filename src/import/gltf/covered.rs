//! Emission below sheen and clearcoat, which dim it as they dim whatever is below (KHR_materials_clearcoat,
//! "Emission"; KHR_materials_sheen, "Albedo-scaling technique").

use crate::desc::graph::{Graph, Leaf, ValueId};
use crate::desc::{Channel, CoatDesc, ColorInput, MaterialDesc, NormalInput, ScalarInput, SheenDesc, TextureRef};

/// Makes the emission of `material` what is left of it above its layers.
pub(super) fn cover(material: &mut MaterialDesc) {
    let black = material.emission.factor.iter().all(|&c| c == 0.0) || material.emission_strength == 0.0;
    if black || material.unlit {
        return;
    }
    let graph = &mut material.graph;
    let below_coat = material.coat.as_ref().map(|coat| below_coat(graph, coat));
    // Fibers stand on the coat, whose normals are not theirs.
    let below_sheen = material.sheen.as_ref().map(|sheen| below_sheen(graph, sheen));
    let left = [below_coat, below_sheen].into_iter().flatten().reduce(|a, b| graph.multiply(a, b));
    material.emission.graph = left;
}

fn below_coat(graph: &mut Graph, coat: &CoatDesc) -> ValueId {
    let normal = match &coat.normal {
        Some(NormalInput::Map { texture, scale }) => mapped(graph, texture, *scale),
        _ => graph.leaf(Leaf::Normal),
    };
    let [weight, roughness, ior] = [&coat.weight, &coat.roughness, &coat.ior].map(|input| number(graph, input));
    let tint = color(graph, &coat.tint);
    graph.below_coat(weight, tint, [roughness, ior, normal])
}

fn below_sheen(graph: &mut Graph, sheen: &SheenDesc) -> ValueId {
    let (color, roughness, normal) =
        (color(graph, &sheen.color), number(graph, &sheen.roughness), graph.leaf(Leaf::Normal));
    graph.below_sheen(color, roughness, normal)
}

fn number(graph: &mut Graph, input: &ScalarInput) -> ValueId {
    match &input.texture {
        None => graph.number(input.factor),
        Some((texture, channel)) => {
            let texel = image(graph, texture);
            let place = match channel {
                Channel::R => 0,
                Channel::G => 1,
                Channel::B => 2,
                Channel::A => 3,
            };
            let value = graph.place(texel, place);
            graph.scale(value, input.factor)
        }
    }
}

fn color(graph: &mut Graph, input: &ColorInput) -> ValueId {
    let [r, g, b] = input.factor;
    let factor = graph.constant([r, g, b, 1.0]);
    match &input.texture {
        None => factor,
        Some(texture) => {
            let texel = image(graph, texture);
            graph.multiply(texel, factor)
        }
    }
}

/// The normal of a map whose x and y count `scale` times.
fn mapped(graph: &mut Graph, texture: &TextureRef, scale: f64) -> ValueId {
    let texel = image(graph, texture);
    let middle = 0.5 * (1.0 - scale);
    let scaled = graph.affine([[scale, 0.0, 0.0, middle], [0.0, scale, 0.0, middle], [0.0, 0.0, 1.0, 0.0]], texel);
    let (whole, tangent) = (graph.number(1.0), graph.leaf(Leaf::Tangent));
    graph.normal_map(scaled, whole, tangent)
}

fn image(graph: &mut Graph, texture: &TextureRef) -> ValueId {
    let uv = graph.leaf(Leaf::Uv(texture.uv_set));
    let [u, v] = texture.transform.0.map(|[x, y, move_by]| [x, y, 0.0, move_by]);
    let uv = graph.affine([u, v, [0.0; 4]], uv);
    graph.image(texture.texture, uv)
}
