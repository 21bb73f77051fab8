//! MaterialX's nodes that carry values between spaces or go by directions: transforms, tangents, facingratio and
//! triplanar projections, by the node graphs of its standard library 1.39.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use super::{geometry, texture};
use crate::desc::graph::{Function as F, Leaf, Math, Quantity, Space};

/// transformpoint, transformvector and transformnormal between the object's space and the stage's.
pub(super) fn transform(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let (quantity, default) = match category {
        "transformpoint" => (Quantity::Point, [0.0, 0.0, 0.0, 1.0]),
        "transformvector" => (Quantity::Vector, [0.0, 0.0, 0.0, 1.0]),
        _ => (Quantity::Normal, [0.0, 0.0, 1.0, 1.0]),
    };
    let value = e.input(node, "in", default);
    let [from, to] = ["fromspace", "tospace"].map(|name| e.node(node).text(name).unwrap_or_default().to_string());
    match (is_of_object(&from), is_of_object(&to)) {
        (Some(from), Some(to)) if from == to => value,
        (Some(true), Some(false)) => to_stage(e, value, quantity),
        (Some(false), Some(true)) => to_object(e, value, quantity),
        _ => {
            e.warn(node, format!("from \"{from}\" to \"{to}\" isn't computed; the value stays as it is"));
            value
        }
    }
}

/// Whether a space is the object's own or the stage's; `None` for others.
fn is_of_object(space: &str) -> Option<bool> {
    match space {
        "object" | "model" => Some(true),
        "world" => Some(false),
        _ => None,
    }
}

fn to_stage(e: &mut Evaluator<'_, '_>, value: Id, quantity: Quantity) -> Id {
    let world = e.exprs.push(Op::Transform { quantity, from: Space::Object, to: Space::World, value });
    geometry::in_stage(e, world, quantity == Quantity::Normal)
}

fn to_object(e: &mut Evaluator<'_, '_>, value: Id, quantity: Quantity) -> Id {
    let value = geometry::out_of_stage(e, value, quantity == Quantity::Normal);
    e.exprs.push(Op::Transform { quantity, from: Space::World, to: Space::Object, value })
}

/// tangent and bitangent, along the growing u and v of the first texture coordinates.
pub(super) fn tangent(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let tangent = e.exprs.push(Op::Leaf(Leaf::Tangent));
    let along = e.exprs.apply(F::Normalize(3), &[tangent]);
    let value = if category == "tangent" {
        along
    } else {
        let (normal, sign) = (e.exprs.push(Op::Leaf(Leaf::SmoothNormal)), e.exprs.extract(tangent, 3));
        let across = e.exprs.apply(F::Cross, &[normal, along]);
        let across = e.exprs.apply(F::Normalize(3), &[across]);
        e.exprs.multiply(across, sign)
    };
    if e.node(node).text("space").unwrap_or("object") != "world" {
        return value;
    }
    let world = to_stage(e, value, Quantity::Vector);
    e.exprs.apply(F::Normalize(3), &[world])
}

/// facingratio: the cosine between the normal and whoever looks.
pub(super) fn facing_ratio(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let normal = e.optional(node, "normal");
    let view = e.optional(node, "viewdirection");
    let own = normal.is_none();
    let normal = normal.unwrap_or_else(|| geometry::world(e, Leaf::Normal));
    let view = view.unwrap_or_else(|| {
        let incoming = geometry::world(e, Leaf::Incoming);
        e.exprs.scale(incoming, -1.0)
    });
    let dot = e.exprs.apply(F::Dot(3), &[view, normal]);
    let facing = if e.uniform(node, "faceforward", 1.0) != 0.0 {
        e.exprs.apply(F::Math(Math::Absolute), &[dot])
    } else if own {
        // The normal that is given faces whoever looks, MaterialX's does not.
        let back = e.exprs.push(Op::Leaf(Leaf::Backfacing));
        let twice = e.exprs.scale(back, 2.0);
        let one = e.exprs.number(1.0);
        let sign = e.exprs.subtract(twice, one);
        e.exprs.multiply(dot, sign)
    } else {
        e.exprs.scale(dot, -1.0)
    };
    if e.uniform(node, "invert", 0.0) == 0.0 {
        return facing;
    }
    let one = e.exprs.number(1.0);
    e.exprs.subtract(one, facing)
}

/// triplanarprojection: three images by two coordinates each, weighted by the normal.
pub(super) fn triplanar(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let position = e.optional(node, "position").unwrap_or_else(|| e.exprs.push(Op::Leaf(Leaf::ObjectPosition)));
    let normal = e.optional(node, "normal").unwrap_or_else(|| e.exprs.push(Op::Leaf(Leaf::ObjectNormal)));
    let up = e.uniform(node, "upaxis", 2.0).clamp(0.0, 2.0) as usize;
    let x = &mut e.exprs;
    let unit = x.apply(F::Normalize(3), &[normal]);
    let sides = x.apply(F::Math(Math::Absolute), &[unit]);
    let all = x.number(1.0);
    let sum = x.apply(F::Dot(3), &[sides, all]);
    let shares = x.math(Math::Divide, &[sides, sum]);
    let (blend, least) = (e.scalar(node, "blend", 1.0), e.exprs.number(0.03));
    let one = e.exprs.number(1.0);
    let blend = e.exprs.math(Math::Clamp, &[blend, least, one]);
    let power = e.exprs.math(Math::Divide, &[one, blend]);
    let shares = if e.exprs.is(power, 1.0) { shares } else { e.exprs.math(Math::Power, &[shares, power]) };
    let sum = e.exprs.apply(F::Dot(3), &[shares, one]);
    let weights = e.exprs.math(Math::Divide, &[shares, sum]);
    let kind = e.node(node).kind.clone();
    let mut projected = e.exprs.number(0.0);
    // Which coordinates each image is looked up by, and the sign of the first, for the axis that is up: x, y or z.
    for (side, file, uv) in [
        (0, "filex", [[2, 1], [2, 1], [1, 2]][up]),
        (1, "filey", [[2, 0], [0, 2], [0, 2]][up]),
        (2, "filez", [[1, 0], [0, 1], [0, 1]][up]),
    ] {
        let [u, v] = uv.map(|place| e.exprs.extract(position, place));
        let u = if side == 2 && up == 0 { e.exprs.scale(u, -1.0) } else { u };
        let at = e.exprs.apply(F::Combine, &[u, v]);
        let texel = texture::named_image_at(e, node, file, at, &kind)?;
        let weight = e.exprs.extract(weights, side);
        let part = e.exprs.multiply(texel, weight);
        projected = e.exprs.add(projected, part);
    }
    Some(projected)
}
