//! What doors build again and again.

use super::{Blend, Function, Graph, Layer, Leaf, Math, Op, Quantity, Space, Value, ValueId};

/// Relative luminance of linear Rec.709 (ITU-R BT.709), as Cycles turns a color into a number.
const LUMINANCE: Value = [0.2126729, 0.7151522, 0.0721750, 0.0];

impl Graph {
    /// Arithmetic.
    pub fn math(&mut self, math: Math, args: &[ValueId]) -> ValueId {
        self.apply(Function::Math(math), args)
    }

    /// `a + b`.
    pub fn add(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.math(Math::Add, &[a, b])
    }

    /// `a − b`.
    pub fn subtract(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.math(Math::Subtract, &[a, b])
    }

    /// `a b`.
    pub fn multiply(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.math(Math::Multiply, &[a, b])
    }

    /// `a` times a number.
    pub fn scale(&mut self, a: ValueId, by: f64) -> ValueId {
        let by = self.number(by);
        self.multiply(a, by)
    }

    /// a where t is 0, b where it is 1.
    pub fn mix(&mut self, a: ValueId, b: ValueId, t: ValueId) -> ValueId {
        self.apply(Function::Mix { blend: Blend::Mix, clamp_factor: false, clamp_result: false }, &[t, a, b])
    }

    /// One place of `a` as a number.
    pub fn place(&mut self, a: ValueId, place: u8) -> ValueId {
        self.apply(Function::Swizzle([place.min(3); 4]), &[a])
    }

    /// The first place of each in one value; alpha is 1.
    pub fn combine(&mut self, x: ValueId, y: ValueId, z: ValueId) -> ValueId {
        self.apply(Function::Combine, &[x, y, z])
    }

    /// A color as a number: its luminance.
    pub fn luminance(&mut self, color: ValueId) -> ValueId {
        let weights = self.constant(LUMINANCE);
        self.apply(Function::Dot(3), &[color, weights])
    }

    /// A vector as a number: the mean of x, y and z.
    pub fn average(&mut self, vector: ValueId) -> ValueId {
        let weights = self.constant([1.0 / 3.0; 4]);
        self.apply(Function::Dot(3), &[vector, weights])
    }

    /// Rows of a 3×4 matrix times `(x, y, z, 1)`.
    pub fn affine(&mut self, rows: [[f64; 4]; 3], vector: ValueId) -> ValueId {
        self.apply(Function::Affine(Box::new(rows)), &[vector])
    }

