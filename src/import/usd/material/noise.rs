//! MaterialX's noise: Perlin's of numbers, vectors and colors, sums of its octaves, and Worley's. MaterialX and Cycles
//! both have that of Open Shading Language, with its hash and scale.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use super::{random, texture};
use crate::desc::graph::{Function, Leaf, Math, Noise, NoiseKind, Procedural};

/// Where a noise that goes by texture coordinates or by the position is taken.
fn place(e: &mut Evaluator<'_, '_>, node: usize, flat: bool) -> Id {
    let at = if flat { e.optional(node, "texcoord") } else { e.optional(node, "position") };
    at.unwrap_or_else(|| match flat {
        true => e.texcoord("st".into()),
        false => e.exprs.push(Op::Leaf(Leaf::ObjectPosition)),
    })
}

/// How many octaves, each how much smaller and weaker than the one before.
#[derive(Clone, Copy)]
struct Octaves {
    count: f64,
    lacunarity: Id,
    diminish: Id,
}

impl Octaves {
    fn one(e: &mut Evaluator<'_, '_>) -> Self {
        Self { count: 1.0, lacunarity: e.exprs.number(2.0), diminish: e.exprs.number(0.5) }
    }

    fn of(e: &mut Evaluator<'_, '_>, node: usize) -> Self {
        Self {
            count: e.uniform(node, "octaves", 3.0).clamp(1.0, 16.0),
            lacunarity: e.scalar(node, "lacunarity", 2.0),
            diminish: e.scalar(node, "diminish", 0.5),
        }
    }
}

/// noise2d, noise3d, fractal2d and fractal3d of `count` numbers.
pub(super) fn perlin(e: &mut Evaluator<'_, '_>, node: usize, category: &str, count: u8) -> Id {
    let flat = category.ends_with("2d");
    let at = place(e, node, flat);
    let is_fractal = category.starts_with("fractal");
    let octaves = if is_fractal { Octaves::of(e, node) } else { Octaves::one(e) };
    let noise = match (count, is_fractal) {
        (1, _) => number(e, at, flat, octaves),
        (2, true) => {
            let parts = [number(e, at, flat, octaves), another(e, at, flat, octaves, FRACTAL)];
            e.exprs.apply(Function::Combine, &parts)
        }
        (4, _) => {
            let vector = vector(e, at, flat, octaves);
            let mut parts = [0, 1, 2].map(|place| e.exprs.extract(vector, place)).to_vec();
            parts.push(another(e, at, flat, octaves, if is_fractal { FRACTAL } else { NOISE }));
            e.exprs.apply(Function::Combine, &parts)
        }
        _ => vector(e, at, flat, octaves),
    };
    let amplitude = e.input(node, "amplitude", [1.0; 4]);
    let scaled = e.exprs.multiply(noise, amplitude);
    if is_fractal {
        return scaled;
    }
    let pivot = e.scalar(node, "pivot", 0.0);
    e.exprs.add(scaled, pivot)
}

/// How far away the noise is taken that is the last number of several.
const NOISE: [f64; 3] = [19.0, 73.0, 29.0];
const FRACTAL: [f64; 3] = [19.0, 193.0, 17.0];

fn another(e: &mut Evaluator<'_, '_>, at: Id, flat: bool, octaves: Octaves, [x, y, z]: [f64; 3]) -> Id {
    let away = e.exprs.constant([x, y, z, 0.0]);
    let at = e.exprs.add(at, away);
    number(e, at, flat, octaves)
}

fn number(e: &mut Evaluator<'_, '_>, at: Id, flat: bool, octaves: Octaves) -> Id {
    let x = &mut e.exprs;
    let (zero, one, detail) = (x.number(0.0), x.number(1.0), x.number(octaves.count - 1.0));
    let dimensions = if flat { 2 } else { 3 };
    let kind = Procedural::Noise(Noise { dimensions, kind: NoiseKind::Fbm, normalize: false, color: false });
    // vector, w, scale, detail, roughness, lacunarity, offset, gain, distortion.
    let args = vec![at, zero, one, detail, octaves.diminish, octaves.lacunarity, zero, zero, zero];
    let noise = x.push(Op::Procedural(kind, args));
    x.extract(noise, 3)
}

