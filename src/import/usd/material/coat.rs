//! What a coat does to the surface beneath it beside what its own layer does.

use super::clear::f0;
use super::evaluate::Evaluator;
use super::expr::{Exprs, Id, Op};
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

/// What a coat throws back at what is beneath: `coat_darkening` by the node's own definition, a factor of all that
/// scatters there. Blender's coat, which is written as this one, does not darken.
pub(super) fn darkening(
    e: &mut Evaluator<'_, '_>,
    node: usize,
    s: &Surface,
    [specular_weight, subsurface]: [Id; 2],
) -> Id {
    let one = e.exprs.number(1.0);
    let Some(coat) = s.coat.filter(|coat| !e.exprs.is(coat.weight, 0.0)) else { return one };
    let amount = e.scalar(node, "coat_darkening", if e.materials.reading.blender { 0.0 } else { 1.0 });
    let color = e.input(node, "base_color", [0.8; 4]);
    let beneath = e.input(node, "subsurface_color", [0.8, 0.8, 0.8, 1.0]);
    let x = &mut e.exprs;
    let amount = x.multiply(coat.weight, amount);
    if x.is(amount, 0.0) {
        return one;
    }
    let f0 = f0(x, coat.ior);
    let (passes, squared) = (x.subtract(one, f0), x.multiply(coat.ior, coat.ior));
    // What leaves through the coat, of light that comes from everywhere beneath it.
    let leaves = x.math(Math::Divide, &[passes, squared]);
    let returns = x.subtract(one, leaves);
    let (metal, dielectric) = (x.multiply(color, specular_weight), x.mix(color, beneath, subsurface));
    let albedo = x.mix(dielectric, metal, s.metallic);
    let again = x.multiply(albedo, returns);
    let rest = x.subtract(one, again);
    let factor = x.math(Math::Divide, &[leaves, rest]);
    x.mix(one, factor, amount)
}

/// The index that the coat makes of that beneath it, `eta_s`: relative to its own, or the reciprocal where light would go
/// to what is thinner, so that there is no critical angle.
pub(super) fn beneath(x: &mut Exprs, s: &Surface) -> Id {
    let Some(coat) = s.coat.filter(|coat| !x.is(coat.weight, 0.0)) else { return s.ior };
    let (over, under) = (x.math(Math::Divide, &[s.ior, coat.ior]), x.math(Math::Divide, &[coat.ior, s.ior]));
    let relative = x.math(Math::Maximum, &[over, under]);
    x.mix(s.ior, relative, coat.weight)
}

/// Light is bent at the coat before it meets the surface: `effective_specular_roughness`, (r⁴ + 2 coat⁴)^¼.
pub(super) fn roughen(x: &mut Exprs, s: &mut Surface) {
    let Some(coat) = s.coat.filter(|coat| !x.is(coat.weight, 0.0) && !x.is(coat.roughness, 0.0)) else { return };
    let [four, fourth, one] = [4.0, 0.25, 1.0].map(|value| x.number(value));
    let [own, above] = [s.roughness, coat.roughness].map(|roughness| x.math(Math::Power, &[roughness, four]));
    let above = x.scale(above, 2.0);
    let sum = x.add(own, above);
    let sum = x.math(Math::Minimum, &[sum, one]);
    let rough = x.math(Math::Power, &[sum, fourth]);
    s.roughness = x.mix(s.roughness, rough, coat.weight);
}
