//! The Principled BSDF as a layered surface.

use super::flow::{At, Flow};
use super::surface::{alpha_mode, anisotropy, color, film, input, normal, number, optional, scalar, solid, subsurface};
use crate::desc::graph::{Function, ValueId};
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

/// What is left of `emission` above sheen and coat.
fn covered<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, mut emission: ValueId) -> ValueId {
    let zero = |flow: &Flow<'_, '_>, value: ValueId| flow.graph.known(value).is_some_and(|v| v[..3] == [0.0; 3]);
    if zero(flow, emission) {
        return emission;
    }
    let own = flow.linked_or(at, "Normal", |flow| flow.normal());
    let (coat, mut top) = (flow.input(at, "Coat Weight"), own);
    if !zero(flow, coat) {
        let normal = flow.linked_or(at, "Coat Normal", |flow| flow.normal());
        top = flow.graph.mix(own, normal, coat);
        top = flow.graph.apply(Function::Normalize(3), &[top]);
        let (tint, roughness) = (flow.input(at, "Coat Tint"), flow.input(at, "Coat Roughness"));
        let ior = flow.input_or(at, "Coat IOR", 1.5);
        let below = flow.graph.below_coat(coat, tint, [roughness, ior, normal]);
        emission = flow.graph.multiply(emission, below);
    }
    let (sheen, tint) = (flow.input(at, "Sheen Weight"), flow.input(at, "Sheen Tint"));
    if !zero(flow, sheen) {
        let (color, roughness) = (flow.graph.multiply(sheen, tint), flow.input(at, "Sheen Roughness"));
        // Fibers stand on whatever is on top.
        let below = flow.graph.below_sheen(color, roughness, top);
        emission = flow.graph.multiply(emission, below);
    }
    emission
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
