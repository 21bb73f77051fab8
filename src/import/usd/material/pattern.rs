//! MaterialX's standard nodes that compute with values, by the defaults of `stdlib_defs.mtlx` 1.39.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use super::{compositing, geometry, noise, ramps, random, relief, spaces};
use crate::desc::graph::{Function as F, Math};

/// Names of the inputs of a function, with their defaults.
type Inputs = &'static [(&'static str, f64)];

/// Functions of which each input has one default.
const SIMPLE: &[(&str, F, Inputs)] = &[
    ("add", F::Math(Math::Add), &[("in1", 0.0), ("in2", 0.0)]),
    ("multiply", F::Math(Math::Multiply), &[("in1", 0.0), ("in2", 1.0)]),
    ("divide", F::Math(Math::Divide), &[("in1", 0.0), ("in2", 1.0)]),
    ("modulo", F::Math(Math::FlooredModulo), &[("in1", 0.0), ("in2", 1.0)]),
    ("power", F::Math(Math::Power), &[("in1", 0.0), ("in2", 1.0)]),
    ("safepower", F::Math(Math::SignedPower), &[("in1", 0.0), ("in2", 1.0)]),
    ("min", F::Math(Math::Minimum), &[("in1", 0.0), ("in2", 0.0)]),
    ("max", F::Math(Math::Maximum), &[("in1", 0.0), ("in2", 0.0)]),
    ("absval", F::Math(Math::Absolute), &[("in", 0.0)]),
    ("sign", F::Math(Math::Sign), &[("in", 0.0)]),
    ("floor", F::Math(Math::Floor), &[("in", 0.0)]),
    ("ceil", F::Math(Math::Ceil), &[("in", 0.0)]),
    ("round", F::Math(Math::RoundAway), &[("in", 0.0)]),
    ("fract", F::Math(Math::Fraction), &[("in", 0.0)]),
    ("sin", F::Math(Math::Sine), &[("in", 0.0)]),
    ("cos", F::Math(Math::Cosine), &[("in", 0.0)]),
    ("tan", F::Math(Math::Tangent), &[("in", 0.0)]),
    ("asin", F::Math(Math::Arcsine), &[("in", 0.0)]),
    ("acos", F::Math(Math::Arccosine), &[("in", 0.0)]),
    ("atan2", F::Math(Math::Arctangent2), &[("iny", 0.0), ("inx", 1.0)]),
    ("sqrt", F::Math(Math::Sqrt), &[("in", 0.0)]),
    ("ln", F::Math(Math::Ln), &[("in", 1.0)]),
    ("exp", F::Math(Math::Exponent), &[("in", 0.0)]),
    ("clamp", F::Math(Math::Clamp), &[("in", 0.0), ("low", 0.0), ("high", 1.0)]),
    ("smoothstep", F::Math(Math::Smoothstep), &[("in", 0.0), ("low", 0.0), ("high", 1.0)]),
    ("ifgreater", F::IfGreater, &[("value1", 1.0), ("value2", 0.0), ("in1", 0.0), ("in2", 0.0)]),
    ("ifgreatereq", F::IfGreaterOrEqual, &[("value1", 1.0), ("value2", 0.0), ("in1", 0.0), ("in2", 0.0)]),
    ("ifequal", F::IfEqual, &[("value1", 0.0), ("value2", 0.0), ("in1", 0.0), ("in2", 0.0)]),
    ("crossproduct", F::Cross, &[("in1", 0.0), ("in2", 0.0)]),
    ("hsvtorgb", F::HsvToRgb, &[("in", 0.0)]),
    ("rgbtohsv", F::RgbToHsv, &[("in", 0.0)]),
];