    /// A vector of this world (y up) as one of a world with z up, or back.
    pub fn turned(&mut self, vector: ValueId, to_z_up: bool) -> ValueId {
        let sign = if to_z_up { 1.0 } else { -1.0 };
        let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -sign, 0.0], [0.0, sign, 0.0, 0.0]];
        self.apply(Function::Affine(Box::new(rows)), &[vector])
    }

    /// A UV set with v upwards.
    pub fn uv_upwards(&mut self, set: u32) -> ValueId {
        let uv = self.leaf(Leaf::Uv(set));
        self.upside_down(uv)
    }

    /// Texture coordinates with v upwards to what [`Op::Image`] takes, or back.
    pub fn upside_down(&mut self, uv: ValueId) -> ValueId {
        let rows = [[1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]];
        self.apply(Function::Affine(Box::new(rows)), &[uv])
    }

    /// An image; `uv` as [`Op::Image`] takes it.
    pub fn image(&mut self, texture: u32, uv: ValueId) -> ValueId {
        self.push(Op::Image { texture, uv })
    }

    /// An image projected from all six sides of a box onto `coordinates` (0 to 1), blended over a share of
    /// the edges; `normal` is in the same space. Blender's box projection.
    pub fn box_image(&mut self, texture: u32, coordinates: ValueId, normal: ValueId, blend: f64) -> ValueId {
        let weights = self.apply(Function::BoxWeights(blend.clamp(0.0, 1.0)), &[normal]);
        let (zero, one) = (self.number(0.0), self.number(1.0));
        let mut sum = None;
        // Which coordinates each side is looked up by, and on which side of it the first runs backwards.
        for (side, [u, v], backwards_if_positive) in [(0, [1, 2], false), (1, [0, 2], true), (2, [1, 0], true)] {
            let (along, up) = (self.place(coordinates, u), self.place(coordinates, v));
            let facing = self.place(normal, side);
            let back = self.subtract(one, along);
            let (a, b) = if backwards_if_positive { (facing, zero) } else { (zero, facing) };
            let along = self.apply(Function::IfGreater, &[a, b, back, along]);
            let uv = self.combine(along, up, zero);
            let uv = self.upside_down(uv);
            let texel = self.image(texture, uv);
            let weight = self.place(weights, side);
            let part = self.multiply(texel, weight);
            sum = Some(match sum {
                Some(sum) => self.add(sum, part),
                None => part,
            });
        }
        sum.unwrap_or(zero)
    }

    /// Where a ray towards whoever looks would be mirrored to by a surface of this normal: Blender's reflection
    /// coordinates, world space.
    pub fn reflection(&mut self, normal: ValueId) -> ValueId {
        let incoming = self.leaf(Leaf::Incoming);
        let mirrored = self.apply(Function::Reflect, &[incoming, normal]);
        self.scale(mirrored, -1.0)
    }

    /// Reflectance of a dielectric with this index at this normal (world space).
    pub fn fresnel(&mut self, ior: ValueId, normal: ValueId) -> ValueId {
        let (incoming, back) = (self.leaf(Leaf::Incoming), self.leaf(Leaf::Backfacing));
        self.apply(Function::Fresnel, &[ior, normal, incoming, back])
    }

    /// Blender's Layer Weight: the Fresnel output.
    pub fn layer_fresnel(&mut self, blend: ValueId, normal: ValueId) -> ValueId {
        let (incoming, back) = (self.leaf(Leaf::Incoming), self.leaf(Leaf::Backfacing));
        self.apply(Function::LayerFresnel, &[blend, normal, incoming, back])
    }

    /// Blender's Layer Weight: the Facing output.
    pub fn layer_facing(&mut self, blend: ValueId, normal: ValueId) -> ValueId {
        let incoming = self.leaf(Leaf::Incoming);
        self.apply(Function::LayerFacing, &[blend, normal, incoming])
    }

    /// What a layer of fibers of this color leaves of what is below it.
    pub fn below_sheen(&mut self, color: ValueId, roughness: ValueId, normal: ValueId) -> ValueId {
        let ior = self.number(1.0);
        let albedo = self.push(Op::Albedo { layer: Layer::Sheen, roughness, ior, normal });
        // No channel gets more than the one of which most is thrown back.
        let [r, g, b] = [0, 1, 2].map(|place| self.place(color, place));
        let most = self.math(Math::Maximum, &[r, g]);
        let most = self.math(Math::Maximum, &[most, b]);
        let gone = self.multiply(most, albedo);
        self.rest(gone)
    }

    /// What a coat leaves of what is below it: by its reflection, and by its tint, of which `tint^(1/cos)` is left
    /// for the cosine within, cos² = 1 − (1 − (n·wo)²) / ior².
    pub fn below_coat(&mut self, weight: ValueId, tint: ValueId, layer: [ValueId; 3]) -> ValueId {
        let [roughness, ior, normal] = layer;
        let albedo = self.push(Op::Albedo { layer: Layer::Coat, roughness, ior, normal });
        let gone = self.multiply(albedo, weight);
        let passed = self.rest(gone);
        let one = self.number(1.0);
        if self.known(tint).is_some_and(|tint| tint[..3] == [1.0; 3]) {
            return passed;
        }
        let incoming = self.leaf(Leaf::Incoming);
        let cos = self.apply(Function::Dot(3), &[incoming, normal]);
        let sine = self.multiply(cos, cos);
        let sine = self.subtract(one, sine);
        let squared = self.multiply(ior, ior);
        let within = self.math(Math::Divide, &[sine, squared]);
        let within = self.subtract(one, within);
        let within = self.math(Math::Sqrt, &[within]);
        let depth = self.math(Math::Divide, &[one, within]);
        let tint = self.math(Math::Power, &[tint, depth]);
        let tint = self.mix(one, tint, weight);
        self.multiply(passed, tint)
    }

    /// `1 − share`, from 0 on.
    fn rest(&mut self, share: ValueId) -> ValueId {
        let (zero, one) = (self.number(0.0), self.number(1.0));
        let rest = self.subtract(one, share);
        self.math(Math::Maximum, &[rest, zero])
    }

    /// A vector carried from space to space.
    pub fn transform(&mut self, quantity: Quantity, from: Space, to: Space, value: ValueId) -> ValueId {
        if from == to { value } else { self.push(Op::Transform { quantity, from, to, value }) }
    }

    /// The world-space normal of a tangent-space map (0 to 1) with a strength. `tangent` is in object space
    /// with the sign of the bitangent in its fourth place: [`Leaf::Tangent`], or an attribute for another UV
    /// set than that of the mesh's tangents.
    pub fn normal_map(&mut self, color: ValueId, strength: ValueId, tangent: ValueId) -> ValueId {
        let smooth = self.leaf(Leaf::SmoothNormal);
        let mapped = self.apply(Function::NormalMap, &[color, strength, smooth, tangent]);
        let world = self.transform(Quantity::Normal, Space::Object, Space::World, mapped);
        self.towards_viewer(world)
    }

    /// The world-space normal of a map of world or object space (0 to 1) with a strength; z of the map's
    /// space is that of its author, who has turned the color where need be.
    pub fn normal_map_of(&mut self, space: Space, color: ValueId, strength: ValueId) -> ValueId {
        let half = self.number(0.5);
        let above = self.subtract(color, half);
        let normal = self.transform(Quantity::Normal, space, Space::World, above);
        let facing = self.towards_viewer(normal);
        let own = self.leaf(Leaf::Normal);
        self.apply(Function::NormalStrength, &[strength, facing, own])
    }

    /// A normal as wound, turned round where the surface is seen from behind.
    fn towards_viewer(&mut self, normal: ValueId) -> ValueId {
        let (back, half) = (self.leaf(Leaf::Backfacing), self.number(0.5));
        let turned = self.scale(normal, -1.0);
        self.apply(Function::IfGreater, &[back, half, turned, normal])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worlds_are_turned_there_and_back() {
        let mut graph = Graph::default();
        let v = graph.constant([1.0, 2.0, 3.0, 0.0]);
        let z_up = graph.turned(v, true);
        assert_eq!(graph.known(z_up), Some([1.0, -3.0, 2.0, 0.0]));
        let back = graph.turned(z_up, false);
        assert_eq!(graph.known(back), Some([1.0, 2.0, 3.0, 0.0]));
        let uv = graph.constant([0.25, 0.25, 0.0, 1.0]);
        let down = graph.upside_down(uv);
        assert_eq!(graph.known(down), Some([0.25, 0.75, 0.0, 1.0]));
    }

    #[test]
    fn colors_and_vectors_become_numbers() {
        let mut graph = Graph::default();
        let color = graph.constant([1.0, 0.5, 0.25, 0.5]);
        let (y, mean, red) = (graph.luminance(color), graph.average(color), graph.place(color, 0));
        let number = |id| graph.known(id).unwrap();
        assert!((number(y)[3] - (0.2126729 + 0.5 * 0.7151522 + 0.25 * 0.0721750)).abs() < 1e-12);
        assert!((number(mean)[0] - 1.75 / 3.0).abs() < 1e-12);
        assert_eq!(number(red), [1.0; 4]);
    }
}
