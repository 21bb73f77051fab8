//! Surfaces put together from MaterialX's BSDF and EDF nodes, as Blender writes for everything that is not
//! its Principled node.

use super::evaluate::Evaluator;
use super::expr::{Exprs, Id};
use super::models::pass_thin_wall;
use super::surface::{Anisotropy, Beneath, Surface};
use crate::desc::graph::{Function, Math};
use crate::desc::{AnisotropyLaw, SubsurfaceMethod};

/// BSDF trees are followed so deep.
const DEEPEST: usize = 64;

/// The node `surface`: a BSDF, an EDF, opacity.
pub(super) fn surface(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let bsdf = source(e, node, "bsdf");
    let mut s = bsdf.and_then(|bsdf| scatters(e, bsdf, 0)).unwrap_or_else(|| black(e));
    if let Some(edf) = source(e, node, "edf") {
        s.emission = emits(e, edf, 0);
    }
    s.opacity = e.scalar(node, "opacity", 1.0);
    s.thin_walled = e.uniform(node, "thin_walled", 0.0) != 0.0;
    if s.thin_walled
        && let Some(Beneath { weight, color, .. }) = s.beneath.take()
    {
        let base = s.base_color;
        pass_thin_wall(e, &mut s, [base, color, weight], 1.0);
    }
    s
}

/// The node `surface_unlit`: emission, and what passes.
pub(super) fn unlit(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = black(e);
    let (weight, color) = (e.scalar(node, "emission", 1.0), e.input(node, "emission_color", [1.0; 4]));
    s.emission = e.exprs.multiply(color, weight);
    let (passes, opacity) = (e.scalar(node, "transmission", 0.0), e.scalar(node, "opacity", 1.0));
    let one = e.exprs.number(1.0);
    let stopped = e.exprs.subtract(one, passes);
    s.opacity = e.exprs.multiply(opacity, stopped);
    s
}

fn source(e: &Evaluator<'_, '_>, node: usize, input: &str) -> Option<usize> {
    Some(e.node(node).inputs.get(input)?.source.as_ref()?.node)
}

/// Nothing is reflected.
fn black(e: &mut Evaluator<'_, '_>) -> Surface {
    let zero = e.exprs.number(0.0);
    let roughness = e.exprs.number(1.0);
    Surface { base_color: zero, specular: zero, roughness, ..Surface::new(e) }
}

fn emits(e: &mut Evaluator<'_, '_>, node: usize, depth: usize) -> Id {
    let zero = e.exprs.number(0.0);
    if let Some(&known) = e.emission.get(&node) {
        return known;
    }
    if depth > DEEPEST {
        return zero;
    }
    e.emission.insert(node, zero);
    let light = shines(e, node, depth);
    e.emission.insert(node, light);
    light
}

fn shines(e: &mut Evaluator<'_, '_>, node: usize, depth: usize) -> Id {
    let zero = e.exprs.number(0.0);
    let of = |e: &mut Evaluator<'_, '_>, input: &str| match source(e, node, input) {
        Some(edf) => emits(e, edf, depth + 1),
        None => zero,
    };
    match e.node(node).category.as_str() {
        "uniform_edf" => e.input(node, "color", [1.0; 4]),
        "mix" => {
            let (bg, fg) = (of(e, "bg"), of(e, "fg"));
            let amount = e.scalar(node, "mix", 0.0);
            e.exprs.mix(bg, fg, amount)
        }
        "add" => {
            let (a, b) = (of(e, "in1"), of(e, "in2"));
            e.exprs.add(a, b)
        }
        "multiply" => {
            let (a, factor) = (of(e, "in1"), e.input(node, "in2", [1.0; 4]));
            e.exprs.multiply(a, factor)
        }
        other => {
            e.warn(node, format!("light of \"{other}\" isn't computed; left out"));
            zero
        }
    }
}

