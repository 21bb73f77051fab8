//! What the inputs of a surface compute, as expressions of constants and texture lookups. What folds is
//! folded when it is built, so that most inputs end as a constant or as `factor × texture`; the rest becomes
//! a value of the material's graph (`lower.rs`).

use std::sync::Arc;

use crate::desc::graph::{Blend, Function, Layer, Leaf, Math, Procedural, Quantity, Space, Value as V};
use crate::desc::{TextureRef, TextureTransform};

/// An expression in an [`Exprs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Id(pub u32);

/// A texture's value: `factor × texel[swizzle] + bias`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lookup {
    pub texture: TextureRef,
    /// Channels of the image.
    pub channels: u8,
    /// True where texels lie within 0 to 1.
    pub unit: bool,
    pub swizzle: [u8; 4],
    pub factor: V,
    pub bias: V,
}

/// An expression. Arguments come before what they are used in.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Op {
    Constant(V),
    Lookup(Lookup),
    /// A texture whose coordinates (USD's, v upwards) are more than a placement.
    Image {
        texture: u32,
        uv: Id,
    },
    /// USD's texture coordinates, v upwards: rows of a 2×3 matrix.
    Uv {
        set: u32,
        rows: [[f64; 3]; 2],
    },
    /// A primvar of the shape that is no texture coordinate.
    Primvar {
        name: Arc<str>,
        fallback: V,
    },
    /// What is known of the hit.
    Leaf(Leaf),
    /// A procedural texture.
    Procedural(Procedural, Vec<Id>),
    /// A point or direction carried from one space to another, as graphs have them.
    Transform {
        quantity: Quantity,
        from: Space,
        to: Space,
        value: Id,
    },
    /// The slope of a height, as graphs have it.
    Relief {
        height: Id,
        scale: Id,
        uv: Id,
    },
    /// What a white layer reflects, as graphs have it.
    Albedo {
        layer: Layer,
        roughness: Id,
        ior: Id,
        normal: Id,
    },
    Apply(Function, Vec<Id>),
}

/// `bg` where the factor is 0, `fg` where it is 1; the factor comes first.
const MIX: Function = Function::Mix { blend: Blend::Mix, clamp_factor: false, clamp_result: false };

/// The expressions of one material.
#[derive(Debug, Default)]
pub(super) struct Exprs {
    ops: Vec<Op>,
}

impl Exprs {
    pub fn op(&self, id: Id) -> &Op {
        &self.ops[id.0 as usize]
    }

    /// Adds an expression, or finds the same one.
    pub fn push(&mut self, op: Op) -> Id {
        let known = self.ops.iter().position(|known| *known == op);
        Id(known.unwrap_or_else(|| {
            self.ops.push(op);
            self.ops.len() - 1
        }) as u32)
    }

    pub fn constant(&mut self, value: V) -> Id {
        self.push(Op::Constant(value))
    }

    pub fn number(&mut self, value: f64) -> Id {
        self.constant([value; 4])
    }

    /// The value of an expression that no texture drives.
    pub fn known(&self, id: Id) -> Option<V> {
        match self.op(id) {
            Op::Constant(value) => Some(*value),
            _ => None,
        }
    }

    /// True for a constant that is `value` in color and in number.
    pub fn is(&self, id: Id, value: f64) -> bool {
        self.known(id).is_some_and(|v| v[..3].iter().all(|x| *x == value))
    }

    /// What `root` depends on, itself included, arguments first.
    pub fn needed(&self, root: Id) -> Vec<Id> {
        self.reached(root, |_| true)
    }

    /// True where `root` goes by vectors that are known of the hit; slopes of heights are in tangent space whatever
    /// those go by.
    pub fn has_leaf(&self, root: Id) -> bool {
        let reached = self.reached(root, |op| !matches!(op, Op::Relief { .. }));
        reached.into_iter().any(|id| matches!(self.op(id), Op::Leaf(_) | Op::Transform { .. }))
    }

    /// `root` and what it is made of, and what that is made of where `goes_on` says so; arguments first.
    fn reached(&self, root: Id, goes_on: impl Fn(&Op) -> bool) -> Vec<Id> {
        let mut needed = vec![false; root.0 as usize + 1];
        needed[root.0 as usize] = true;
        for i in (0..needed.len()).rev() {
            let op = &self.ops[i];
            if !needed[i] || !goes_on(op) {
                continue;
            }
            let mut need = |id: &Id| needed[id.0 as usize] = true;
            match op {
                Op::Apply(_, args) | Op::Procedural(_, args) => args.iter().for_each(need),
                Op::Image { uv: from, .. } | Op::Transform { value: from, .. } => need(from),
                Op::Relief { height, scale, uv } => [height, scale, uv].into_iter().for_each(need),
                Op::Albedo { roughness, ior, normal, .. } => [roughness, ior, normal].into_iter().for_each(need),
                Op::Constant(_) | Op::Lookup(_) | Op::Uv { .. } | Op::Primvar { .. } | Op::Leaf(_) => {}
            }
        }
        (0..needed.len() as u32).filter(|i| needed[*i as usize]).map(Id).collect()
    }

