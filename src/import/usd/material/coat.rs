//! What a coat does to the surface beneath it beside what its own layer does.

use super::evaluate::Evaluator;
use super::expr::{Id, Op};
use super::surface::Surface;
use crate::desc::graph::{Function, Leaf, Math};

/// What is left of the emission above the coat, taken for smooth: `emission × mix(1, tint × (1 − F), weight)`, as the
/// graphs of standard_surface and open_pbr_surface have it (`blended_coat_emission_edf`), with Fresnel's equations in
/// place of Schlick's curve; KHR_materials_clearcoat says the same of glTF. A normal of the coat's own does not
/// count.
pub(super) fn dim_emission(e: &mut Evaluator<'_, '_>, s: &mut Surface) {
    let Some(coat) = s.coat else { return };
    let x = &mut e.exprs;
    if x.is(coat.weight, 0.0) || x.is(s.emission, 0.0) {
        return;
    }
    let [normal, incoming, back] = [Leaf::Normal, Leaf::Incoming, Leaf::Backfacing].map(|leaf| x.push(Op::Leaf(leaf)));
    let reflected = x.apply(Function::Fresnel, &[coat.ior, normal, incoming, back]);
    let one = x.number(1.0);
    let passed = x.subtract(one, reflected);
    let tinted = x.multiply(coat.tint, passed);
    let left = x.mix(one, tinted, coat.weight);
    s.emission = x.multiply(s.emission, left);
}

/// What a coat throws back at what is beneath: `coat_darkening` by the node's own definition. What it does to the whole
/// reflection beneath is done to its colors. Blender's coat, which is written as this one, does not darken.
pub(super) fn darken(e: &mut Evaluator<'_, '_>, node: usize, s: &mut Surface, subsurface: Id) {
    let Some(coat) = s.coat.filter(|coat| !e.exprs.is(coat.weight, 0.0)) else { return };
    let amount = e.scalar(node, "coat_darkening", if e.materials.reading.blender { 0.0 } else { 1.0 });
    let color = e.input(node, "base_color", [0.8; 4]);
    let beneath = e.input(node, "subsurface_color", [0.8, 0.8, 0.8, 1.0]);
    let x = &mut e.exprs;
    let amount = x.multiply(coat.weight, amount);
    if x.is(amount, 0.0) {
        return;
    }
    let one = x.number(1.0);
    let (below, above) = (x.subtract(one, coat.ior), x.add(one, coat.ior));
    let ratio = x.math(Math::Divide, &[below, above]);
    let f0 = x.multiply(ratio, ratio);
    let (passes, squared) = (x.subtract(one, f0), x.multiply(coat.ior, coat.ior));
    // What leaves through the coat, of light that comes from everywhere beneath it.
    let leaves = x.math(Math::Divide, &[passes, squared]);
    let returns = x.subtract(one, leaves);
    let (metal, dielectric) = (x.multiply(color, s.specular), x.mix(color, beneath, subsurface));
    let albedo = x.mix(dielectric, metal, s.metallic);
    let again = x.multiply(albedo, returns);
    let rest = x.subtract(one, again);
    let factor = x.math(Math::Divide, &[leaves, rest]);
    let factor = x.mix(one, factor, amount);
    s.base_color = x.multiply(s.base_color, factor);
    s.specular_color = x.multiply(s.specular_color, factor);
    if let Some(beneath) = &mut s.beneath {
        beneath.color = x.multiply(beneath.color, factor);
    }
    if let Some((_, color)) = &mut s.translucent {
        *color = x.multiply(*color, factor);
    }
}
