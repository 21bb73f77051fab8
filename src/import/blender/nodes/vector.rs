//! Nodes of the Vector menu.

use std::sync::Arc;

use super::flow::{At, Flow};
use super::tables;
use crate::desc::graph::{Bump, Function, Mapping, Op, Quantity, Space, ValueId};

/// Mapping.
pub fn mapping<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let args = ["Vector", "Location", "Rotation", "Scale"].map(|name| flow.input(at, name));
    let mapping = match at.node.text("vector_type") {
        "TEXTURE" => Mapping::Texture,
        "VECTOR" => Mapping::Vector,
        "NORMAL" => Mapping::Normal,
        _ => Mapping::Point,
    };
    flow.graph.apply(Function::Mapping(mapping), &args)
}

/// Normal: the direction that it shows, and its product with a normal.
pub fn normal<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, output: &str) -> ValueId {
    let shown = at.node.outputs.first().map(|socket| socket.value.places()).unwrap_or_default();
    let shown = flow.graph.constant(shown);
    let direction = flow.graph.apply(Function::Normalize(3), &[shown]);
    if output != "Dot" {
        return direction;
    }
    let normal = flow.input(at, "Normal");
    let normal = flow.graph.apply(Function::Normalize(3), &[normal]);
    flow.graph.apply(Function::Dot(3), &[direction, normal])
}

/// Normal Map.
pub fn normal_map<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let (strength, color) = (flow.input(at, "Strength"), flow.input(at, "Color"));
    match at.node.text("space") {
        "OBJECT" => flow.graph.normal_map_of(Space::Object, color, strength),
        "WORLD" => flow.graph.normal_map_of(Space::World, color, strength),
        "BLENDER_OBJECT" | "BLENDER_WORLD" => {
            // Their y and z run the other way.
            let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 1.0], [0.0, 0.0, -1.0, 1.0]];
            let color = flow.graph.affine(rows, color);
            let space = if at.node.text("space") == "BLENDER_OBJECT" { Space::Object } else { Space::World };
            flow.graph.normal_map_of(space, color, strength)
        }
        _ => {
            let tangent = super::input::tangent_of_map(flow, at.node.text("uv_map"));
            flow.graph.normal_map(color, strength, tangent)
        }
    }
}

/// Bump.
pub fn bump<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let normal = flow.linked_or(at, "Normal", |flow| flow.normal());
    if !flow.is_linked(at, "Height") {
        return normal;
    }
    let height = flow.input(at, "Height");
    let strength = flow.input(at, "Strength");
    let distance = flow.input(at, "Distance");
    let distance = if at.node.flag("invert") { flow.graph.scale(distance, -1.0) } else { distance };
    // Nodes of versions that know no width look a whole pixel further.
    let width = flow.input_or(at, "Filter Width", 1.0);
    let filter_width = flow.graph.known(width).map_or(0.1, |width| width[0]);
    flow.graph.push(Op::Bump(Bump { height, strength, distance, normal, filter_width, object_space: true }))
}

/// Vector Rotate.
pub fn rotate<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let (vector, center) = (flow.input(at, "Vector"), flow.input(at, "Center"));
    let invert = at.node.flag("invert");
    let axis = match at.node.text("rotation_type") {
        "EULER_XYZ" => {
            let rotation = flow.input(at, "Rotation");
            return flow.graph.apply(Function::RotateEuler { invert }, &[vector, center, rotation]);
        }
        "X_AXIS" => flow.graph.constant([1.0, 0.0, 0.0, 0.0]),
        "Y_AXIS" => flow.graph.constant([0.0, 1.0, 0.0, 0.0]),
        "Z_AXIS" => flow.graph.constant([0.0, 0.0, 1.0, 0.0]),
        _ => flow.input(at, "Axis"),
    };
    let angle = flow.input(at, "Angle");
    let angle = if invert { flow.graph.scale(angle, -1.0) } else { angle };
    flow.graph.apply(Function::RotateAxis, &[vector, center, axis, angle])
}

/// Vector Transform.
pub fn transform<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let value = flow.input(at, "Vector");
    let space = |name: &str| match at.node.text(name) {
        "OBJECT" => Space::Object,
        "CAMERA" => Space::Camera,
        _ => Space::World,
    };
    let quantity = match at.node.text("vector_type") {
        "POINT" => Quantity::Point,
        "NORMAL" => Quantity::Normal,
        _ => Quantity::Vector,
    };
    let (from, to) = (space("convert_from"), space("convert_to"));
    let moved = flow.graph.transform(quantity, from, to, value);
    // Normals are unit in every space that they come to.
    if quantity == Quantity::Normal && from != to { flow.graph.apply(Function::Normalize(3), &[moved]) } else { moved }
}

/// Vector Curves.
pub fn curves<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, _: &str) -> ValueId {
    let (factor, vector) = (flow.input(at, "Fac"), flow.input(at, "Vector"));
    let Some(table) = tables::curves(at.node, &[0, 1, 2]) else { return vector };
    let curved = flow.graph.apply(Function::Curves(Arc::new(table)), &[vector]);
    flow.graph.mix(vector, curved, factor)
}
