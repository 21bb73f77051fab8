//! The shading models: UsdPreviewSurface, and those of MaterialX.
//!
//! Defaults and meaning: <https://openusd.org/release/spec_usdpreviewsurface.html>, and the definitions in
//! `libraries/bxdf` of MaterialX 1.39.

use super::evaluate::Evaluator;
use super::expr::Id;
use super::network::Source;
use super::surface::{Alpha, Anisotropy, Beneath, Coat, Film, Surface};
use super::{closure, coat, open_pbr};
use crate::desc::graph::{Function, Math};
use crate::desc::{AnisotropyLaw, SubsurfaceMethod};

/// Reflectance at normal incidence of index 1.5.
const F0_OF_1_5: f64 = 0.04;

/// The surface of a node, `None` for a model that isn't known.
pub(super) fn read(e: &mut Evaluator<'_, '_>, source: &Source) -> Option<Surface> {
    let node = source.node;
    match e.node(node).category.as_str() {
        "UsdPreviewSurface" => Some(preview(e, node)),
        "standard_surface" => Some(standard_surface(e, node)),
        "open_pbr_surface" => Some(open_pbr::surface(e, node)),
        "gltf_pbr" => Some(gltf(e, node)),
        "surface" => Some(closure::surface(e, node)),
        "surface_unlit" => Some(closure::unlit(e, node)),
        _ => None,
    }
}

/// UsdPreviewSurface.
fn preview(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = Surface::new(e);
    s.base_color = e.input(node, "diffuseColor", [0.18, 0.18, 0.18, 1.0]);
    s.roughness = e.scalar(node, "roughness", 0.5);
    s.emission = e.input(node, "emissiveColor", [0.0; 4]);
    s.ior = e.scalar(node, "ior", 1.5);
    s.normal = e.optional(node, "normal");
    let (weight, roughness) = (e.scalar(node, "clearcoat", 0.0), e.scalar(node, "clearcoatRoughness", 0.01));
    let tint = e.exprs.number(1.0);
    s.coat = Some(Coat { weight, roughness, ior: s.ior, tint, normal: s.normal });
    if e.uniform(node, "useSpecularWorkflow", 0.0) == 0.0 {
        s.metallic = e.scalar(node, "metallic", 0.0);
    } else {
        // F0 is the color itself and F90 white, whatever the index.
        let color = e.input(node, "specularColor", [0.0, 0.0, 0.0, 1.0]);
        s.specular_color = e.exprs.scale(color, 1.0 / F0_OF_1_5);
        s.ior = e.exprs.number(1.5);
    }
    s.opacity = e.scalar(node, "opacity", 1.0);
    let threshold = e.uniform(node, "opacityThreshold", 0.0);
    s.alpha = match is_presence(e, node) {
        _ if threshold > 0.0 => Alpha::Mask(threshold),
        true => Alpha::Blend,
        false => Alpha::Clear,
    };
    s.occlusion = e.optional(node, "occlusion");
    let displacement = e.scalar(node, "displacement", 0.0);
    if !e.exprs.is(displacement, 0.0) {
        e.warn(node, "its displacement is left out: not computed yet");
    }
    s
}

/// opacityMode: true where opacity fades the whole surface, false where it fades what is beneath its reflections.
/// Blender writes Principled's alpha as opacity, and no mode.
fn is_presence(e: &mut Evaluator<'_, '_>, node: usize) -> bool {
    match e.node(node).text("opacityMode") {
        Some("presence") => true,
        Some("transparent") => false,
        Some(other) => {
            e.warn(node, format!("there is no opacityMode \"{other}\"; \"transparent\" is used"));
            false
        }
        // MaterialX has the place in the list.
        None if e.node(node).has("opacityMode") => e.uniform(node, "opacityMode", 0.0) == 1.0,
        None => e.materials.reading.blender,
    }
}

