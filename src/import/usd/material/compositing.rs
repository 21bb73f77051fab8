//! Nodes of MaterialX that lay pictures over each other, that decide, waves and the time.

use super::evaluate::Evaluator;
use super::expr::Id;
use super::pattern::count;
use crate::desc::graph::{Function as F, Leaf, Math};

/// The value of a node; `None` for another one.
pub(super) fn compute(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Option<Id> {
    let count = count(&e.node(node).kind);
    Some(match category {
        "over" | "in" | "out" | "mask" | "matte" | "disjointover" => {
            let [fg, bg] = ["fg", "bg"].map(|name| e.input(node, name, [0.0; 4]));
            let mix = e.scalar(node, "mix", 1.0);
            let whole = composite(e, fg, bg, category);
            e.exprs.mix(bg, whole, mix)
        }
        "inside" | "outside" => {
            let (value, mask) = (e.input(node, "in", [0.0; 4]), e.scalar(node, "mask", 1.0));
            let mask = if category == "inside" { mask } else { not(e, mask) };
            e.exprs.multiply(value, mask)
        }
        "and" | "logical_and" => {
            let [a, b] = both(e, node);
            e.exprs.multiply(a, b)
        }
        "or" | "logical_or" => {
            let [a, b] = both(e, node);
            e.exprs.math(Math::Maximum, &[a, b])
        }
        "xor" | "logical_xor" => {
            let [a, b] = both(e, node);
            let difference = e.exprs.subtract(a, b);
            e.exprs.apply(F::Math(Math::Absolute), &[difference])
        }
        "not" | "logical_not" => {
            let a = e.scalar(node, "in", 0.0);
            not(e, a)
        }
        "distance" => {
            let [a, b] = both(e, node);
            let apart = e.exprs.subtract(a, b);
            e.exprs.apply(F::Length(count), &[apart])
        }
        "maxcomponent" | "mincomponent" => {
            let value = e.input(node, "in", [0.0; 4]);
            let math = if category == "maxcomponent" { Math::Maximum } else { Math::Minimum };
            let first = e.exprs.extract(value, 0);
            (1..count).fold(first, |most, place| {
                let next = e.exprs.extract(value, place);
                e.exprs.math(math, &[most, next])
            })
        }
        "reflect" | "refract" => {
            let value = e.input(node, "in", [1.0, 0.0, 0.0, 0.0]);
            let normal = e.optional(node, "normal").unwrap_or_else(|| super::geometry::world(e, Leaf::Normal));
            if category == "reflect" {
                e.exprs.apply(F::Reflect, &[value, normal])
            } else {
                let ior = e.scalar(node, "ior", 1.0);
                e.exprs.apply(F::Refract, &[value, normal, ior])
            }
        }
        "trianglewave" => {
            let value = e.scalar(node, "in", 0.0);
            let (one, half) = (e.exprs.number(1.0), e.exprs.number(0.5));
            let ahead = e.exprs.apply(F::Math(Math::Absolute), &[value]);
            let share = e.exprs.math(Math::FlooredModulo, &[ahead, one]);
            let off = e.exprs.subtract(share, half);
            let off = e.exprs.apply(F::Math(Math::Absolute), &[off]);
            e.exprs.subtract(half, off)
        }
        "frame" => {
            let frame = frame(e).unwrap_or(1.0);
            e.exprs.number(frame)
        }
        "time" => {
            let seconds = frame(e).unwrap_or(0.0) / e.materials.reading.stage.time_codes_per_second();
            e.exprs.number(seconds)
        }
        _ => return None,
    })
}

/// The time code that is read; `None` for a stage without time.
fn frame(e: &Evaluator<'_, '_>) -> Option<f64> {
    let time = e.materials.reading.time;
    (!time.is_earliest_time()).then(|| time.value())
}

fn both(e: &mut Evaluator<'_, '_>, node: usize) -> [Id; 2] {
    ["in1", "in2"].map(|name| e.input(node, name, [0.0; 4]))
}

fn not(e: &mut Evaluator<'_, '_>, a: Id) -> Id {
    let one = e.exprs.number(1.0);
    e.exprs.subtract(one, a)
}

/// Thomas Porter, Tom Duff: *Compositing Digital Images*, SIGGRAPH 1984; colors are premultiplied but those of a matte.
fn composite(e: &mut Evaluator<'_, '_>, fg: Id, bg: Id, category: &str) -> Id {
    let [above, below] = [fg, bg].map(|color| e.exprs.extract(color, 3));
    match category {
        "in" => e.exprs.multiply(fg, below),
        "mask" => e.exprs.multiply(bg, above),
        "out" => {
            let rest = not(e, below);
            e.exprs.multiply(fg, rest)
        }
        "disjointover" => {
            let x = &mut e.exprs;
            let (zero, one) = (x.number(0.0), x.number(1.0));
            let (alphas, plain) = (x.add(above, below), x.add(fg, bg));
            let left = x.subtract(one, above);
            // Nothing where the background is clear.
            let share = x.math(Math::Divide, &[left, below]);
            let squeezed = x.multiply(bg, share);
            let squeezed = x.add(fg, squeezed);
            let squeezed = x.apply(F::IfGreater, &[below, zero, squeezed, zero]);
            let color = x.apply(F::IfGreater, &[alphas, one, squeezed, plain]);
            let alpha = x.math(Math::Minimum, &[alphas, one]);
            let mut parts = [0, 1, 2].map(|place| x.extract(color, place)).to_vec();
            parts.push(alpha);
            x.apply(F::Combine, &parts)
        }
        _ => {
            let fg = if category == "matte" {
                let color = e.exprs.multiply(fg, above);
                let mut parts = [0, 1, 2].map(|place| e.exprs.extract(color, place)).to_vec();
                parts.push(above);
                e.exprs.apply(F::Combine, &parts)
            } else {
                fg
            };
            let rest = not(e, above);
            let behind = e.exprs.multiply(bg, rest);
            e.exprs.add(fg, behind)
        }
    }
}