fn scatters(e: &mut Evaluator<'_, '_>, node: usize, depth: usize) -> Option<Surface> {
    if depth > DEEPEST {
        e.warn(node, "lies too deep in its network; left out");
        return None;
    }
    if let Some(known) = e.scattering.get(&node) {
        return known.clone();
    }
    e.scattering.insert(node, None);
    let surface = compute(e, node, depth);
    e.scattering.insert(node, surface.clone());
    surface
}

fn compute(e: &mut Evaluator<'_, '_>, node: usize, depth: usize) -> Option<Surface> {
    let of = |e: &mut Evaluator<'_, '_>, input: &str| {
        let bsdf = source(e, node, input)?;
        scatters(e, bsdf, depth + 1)
    };
    let category = e.node(node).category.as_str();
    Some(match category {
        "mix" => {
            let amount = e.scalar(node, "mix", 0.0);
            // What has no share is not looked at: Blender writes all of Principled's lobes.
            if e.exprs.is(amount, 0.0) {
                return of(e, "bg");
            }
            if e.exprs.is(amount, 1.0) {
                return of(e, "fg");
            }
            let (bg, fg) = (of(e, "bg"), of(e, "fg"));
            match (bg, fg) {
                (Some(bg), Some(fg)) => mixed(e, node, bg, fg, amount),
                (one, other) => one.or(other)?,
            }
        }
        "add" => {
            // A surface has one base: the first stands for both.
            let (a, b) = (of(e, "in1"), of(e, "in2"));
            if a.is_some() && b.is_some() {
                e.warn(node, "adds two BSDFs, which isn't computed; the mean of the two is used");
            }
            match (a, b) {
                (Some(a), Some(b)) => {
                    let half = e.exprs.number(0.5);
                    mixed(e, node, a, b, half)
                }
                (a, b) => a.or(b)?,
            }
        }
        "multiply" => {
            let mut s = of(e, "in1")?;
            let factor = e.input(node, "in2", [1.0; 4]);
            s.base_color = e.exprs.multiply(s.base_color, factor);
            if let Some((_, color)) = &mut s.translucent {
                *color = e.exprs.multiply(*color, factor);
            }
            if let Some(beneath) = &mut s.beneath {
                // A grey factor takes its share of the walks; what a color does to each of them is not known.
                let grey = e.exprs.known(factor).is_some_and(|[r, g, b, _]| r == g && g == b);
                let scaled = if grey { &mut beneath.weight } else { &mut beneath.color };
                *scaled = e.exprs.multiply(*scaled, factor);
            }
            let number = e.exprs.extract(factor, 0);
            s.specular = e.exprs.multiply(s.specular, number);
            s
        }
        "layer" => {
            let base = of(e, "base");
            match source(e, node, "top") {
                Some(top) => layered(e, top, base, depth)?,
                None => base?,
            }
        }
        "subsurface_bsdf" => beneath(e, node),
        "oren_nayar_diffuse_bsdf" | "burley_diffuse_bsdf" | "translucent_bsdf" => {
            let default = if category == "translucent_bsdf" { 1.0 } else { 0.18 };
            let mut s = black(e);
            s.base_color = e.input(node, "color", [default; 4]);
            weigh(e, node, &mut s.base_color);
            if category == "translucent_bsdf" {
                s.translucent = Some((e.exprs.number(1.0), s.base_color));
            }
            if category == "oren_nayar_diffuse_bsdf" {
                s.diffuse_roughness = e.scalar(node, "roughness", 0.0);
            }
            s.normal = e.optional(node, "normal");
            s
        }
        "dielectric_bsdf" | "generalized_schlick_bsdf" => dielectric(e, node),
        "conductor_bsdf" => conductor(e, node),
        "sheen_bsdf" => {
            let mut s = black(e);
            s.sheen = Some(sheen(e, node));
            s
        }
        other => {
            e.warn(node, format!("\"{other}\" isn't computed; left out"));
            return None;
        }
    })
}

