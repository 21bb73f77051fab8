//! UsdPreviewSurface's opacityMode "transparent": what is not opaque is clear, beneath reflections that stay.
//!
//! "Fully transparent objects will still receive a lighting response when the opacityMode is transparent"
//! (UsdPreviewSurface Specification, version 2.6). A share o of the surface is opaque; of the rest, light that the
//! coat and the dielectric's interface do not reflect passes straight on, whatever the roughness: the node's
//! "transmissive lobe always assumes roughness 0". Metal is opaque, and fades with o as in Storm.

use super::expr::{Exprs, Id, Op};
use super::surface::Surface;
use crate::desc::graph::{Layer, Leaf, Math};

/// What stands in for alpha.
pub(super) struct Clear {
    /// Share of light that passes.
    pub passes: Id,
    /// Where the surface is metal: the opaque share, the rest, and the weight of the dielectric's reflection there.
    pub parts: Option<[Id; 3]>,
}

/// Makes `s` opaque, what it lets pass is in the answer; `None` where it is opaque already. `of_shape` says that the
/// opacities of the shape come on top.
pub(super) fn split(x: &mut Exprs, s: &mut Surface, of_shape: bool) -> Option<Clear> {
    let [zero, one] = [0.0, 1.0].map(|value| x.number(value));
    let mut opacity = s.opacity;
    if of_shape {
        let colors = x.push(Op::Leaf(Leaf::VertexColor));
        let own = x.extract(colors, 3);
        opacity = x.multiply(opacity, own);
    }
    let opacity = x.math(Math::Clamp, &[opacity, zero, one]);
    s.opacity = one;
    if x.is(opacity, 1.0) {
        return None;
    }
    let rest = x.subtract(one, opacity);
    let metallic = x.math(Math::Clamp, &[s.metallic, zero, one]);
    let dielectric = x.subtract(one, metallic);
    let f0 = f0(x, s.ior);
    let tinted = x.multiply(s.specular_color, f0);
    let tinted = x.math(Math::Clamp, &[tinted, zero, one]);
    let below = left(x, tinted, s.ior, s.roughness);
    let below = x.mix(one, below, dielectric);
    let mut passes = x.multiply(rest, below);
    if let Some(coat) = s.coat.filter(|coat| !x.is(coat.weight, 0.0)) {
        let f0 = self::f0(x, coat.ior);
        let below = left(x, f0, coat.ior, coat.roughness);
        let weight = x.math(Math::Clamp, &[coat.weight, zero, one]);
        let below = x.mix(one, below, weight);
        passes = x.multiply(passes, below);
    }
    if x.is(metallic, 0.0) {
        s.base_color = x.multiply(s.base_color, opacity);
        return Some(Clear { passes, parts: None });
    }
    Some(Clear { passes, parts: Some([opacity, rest, dielectric]) })
}

/// Reflectance at normal incidence.
pub(super) fn f0(x: &mut Exprs, ior: Id) -> Id {
    let one = x.number(1.0);
    let (below, above) = (x.subtract(ior, one), x.add(ior, one));
    let ratio = x.math(Math::Divide, &[below, above]);
    x.multiply(ratio, ratio)
}

/// What a reflection of `f0` at normal incidence and white at the edge leaves for what is beneath. Of what the white one
/// of the index reflects, that which is beyond its own reflectance at normal incidence is the edge's.
fn left(x: &mut Exprs, f0: Id, ior: Id, roughness: Id) -> Id {
    let one = x.number(1.0);
    // Both sides of a surface without an inside are the same.
    let inverse = x.math(Math::Divide, &[one, ior]);
    let ior = x.math(Math::Maximum, &[ior, inverse]);
    let normal = x.push(Op::Leaf(Leaf::Normal));
    let white = x.push(Op::Albedo { layer: Layer::Coat, roughness, ior, normal });
    let passes = x.subtract(one, white);
    let own = self::f0(x, ior);
    if own == f0 {
        return passes;
    }
    let [left, of] = [f0, own].map(|f0| x.subtract(one, f0));
    let passes = x.math(Math::Divide, &[passes, of]);
    x.multiply(left, passes)
}
