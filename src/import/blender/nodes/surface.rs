//! Surfaces: the sum of shaders as the parts of one material.
//!
//! Each BSDF node is a lobe with its weight and its normal; the Principled BSDF alone is the material's own layered
//! surface. What is transparent passes on top of that, what emits is added.

use super::aov;
use super::closure::{self, Part};
use super::displacement;
use super::flow::{At, Flow};
use super::lamp::emission;
use super::principled::{self, principled};
use super::volume;
use crate::desc::graph::{Leaf, ValueId};
use crate::desc::{
    AlphaMode, AnisotropyDesc, AnisotropyLaw, ClosureDesc, ColorInput, FacetsDesc, IridescenceDesc, MaterialDesc,
    NormalInput, PartDesc, ScalarInput, SheenDesc, SubsurfaceDesc, SubsurfaceMethod, VolumeDesc,
};

/// What the nodes of a surface come to.
#[derive(Default)]
struct Sum {
    parts: Vec<PartDesc>,
    /// Colors.
    transparent: Vec<ValueId>,
    emitted: Vec<ValueId>,
    holdout: bool,
}

/// `base` with the surface of the tree.
///
/// `displacement` is `material.displacement_method`.
pub fn surface(flow: &mut Flow<'_, '_>, base: MaterialDesc, displacement: &str) -> MaterialDesc {
    let output = flow.output_node("ShaderNodeOutputMaterial");
    let relief = output.and_then(|output| displacement::relief(flow, output, displacement));
    flow.set_relief(relief);
    let parts = match output.and_then(|output| Some((output, output.node.input("Surface")?))) {
        Some((output, input)) => closure::parts(flow, output, input),
        None => Vec::new(),
    };
    let inside = output.and_then(|output| volume::volume(flow, output));
    // A volume alone: nothing is at its boundary.
    let bare = inside.is_some() && output.is_some_and(|output| !flow.is_linked(output, "Surface"));
    let mut material = match parts[..] {
        [Part { weight, at, emitted: None }]
            if at.node.r#type == "ShaderNodeBsdfPrincipled"
                && flow.graph.known(weight) == Some([1.0; 4])
                && !(relief.is_some() && flow.is_linked(at, "Normal")) =>
        {
            principled::alone(flow, at, base)
        }
        _ => {
            let mut sum = Sum::default();
            for part in parts {
                add(flow, part, &mut sum);
            }
            mixed(flow, sum, base)
        }
    };
    material.volume = inside.or(material.volume);
    material.relief = relief.is_some();
    if bare {
        material.transparency = ColorInput::constant([1.0; 3]);
    }
    material.aovs = aov::outputs(flow);
    material.graph = std::mem::take(&mut flow.graph);
    material
}

/// `base` with a sum of shaders.
fn mixed(flow: &mut Flow<'_, '_>, sum: Sum, base: MaterialDesc) -> MaterialDesc {
    let Sum { parts, transparent, emitted, holdout } = sum;
    let mut total = |values: Vec<ValueId>| {
        let zero = flow.graph.constant([0.0; 4]);
        values.into_iter().fold(zero, |sum, value| flow.graph.add(sum, value))
    };
    let (transparent, emitted) = (total(transparent), total(emitted));
    let black = ScalarInput::constant(0.0);
    // Normals that are the same everywhere are the material's, and that of a relief is.
    let relief = flow.relief().map(NormalInput::Graph);
    let normal = relief.or(parts.first().and_then(|part| part.normal));
    let shared = relief.is_some() || parts.iter().all(|part| part.normal == normal);
    let own = |part: &PartDesc| part.normal.filter(|own| !(shared && Some(*own) == normal));
    let parts: Vec<_> = parts.into_iter().map(|part| PartDesc { normal: own(&part), ..part }).collect();
    let transmits = parts.iter().any(|part| part.closure.transmits());
    MaterialDesc {
        // Without parts nothing scatters.
        base_color: ColorInput::constant([0.0; 3]),
        specular: black,
        transparency: color(flow, transparent),
        emission: color(flow, emitted),
        normal: normal.filter(|_| shared),
        volume: transmits.then(solid),
        parts,
        holdout,
        ..base
    }
}

