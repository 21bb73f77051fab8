//! MaterialX's nodes that go by where a surface is hit.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use crate::desc::graph::{Function, Leaf, Math};
use crate::math::DMat3;

/// position, normal and viewdirection, in the space that the node names, in the stage's axes and units.
///
/// A normal that is an input of a surface means the surface's own.
pub(super) fn vector(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let fallback = if category == "position" { "object" } else { "world" };
    let space = e.node(node).text("space").unwrap_or(fallback).to_string();
    let in_world = space == "world";
    let leaf = match category {
        "position" if in_world => Leaf::Position,
        "position" => Leaf::ObjectPosition,
        "normal" if in_world => Leaf::Normal,
        "normal" => Leaf::ObjectNormal,
        _ => {
            if !in_world {
                e.warn(node, format!("its space \"{space}\" isn't computed; world is used"));
            }
            Leaf::Incoming
        }
    };
    let towards = leaf == Leaf::Incoming;
    let value = e.exprs.push(Op::Leaf(leaf));
    let value = match category {
        "position" if in_world => in_stage(e, value, false),
        _ if in_world || towards => in_stage(e, value, true),
        _ => value,
    };
    // MaterialX looks along the ray.
    if towards { e.exprs.scale(value, -1.0) } else { value }
}

/// A direction of the world in the stage's axes.
pub(super) fn world(e: &mut Evaluator<'_, '_>, leaf: Leaf) -> Id {
    let value = e.exprs.push(Op::Leaf(leaf));
    in_stage(e, value, true)
}

/// A point or direction of the world in the stage's own axes; points in its units, too.
pub(super) fn in_stage(e: &mut Evaluator<'_, '_>, value: Id, is_direction: bool) -> Id {
    let reading = e.materials.reading;
    let mut back = reading.to_world.inverse();
    if is_direction {
        back.matrix3 *= reading.meters;
    }
    turned(e, value, back.matrix3)
}

/// And back.
pub(super) fn out_of_stage(e: &mut Evaluator<'_, '_>, value: Id, is_direction: bool) -> Id {
    let reading = e.materials.reading;
    let meters = if is_direction { reading.meters } else { 1.0 };
    turned(e, value, reading.to_world.matrix3 * meters.recip())
}

fn turned(e: &mut Evaluator<'_, '_>, value: Id, by: DMat3) -> Id {
    let m = by.transpose();
    if m == DMat3::IDENTITY {
        return value;
    }
    let rows = [m.x_axis, m.y_axis, m.z_axis].map(|row| [row.x, row.y, row.z, 0.0]);
    e.exprs.apply(Function::Affine(Box::new(rows)), &[value])
}

/// checkerboard, as its node graph in `stdlib_ng.mtlx` has it.
pub(super) fn checkerboard(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    let (tiling, offset) = (e.input(node, "uvtiling", [8.0; 4]), e.input(node, "uvoffset", [0.0; 4]));
    let (a, b) = (e.input(node, "color1", [1.0; 4]), e.input(node, "color2", [0.0; 4]));
    let x = &mut e.exprs;
    let tiled = x.multiply(uv, tiling);
    let moved = x.subtract(tiled, offset);
    let corner = x.math(Math::Floor, &[moved]);
    let (u, v, two) = (x.extract(corner, 0), x.extract(corner, 1), x.number(2.0));
    let sum = x.add(u, v);
    let odd = x.math(Math::FlooredModulo, &[sum, two]);
    x.mix(b, a, odd)
}