/// A random walk inside of the object, in place of all diffuse light.
fn beneath(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = black(e);
    let radius = e.input(node, "radius", [1.0; 4]);
    let reading = &e.materials.reading;
    let (meters, blender) = (reading.meters, reading.blender);
    let radius = e.exprs.scale(radius, meters);
    s.beneath = Some(Beneath {
        weight: e.scalar(node, "weight", 1.0),
        color: e.input(node, "color", [0.18; 4]),
        radius,
        anisotropy: e.scalar(node, "anisotropy", 0.0),
        method: if blender { SubsurfaceMethod::RandomWalk } else { SubsurfaceMethod::FreePath },
    });
    s.normal = e.optional(node, "normal");
    s
}

/// `top` over `base`: a dielectric's reflection or sheen.
fn layered(e: &mut Evaluator<'_, '_>, top: usize, base: Option<Surface>, depth: usize) -> Option<Surface> {
    let Some(mut base) = base else { return scatters(e, top, depth + 1) };
    match e.node(top).category.as_str() {
        "dielectric_bsdf" | "generalized_schlick_bsdf" if e.node(top).text("scatter_mode") != Some("RT") => {
            let over = dielectric(e, top);
            if e.exprs.is(over.specular, 0.0) {
                return Some(base);
            }
            if !e.exprs.is(base.specular, 0.0) || e.exprs.is(base.metallic, 1.0) {
                let (weight, roughness, ior) = (over.specular, over.roughness, over.ior);
                let tint = e.exprs.number(1.0);
                base.coat = Some(super::surface::Coat { weight, roughness, ior, tint, normal: over.normal });
                return Some(base);
            }
            let normal = base.normal.or(over.normal);
            let Surface { base_color, transmission, sheen, translucent, beneath, diffuse_roughness, .. } = base;
            Some(Surface { base_color, transmission, sheen, translucent, beneath, diffuse_roughness, normal, ..over })
        }
        "sheen_bsdf" => {
            base.sheen = Some(sheen(e, top));
            Some(base)
        }
        _ => {
            e.warn(top, "lies over another BSDF, which isn't computed; the one beneath is used");
            Some(base)
        }
    }
}

fn sheen(e: &mut Evaluator<'_, '_>, node: usize) -> (Id, Id) {
    let mut color = e.input(node, "color", [1.0; 4]);
    weigh(e, node, &mut color);
    (color, e.scalar(node, "roughness", 0.3))
}

fn weigh(e: &mut Evaluator<'_, '_>, node: usize, color: &mut Id) {
    let weight = e.scalar(node, "weight", 1.0);
    *color = e.exprs.multiply(*color, weight);
}

fn dielectric(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = black(e);
    s.specular = e.scalar(node, "weight", 1.0);
    if e.node(node).category == "dielectric_bsdf" {
        s.ior = e.scalar(node, "ior", 1.5);
        s.specular_color = e.input(node, "tint", [1.0; 4]);
    } else {
        // F0 itself: at index 1.5 that is 0.04 times the tint.
        let f0 = e.input(node, "color0", [1.0; 4]);
        s.specular_color = e.exprs.scale(f0, 25.0);
    }
    roughness(e, node, &mut s);
    s.normal = e.optional(node, "normal");
    if matches!(e.node(node).text("scatter_mode"), Some("T" | "RT")) {
        let tint = e.input(node, "tint", [1.0; 4]);
        (s.transmission, s.base_color) = (s.specular, tint);
        if e.node(node).text("scatter_mode") == Some("RT") {
            (s.specular, s.specular_color) = (e.exprs.number(1.0), e.exprs.number(1.0));
        } else {
            s.specular = e.exprs.number(0.0);
        }
    }
    s
}