/// Adds what one shader does.
fn add<'a>(flow: &mut Flow<'a, '_>, part: Part<'a>, sum: &mut Sum) {
    if part.emits() {
        return sum.emitted.push(emission(flow, part));
    }
    let Part { weight, at, .. } = part;
    let closure = match at.node.r#type.as_str() {
        "ShaderNodeBsdfPrincipled" => {
            let (layers, alpha, emission) = principled(flow, at);
            let one = flow.graph.number(1.0);
            let through = flow.graph.subtract(one, alpha);
            sum.transparent.push(flow.graph.multiply(through, weight));
            let weight = flow.graph.multiply(weight, alpha);
            sum.emitted.push(flow.graph.multiply(emission, weight));
            let normal = layers.normal;
            let layers = MaterialDesc { normal: None, ..layers };
            let closure = ClosureDesc::Layered(Box::new(layers));
            sum.parts.push(PartDesc { weight: scalar(flow, weight), normal, closure });
            return;
        }
        "ShaderNodeBsdfTransparent" => {
            let color = flow.input(at, "Color");
            return sum.transparent.push(flow.graph.multiply(color, weight));
        }
        "ShaderNodeHoldout" => {
            if flow.graph.known(weight) == Some([1.0; 4]) {
                sum.holdout = true;
                return;
            }
            flow.warn("a Holdout that is mixed with others is rendered as transparent, which shows what lies behind");
            return sum.transparent.push(weight);
        }
        "ShaderNodeBsdfDiffuse" => {
            let (color, roughness) = (input(flow, at, "Color"), number(flow, at, "Roughness"));
            ClosureDesc::Diffuse { color, roughness, multiscatter: flow.version >= [4, 3, 0] }
        }
        "ShaderNodeBsdfTranslucent" => ClosureDesc::Translucent { color: input(flow, at, "Color") },
        "ShaderNodeBsdfGlossy" | "ShaderNodeBsdfAnisotropic" => glossy(flow, at),
        "ShaderNodeBsdfMetallic" => metallic(flow, at),
        "ShaderNodeBsdfGlass" => ClosureDesc::Glass {
            color: input(flow, at, "Color"),
            ior: number(flow, at, "IOR"),
            facets: facets(flow, at, None),
            film: film(flow, at),
        },
        "ShaderNodeBsdfRefraction" => ClosureDesc::Refraction {
            color: input(flow, at, "Color"),
            ior: number(flow, at, "IOR"),
            facets: facets(flow, at, None),
        },
        "ShaderNodeBsdfSheen" => {
            if at.node.text("distribution") == "ASHIKHMIN" {
                flow.warn("Ashikhmin's sheen is rendered as that of microfibers");
            }
            ClosureDesc::Sheen(SheenDesc { color: input(flow, at, "Color"), roughness: number(flow, at, "Roughness") })
        }
        "ShaderNodeBsdfToon" => ClosureDesc::Toon {
            color: input(flow, at, "Color"),
            size: number(flow, at, "Size"),
            smooth: number(flow, at, "Smooth"),
            glossy: at.node.text("component") == "GLOSSY",
        },
        "ShaderNodeSubsurfaceScattering" => {
            let names = ["Color", "Radius", "Scale", "Anisotropy", "IOR"];
            let subsurface = subsurface(flow, at, at.node.text("falloff"), names);
            ClosureDesc::Beneath { subsurface, alpha: optional(flow, at, "Roughness", 1.0) }
        }
        kind => {
            return flow.warn(format!("the shader \"{}\" ({kind}) is not supported; it is black", at.node.name));
        }
    };
    let normal = normal(flow, at, "Normal");
    sum.parts.push(PartDesc { weight: scalar(flow, weight), normal, closure });
}

/// Light beneath the surface, by the names of the inputs: color, radius, scale, anisotropy, index.
pub(super) fn subsurface<'a>(
    flow: &mut Flow<'a, '_>,
    at: At<'a>,
    method: &str,
    [color, radius, scale, anisotropy, ior]: [&str; 5],
) -> SubsurfaceDesc {
    let color = input(flow, at, color);
    let (radius, scale) = (flow.input(at, radius), flow.input(at, scale));
    let radius = flow.graph.multiply(radius, scale);
    SubsurfaceDesc {
        weight: ScalarInput::constant(1.0),
        color,
        radius: self::color(flow, radius),
        anisotropy: optional(flow, at, anisotropy, 0.0),
        ior: optional(flow, at, ior, 1.4),
        method: match method {
            "RANDOM_WALK_SKIN" => SubsurfaceMethod::RandomWalkSkin,
            "BURLEY" => SubsurfaceMethod::Burley,
            _ => SubsurfaceMethod::RandomWalk,
        },
        shallow: flow.version < [5, 0, 0] || method == "BURLEY",
    }
}

fn glossy<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> ClosureDesc {
    let color = input(flow, at, "Color");
    let anisotropy = anisotropy(flow, at, "Anisotropy", "Rotation", AnisotropyLaw::Glossy);
    ClosureDesc::Glossy { color, facets: facets(flow, at, anisotropy) }
}

