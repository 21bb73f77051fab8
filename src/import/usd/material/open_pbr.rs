//! open_pbr_surface by its node's graph, `libraries/bxdf/open_pbr_surface.mtlx` of MaterialX 1.39.
//!
//! In files of Blender it stands for the Principled BSDF, whose inputs it was filled with: there the level changes the
//! index of opaque parts alone, metal knows no weight, and a coat changes nothing beneath but by its tint.

use super::clear::f0;
use super::evaluate::Evaluator;
use super::expr::{Exprs, Id};
use super::models::{left_out, pass_thin_wall, scatter_beneath, transmit, weighted};
use super::surface::{Anisotropy, Coat, Film, Surface};
use super::{closure, coat};
use crate::desc::AnisotropyLaw;
use crate::desc::graph::Math;

/// The graph's largest reflectance at normal incidence.
const LARGEST_F0: f64 = 0.99999;

/// Blender writes 0.7 of its anisotropy (measured: 4.5 and 5.0).
const OF_PRINCIPLED: f64 = 0.7;

/// The surface of the node.
pub(super) fn surface(e: &mut Evaluator<'_, '_>, node: usize) -> Surface {
    let mut s = Surface::new(e);
    let base = weighted(e, node, ["base_weight", "base_color"], [1.0, 0.8]);
    let subsurface = e.scalar(node, "subsurface_weight", 0.0);
    let beneath = e.input(node, "subsurface_color", [0.8, 0.8, 0.8, 1.0]);
    s.thin_walled = e.uniform(node, "geometry_thin_walled", 0.0) != 0.0;
    if s.thin_walled {
        let forward = 0.5 + 0.5 * e.uniform(node, "subsurface_scatter_anisotropy", 0.0).clamp(-1.0, 1.0);
        pass_thin_wall(e, &mut s, [base, beneath, subsurface], forward);
    } else {
        let (scale, longest) = (e.input(node, "subsurface_radius_scale", [1.0, 0.5, 0.25, 1.0]), "subsurface_radius");
        let longest = e.scalar(node, longest, 1.0);
        let radius = e.exprs.multiply(scale, longest);
        scatter_beneath(e, node, &mut s, [base, beneath, subsurface, radius], "subsurface_scatter_anisotropy");
    }
    s.diffuse_roughness = e.scalar(node, "base_diffuse_roughness", 0.0);
    s.metallic = e.scalar(node, "base_metalness", 0.0);
    let weight = e.scalar(node, "specular_weight", 1.0);
    s.specular_color = e.input(node, "specular_color", [1.0; 4]);
    s.metal_edge = s.specular_color;
    s.roughness = e.scalar(node, "specular_roughness", 0.3);
    s.ior = e.scalar(node, "specular_ior", 1.5);
    s.anisotropy = stretched(e, node);
    s.transmission = e.scalar(node, "transmission_weight", 0.0);
    transmit(e, node, &mut s);
    let abbe = e.uniform(node, "transmission_dispersion_abbe_number", 20.0);
    let scale = e.uniform(node, "transmission_dispersion_scale", 0.0);
    s.dispersion = if abbe > 0.0 { 20.0 / abbe * scale } else { 0.0 };
    s.coat = Some(Coat {
        weight: e.scalar(node, "coat_weight", 0.0),
        roughness: e.scalar(node, "coat_roughness", 0.0),
        ior: e.scalar(node, "coat_ior", 1.6),
        tint: e.input(node, "coat_color", [1.0; 4]),
        normal: e.optional(node, "geometry_coat_normal"),
    });
    let darkening = coat::darkening(e, node, &s, [weight, subsurface]);
    if e.materials.reading.blender {
        s.specular_level = weight;
        darken(&mut e.exprs, &mut s, darkening);
    } else {
        let (color, metal) = (s.base_color, e.exprs.multiply(weight, darkening));
        darken(&mut e.exprs, &mut s, darkening);
        weigh_metal(&mut e.exprs, &mut s, color, [weight, metal]);
        weigh_reflection(&mut e.exprs, &mut s, weight);
        coat::roughen(&mut e.exprs, &mut s);
    }
    left_out(e, node, "coat_roughness_anisotropy", "coat's anisotropy");
    let fuzz = weighted(e, node, ["fuzz_weight", "fuzz_color"], [0.0, 1.0]);
    s.sheen = Some((fuzz, e.scalar(node, "fuzz_roughness", 0.5)));
    let micrometres = e.scalar(node, "thin_film_thickness", 0.5);
    s.film = Some(Film {
        weight: e.scalar(node, "thin_film_weight", 0.0),
        ior: e.scalar(node, "thin_film_ior", 1.4),
        thickness: e.exprs.scale(micrometres, 1000.0),
    });
    // The node's definition emits `luminance × color` as radiance; Blender writes its strength there.
    s.emission = weighted(e, node, ["emission_luminance", "emission_color"], [0.0, 1.0]);
    s.opacity = e.scalar(node, "geometry_opacity", 1.0);
    s.normal = e.optional(node, "geometry_normal");
    coat::dim_emission(e, &mut s);
    s
}