fn vector(e: &mut Evaluator<'_, '_>, at: Id, flat: bool, octaves: Octaves) -> Id {
    let detail = e.exprs.number(octaves.count - 1.0);
    let kind = Procedural::VectorNoise { dimensions: if flat { 2 } else { 3 } };
    e.exprs.push(Op::Procedural(kind, vec![at, detail, octaves.diminish, octaves.lacunarity]))
}

/// worleynoise2d and worleynoise3d of `count` numbers.
pub(super) fn worley(e: &mut Evaluator<'_, '_>, node: usize, category: &str, count: u8) -> Id {
    let flat = category.ends_with("2d");
    let at = place(e, node, flat);
    let cell = cell_of(e, node, at, flat);
    if count == 1 { e.exprs.extract(cell, 3) } else { cell }
}

fn cell_of(e: &mut Evaluator<'_, '_>, node: usize, at: Id, flat: bool) -> Id {
    let (jitter, solid) = (e.scalar(node, "jitter", 1.0), e.uniform(node, "style", 0.0) == 1.0);
    let kind = Procedural::Worley { dimensions: if flat { 2 } else { 3 }, solid };
    e.exprs.push(Op::Procedural(kind, vec![at, jitter]))
}

/// unifiednoise2d and unifiednoise3d: one of the noises above, by their node graphs.
pub(super) fn unified(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let flat = category.ends_with("2d");
    let at = place(e, node, flat);
    let (freq, offset) = (e.input(node, "freq", [1.0; 4]), e.input(node, "offset", [0.0; 4]));
    let at = e.exprs.multiply(at, freq);
    let at = e.exprs.add(at, offset);
    // A jitter of 1 leaves all but Worley's points where they are.
    let jitter = e.scalar(node, "jitter", 1.0);
    let one = e.exprs.number(1.0);
    let off = e.exprs.subtract(jitter, one);
    let off = e.exprs.scale(off, 90_000.0);
    let value = match e.uniform(node, "type", 0.0) {
        2.0 => {
            let cell = cell_of(e, node, at, flat);
            e.exprs.extract(cell, 3)
        }
        3.0 => {
            let at = if flat {
                let [u, v] = [0, 1].map(|place| e.exprs.extract(at, place));
                e.exprs.apply(Function::Combine, &[u, v, off])
            } else {
                turned(e, at, off)
            };
            let octaves = Octaves::of(e, node);
            number(e, at, false, octaves)
        }
        kind => {
            let at = if flat { texture::rotate_by(e, at, off, -1.0) } else { turned(e, at, off) };
            if kind == 1.0 {
                random::cell(e, at, if flat { 2 } else { 3 })
            } else {
                let one = Octaves::one(e);
                let noise = number(e, at, flat, one);
                let half = e.exprs.number(0.5);
                e.exprs.math(Math::MultiplyAdd, &[noise, half, half])
            }
        }
    };
    let (low, high) = (e.scalar(node, "outmin", 0.0), e.scalar(node, "outmax", 1.0));
    let range = e.exprs.subtract(high, low);
    let value = e.exprs.math(Math::MultiplyAdd, &[value, range, low]);
    if e.uniform(node, "clampoutput", 1.0) == 0.0 { value } else { e.exprs.math(Math::Clamp, &[value, low, high]) }
}

/// `at` turned by so many degrees around the axis that the node graph of unifiednoise3d has.
fn turned(e: &mut Evaluator<'_, '_>, at: Id, degrees: Id) -> Id {
    if e.exprs.is(degrees, 0.0) {
        return at;
    }
    // Clockwise, as rotate3d.
    let angle = e.exprs.scale(degrees, -(1.0_f64.to_radians()));
    let (center, axis) = (e.exprs.number(0.0), e.exprs.constant([0.1, 1.0, 0.0, 0.0]));
    e.exprs.apply(Function::RotateAxis, &[at, center, axis, angle])
}