fn standard_surface(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = Surface::new(e);
    // Version 1.0.0 of the node had 0.8 and white for 1 and 0.8: the same product.
    let base = weighted(e, node, ["base", "base_color"], [1.0, 0.8]);
    let subsurface = e.scalar(node, "subsurface", 0.0);
    let beneath = e.input(node, "subsurface_color", [1.0; 4]);
    s.thin_walled = e.uniform(node, "thin_walled", 0.0) != 0.0;
    if s.thin_walled {
        pass_thin_wall(e, &mut s, [base, beneath, subsurface], 1.0);
    } else {
        let radius = weighted(e, node, ["subsurface_scale", "subsurface_radius"], [1.0, 1.0]);
        scatter_beneath(e, node, &mut s, [base, beneath, subsurface, radius], "subsurface_anisotropy");
    }
    s.diffuse_roughness = e.scalar(node, "diffuse_roughness", 0.0);
    s.metallic = e.scalar(node, "metalness", 0.0);
    s.specular = e.scalar(node, "specular", 1.0);
    s.specular_color = e.input(node, "specular_color", [1.0; 4]);
    s.metal_edge = s.specular_color;
    s.roughness = e.scalar(node, "specular_roughness", 0.2);
    s.ior = e.scalar(node, "specular_IOR", 1.5);
    s.anisotropy = Some(stretched(e, node));
    s.transmission = e.scalar(node, "transmission", 0.0);
    transmit(e, node, &mut s);
    let abbe = e.uniform(node, "transmission_dispersion", 0.0);
    s.dispersion = if abbe > 0.0 { 20.0 / abbe } else { 0.0 };
    if e.materials.reading.blender {
        of_principled(e, &mut s);
    } else {
        left_out(e, node, "transmission_extra_roughness", "extra roughness of transmission");
    }
    s.coat = Some(Coat {
        weight: e.scalar(node, "coat", 0.0),
        roughness: e.scalar(node, "coat_roughness", 0.1),
        ior: e.scalar(node, "coat_IOR", 1.5),
        tint: e.input(node, "coat_color", [1.0; 4]),
        normal: e.optional(node, "coat_normal"),
    });
    for (input, what) in [
        ("coat_affect_color", "coat's effect on the color beneath"),
        ("coat_affect_roughness", "coat's effect on the roughness beneath"),
        ("coat_anisotropy", "coat's anisotropy"),
    ] {
        left_out(e, node, input, what);
    }
    let sheen = weighted(e, node, ["sheen", "sheen_color"], [0.0, 1.0]);
    s.sheen = Some((sheen, e.scalar(node, "sheen_roughness", 0.3)));
    s.film = Some(Film {
        weight: e.exprs.number(1.0),
        ior: e.scalar(node, "thin_film_IOR", 1.5),
        thickness: e.scalar(node, "thin_film_thickness", 0.0),
    });
    s.emission = weighted(e, node, ["emission", "emission_color"], [0.0, 1.0]);
    let opacity = e.input(node, "opacity", [1.0; 4]);
    s.opacity = as_number(e, opacity);
    s.normal = e.optional(node, "normal");
    coat::dim_emission(e, &mut s);
    s
}

/// What Blender 4.2 means by the node: it writes the inputs of its Principled BSDF under the names that are nearest.
/// Specular levels are factors of F0, 0.5 for 1; the roughness stands thrice, for that of the diffuse base and for
/// an extra one of what is transmitted too, which that BSDF lacks.
fn of_principled(e: &mut Evaluator<'_, '_>, s: &mut Surface) {
    let factor = e.exprs.scale(s.specular, 2.0);
    s.specular_color = e.exprs.multiply(s.specular_color, factor);
    s.specular = e.exprs.number(1.0);
    s.diffuse_roughness = e.exprs.number(0.0);
    s.anisotropy = s.anisotropy.map(|stretched| Anisotropy { law: AnisotropyLaw::Aspect, ..stretched });
}

