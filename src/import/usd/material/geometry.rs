//! MaterialX's nodes that go by where a surface is hit, and its noise.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use crate::desc::graph::{Function, Leaf, Math, Noise, NoiseKind, Procedural};
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

/// Perlin noise of one number, `amplitude × noise + pivot`, and sums of its octaves. MaterialX and Cycles both
/// have that of Open Shading Language, with its hash and scale.
pub(super) fn noise(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let flat = category.ends_with("2d");
    let at = if flat { e.optional(node, "texcoord") } else { e.optional(node, "position") };
    let at = at.unwrap_or_else(|| match flat {
        true => e.texcoord("st".into()),
        false => e.exprs.push(Op::Leaf(Leaf::ObjectPosition)),
    });
    let is_fractal = category.starts_with("fractal");
    let octaves = if is_fractal { e.uniform(node, "octaves", 3.0).clamp(1.0, 16.0) } else { 1.0 };
    let (lacunarity, diminish) = match is_fractal {
        true => (e.scalar(node, "lacunarity", 2.0), e.scalar(node, "diminish", 0.5)),
        false => (e.exprs.number(2.0), e.exprs.number(0.5)),
    };
    let amplitude = e.scalar(node, "amplitude", 1.0);
    let pivot = if is_fractal { e.exprs.number(0.0) } else { e.scalar(node, "pivot", 0.0) };
    let (zero, one, detail) = (e.exprs.number(0.0), e.exprs.number(1.0), e.exprs.number(octaves - 1.0));
    let dimensions = if flat { 2 } else { 3 };
    let kind = Procedural::Noise(Noise { dimensions, kind: NoiseKind::Fbm, normalize: false, color: false });
    // vector, w, scale, detail, roughness, lacunarity, offset, gain, distortion.
    let args = vec![at, zero, one, detail, diminish, lacunarity, zero, zero, zero];
    let noise = e.exprs.push(Op::Procedural(kind, args));
    let number = e.exprs.extract(noise, 3);
    let scaled = e.exprs.multiply(number, amplitude);
    e.exprs.add(scaled, pivot)
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