/// By the law of the node's own `open_pbr_anisotropy`, or by that of the Principled BSDF.
fn stretched(e: &mut Evaluator<'_, '_>, node: usize) -> Option<Anisotropy> {
    let strength = e.scalar(node, "specular_roughness_anisotropy", 0.0);
    if e.exprs.is(strength, 0.0) {
        return None;
    }
    let rotation = closure::tangent(e, node, "geometry_tangent");
    let rotation = e.exprs.number(rotation);
    Some(match e.materials.reading.blender {
        true => {
            let strength = e.exprs.scale(strength, 1.0 / OF_PRINCIPLED);
            Anisotropy { strength, rotation, law: AnisotropyLaw::Aspect }
        }
        false => Anisotropy { strength, rotation, law: AnisotropyLaw::OpenPbr },
    })
}

/// What scatters beneath the coat times `factor`, metal's reflection but at normal incidence excepted.
fn darken(x: &mut Exprs, s: &mut Surface, factor: Id) {
    s.base_color = x.multiply(s.base_color, factor);
    s.specular_color = x.multiply(s.specular_color, factor);
    if let Some(beneath) = &mut s.beneath {
        beneath.color = x.multiply(beneath.color, factor);
    }
    if let Some((_, color)) = &mut s.translucent {
        *color = x.multiply(*color, factor);
    }
}

/// Metal of this color, whose edge is specular_color × `weight` over Schlick's curve, times `factor`, which is the weight
/// and what the coat darkens by. A lobe has no such factor: reflectances at normal incidence and at 82 degrees have it.
///
/// Approximation: at 90 degrees metal reflects all.
fn weigh_metal(x: &mut Exprs, s: &mut Surface, color: Id, [weight, factor]: [Id; 2]) {
    if x.is(factor, 1.0) || x.is(s.metallic, 0.0) {
        return;
    }
    let one = x.number(1.0);
    let share = x.mix(one, weight, s.metallic);
    s.base_color = x.multiply(s.base_color, share);
    // Schlick's curve at cos θ = 1/7, from `f0`.
    let at_82 = |x: &mut Exprs, f0: Id| {
        let white = x.number((6.0_f64 / 7.0).powi(5));
        x.mix(f0, one, white)
    };
    let (of_color, of_product) = (at_82(x, color), x.multiply(color, factor));
    let of_product = at_82(x, of_product);
    let wanted = x.multiply(of_color, factor);
    let relative = x.math(Math::Divide, &[wanted, of_product]);
    let edge = x.multiply(s.metal_edge, weight);
    s.metal_edge = x.multiply(edge, relative);
}

/// `modulated_eta_s`: specular_weight scales the reflectance at normal incidence, and with it the index. What is opaque
/// lies beneath the coat (`eta_s`); light that gets inside is bent from the air to the inside whatever is on it, and
/// where it passes by the index that the weight makes.
fn weigh_reflection(x: &mut Exprs, s: &mut Surface, weight: Id) {
    let (beneath, clear) = (coat::beneath(x, s), !x.is(s.transmission, 0.0));
    s.specular_level = if clear { x.number(1.0) } else { weight };
    if !clear && s.beneath.is_none() {
        s.ior = beneath;
        return;
    }
    if beneath != s.ior {
        let (of, own) = (f0(x, beneath), f0(x, s.ior));
        let relative = x.math(Math::Divide, &[of, own]);
        s.specular_level = x.multiply(s.specular_level, relative);
    }
    if !clear || x.is(weight, 1.0) {
        return;
    }
    let [zero, one, most] = [0.0, 1.0, LARGEST_F0].map(|value| x.number(value));
    let own = f0(x, s.ior);
    let scaled = x.multiply(own, weight);
    let scaled = x.math(Math::Clamp, &[scaled, zero, most]);
    let (root, denser) = (x.math(Math::Sqrt, &[scaled]), x.subtract(s.ior, one));
    let sign = x.math(Math::Sign, &[denser]);
    let root = x.multiply(root, sign);
    let (above, below) = (x.add(one, root), x.subtract(one, root));
    s.ior = x.math(Math::Divide, &[above, below]);
}