/// specular_anisotropy along the tangent, which specular_rotation turns as rotate3d does: MaterialX turns clockwise,
/// the Principled BSDF counter-clockwise.
fn stretched(e: &mut Evaluator<'_, '_>, node: usize) -> Anisotropy {
    let way = if e.materials.reading.blender { 1.0 } else { -1.0 };
    let turns = e.scalar(node, "specular_rotation", 0.0);
    let (own, turned) = (closure::tangent(e, node, "tangent"), e.exprs.scale(turns, way * std::f64::consts::TAU));
    let own = e.exprs.number(own);
    Anisotropy {
        strength: e.scalar(node, "specular_anisotropy", 0.0),
        rotation: e.exprs.add(own, turned),
        law: AnisotropyLaw::RoughnessAnisotropy,
    }
}

fn gltf(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = Surface::new(e);
    s.base_color = e.input(node, "base_color", [1.0; 4]);
    s.metallic = e.scalar(node, "metallic", 1.0);
    s.roughness = e.scalar(node, "roughness", 1.0);
    s.normal = e.optional(node, "normal");
    s.occlusion = e.optional(node, "occlusion");
    s.transmission = e.scalar(node, "transmission", 0.0);
    s.specular = e.scalar(node, "specular", 1.0);
    s.specular_color = e.input(node, "specular_color", [1.0; 4]);
    s.ior = e.scalar(node, "ior", 1.5);
    s.opacity = e.scalar(node, "alpha", 1.0);
    s.alpha = match e.uniform(node, "alpha_mode", 0.0) {
        1.0 => Alpha::Mask(e.uniform(node, "alpha_cutoff", 0.5)),
        2.0 => Alpha::Blend,
        _ => Alpha::Ignored,
    };
    s.film = Some(Film {
        weight: e.scalar(node, "iridescence", 0.0),
        ior: e.scalar(node, "iridescence_ior", 1.3),
        thickness: e.scalar(node, "iridescence_thickness", 100.0),
    });
    let sheen = e.input(node, "sheen_color", [0.0; 4]);
    s.sheen = Some((sheen, e.scalar(node, "sheen_roughness", 0.0)));
    s.coat = Some(Coat {
        weight: e.scalar(node, "clearcoat", 0.0),
        roughness: e.scalar(node, "clearcoat_roughness", 0.0),
        ior: e.exprs.number(1.5),
        tint: e.exprs.number(1.0),
        normal: e.optional(node, "clearcoat_normal"),
    });
    s.emission = weighted(e, node, ["emissive_strength", "emissive"], [1.0, 0.0]);
    let thickness = e.scalar(node, "thickness", 0.0);
    s.thin_walled = e.exprs.is(thickness, 0.0);
    let distance = e.uniform(node, "attenuation_distance", f64::INFINITY);
    let color = e.input(node, "attenuation_color", [1.0; 4]);
    s.attenuation = (distance > 0.0).then_some((distance * e.materials.reading.meters, color));
    let strength = e.scalar(node, "anisotropy_strength", 0.0);
    let rotation = e.scalar(node, "anisotropy_rotation", 0.0);
    s.anisotropy = Some(Anisotropy { strength, rotation, law: AnisotropyLaw::Gltf });
    s.dispersion = e.uniform(node, "dispersion", 0.0);
    coat::dim_emission(e, &mut s);
    s
}

/// A weight times a color.
pub(super) fn weighted(e: &mut Evaluator<'_, '_>, node: usize, names: [&str; 2], defaults: [f64; 2]) -> Id {
    let weight = e.scalar(node, names[0], defaults[0]);
    let color = e.input(node, names[1], [defaults[1]; 4]);
    e.exprs.multiply(color, weight)
}