fn metallic<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> ClosureDesc {
    let anisotropy = anisotropy(flow, at, "Anisotropy", "Rotation", AnisotropyLaw::Aspect);
    let facets = facets(flow, at, anisotropy);
    let film = film(flow, at);
    match at.node.text("fresnel_type") {
        "PHYSICAL_CONDUCTOR" => {
            ClosureDesc::Conductor { eta: input(flow, at, "IOR"), k: input(flow, at, "Extinction"), facets, film }
        }
        _ => {
            ClosureDesc::Metal { base: input(flow, at, "Base Color"), edge: input(flow, at, "Edge Tint"), facets, film }
        }
    }
}

fn facets<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, anisotropy: Option<AnisotropyDesc>) -> FacetsDesc {
    let distribution = at.node.text("distribution");
    if matches!(distribution, "BECKMANN" | "ASHIKHMIN_SHIRLEY") {
        flow.warn(format!("the distribution {distribution} of \"{}\" is rendered as GGX", at.node.name));
    }
    FacetsDesc { roughness: number(flow, at, "Roughness"), anisotropy, multiscatter: distribution == "MULTI_GGX" }
}

/// A thin film, where the node has one.
pub(super) fn film<'a>(flow: &mut Flow<'a, '_>, at: At<'a>) -> Option<IridescenceDesc> {
    at.node.input("Thin Film Thickness")?;
    let thickness = flow.input(at, "Thin Film Thickness");
    if flow.graph.known(thickness).is_some_and(|thickness| thickness[0] <= 0.0) {
        return None;
    }
    Some(IridescenceDesc {
        weight: ScalarInput::constant(1.0),
        ior: optional(flow, at, "Thin Film IOR", 1.33),
        thickness_min: 0.0,
        thickness_max: 1.0,
        thickness: scalar(flow, thickness),
        // The Metallic BSDF has one from 5.0 on, too.
        on_metal: flow.version >= [5, 0, 0],
    })
}

/// What microfacets are stretched along; `None` where they are not.
pub(super) fn anisotropy<'a>(
    flow: &mut Flow<'a, '_>,
    at: At<'a>,
    strength: &str,
    rotation: &str,
    law: AnisotropyLaw,
) -> Option<AnisotropyDesc> {
    at.node.input(strength)?;
    let strength = flow.input(at, strength);
    if flow.graph.known(strength).is_some_and(|strength| strength[0] == 0.0) {
        return None;
    }
    let rotation = flow.input(at, rotation);
    let rotation = flow.graph.scale(rotation, std::f64::consts::TAU);
    let tangent = flow.linked_or(at, "Tangent", |flow| flow.graph.leaf(Leaf::RadialTangent));
    Some(AnisotropyDesc {
        strength: scalar(flow, strength),
        rotation: scalar(flow, rotation),
        texture: None,
        tangent: Some(tangent),
        law,
    })
}

/// The normal that is linked to an input, or that the displacement makes.
pub(super) fn normal<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> Option<NormalInput> {
    let linked = flow.is_linked(at, name).then(|| flow.input(at, name));
    linked.or(flow.relief()).map(NormalInput::Graph)
}

pub(super) fn input<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> ColorInput {
    let value = flow.input(at, name);
    color(flow, value)
}

pub(super) fn number<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str) -> ScalarInput {
    let value = flow.input(at, name);
    scalar(flow, value)
}

/// An input that some versions lack; `otherwise` there.
pub(super) fn optional<'a>(flow: &mut Flow<'a, '_>, at: At<'a>, name: &str, otherwise: f64) -> ScalarInput {
    match at.node.input(name) {
        Some(_) => number(flow, at, name),
        None => ScalarInput::constant(otherwise),
    }
}

/// A value as an input, a constant as such.
pub(super) fn color(flow: &Flow<'_, '_>, value: ValueId) -> ColorInput {
    match flow.graph.known(value) {
        Some([r, g, b, _]) => ColorInput::constant([r, g, b]),
        None => ColorInput::graph(value),
    }
}

/// See [`color`].
pub(super) fn scalar(flow: &Flow<'_, '_>, value: ValueId) -> ScalarInput {
    match flow.graph.known(value) {
        Some([x, ..]) => ScalarInput::constant(x),
        None => ScalarInput::graph(value),
    }
}

/// The inside of a transmissive surface: light is bent and nothing is absorbed.
pub(super) fn solid() -> VolumeDesc {
    VolumeDesc {
        thickness: ScalarInput::constant(1.0),
        attenuation_distance: f64::INFINITY,
        attenuation_color: [1.0; 3],
        adds: true,
    }
}

/// How an opacity of `alpha` is read.
pub(super) fn alpha_mode(flow: &Flow<'_, '_>, alpha: ValueId) -> AlphaMode {
    let opaque = flow.graph.known(alpha).is_some_and(|alpha| alpha[0] == 1.0);
    if opaque { AlphaMode::Opaque } else { AlphaMode::Blend }
}
