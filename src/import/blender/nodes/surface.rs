//! Surfaces: the sum of shaders as one layered material.
//!
//! Every BSDF node is written in the parameters of the layered surface (`MaterialDesc`); a sum of several
//! is the one whose parameters are their weighted mean, which is told. What is transparent lowers alpha,
//! what emits is added.

use super::closure::{self, Part};
use super::flow::{At, Flow};
use super::lamp::emission;
use crate::desc::graph::{Math, ValueId};
use crate::desc::{
    AlphaMode, AnisotropyDesc, CoatDesc, ColorInput, MaterialDesc, NormalInput, ScalarInput, SheenDesc, VolumeDesc,
};

/// A BSDF in the parameters of the layered surface.
#[derive(Clone, Copy)]
struct Layered {
    base_color: ValueId,
    metallic: ValueId,
    roughness: ValueId,
    ior: ValueId,
    specular: ValueId,
    specular_color: ValueId,
    transmission: ValueId,
    coat: ValueId,
    coat_roughness: ValueId,
    coat_ior: ValueId,
    sheen: ValueId,
    sheen_roughness: ValueId,
    anisotropy: ValueId,
    anisotropy_rotation: ValueId,
    normal: Option<ValueId>,
    coat_normal: Option<ValueId>,
}

/// What one node does.
#[derive(Default)]
struct Meaning {
    bsdf: Option<Layered>,
    /// Share that passes unscattered, a number.
    transparent: Option<ValueId>,
    emission: Option<ValueId>,
    /// The camera sees a hole.
    holdout: bool,
}

/// `base` with the surface of the tree.
pub fn surface(flow: &mut Flow<'_, '_>, base: MaterialDesc) -> MaterialDesc {
    let parts = match flow.output_node("ShaderNodeOutputMaterial") {
        Some(output) => match output.node.input("Surface") {
            Some(input) => closure::parts(flow, output, input),
            None => Vec::new(),
        },
        None => Vec::new(),
    };
    let zero = flow.graph.number(0.0);
    let (mut transparent, mut emitted, mut scattered, mut holdout) = (zero, zero, Vec::new(), false);
    for part in parts {
        let Meaning { bsdf, transparent: passes, emission, holdout: is_hole } = meaning(flow, part);
        holdout |= is_hole;
        if let Some(passes) = passes {
            transparent = flow.graph.add(transparent, passes);
        }
        if let Some(emission) = emission {
            emitted = flow.graph.add(emitted, emission);
        }
        if let Some(bsdf) = bsdf {
            scattered.push((part.weight, bsdf));
        }
    }
    let opaque = {
        let one = flow.graph.number(1.0);
        let rest = flow.graph.subtract(one, transparent);
        flow.clamped(rest)
    };
    // Alpha multiplies all that the surface does; emission was the whole's.
    let emission = flow.graph.math(Math::Divide, &[emitted, opaque]);
    if flow.graph.known(opaque).is_some_and(|o| o[0] == 0.0) && flow.graph.known(emitted) != Some([0.0; 4]) {
        flow.warn("a surface that is wholly transparent and emits is not supported; its light is left out");
    }
    let black = black(flow);
    let mixed = mixed(flow, &scattered).unwrap_or(black);
    finish(flow, MaterialDesc { holdout, ..base }, mixed, opaque, emission)
}

/// The BSDF of the weighted mean of parameters; weights are relative.
fn mixed(flow: &mut Flow<'_, '_>, scattered: &[(ValueId, Layered)]) -> Option<Layered> {
    let (&(mut sum, mut mean), others) = scattered.split_first()?;
    for &(weight, next) in others {
        sum = flow.graph.add(sum, weight);
        let share = flow.graph.math(Math::Divide, &[weight, sum]);
        let mut mix = |a: ValueId, b: ValueId| flow.graph.mix(a, b, share);
        mean = Layered {
            base_color: mix(mean.base_color, next.base_color),
            metallic: mix(mean.metallic, next.metallic),
            roughness: mix(mean.roughness, next.roughness),
            ior: mix(mean.ior, next.ior),
            specular: mix(mean.specular, next.specular),
            specular_color: mix(mean.specular_color, next.specular_color),
            transmission: mix(mean.transmission, next.transmission),
            coat: mix(mean.coat, next.coat),
            coat_roughness: mix(mean.coat_roughness, next.coat_roughness),
            coat_ior: mix(mean.coat_ior, next.coat_ior),
            sheen: mix(mean.sheen, next.sheen),
            sheen_roughness: mix(mean.sheen_roughness, next.sheen_roughness),
            anisotropy: mix(mean.anisotropy, next.anisotropy),
            anisotropy_rotation: mix(mean.anisotropy_rotation, next.anisotropy_rotation),
            normal: mean.normal.or(next.normal),
            coat_normal: mean.coat_normal.or(next.coat_normal),
        };
    }
    if !others.is_empty() {
        flow.warn(format!("{} BSDFs are mixed by their parameters, not by what they scatter", scattered.len()));
    }
    Some(mean)
}

