//! The Principled BSDF as a layered surface.

use super::flow::{At, Flow};
use super::surface::{alpha_mode, anisotropy, color, film, fixed, input, normal, number, scalar, solid};
use crate::desc::graph::ValueId;
use crate::desc::{AnisotropyLaw, CoatDesc, ColorInput, MaterialDesc, ScalarInput, SheenDesc};

/// `base` as the surface of the node alone.
pub fn alone<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, base: MaterialDesc) -> MaterialDesc {
    let (layers, alpha, emission) = principled(flow, at);
    let MaterialDesc { name, place, material_index, .. } = base;
    MaterialDesc {
        name,
        place,
        material_index,
        alpha: scalar(flow, alpha),
        alpha_mode: alpha_mode(flow, alpha),
        emission: color(flow, emission),
        ..layers
    }
}

/// What the node scatters, its alpha and what it emits.
pub fn principled<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> (MaterialDesc, ValueId, ValueId) {
    let level = flow.input(at, "Specular IOR Level");
    let level = flow.graph.scale(level, 2.0);
    let ior = flow.input(at, "IOR");
    let transmission = number(flow, at, "Transmission Weight");
    let layers = MaterialDesc {
        base_color: input(flow, at, "Base Color"),
        metallic: number(flow, at, "Metallic"),
        metal_edge: input(flow, at, "Specular Tint"),
        diffuse_roughness: optional(flow, at, "Diffuse Roughness"),
        roughness: number(flow, at, "Roughness"),
        multiscatter: at.node.text("distribution") != "GGX",
        ior: fixed(flow, ior, "the IOR", 1.5),
        specular_color: input(flow, at, "Specular Tint"),
        specular_level: scalar(flow, level),
        transmission,
        volume: (transmission.factor > 0.0).then(solid),
        coat: coat(flow, at),
        sheen: sheen(flow, at),
        iridescence: film(flow, at),
        anisotropy: anisotropy(flow, at, "Anisotropic", "Anisotropic Rotation", AnisotropyLaw::Aspect),
        normal: normal(flow, at, "Normal"),
        ..MaterialDesc::default()
    };
    let subsurface = flow.input(at, "Subsurface Weight");
    if flow.graph.known(subsurface) != Some([0.0; 4]) {
        flow.warn("Subsurface Weight of the Principled BSDF: not computed yet, it is diffuse");
    }
    let alpha = flow.input(at, "Alpha");
    let (color, strength) = (flow.input(at, "Emission Color"), flow.input(at, "Emission Strength"));
    (layers, alpha, flow.graph.multiply(color, strength))
}

/// An input that older versions lack; 0 there.
fn optional<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> ScalarInput {
    match at.node.input(name) {
        Some(_) => number(flow, at, name),
        None => ScalarInput::constant(0.0),
    }
}

fn coat<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Option<CoatDesc> {
    let weight = number(flow, at, "Coat Weight");
    if weight.factor <= 0.0 {
        return None;
    }
    let ior = flow.input_or(at, "Coat IOR", 1.5);
    Some(CoatDesc {
        weight,
        roughness: number(flow, at, "Coat Roughness"),
        ior: fixed(flow, ior, "the IOR of the coat", 1.5),
        tint: input(flow, at, "Coat Tint"),
        normal: normal(flow, at, "Coat Normal"),
    })
}

fn sheen<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Option<SheenDesc> {
    let (weight, tint) = (flow.input(at, "Sheen Weight"), flow.input(at, "Sheen Tint"));
    let product = flow.graph.multiply(weight, tint);
    let color: ColorInput = color(flow, product);
    let roughness = number(flow, at, "Sheen Roughness");
    color.factor.iter().any(|&c| c > 0.0).then_some(SheenDesc { color, roughness })
}
