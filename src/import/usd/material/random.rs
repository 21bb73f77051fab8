//! MaterialX's random values: cells of noise, and what its node graphs make of them.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use crate::desc::graph::{Function as F, Leaf, Math, Procedural};

/// cellnoise2d and cellnoise3d: a number for each cell of whole coordinates.
pub(super) fn cell_noise(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    if category.ends_with("2d") {
        let at = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
        return cell(e, at, 2);
    }
    let at = e.optional(node, "position").unwrap_or_else(|| e.exprs.push(Op::Leaf(Leaf::ObjectPosition)));
    cell(e, at, 3)
}

/// The number of 0 to 1 of the cell at `at`.
pub(super) fn cell(e: &mut Evaluator<'_, '_>, at: Id, dimensions: u8) -> Id {
    e.exprs.push(Op::Procedural(Procedural::Cell { dimensions }, vec![at]))
}

/// randomfloat: a number between `min` and `max` for each input and seed.
pub(super) fn random_float(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let (input, seed) = (e.scalar(node, "in", 0.0), e.scalar(node, "seed", 0.0));
    let number = random(e, node, input, seed);
    let (low, high) = (e.scalar(node, "min", 0.0), e.scalar(node, "max", 1.0));
    let value = between(e, number, low, high);
    e.exprs.math(Math::Clamp, &[value, low, high])
}

/// randomcolor: hue, saturation and brightness within their ranges.
pub(super) fn random_color(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let (input, seed) = (e.scalar(node, "in", 0.0), e.scalar(node, "seed", 0.0));
    let parts = [("hue", 413.3, 0.0), ("saturation", 1522.4, 0.825), ("brightness", 1813.8, 1.0)];
    let hsv = parts.map(|(name, offset, low)| {
        let offset = e.exprs.number(offset);
        let moved = e.exprs.add(seed, offset);
        let seed = e.exprs.math(Math::Ceil, &[moved]);
        let number = random(e, node, input, seed);
        let low = e.scalar(node, &format!("{name}low"), low);
        let high = e.scalar(node, &format!("{name}high"), 1.0);
        between(e, number, low, high)
    });
    let hsv = e.exprs.apply(F::Combine, &hsv);
    e.exprs.apply(F::HsvToRgb, &[hsv])
}

/// 0 to 1 for an input and a seed. Numbers that are no whole ones are told apart to a 4096th.
fn random(e: &mut Evaluator<'_, '_>, node: usize, input: Id, seed: Id) -> Id {
    let is_whole = e.node(node).kind.ends_with("integer");
    let input = if is_whole { input } else { e.exprs.scale(input, 4096.0) };
    let at = e.exprs.apply(F::Combine, &[input, seed]);
    cell(e, at, 2)
}

fn between(e: &mut Evaluator<'_, '_>, number: Id, low: Id, high: Id) -> Id {
    let range = e.exprs.subtract(high, low);
    let above = e.exprs.multiply(number, range);
    e.exprs.add(above, low)
}