/// A surface that scatters nothing.
fn black(flow: &mut Flow<'_, '_>) -> Layered {
    let [zero, half, one] = [0.0, 0.5, 1.0].map(|x| flow.graph.number(x));
    let ior = flow.graph.number(1.5);
    Layered {
        base_color: zero,
        metallic: zero,
        roughness: half,
        ior,
        specular: zero,
        specular_color: one,
        transmission: zero,
        coat: zero,
        coat_roughness: zero,
        coat_ior: ior,
        sheen: zero,
        sheen_roughness: half,
        anisotropy: zero,
        anisotropy_rotation: zero,
        normal: None,
        coat_normal: None,
    }
}

fn meaning<'a>(flow: &mut Flow<'a, '_>, part: Part<'a>) -> Meaning {
    let Part { weight, at } = part;
    let none = black(flow);
    let one = flow.graph.number(1.0);
    let normal = flow.is_linked(at, "Normal").then(|| flow.input(at, "Normal"));
    let bsdf = match at.node.r#type.as_str() {
        "ShaderNodeBsdfPrincipled" => return principled(flow, at, weight, none),
        "ShaderNodeEmission" => {
            let emission = emission(flow, at, weight);
            return Meaning { emission: Some(emission), ..Meaning::default() };
        }
        "ShaderNodeBsdfTransparent" => {
            let color = flow.input(at, "Color");
            let share = flow.graph.luminance(color);
            if flow.graph.known(color).is_none_or(|c| c[0] != c[1] || c[1] != c[2]) {
                flow.warn("colored transparency is rendered gray");
            }
            let share = flow.graph.multiply(share, weight);
            return Meaning { transparent: Some(share), ..Meaning::default() };
        }
        "ShaderNodeHoldout" => {
            if flow.graph.known(weight) == Some([1.0; 4]) {
                return Meaning { holdout: true, ..Meaning::default() };
            }
            flow.warn("a Holdout that is mixed with others is rendered as transparent, which shows what lies behind");
            return Meaning { transparent: Some(weight), ..Meaning::default() };
        }
        "ShaderNodeBsdfDiffuse" => Layered { base_color: flow.input(at, "Color"), roughness: one, ..none },
        "ShaderNodeBsdfGlossy" | "ShaderNodeBsdfAnisotropic" | "ShaderNodeBsdfMetallic" => {
            let color = if at.node.input("Color").is_some() { "Color" } else { "Base Color" };
            let base_color = flow.input(at, color);
            let roughness = flow.input(at, "Roughness");
            Layered { base_color, metallic: one, roughness, ..none }
        }
        "ShaderNodeBsdfGlass" | "ShaderNodeBsdfRefraction" => {
            let base_color = squared(flow, at);
            let roughness = flow.input(at, "Roughness");
            let ior = flow.input(at, "IOR");
            let specular = if at.node.r#type == "ShaderNodeBsdfGlass" { one } else { none.specular };
            Layered { base_color, roughness, ior, specular, transmission: one, ..none }
        }
        "ShaderNodeBsdfSheen" => {
            let color = flow.input(at, "Color");
            Layered { sheen: color, sheen_roughness: flow.input(at, "Roughness"), ..none }
        }
        kind @ ("ShaderNodeBsdfTranslucent" | "ShaderNodeSubsurfaceScattering" | "ShaderNodeBsdfToon") => {
            flow.warn(format!("{} is rendered as a diffuse surface", &kind["ShaderNode".len()..]));
            Layered { base_color: flow.input(at, "Color"), roughness: one, ..none }
        }
        kind => {
            flow.warn(format!("the shader \"{}\" ({kind}) is not supported; it is black", at.node.name));
            return Meaning::default();
        }
    };
    Meaning { bsdf: Some(Layered { normal, ..bsdf }), ..Meaning::default() }
}

/// A color that the layered surface, which takes its root at each boundary, tints by as the Glass node
/// does.
fn squared<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> ValueId {
    let color = flow.input(at, "Color");
    flow.graph.multiply(color, color)
}