fn conductor(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = black(e);
    s.metallic = e.exprs.number(1.0);
    // Reflectance is what artistic_ior started from, or follows from index and extinction.
    let artistic = source(e, node, "ior").filter(|ior| e.node(*ior).category == "artistic_ior");
    s.base_color = match artistic {
        Some(artistic) => e.input(artistic, "reflectivity", [0.944, 0.776, 0.373, 1.0]),
        None => {
            let n = e.input(node, "ior", [0.183, 0.421, 1.373, 1.0]);
            let k = e.input(node, "extinction", [3.424, 2.346, 1.77, 0.0]);
            let x = &mut e.exprs;
            let (one, k2) = (x.number(1.0), x.multiply(k, k));
            let (below, above) = (x.subtract(n, one), x.add(n, one));
            let (below, above) = (x.multiply(below, below), x.multiply(above, above));
            let (below, above) = (x.add(below, k2), x.add(above, k2));
            x.apply(Function::Math(Math::Divide), &[below, above])
        }
    };
    weigh(e, node, &mut s.base_color);
    roughness(e, node, &mut s);
    s.normal = e.optional(node, "normal");
    s
}

/// The `roughness` of a microfacet node, which is the width α along the tangent and across it; ours is its
/// root. Blender writes the root into nodes that it fills in itself.
fn roughness(e: &mut Evaluator<'_, '_>, node: usize, s: &mut Surface) {
    if let Some(from) = source(e, node, "roughness")
        && matches!(e.node(from).category.as_str(), "roughness_anisotropy" | "open_pbr_anisotropy")
    {
        let law = match e.node(from).category.as_str() {
            "open_pbr_anisotropy" => AnisotropyLaw::OpenPbr,
            _ => AnisotropyLaw::RoughnessAnisotropy,
        };
        s.roughness = e.scalar(from, "roughness", 0.0);
        let strength = e.scalar(from, "anisotropy", 0.0);
        if !e.exprs.is(strength, 0.0) {
            let rotation = tangent(e, node, "tangent");
            s.anisotropy = Some(Anisotropy { strength, rotation: e.exprs.number(rotation), law });
        }
        return;
    }
    let width = e.input(node, "roughness", [0.05; 4]);
    let width = e.exprs.extract(width, 0);
    s.roughness = if e.materials.reading.blender { width } else { e.exprs.apply(Function::Math(Math::Sqrt), &[width]) };
}

/// The angle, in radians counter-clockwise, by which the network turns the tangent in `input`. MaterialX
/// turns clockwise.
pub(super) fn tangent(e: &mut Evaluator<'_, '_>, node: usize, input: &str) -> f64 {
    let mut angle = 0.0;
    let mut at = source(e, node, input);
    for _ in 0..DEEPEST {
        let Some(node) = at else { return angle };
        match e.node(node).category.as_str() {
            "tangent" => return angle,
            "normalize" => {}
            "rotate3d" => angle -= e.uniform(node, "amount", 0.0).to_radians(),
            _ => break,
        }
        at = source(e, node, "in");
    }
    e.warn(node, format!("its {input} isn't computed; the tangent of the UVs is used"));
    0.0
}

/// Between two surfaces, input by input. What only one of them has is there by its share.
fn mixed(e: &mut Evaluator<'_, '_>, node: usize, bg: Surface, fg: Surface, amount: Id) -> Surface {
    if bg.normal != fg.normal && bg.normal.is_some() && fg.normal.is_some() {
        e.warn(node, "mixes two normal maps; the one of the background is used");
    }
    let zero = e.exprs.number(0.0);
    let x = &mut e.exprs;
    let sheen = match (bg.sheen, fg.sheen) {
        (None, None) => None,
        (a, b) => {
            let roughness = a.or(b).map_or(zero, |sheen| sheen.1);
            let color = |sheen: Option<(Id, Id)>| sheen.map_or(zero, |sheen| sheen.0);
            Some((x.mix(color(a), color(b), amount), roughness))
        }
    };
    let diffuse = diffuse(x, &bg, &fg, amount);
    Surface {
        base_color: diffuse.reflected,
        translucent: diffuse.passed,
        beneath: diffuse.beneath,
        diffuse_roughness: x.mix(bg.diffuse_roughness, fg.diffuse_roughness, amount),
        metallic: x.mix(bg.metallic, fg.metallic, amount),
        roughness: match (reflects(x, &bg), reflects(x, &fg)) {
            (true, true) => x.mix(bg.roughness, fg.roughness, amount),
            (false, true) => fg.roughness,
            _ => bg.roughness,
        },
        ior: if reflects(x, &bg) { bg.ior } else { fg.ior },
        specular: x.mix(bg.specular, fg.specular, amount),
        specular_color: if reflects(x, &bg) { bg.specular_color } else { fg.specular_color },
        transmission: x.mix(bg.transmission, fg.transmission, amount),
        sheen,
        coat: bg.coat.or(fg.coat),
        anisotropy: bg.anisotropy.or(fg.anisotropy),
        normal: bg.normal.or(fg.normal),
        ..bg
    }
}