/// The value of a node; `None`, with a warning, for one that is not known.
pub(super) fn compute(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Id> {
    let data = e.node(node);
    let category = data.category.as_str();
    if let Some((_, function, inputs)) = SIMPLE.iter().find(|(name, _, _)| *name == category) {
        return Some(e.function(node, function.clone(), inputs));
    }
    let count = count(&data.kind);
    Some(match category {
        "constant" => e.input(node, "value", [0.0; 4]),
        "dot" => e.input(node, "in", [0.0; 4]),
        "subtract" => {
            let (a, b) = (e.input(node, "in1", [0.0; 4]), e.input(node, "in2", [0.0; 4]));
            e.exprs.subtract(a, b)
        }
        "mix" => {
            let [bg, fg, amount] = ["bg", "fg", "mix"].map(|name| e.input(node, name, [0.0; 4]));
            e.exprs.mix(bg, fg, amount)
        }
        "invert" => {
            let (a, b) = (e.input(node, "amount", [1.0; 4]), e.input(node, "in", [0.0; 4]));
            e.exprs.subtract(a, b)
        }
        "dotproduct" => e.function(node, F::Dot(count), &[("in1", 0.0), ("in2", 0.0)]),
        "magnitude" => e.function(node, F::Length(count), &[("in", 0.0)]),
        "normalize" => e.function(node, F::Normalize(count), &[("in", 0.0)]),
        "luminance" => {
            let color = e.input(node, "in", [0.0; 4]);
            luminance(e, node, color)
        }
        "saturate" => {
            let color = e.input(node, "in", [0.0; 4]);
            let (grey, amount) = (luminance(e, node, color), e.scalar(node, "amount", 1.0));
            e.exprs.mix(grey, color, amount)
        }
        "contrast" => {
            let (a, pivot) = (e.input(node, "in", [0.0; 4]), e.input(node, "pivot", [0.5; 4]));
            let amount = e.input(node, "amount", [1.0; 4]);
            let above = e.exprs.subtract(a, pivot);
            let above = e.exprs.multiply(above, amount);
            e.exprs.add(above, pivot)
        }
        "remap" => remap(e, node),
        "range" => range(e, node),
        "hsvadjust" => {
            let color = e.function(node, F::RgbToHsv, &[("in", 0.0)]);
            let amount = e.input(node, "amount", [0.0, 1.0, 1.0, 1.0]);
            // Hue is added, saturation and value multiplied.
            let (hue, rest) = (e.exprs.constant([1.0, 0.0, 0.0, 0.0]), e.exprs.constant([0.0, 1.0, 1.0, 1.0]));
            let (added, multiplied) = (e.exprs.multiply(amount, hue), e.exprs.multiply(amount, rest));
            let multiplied = e.exprs.add(multiplied, hue);
            let color = e.exprs.multiply(color, multiplied);
            let color = e.exprs.add(color, added);
            e.exprs.apply(F::HsvToRgb, &[color])
        }
        "colorcorrect" => color_correct(e, node),
        "plus" | "minus" | "difference" | "screen" | "burn" | "dodge" | "overlay" => blend(e, node, category)?,
        "convert" => convert(e, node),
        "extract" => {
            let (a, index) = (e.input(node, "in", [0.0; 4]), e.uniform(node, "index", 0.0));
            e.exprs.extract(a, index.clamp(0.0, 3.0) as u8)
        }
        "swizzle" => {
            let channels = data.text("channels").unwrap_or("x").to_string();
            let a = e.input(node, "in", [0.0; 4]);
            swizzle(e, a, &channels)
        }
        "combine2" | "combine3" | "combine4" => combine(e, node),
        "switch" => {
            let which = e.uniform(node, "which", 0.0).clamp(0.0, 9.0) as u8;
            e.input(node, &format!("in{}", which + 1), [0.0; 4])
        }
        "rotate2d" => {
            let a = e.input(node, "in", [0.0; 4]);
            let amount = e.scalar(node, "amount", 0.0);
            super::texture::rotate_by(e, a, amount, -1.0)
        }
        "rotate3d" => super::texture::rotate_around(e, node)?,
        "ramplr" | "ramptb" | "splitlr" | "splittb" => ramp(e, node, category),
        "ramp4" => {
            let (u, v) = (position(e, node, 0), position(e, node, 1));
            let corner = ["valuetl", "valuetr", "valuebl", "valuebr"].map(|name| e.input(node, name, [0.0; 4]));
            let (top, bottom) = (e.exprs.mix(corner[0], corner[1], u), e.exprs.mix(corner[2], corner[3], u));
            e.exprs.mix(bottom, top, v)
        }
        "ramp" => ramps::ramp(e, node),
        "ramp_gradient" => ramps::interval(e, node),
        "transformpoint" | "transformvector" | "transformnormal" => spaces::transform(e, node, category),
        "tangent" | "bitangent" => spaces::tangent(e, node, category),
        "facingratio" => spaces::facing_ratio(e, node),
        "triplanarprojection" => spaces::triplanar(e, node)?,
        "cellnoise2d" | "cellnoise3d" => random::cell_noise(e, node, category),
        "randomfloat" => random::random_float(e, node),
        "randomcolor" => random::random_color(e, node),
        "blackbody" => {
            let kelvin = e.scalar(node, "temperature", 5000.0);
            e.exprs.apply(F::Blackbody, &[kelvin])
        }
        "premult" | "unpremult" => with_alpha(e, node, category == "premult"),
        "position" | "normal" | "viewdirection" => geometry::vector(e, node, category),
        "noise2d" | "noise3d" | "fractal2d" | "fractal3d" => noise::perlin(e, node, category, count),
        "worleynoise2d" | "worleynoise3d" => noise::worley(e, node, category, count),
        "unifiednoise2d" | "unifiednoise3d" => noise::unified(e, node, category),
        "checkerboard" => geometry::checkerboard(e, node),
        "normalmap" => relief::normal_map(e, node),
        "heighttonormal" => relief::height_to_normal(e, node),
        "bump" => relief::bump(e, node),
        "" => {
            e.warn(node, "is a shader without identifier; the input that it drives keeps its default");
            return None;
        }
        _ => {
            let found = compositing::compute(e, node, category);
            if found.is_none() {
                let what = format!("node \"{category}\" isn't computed; the input that it drives keeps its default");
                e.warn(node, what);
            }
            found?
        }
    })
}

/// How many numbers a type has.
pub(super) fn count(kind: &str) -> u8 {
    match kind.split('_').next().unwrap_or_default() {
        kind if kind.ends_with('2') || kind.ends_with("2FA") => 2,
        kind if kind.ends_with('4') || kind.ends_with("4FA") => 4,
        "float" | "integer" => 1,
        _ => 3,
    }
}

/// A color times its alpha, or without it; alpha itself stays.
fn with_alpha(e: &mut Evaluator<'_, '_>, node: usize, multiplies: bool) -> Id {
    let color = e.input(node, "in", [0.0, 0.0, 0.0, 1.0]);
    let alpha = e.exprs.extract(color, 3);
    let math = if multiplies { Math::Multiply } else { Math::Divide };
    let changed = e.exprs.math(math, &[color, alpha]);
    let mut parts = [0, 1, 2].map(|place| e.exprs.extract(changed, place)).to_vec();
    parts.push(alpha);
    e.exprs.apply(F::Combine, &parts)
}

/// The index of refraction or the extinction of a metal that reflects `reflectivity`, and `edge_color` at its edge
/// (O. Gulbrandsen, "Artist friendly metallic Fresnel", JCGT 3(4), 2014).
pub(super) fn artistic_ior(e: &mut Evaluator<'_, '_>, node: usize, extinction: bool) -> Id {
    let color = e.input(node, "reflectivity", [0.944, 0.776, 0.373, 1.0]);
    let edge = e.input(node, "edge_color", [0.998, 0.981, 0.751, 1.0]);
    let x = &mut e.exprs;
    let (zero, one, most) = (x.number(0.0), x.number(1.0), x.number(0.99));
    let r = x.math(Math::Clamp, &[color, zero, most]);
    let root = x.apply(F::Math(Math::Sqrt), &[r]);
    let (rest, all) = (x.subtract(one, r), x.add(one, r));
    let (least, largest) = (x.subtract(one, root), x.add(one, root));
    let (low, high) = (x.math(Math::Divide, &[rest, all]), x.math(Math::Divide, &[largest, least]));
    let ior = x.mix(high, low, edge);
    if !extinction {
        return ior;
    }
    let [above, below] = [1.0, -1.0].map(|by| {
        let by = x.number(by);
        let sum = x.add(ior, by);
        x.multiply(sum, sum)
    });
    let scaled = x.multiply(above, r);
    let over = x.subtract(scaled, below);
    let squared = x.math(Math::Divide, &[over, rest]);
    let squared = x.math(Math::Maximum, &[squared, zero]);
    x.apply(F::Math(Math::Sqrt), &[squared])
}

fn luminance(e: &mut Evaluator<'_, '_>, node: usize, color: Id) -> Id {
    let coefficients = e.input(node, "lumacoeffs", [0.2722287, 0.6740818, 0.0536895, 0.0]);
    e.exprs.apply(F::Dot(3), &[color, coefficients])
}

fn remap(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let [a, in_low, out_low] = ["in", "inlow", "outlow"].map(|name| e.input(node, name, [0.0; 4]));
    let [in_high, out_high] = ["inhigh", "outhigh"].map(|name| e.input(node, name, [1.0; 4]));
    let (above, in_range) = (e.exprs.subtract(a, in_low), e.exprs.subtract(in_high, in_low));
    let (share, out_range) =
        (e.exprs.apply(F::Math(Math::Divide), &[above, in_range]), e.exprs.subtract(out_high, out_low));
    let above = e.exprs.multiply(share, out_range);
    e.exprs.add(above, out_low)
}

fn range(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let [a, in_low, out_low] = ["in", "inlow", "outlow"].map(|name| e.input(node, name, [0.0; 4]));
    let [in_high, out_high, gamma] = ["inhigh", "outhigh", "gamma"].map(|name| e.input(node, name, [1.0; 4]));
    let (above, in_range) = (e.exprs.subtract(a, in_low), e.exprs.subtract(in_high, in_low));
    let share = e.exprs.apply(F::Math(Math::Divide), &[above, in_range]);
    let one = e.exprs.number(1.0);
    let power = e.exprs.apply(F::Math(Math::Divide), &[one, gamma]);
    let share = if e.exprs.is(power, 1.0) { share } else { e.exprs.apply(F::Math(Math::SignedPower), &[share, power]) };
    let out_range = e.exprs.subtract(out_high, out_low);
    let above = e.exprs.multiply(share, out_range);
    let value = e.exprs.add(above, out_low);
    if e.uniform(node, "doclamp", 0.0) == 0.0 {
        value
    } else {
        e.exprs.apply(F::Math(Math::Clamp), &[value, out_low, out_high])
    }
}

/// Hue, saturation, gamma, lift, gain, contrast and exposure, in this order, by MaterialX's own graph.
fn color_correct(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let color = e.input(node, "in", [1.0; 4]);
    let [hue, lift, exposure] = ["hue", "lift", "exposure"].map(|name| e.scalar(node, name, 0.0));
    let [amount, gamma, gain, contrast] =
        ["saturation", "gamma", "gain", "contrast"].map(|name| e.scalar(node, name, 1.0));
    let pivot = e.scalar(node, "contrastpivot", 0.5);
    let hsv = e.exprs.apply(F::RgbToHsv, &[color]);
    let first = e.exprs.constant([1.0, 0.0, 0.0, 0.0]);
    let turn = e.exprs.multiply(hue, first);
    let turned = e.exprs.add(hsv, turn);
    let rgb = e.exprs.apply(F::HsvToRgb, &[turned]);
    let grey = luminance(e, node, rgb);
    let x = &mut e.exprs;
    let one = x.number(1.0);
    let saturated = x.mix(grey, rgb, amount);
    let power = x.math(Math::Divide, &[one, gamma]);
    let curved = if x.is(power, 1.0) { saturated } else { x.math(Math::SignedPower, &[saturated, power]) };
    let rest = x.subtract(one, lift);
    let scaled = x.multiply(curved, rest);
    let lifted = x.add(scaled, lift);
    let gained = x.multiply(lifted, gain);
    let above = x.subtract(gained, pivot);
    let above = x.multiply(above, contrast);
    let contrasted = x.add(above, pivot);
    let two = x.number(2.0);
    let stops = x.math(Math::Power, &[two, exposure]);
    let exposed = x.multiply(contrasted, stops);
    if count(&e.node(node).kind) < 4 {
        return exposed;
    }
    // Opacity stays as it is.
    let mut parts = [0, 1, 2].map(|place| e.exprs.extract(exposed, place)).to_vec();
    parts.push(e.exprs.extract(color, 3));
    e.exprs.apply(F::Combine, &parts)
}

/// The blend nodes: a function of foreground and background, mixed over the background.
fn blend(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Option<Id> {
    let [fg, bg] = ["fg", "bg"].map(|name| e.input(node, name, [0.0; 4]));
    let mix = e.scalar(node, "mix", 1.0);
    let x = &mut e.exprs;
    let one = x.number(1.0);
    let (not_fg, not_bg) = (x.subtract(one, fg), x.subtract(one, bg));
    let blended = match category {
        "plus" => x.add(bg, fg),
        "minus" => x.subtract(bg, fg),
        "difference" => {
            let difference = x.subtract(bg, fg);
            x.apply(F::Math(Math::Absolute), &[difference])
        }
        "screen" => {
            let product = x.multiply(not_fg, not_bg);
            x.subtract(one, product)
        }
        "burn" => {
            let ratio = x.apply(F::Math(Math::Divide), &[not_bg, fg]);
            x.subtract(one, ratio)
        }
        "dodge" => x.apply(F::Math(Math::Divide), &[bg, not_fg]),
        "overlay" => {
            // Per channel: multiplied where the background is dark, screened where it is bright.
            let (dark, bright) = (x.multiply(fg, bg), x.multiply(not_fg, not_bg));
            let (dark, bright) = (x.scale(dark, 2.0), x.scale(bright, 2.0));
            let bright = x.subtract(one, bright);
            let half = x.number(0.5);
            let step = x.subtract(bg, half);
            let step = x.apply(F::Math(Math::Sign), &[step]);
            let step = x.add(step, one);
            let step = x.scale(step, 0.5);
            x.mix(dark, bright, step)
        }
        _ => return None,
    };
    Some(x.mix(bg, blended, mix))
}

fn convert(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let a = e.input(node, "in", [0.0; 4]);
    let kind = e.node(node).kind.as_str();
    let (from, to) = kind.split_once('_').unwrap_or((kind, kind));
    if to.ends_with('4') && count(from) < 4 {
        // A color becomes opaque, a number fills all four places but alpha.
        let parts = [0, 1, 2].map(|place| e.exprs.extract(a, place));
        let one = e.exprs.number(1.0);
        return e.exprs.apply(F::Combine, &[parts[0], parts[1], parts[2], one]);
    }
    if to == "float" { e.exprs.extract(a, 0) } else { a }
}

fn combine(e: &mut Evaluator<'_, '_>, node: usize) -> Id {
    let data = e.node(node);
    let first = e.input(node, "in1", [0.0; 4]);
    let second = e.input(node, "in2", [0.0; 4]);
    if data.kind.starts_with("color4") && data.category == "combine2" {
        let parts = [0, 1, 2].map(|place| e.exprs.extract(first, place));
        return e.exprs.apply(F::Combine, &[parts[0], parts[1], parts[2], second]);
    }
    let mut args = vec![first, second];
    for (i, name) in ["in3", "in4"].into_iter().enumerate() {
        if data.category.ends_with(['3', '4']) && (i == 0 || data.category.ends_with('4')) {
            args.push(e.input(node, name, [0.0; 4]));
        }
    }
    // Two texture coordinates that are taken apart and put together again are the same.
    let uv = |id: Id, place: u8| match e.exprs.op(id) {
        Op::Apply(F::Swizzle(places), args) if *places == [place; 4] => Some(args[0]),
        _ => None,
    };
    if let (2, Some(u), Some(v)) = (args.len(), uv(args[0], 0), uv(args[1], 1))
        && u == v
    {
        return u;
    }
    e.exprs.apply(F::Combine, &args)
}

/// `channels` of a version 1.38 swizzle: letters, or the digits 0 and 1.
fn swizzle(e: &mut Evaluator<'_, '_>, a: Id, channels: &str) -> Id {
    let parts: Vec<Id> = channels
        .chars()
        .take(4)
        .map(|c| match c {
            'r' | 'x' => e.exprs.extract(a, 0),
            'g' | 'y' => e.exprs.extract(a, 1),
            'b' | 'z' => e.exprs.extract(a, 2),
            'a' | 'w' => e.exprs.extract(a, 3),
            c => e.exprs.number(f64::from(u8::from(c == '1'))),
        })
        .collect();
    match parts.as_slice() {
        [] => a,
        [one] => *one,
        _ if "rgba".starts_with(channels) || "xyzw".starts_with(channels) => a,
        _ => e.exprs.apply(F::Combine, &parts),
    }
}

/// One of the coordinates that a ramp goes along.
fn position(e: &mut Evaluator<'_, '_>, node: usize, place: u8) -> Id {
    let uv = e.optional(node, "texcoord").unwrap_or_else(|| e.texcoord("st".into()));
    let along = e.exprs.extract(uv, place);
    let (zero, one) = (e.exprs.number(0.0), e.exprs.number(1.0));
    e.exprs.apply(F::Math(Math::Clamp), &[along, zero, one])
}

fn ramp(e: &mut Evaluator<'_, '_>, node: usize, category: &str) -> Id {
    let across = category.ends_with("lr");
    let names = if across { ["valuel", "valuer"] } else { ["valueb", "valuet"] };
    let [low, high] = names.map(|name| e.input(node, name, [0.0; 4]));
    let along = position(e, node, u8::from(!across));
    if category.starts_with("ramp") {
        return e.exprs.mix(low, high, along);
    }
    let center = e.scalar(node, "center", 0.5);
    e.exprs.apply(F::IfGreaterOrEqual, &[along, center, high, low])
}