    pub fn math(&mut self, math: Math, args: &[Id]) -> Id {
        self.apply(Function::Math(math), args)
    }

    pub fn add(&mut self, a: Id, b: Id) -> Id {
        self.math(Math::Add, &[a, b])
    }

    pub fn multiply(&mut self, a: Id, b: Id) -> Id {
        self.math(Math::Multiply, &[a, b])
    }

    pub fn scale(&mut self, a: Id, factor: f64) -> Id {
        let factor = self.number(factor);
        self.multiply(a, factor)
    }

    pub fn subtract(&mut self, a: Id, b: Id) -> Id {
        let minus = self.scale(b, -1.0);
        self.add(a, minus)
    }

    /// `bg` where `amount` is 0, `fg` where it is 1.
    pub fn mix(&mut self, bg: Id, fg: Id, amount: Id) -> Id {
        let range = self.subtract(fg, bg);
        match (self.known(amount), self.known(range)) {
            _ if bg == fg => bg,
            (Some([0.0, 0.0, 0.0, _]), _) => bg,
            (Some([1.0, 1.0, 1.0, _]), _) => fg,
            // One of the three is no constant: still linear in it.
            (None, Some(_)) | (Some(_), _) => {
                let one = self.number(1.0);
                if self.known(amount).is_some() {
                    let rest = self.subtract(one, amount);
                    let (bg, fg) = (self.multiply(bg, rest), self.multiply(fg, amount));
                    return self.add(bg, fg);
                }
                let upper = self.multiply(range, amount);
                self.add(bg, upper)
            }
            (None, None) => self.apply(MIX, &[amount, bg, fg]),
        }
    }

    pub fn swizzle(&mut self, a: Id, places: [u8; 4]) -> Id {
        self.apply(Function::Swizzle(places), &[a])
    }

    /// One number of `a` in all places.
    pub fn extract(&mut self, a: Id, place: u8) -> Id {
        self.swizzle(a, [place.min(3); 4])
    }

    /// `function` of `args`, folded where that keeps it simple.
    pub fn apply(&mut self, function: Function, args: &[Id]) -> Id {
        let values: Option<Vec<V>> = args.iter().map(|arg| self.known(*arg)).collect();
        if let Some(values) = values {
            let value = function.eval(&values);
            return self.constant(value);
        }
        self.fold(&function, args).unwrap_or_else(|| self.push(Op::Apply(function, args.to_vec())))
    }

    fn fold(&mut self, function: &Function, args: &[Id]) -> Option<Id> {
        match (function, args) {
            (&Function::Math(math @ (Math::Add | Math::Multiply)), &[a, b]) => match (self.known(a), self.known(b)) {
                (Some(value), None) => self.affine(math, b, value),
                (None, Some(value)) => self.affine(math, a, value),
                _ => None,
            },
            (Function::Math(Math::Divide), &[a, b]) => {
                let inverse = self.known(b)?.map(|x| if x == 0.0 { 0.0 } else { x.recip() });
                let inverse = self.constant(inverse);
                Some(self.multiply(a, inverse))
            }
            (Function::Math(Math::Clamp), &[a, low, high]) => {
                let (low, high) = (self.known(low)?, self.known(high)?);
                let Op::Lookup(lookup) = self.op(a) else { return None };
                let inside = |i: usize| {
                    let ends = [lookup.bias[i], lookup.bias[i] + lookup.factor[i]];
                    ends.iter().all(|end| (low[i]..=high[i]).contains(end))
                };
                (lookup.unit && (0..3).all(inside)).then_some(a)
            }
            (Function::Math(Math::Power | Math::SignedPower), &[a, b]) if self.is(b, 1.0) => Some(a),
            (Function::Swizzle(places), &[a]) => self.fold_swizzle(a, *places),
            _ => None,
        }
    }