fn principled<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, weight: ValueId, none: Layered) -> Meaning {
    let value = |flow: &mut Flow<'a, '_>, name: &str| flow.input(at, name);
    let level = value(flow, "Specular IOR Level");
    let tint = value(flow, "Specular Tint");
    let double = flow.graph.scale(level, 2.0);
    let sheen_tint = value(flow, "Sheen Tint");
    let sheen = value(flow, "Sheen Weight");
    let one = flow.graph.number(1.0);
    let no_specular = flow.graph.known(level).is_some_and(|level| level[0] == 0.0);
    let bsdf = Layered {
        base_color: value(flow, "Base Color"),
        metallic: value(flow, "Metallic"),
        roughness: value(flow, "Roughness"),
        ior: value(flow, "IOR"),
        specular: if no_specular { none.specular } else { one },
        specular_color: flow.graph.multiply(tint, double),
        transmission: value(flow, "Transmission Weight"),
        coat: value(flow, "Coat Weight"),
        coat_roughness: value(flow, "Coat Roughness"),
        coat_ior: flow.input_or(at, "Coat IOR", 1.5),
        sheen: flow.graph.multiply(sheen, sheen_tint),
        sheen_roughness: value(flow, "Sheen Roughness"),
        anisotropy: value(flow, "Anisotropic"),
        anisotropy_rotation: value(flow, "Anisotropic Rotation"),
        normal: flow.is_linked(at, "Normal").then(|| flow.input(at, "Normal")),
        coat_normal: flow.is_linked(at, "Coat Normal").then(|| flow.input(at, "Coat Normal")),
    };
    let left_out: Vec<&str> = ["Subsurface Weight", "Thin Film Thickness", "Diffuse Roughness"]
        .into_iter()
        .filter(|name| {
            let value = flow.input(at, name);
            flow.graph.known(value) != Some([0.0; 4])
        })
        .collect();
    if !left_out.is_empty() {
        flow.warn(format!("{} of the Principled BSDF: not computed yet", left_out.join(", ")));
    }
    let alpha = value(flow, "Alpha");
    let through = flow.graph.subtract(one, alpha);
    let transparent = flow.graph.multiply(through, weight);
    let (color, strength) = (value(flow, "Emission Color"), value(flow, "Emission Strength"));
    let emitted = flow.graph.multiply(color, strength);
    let seen = flow.graph.multiply(emitted, alpha);
    let emission = flow.graph.multiply(seen, weight);
    Meaning { bsdf: Some(bsdf), transparent: Some(transparent), emission: Some(emission), holdout: false }
}

/// The material of its parameters, constants as such.
fn finish(flow: &mut Flow<'_, '_>, base: MaterialDesc, l: Layered, alpha: ValueId, emission: ValueId) -> MaterialDesc {
    let known = |flow: &Flow<'_, '_>, id: ValueId| flow.graph.known(id);
    let color = |flow: &Flow<'_, '_>, id: ValueId| match known(flow, id) {
        Some([r, g, b, _]) => ColorInput::constant([r, g, b]),
        None => ColorInput::graph(id),
    };
    let scalar = |flow: &Flow<'_, '_>, id: ValueId| match known(flow, id) {
        Some([x, ..]) => ScalarInput::constant(x),
        None => ScalarInput::graph(id),
    };
    let fixed = |flow: &mut Flow<'_, '_>, id: ValueId, name: &str, otherwise: f64| {
        let value = known(flow, id);
        if value.is_none() {
            flow.warn(format!("{name} varies over the surface, which is not supported; {otherwise} is taken"));
        }
        value.map_or(otherwise, |value| value[0])
    };
    let is_zero = |flow: &Flow<'_, '_>, id: ValueId| known(flow, id).is_some_and(|v| v[..3] == [0.0; 3]);
    let ior = fixed(flow, l.ior, "the IOR", 1.5);
    let coat = (!is_zero(flow, l.coat)).then(|| CoatDesc {
        weight: scalar(flow, l.coat),
        roughness: scalar(flow, l.coat_roughness),
        ior: fixed(flow, l.coat_ior, "the IOR of the coat", 1.5),
        normal: l.coat_normal.map(NormalInput::Graph),
    });
    let sheen = (!is_zero(flow, l.sheen))
        .then(|| SheenDesc { color: color(flow, l.sheen), roughness: scalar(flow, l.sheen_roughness) });
    let anisotropy = (!is_zero(flow, l.anisotropy)).then(|| AnisotropyDesc {
        strength: fixed(flow, l.anisotropy, "anisotropy", 0.0),
        rotation: fixed(flow, l.anisotropy_rotation, "the rotation of anisotropy", 0.0) * std::f64::consts::TAU,
        texture: None,
    });
    let solid = VolumeDesc {
        thickness: ScalarInput::constant(1.0),
        attenuation_distance: f64::INFINITY,
        attenuation_color: [1.0; 3],
    };
    let opaque = known(flow, alpha).is_some_and(|alpha| alpha[0] == 1.0);
    MaterialDesc {
        base_color: color(flow, l.base_color),
        alpha: scalar(flow, alpha),
        alpha_mode: if opaque { AlphaMode::Opaque } else { AlphaMode::Blend },
        metallic: scalar(flow, l.metallic),
        roughness: scalar(flow, l.roughness),
        ior,
        specular: scalar(flow, l.specular),
        specular_color: color(flow, l.specular_color),
        transmission: scalar(flow, l.transmission),
        volume: (!is_zero(flow, l.transmission)).then_some(solid),
        coat,
        sheen,
        anisotropy,
        emission: color(flow, emission),
        normal: l.normal.map(NormalInput::Graph),
        graph: std::mem::take(&mut flow.graph),
        ..base
    }
}
