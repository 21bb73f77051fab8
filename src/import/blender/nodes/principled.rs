//! The Principled BSDF as a layered surface.

use super::flow::{At, Flow};
use super::surface::{alpha_mode, anisotropy, color, film, input, normal, number, optional, scalar, solid, subsurface};
use crate::desc::graph::{Function, Leaf, Math, ValueId};
use crate::desc::{AnisotropyLaw, CoatDesc, ColorInput, MaterialDesc, SheenDesc, SubsurfaceDesc};

/// `base` as the surface of the node alone.
pub fn alone<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, base: MaterialDesc) -> MaterialDesc {
    let (layers, alpha, emission) = principled(flow, at);
    let MaterialDesc { name, place, material_index, bump_correction, .. } = base;
    MaterialDesc {
        name,
        place,
        material_index,
        bump_correction,
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
    let transmission = number(flow, at, "Transmission Weight");
    let layers = MaterialDesc {
        base_color: input(flow, at, "Base Color"),
        unbounded: true,
        metallic: number(flow, at, "Metallic"),
        metal_edge: input(flow, at, "Specular Tint"),
        diffuse_roughness: optional(flow, at, "Diffuse Roughness", 0.0),
        roughness: number(flow, at, "Roughness"),
        multiscatter: at.node.text("distribution") != "GGX",
        ior: number(flow, at, "IOR"),
        specular_color: input(flow, at, "Specular Tint"),
        specular_level: scalar(flow, level),
        transmission,
        volume: (transmission.factor > 0.0).then(solid),
        subsurface: beneath(flow, at),
        coat: coat(flow, at),
        sheen: sheen(flow, at),
        iridescence: film(flow, at),
        anisotropy: anisotropy(flow, at, "Anisotropic", "Anisotropic Rotation", AnisotropyLaw::Aspect),
        normal: normal(flow, at, "Normal"),
        ..MaterialDesc::default()
    };
    let alpha = flow.input(at, "Alpha");
    let (color, strength) = (flow.input(at, "Emission Color"), flow.input(at, "Emission Strength"));
    let emission = flow.graph.multiply(color, strength);
    (layers, alpha, covered(flow, at, emission))
}

/// What is left of `emission` above the coat, taken for smooth.
fn covered<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, emission: ValueId) -> ValueId {
    let zero = |flow: &Flow<'_, '_>, value: ValueId| flow.graph.known(value).is_some_and(|v| v[..3] == [0.0; 3]);
    let weight = flow.input(at, "Coat Weight");
    if zero(flow, emission) {
        return emission;
    }
    let sheen = flow.input(at, "Sheen Weight");
    if !zero(flow, sheen) {
        flow.warn("the sheen of a Principled BSDF does not dim its emission");
    }
    if zero(flow, weight) {
        return emission;
    }
    let ior = flow.input_or(at, "Coat IOR", 1.5);
    let normal = flow.linked_or(at, "Coat Normal", |flow| flow.normal());
    let one = flow.graph.number(1.0);
    let reflected = flow.graph.fresnel(ior, normal);
    let reflected = flow.graph.multiply(reflected, weight);
    let passed = flow.graph.subtract(one, reflected);
    // tint^(1/cos) for the cosine within the coat, cos² = 1 − (1 − (n·wo)²) / ior².
    let incoming = flow.graph.leaf(Leaf::Incoming);
    let cos = flow.graph.apply(Function::Dot(3), &[incoming, normal]);
    let sine = flow.graph.multiply(cos, cos);
    let sine = flow.graph.subtract(one, sine);
    let squared = flow.graph.multiply(ior, ior);
    let within = flow.graph.math(Math::Divide, &[sine, squared]);
    let within = flow.graph.subtract(one, within);
    let within = flow.graph.math(Math::Sqrt, &[within]);
    let depth = flow.graph.math(Math::Divide, &[one, within]);
    let tint = flow.input(at, "Coat Tint");
    let tint = flow.graph.math(Math::Power, &[tint, depth]);
    let tint = flow.graph.mix(one, tint, weight);
    let emission = flow.graph.multiply(emission, passed);
    flow.graph.multiply(emission, tint)
}

fn beneath<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Option<SubsurfaceDesc> {
    let weight = number(flow, at, "Subsurface Weight");
    if weight.factor <= 0.0 {
        return None;
    }
    let method = at.node.text("subsurface_method");
    let names = ["Base Color", "Subsurface Radius", "Subsurface Scale", "Subsurface Anisotropy", "Subsurface IOR"];
    Some(SubsurfaceDesc { weight, ..subsurface(flow, at, method, names) })
}

fn coat<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Option<CoatDesc> {
    let weight = number(flow, at, "Coat Weight");
    if weight.factor <= 0.0 {
        return None;
    }
    Some(CoatDesc {
        weight,
        roughness: number(flow, at, "Coat Roughness"),
        ior: optional(flow, at, "Coat IOR", 1.5),
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
