//! MaterialX's ramp of up to ten colors, and the ramp_gradient that it is made of, by their node graphs.

use super::evaluate::Evaluator;
use super::expr::Id;
use crate::desc::graph::{Function as F, Math};

/// The most colors of a ramp.
const MOST: usize = 10;

/// ramp: colors along u, around the middle of the texture coordinates, or by the distance from there.
pub(super) fn ramp(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    let x = place(e, node, uv);
    let interpolation = e.uniform(node, "interpolation", 1.0);
    let count = e.uniform(node, "num_intervals", 2.0).clamp(1.0, MOST as f64) as usize;
    let stops: Vec<(Id, Id)> = (1..=count)
        .map(|i| {
            let (at, color) = if i == 1 { (0.0, [0.0, 0.0, 0.0, 1.0]) } else { (1.0, [1.0; 4]) };
            (e.scalar(node, &format!("interval{i}"), at), e.input(node, &format!("color{i}"), color))
        })
        .collect();
    let mut color = stops[0].1;
    for pair in stops.windows(2) {
        color = gradient(e, x, [pair[0], pair[1]], color, interpolation);
    }
    color
}

/// Where between 0 and 1 the coordinates `uv` lie.
fn place(e: &mut Evaluator<'_, '_>, node: usize, uv: Id) -> Id {
    let kind = e.uniform(node, "type", 0.0);
    let x = &mut e.exprs;
    let half = x.number(0.5);
    let along = x.extract(uv, 0);
    if kind == 0.0 {
        return along;
    }
    let off = x.subtract(uv, half);
    let [u, v] = [0, 1].map(|place| x.extract(off, place));
    match kind {
        1.0 => {
            let angle = x.math(Math::Arctangent2, &[u, v]);
            let turn = x.scale(angle, std::f64::consts::TAU.recip());
            x.add(turn, half)
        }
        2.0 => {
            // The root of 2, in as many digits as the node graph has.
            let wide = x.scale(off, 1.414);
            x.apply(F::Length(2), &[wide])
        }
        _ => {
            let [u, v] = [u, v].map(|side| x.apply(F::Math(Math::Absolute), &[side]));
            let farther = x.math(Math::Maximum, &[u, v]);
            x.scale(farther, 2.0)
        }
    }
}

/// ramp_gradient: one interval of a ramp.
pub(super) fn interval(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let (x, before) = (e.scalar(node, "x", 0.0), e.input(node, "prev_color", [0.0, 0.0, 0.0, 1.0]));
    let (number, count) = (e.uniform(node, "interval_num", 1.0), e.uniform(node, "num_intervals", 2.0));
    if number >= count {
        return before;
    }
    let low = (e.scalar(node, "interval1", 0.0), e.input(node, "color1", [0.0, 0.0, 0.0, 1.0]));
    let high = (e.scalar(node, "interval2", 1.0), e.input(node, "color2", [1.0; 4]));
    let interpolation = e.uniform(node, "interpolation", 1.0);
    gradient(e, x, [low, high], before, interpolation)
}

/// From one stop to the next; `before` in front of the first. Linear, smooth or in steps.
fn gradient(
    e: &mut Evaluator<'_, '_>,
    x: Id,
    [(low, from), (high, to)]: [(Id, Id); 2],
    before: Id,
    interpolation: f64,
) -> Id {
    let exprs = &mut e.exprs;
    let within = if interpolation == 2.0 {
        exprs.apply(F::IfGreater, &[high, x, from, to])
    } else {
        let share = if interpolation == 0.0 {
            let inside = exprs.math(Math::Clamp, &[x, low, high]);
            let (above, range) = (exprs.subtract(inside, low), exprs.subtract(high, low));
            exprs.math(Math::Divide, &[above, range])
        } else {
            exprs.math(Math::Smoothstep, &[x, low, high])
        };
        exprs.mix(from, to, share)
    };
    exprs.apply(F::IfGreater, &[x, low, within, before])
}
