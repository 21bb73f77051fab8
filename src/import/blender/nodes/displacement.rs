//! Displacement: a relief that bends the normal of all that the surface scatters, as Cycles' bump from displacement.

use super::flow::{At, Flow};
use super::input::tangent_of_map;
use crate::desc::graph::{Bump, Function, Leaf, Op, Quantity, Space, ValueId};

/// What Cycles takes as the width of its filter where it makes the bump itself; versions before look a whole pixel
/// further.
const FILTER_WIDTH: f64 = 0.1;

/// The normal that the displacement of a material's `output` makes, world space; `None` where nothing is linked to it.
///
/// `method` is `material.displacement_method`. Where it asks for vertices that move, this relief stands for it (told).
pub fn relief<'a>(flow: &mut Flow<'a, '_>, output: At<'a>, method: &str) -> Option<ValueId> {
    if !flow.is_linked(output, "Displacement") {
        return None;
    }
    if method != "BUMP" {
        flow.warn("vertices are not displaced yet: the displacement is rendered as bump alone");
    }
    let moved = flow.input(output, "Displacement");
    let normal = flow.graph.leaf(Leaf::Normal);
    let height = flow.graph.apply(Function::Dot(3), &[moved, normal]);
    let one = flow.graph.number(1.0);
    let filter_width = if flow.version >= [4, 5, 0] { FILTER_WIDTH } else { 1.0 };
    let object_space = method == "BOTH";
    Some(flow.graph.push(Op::Bump(Bump { height, strength: one, distance: one, normal, filter_width, object_space })))
}

/// Displacement; world space.
pub fn displacement<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let height = above_middle(flow, at, "Height");
    let normal = flow.linked_or(at, "Normal", |flow| flow.normal());
    if at.node.text("space") != "OBJECT" {
        return flow.graph.multiply(normal, height);
    }
    let normal = flow.graph.transform(Quantity::Normal, Space::World, Space::Object, normal);
    let moved = flow.graph.multiply(normal, height);
    flow.graph.transform(Quantity::Vector, Space::Object, Space::World, moved)
}

/// Vector Displacement; world space.
pub fn vector<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let moved = above_middle(flow, at, "Vector");
    let moved = match at.node.text("space") {
        "WORLD" => return moved,
        "OBJECT" => moved,
        _ => {
            // Along the tangent, the normal and the bitangent.
            let tangent = tangent_of_map(flow, "");
            let normal = flow.object_normal();
            let bitangent = flow.graph.apply(Function::Cross, &[normal, tangent]);
            let bitangent = flow.graph.apply(Function::Normalize(3), &[bitangent]);
            let sign = flow.graph.place(tangent, 3);
            let bitangent = flow.graph.multiply(bitangent, sign);
            let mut sum = flow.graph.constant([0.0; 4]);
            for (place, axis) in [tangent, normal, bitangent].into_iter().enumerate() {
                let along = flow.graph.place(moved, place as u8);
                let part = flow.graph.multiply(axis, along);
                sum = flow.graph.add(sum, part);
            }
            sum
        }
    };
    flow.graph.transform(Quantity::Vector, Space::Object, Space::World, moved)
}

/// An input less the middle level, times the scale.
fn above_middle<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> ValueId {
    let (value, middle, scale) = (flow.input(at, name), flow.input(at, "Midlevel"), flow.input(at, "Scale"));
    let above = flow.graph.subtract(value, middle);
    flow.graph.multiply(above, scale)
}