/// Transmission's color: the tint of the base where it has no depth, that of the inside where it has one.
/// MaterialX tints each passage by it; a base color is what is left after two (Cycles), and that is what
/// Blender exports.
pub(super) fn transmit(e: &mut Evaluator<'_, '_>, node: usize, s: &mut Surface) {
    if e.exprs.is(s.transmission, 0.0) {
        return;
    }
    let color = e.input(node, "transmission_color", [1.0; 4]);
    let depth = e.uniform(node, "transmission_depth", 0.0);
    let scatter = e.input(node, "transmission_scatter", [0.0; 4]);
    if !e.exprs.is(scatter, 0.0) {
        e.warn(node, "its transmission_scatter is left out: light isn't scattered inside yet");
    }
    let tint = if depth > 0.0 { e.exprs.number(1.0) } else { color };
    s.base_color = e.exprs.mix(s.base_color, tint, s.transmission);
    if depth > 0.0 {
        s.attenuation = Some((depth * e.materials.reading.meters, color));
    }
}

/// The diffuse part: `base`, and by its weight light that is scattered `beneath` on paths of a `radius` in the stage's
/// units. Blender writes its own radius, which is no mean free path.
pub(super) fn scatter_beneath(
    e: &mut Evaluator<'_, '_>,
    node: usize,
    s: &mut Surface,
    [base, beneath, weight, radius]: [Id; 4],
    anisotropy: &str,
) {
    s.base_color = base;
    if e.exprs.is(weight, 0.0) {
        return;
    }
    let reading = &e.materials.reading;
    let (meters, blender) = (reading.meters, reading.blender);
    s.beneath = Some(Beneath {
        weight,
        color: beneath,
        radius: e.exprs.scale(radius, meters),
        anisotropy: e.scalar(node, anisotropy, 0.0),
        method: if blender { SubsurfaceMethod::RandomWalk } else { SubsurfaceMethod::FreePath },
    });
}

/// The diffuse part of a thin wall: of what light that is scattered `beneath` comes to, the share `forward` leaves on
/// the other side.
pub(super) fn pass_thin_wall(
    e: &mut Evaluator<'_, '_>,
    s: &mut Surface,
    [base, beneath, weight]: [Id; 3],
    forward: f64,
) {
    if e.exprs.is(weight, 0.0) {
        s.base_color = base;
        return;
    }
    let x = &mut e.exprs;
    let (passes, one) = (x.scale(weight, forward), x.number(1.0));
    // What stays on this side is mixed by what is left of the weights.
    let (kept, back) = (x.subtract(one, weight), x.scale(weight, 1.0 - forward));
    let (of_base, of_beneath) = (x.multiply(base, kept), x.multiply(beneath, back));
    let (sum, stays) = (x.add(of_base, of_beneath), x.subtract(one, passes));
    s.base_color = x.math(Math::Divide, &[sum, stays]);
    s.translucent = Some((passes, beneath));
}

pub(super) fn left_out(e: &mut Evaluator<'_, '_>, node: usize, input: &str, what: &str) {
    let value = e.scalar(node, input, 0.0);
    if !e.exprs.is(value, 0.0) {
        e.warn(node, format!("its {what} is left out: not computed yet"));
    }
}

/// A color read as a number: itself where it is grey, else its luminance (Rec.709).
fn as_number(e: &mut Evaluator<'_, '_>, color: Id) -> Id {
    use super::expr::Op;
    let grey = match e.exprs.op(color) {
        Op::Constant([r, g, b, _]) => r == g && g == b,
        Op::Lookup(l) => {
            let same = |v: [f64; 4]| v[0] == v[1] && v[1] == v[2];
            let one_channel = l.channels <= 2 || (l.swizzle[0] == l.swizzle[1] && l.swizzle[1] == l.swizzle[2]);
            one_channel && same(l.factor) && same(l.bias)
        }
        _ => false,
    };
    if grey {
        return e.exprs.extract(color, 0);
    }
    let weights = e.exprs.constant([0.2126, 0.7152, 0.0722, 0.0]);
    e.exprs.apply(Function::Dot(3), &[color, weights])
}