/// What is not a matter of microfacets.
struct Diffuse {
    reflected: Id,
    /// Share and color.
    passed: Option<(Id, Id)>,
    beneath: Option<Beneath>,
}

/// The diffuse parts of two surfaces together: on each side, and beneath, what they put there.
fn diffuse(x: &mut Exprs, bg: &Surface, fg: &Surface, amount: Id) -> Diffuse {
    let both = [bg, fg];
    if both.iter().all(|s| s.translucent.is_none() && s.beneath.is_none()) {
        return Diffuse { reflected: x.mix(bg.base_color, fg.base_color, amount), passed: None, beneath: None };
    }
    let (zero, one) = (x.number(0.0), x.number(1.0));
    // Of all diffuse light: what passes, what goes beneath of the rest, what is left.
    let passes = both.map(|s| s.translucent.unwrap_or((zero, zero)));
    let kept = passes.map(|(share, _)| x.subtract(one, share));
    let walks = [0, 1].map(|i| both[i].beneath.map_or(zero, |beneath| x.multiply(kept[i], beneath.weight)));
    let stays = [0, 1].map(|i| x.subtract(kept[i], walks[i]));
    let mut mean = |shares: [Id; 2], values: [Id; 2]| {
        let [below, above] = [0, 1].map(|i| x.multiply(shares[i], values[i]));
        let (sum, share) = (x.mix(below, above, amount), x.mix(shares[0], shares[1], amount));
        (x.math(Math::Divide, &[sum, share]), share)
    };
    let (reflected, _) = mean(stays, both.map(|s| s.base_color));
    let passed = both.iter().any(|s| s.translucent.is_some()).then(|| {
        let (color, share) = mean(passes.map(|(share, _)| share), passes.map(|(_, color)| color));
        (share, color)
    });
    let beneath = bg.beneath.or(fg.beneath).map(|some| {
        let of = |i: usize, part: fn(&Beneath) -> Id| both[i].beneath.as_ref().map_or(zero, part);
        let mut of_both = |part: fn(&Beneath) -> Id| mean(walks, [of(0, part), of(1, part)]);
        let (color, share) = of_both(|beneath| beneath.color);
        let (radius, _) = of_both(|beneath| beneath.radius);
        let (anisotropy, _) = of_both(|beneath| beneath.anisotropy);
        Beneath { weight: share, color, radius, anisotropy, ..some }
    });
    let beneath = beneath.map(|beneath| {
        let passed = passed.map_or(zero, |(share, _)| share);
        let rest = x.subtract(one, passed);
        Beneath { weight: x.math(Math::Divide, &[beneath.weight, rest]), ..beneath }
    });
    Diffuse { reflected, passed, beneath }
}

/// Whether a surface has anything that its roughness shows in.
fn reflects(x: &Exprs, s: &Surface) -> bool {
    !x.is(s.specular, 0.0) || !x.is(s.metallic, 0.0) || !x.is(s.transmission, 0.0)
}