    /// `a + value` or `a × value`.
    fn affine(&mut self, math: Math, a: Id, value: V) -> Option<Id> {
        let multiplies = math == Math::Multiply;
        // Alpha of a color is not looked at.
        let neutral = if multiplies { 1.0 } else { 0.0 };
        if value == [neutral; 4] {
            return Some(a);
        }
        if multiplies && value[..3] == [0.0; 3] {
            return Some(self.constant([0.0; 4]));
        }
        let change = |x: V| -> V { Function::Math(math).eval(&[x, value]) };
        let op = match self.op(a).clone() {
            Op::Lookup(l) if multiplies => Op::Lookup(Lookup { factor: change(l.factor), bias: change(l.bias), ..l }),
            Op::Lookup(l) => Op::Lookup(Lookup { bias: change(l.bias), ..l }),
            Op::Uv { set, rows: [u, v] } if multiplies => {
                Op::Uv { set, rows: [u.map(|x| x * value[0]), v.map(|x| x * value[1])] }
            }
            Op::Uv { set, rows: [[a, b, c], [d, e, f]] } => {
                Op::Uv { set, rows: [[a, b, c + value[0]], [d, e, f + value[1]]] }
            }
            Op::Apply(Function::Math(inner), args) if inner == math && args.len() == 2 => {
                let (place, other) = match (self.known(args[0]), self.known(args[1])) {
                    (Some(known), None) => (known, args[1]),
                    (None, Some(known)) => (known, args[0]),
                    _ => return None,
                };
                let both = self.constant(change(place));
                return Some(self.math(math, &[other, both]));
            }
            _ => return None,
        };
        Some(self.push(op))
    }

    fn fold_swizzle(&mut self, a: Id, places: [u8; 4]) -> Option<Id> {
        if places == [0, 1, 2, 3] {
            return Some(a);
        }
        let pick = |x: V| Function::Swizzle(places).eval(&[x]);
        match self.op(a).clone() {
            Op::Lookup(l) => {
                let swizzle = places.map(|place| l.swizzle[usize::from(place.min(3))]);
                let (factor, bias) = (pick(l.factor), pick(l.bias));
                if swizzle == [3; 4] && l.channels % 2 == 1 {
                    // The alpha of an image without.
                    return Some(self.constant(std::array::from_fn(|i| factor[i] + bias[i])));
                }
                Some(self.push(Op::Lookup(Lookup { swizzle, factor, bias, ..l })))
            }
            Op::Apply(Function::Swizzle(inner), args) => {
                let both = places.map(|place| inner[usize::from(place.min(3))]);
                Some(self.swizzle(*args.first()?, both))
            }
            Op::Apply(Function::Combine, args) if places.iter().all(|p| *p == places[0]) => {
                let part = args.get(usize::from(places[0])).copied();
                let part = part.unwrap_or_else(|| self.number(f64::from(places[0] == 3)));
                Some(self.extract(part, 0))
            }
            _ => None,
        }
    }
}

/// USD's texture coordinates have v upwards, a mesh's downwards: `flip · rows · flip`.
pub(super) fn placement([[a, b, c], [d, e, f]]: [[f64; 3]; 2]) -> TextureTransform {
    TextureTransform([[a, -b, b + c], [-d, e, 1.0 - e - f]])
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub fn lookup() -> Lookup {
        let texture = TextureRef { texture: 0, uv_set: 0, transform: TextureTransform::IDENTITY };
        Lookup { texture, channels: 3, unit: true, swizzle: [0, 1, 2, 3], factor: [1.0; 4], bias: [0.0; 4] }
    }

    #[test]
    fn affine_chains_fold_into_the_lookup() {
        let mut e = Exprs::default();
        let texture = e.push(Op::Lookup(lookup()));
        let red = e.extract(texture, 0);
        let double = e.scale(red, 2.0);
        let one = e.number(1.0);
        let minus = e.subtract(double, one);
        assert_eq!(e.op(minus), &Op::Lookup(Lookup { swizzle: [0; 4], factor: [2.0; 4], bias: [-1.0; 4], ..lookup() }));
        let (dark, bright) = (e.constant([0.1, 0.2, 0.3, 1.0]), e.constant([0.5, 0.6, 0.7, 1.0]));
        let mixed = e.mix(dark, bright, red);
        let Op::Lookup(l) = e.op(mixed) else { panic!("{:?}", e.op(mixed)) };
        assert!((l.factor[1] - 0.4).abs() < 1e-12 && l.bias[1] == 0.2);
        assert_eq!(e.mix(texture, dark, one), dark);
        let alpha = e.extract(texture, 3);
        assert_eq!(e.known(alpha), Some([1.0; 4]));
        let zero = e.number(0.0);
        assert_eq!(e.math(Math::Clamp, &[texture, zero, one]), texture);
        let product = e.multiply(texture, red);
        let scaled = e.scale(product, 3.0);
        let again = e.scale(scaled, 2.0);
        let Op::Apply(Function::Math(Math::Multiply), args) = e.op(again).clone() else { panic!() };
        assert_eq!(e.known(args[1]), Some([6.0; 4]));
    }

    #[test]
    fn uv_is_flipped_twice() {
        // st' = (2u + 0.1, 3v + 0.2): the lookup at v down is 1 − (3 (1 − v) + 0.2).
        let TextureTransform([u, v]) = placement([[2.0, 0.0, 0.1], [0.0, 3.0, 0.2]]);
        assert_eq!(u, [2.0, 0.0, 0.1]);
        assert!((v[2] - -2.2).abs() < 1e-12 && v[1] == 3.0);
    }
}
