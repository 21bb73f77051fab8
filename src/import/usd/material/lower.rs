//! Expressions that are more than `factor × texture`, handed over as values of the material's graph.

use std::collections::HashMap;

use super::Materials;
use super::expr::{Exprs, Id, Lookup, Op};
use crate::desc::TextureTransform;
use crate::desc::graph::{self, Function, Graph, Leaf, Math, Relief, Value, ValueId};
use crate::desc::{ColorSpace, ImageDesc};

/// The graph of a material in the making.
#[derive(Debug, Default)]
pub(super) struct Lowering {
    pub graph: Graph,
    known: HashMap<Id, ValueId>,
}

impl Lowering {
    /// The value of the graph that `id` is.
    pub fn value(&mut self, exprs: &Exprs, id: Id) -> ValueId {
        for needed in exprs.needed(id) {
            if !self.known.contains_key(&needed) {
                let value = self.one(exprs.op(needed));
                self.known.insert(needed, value);
            }
        }
        self.at(id)
    }

    /// What an expression that comes before has become.
    fn at(&self, id: Id) -> ValueId {
        self.known[&id]
    }

    fn one(&mut self, op: &Op) -> ValueId {
        match op {
            Op::Constant(value) => self.graph.constant(*value),
            Op::Lookup(lookup) => self.lookup(lookup),
            Op::Image { texture, uv } => {
                let uv = self.graph.upside_down(self.at(*uv));
                self.graph.image(*texture, uv)
            }
            Op::Uv { set, rows: [u, v] } => {
                let uv = self.graph.uv_upwards(*set);
                let row = |r: &[f64; 3]| [r[0], r[1], 0.0, r[2]];
                let rows = [row(u), row(v), [0.0; 4]];
                self.graph.apply(Function::Affine(Box::new(rows)), &[uv])
            }
            Op::Primvar { name, fallback } => {
                self.graph.leaf(Leaf::Attribute { name: name.clone(), fallback: *fallback })
            }
            Op::Leaf(leaf) => self.graph.leaf(leaf.clone()),
            Op::Procedural(texture, args) => {
                let args = args.iter().map(|arg| self.at(*arg)).collect();
                self.graph.push(graph::Op::Procedural(*texture, args))
            }
            Op::Transform { quantity, from, to, value } => {
                let value = self.at(*value);
                self.graph.transform(*quantity, *from, *to, value)
            }
            Op::Relief { height, scale, uv } => {
                let [height, scale, uv] = [height, scale, uv].map(|id| self.at(*id));
                self.graph.push(graph::Op::Relief(Relief { height, scale, uv }))
            }
            Op::Albedo { layer, roughness, ior, normal } => {
                let [roughness, ior, normal] = [roughness, ior, normal].map(|id| self.at(*id));
                self.graph.push(graph::Op::Albedo { layer: *layer, roughness, ior, normal })
            }
            Op::Apply(function, args) => {
                let args: Vec<ValueId> = args.iter().map(|arg| self.at(*arg)).collect();
                self.graph.apply(function.clone(), &args)
            }
        }
    }

    fn lookup(&mut self, lookup: &Lookup) -> ValueId {
        let Lookup { texture, swizzle, factor, bias, .. } = lookup;
        let graph = &mut self.graph;
        let TextureTransform([u, v]) = texture.transform;
        let rows = [[u[0], u[1], 0.0, u[2]], [v[0], v[1], 0.0, v[2]], [0.0; 4]];
        let uv = graph.leaf(Leaf::Uv(texture.uv_set));
        let uv = graph.apply(Function::Affine(Box::new(rows)), &[uv]);
        let texel = graph.image(texture.texture, uv);
        let texel = if *swizzle == [0, 1, 2, 3] { texel } else { graph.apply(Function::Swizzle(*swizzle), &[texel]) };
        let (factor, bias) = (graph.constant(*factor), graph.constant(*bias));
        graph.math(Math::MultiplyAdd, &[texel, factor, bias])
    }

    /// What an input that can't vary has instead: the value where every texture is its mean and every
    /// coordinate in the middle.
    pub fn mean(&self, exprs: &Exprs, id: Id, materials: &Materials<'_>) -> Value {
        let mut known: HashMap<Id, Value> = HashMap::new();
        let mean = |texture: u32| {
            let image = materials.textures[texture as usize].image;
            mean_of(&materials.images.images[image as usize])
        };
        for needed in exprs.needed(id) {
            let value = match exprs.op(needed) {
                Op::Constant(value) => *value,
                Op::Lookup(l) => {
                    let texel = mean(l.texture.texture);
                    std::array::from_fn(|i| l.factor[i] * texel[usize::from(l.swizzle[i].min(3))] + l.bias[i])
                }
                Op::Image { texture, .. } => mean(*texture),
                Op::Uv { rows, .. } => {
                    let [u, v] = rows.map(|row| 0.5 * (row[0] + row[1]) + row[2]);
                    [u, v, 0.0, 1.0]
                }
                Op::Primvar { fallback, .. } => *fallback,
                Op::Relief { .. } => [0.5, 0.5, 1.0, 1.0],
                // Anywhere, seen from ahead; signed noise is 0 in the mean.
                Op::Leaf(_) | Op::Procedural(..) => [0.0, 0.0, 0.0, 1.0],
                Op::Transform { value, .. } => known[value],
                // At normal incidence.
                Op::Albedo { ior, .. } => known[ior].map(|ior| ((ior - 1.0) / (ior + 1.0)).powi(2)),
                Op::Apply(function, args) => {
                    let args: Vec<Value> = args.iter().map(|arg| known[arg]).collect();
                    function.eval(&args)
                }
            };
            known.insert(needed, value);
        }
        known[&id]
    }
}

/// Mean of an image's texels in linear light.
fn mean_of(image: &ImageDesc) -> Value {
    let channels = usize::from(image.channels);
    let texels = image.pixels.len() / channels.max(1);
    let mut sum = [0.0; 4];
    for texel in 0..texels {
        for (channel, sum) in sum.iter_mut().enumerate().take(channels) {
            let is_alpha = channels.is_multiple_of(2) && channel + 1 == channels;
            let stored = [f64::from(image.pixels.get(texel * channels + channel)); 4];
            let decoded = match image.color_space {
                ColorSpace::Srgb if !is_alpha => Function::FromSrgb.eval(&[stored]),
                _ => stored,
            };
            *sum += decoded[0];
        }
    }
    let [a, b, c, d] = sum.map(|sum| sum / texels.max(1) as f64);
    match channels {
        1 => [a, a, a, 1.0],
        2 => [a, a, a, b],
        3 => [a, b, c, 1.0],
        _ => [a, b, c, d],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{Blending, PixelData};
    use crate::error::Place;

    #[test]
    fn means_are_of_linear_light() {
        let image = |channels: u8, color_space, bytes: Vec<u8>| ImageDesc {
            name: "a".into(),
            place: Place::default(),
            width: 2,
            height: 1,
            channels,
            color_space,
            blending: Blending::default(),
            pixels: PixelData::U8(bytes),
        };
        let close = |a: Value, b: Value| assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?}");
        close(mean_of(&image(2, ColorSpace::Srgb, vec![255, 51, 0, 102])), [0.5, 0.5, 0.5, 0.3]);
        close(mean_of(&image(3, ColorSpace::Linear, vec![255, 51, 0, 0, 51, 51])), [0.5, 0.2, 0.1, 1.0]);
    }
}
