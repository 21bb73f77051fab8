//! Shader graphs as authored: textures and maths that are evaluated where a ray meets a surface.
//!
//! A [`Graph`] is a list of operations, arguments before what uses them; every front door fills one for
//! each material that is more than `factor × texture`. Operations are small: what a node of an artist's
//! tree is, the door says with a few of them (`build.rs` has those that every door needs).
//!
//! **Values** are four numbers:
//! * a *number* stands in all four places;
//! * a *color* is red, green, blue and alpha, linear Rec.709, straight;
//! * a *vector* is x, y and z; nobody reads its fourth place.
//!
//! So a number is a gray color and a vector of three like coordinates, without conversion. Where a function
//! wants a number it reads the first place. What a color or a vector means as a number the doors don't
//! agree on (Blender takes the luminance of a color and the mean of a vector, MaterialX a place by name):
//! they say it with [`Graph::luminance`], [`Graph::average`] or [`Graph::place`].
//!
//! **No value is ever NaN, infinite or −0**: a function that has no finite result gives 0 in that place, as
//! Cycles' `safe_*` functions do.

mod build;
mod function;
mod leaf;
mod op;
mod replace;
mod sky;

pub use function::{Blend, Curves, Function, IesTable, Mapping, Math, Ramp, RampKind, Range, Table};
pub use leaf::{Leaf, PathInfo};
pub use op::{
    Brick, Bump, Gradient, Layer, Metric, Noise, NoiseKind, Op, Procedural, Quantity, Relief, Scatter, Space, Voronoi,
    VoronoiFeature, VoronoiOutput, Wave, WaveDirection, WaveProfile,
};
pub use sky::{Atmosphere, Scattering, Sky};

/// Four numbers.
pub type Value = [f64; 4];

/// A value of the [`Graph`] that has made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ValueId(u32);

impl ValueId {
    /// Index of the operation.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// How far back [`Graph::push`] looks for an operation that is there already. What it misses only makes
/// the list longer: the engine shares all that is the same when it compiles the graph.
const LOOK_BACK: usize = 512;

/// The operations of one material, arguments before what uses them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Graph {
    ops: Vec<Op>,
}

impl Graph {
    /// True for a material that needs none.
    pub fn is_empty(&self) -> bool {
        self.ops.is_empty()
    }

    /// All operations.
    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// How a value is made.
    ///
    /// # Panics
    /// For a value of another graph.
    pub fn op(&self, id: ValueId) -> &Op {
        &self.ops[id.index()]
    }

    /// Adds an operation, or finds the same one. An argument that is no value of this graph yet, which only
    /// a door with a bug has, is taken as the operation before.
    pub fn push(&mut self, mut op: Op) -> ValueId {
        let count = self.ops.len() as u32;
        op.args_mut().for_each(|arg| arg.0 = arg.0.min(count.saturating_sub(1)));
        if let Op::Constant(value) = &mut op {
            *value = finite(*value);
        }
        let recent = self.ops.len().saturating_sub(LOOK_BACK);
        let known = self.ops[recent..].iter().rposition(|known| *known == op).map(|i| recent + i);
        ValueId(known.unwrap_or_else(|| {
            self.ops.push(op);
            self.ops.len() - 1
        }) as u32)
    }

    /// The same value everywhere.
    pub fn constant(&mut self, value: Value) -> ValueId {
        self.push(Op::Constant(value))
    }

    /// The same number everywhere.
    pub fn number(&mut self, value: f64) -> ValueId {
        self.constant([value; 4])
    }

    /// What is known of the place where a ray met the surface.
    pub fn leaf(&mut self, leaf: Leaf) -> ValueId {
        self.push(Op::Leaf(leaf))
    }

    /// The value of what is the same everywhere.
    pub fn known(&self, id: ValueId) -> Option<Value> {
        match self.op(id) {
            Op::Constant(value) => Some(*value),
            _ => None,
        }
    }

    /// `function` of `args`; of constants a constant.
    pub fn apply(&mut self, function: Function, args: &[ValueId]) -> ValueId {
        let values: Option<Vec<Value>> = args.iter().map(|arg| self.known(*arg)).collect();
        match values {
            Some(values) => {
                let value = function.eval(&values);
                self.constant(value)
            }
            None => self.push(Op::Apply(function, args.to_vec())),
        }
    }

    /// Which operations `roots` depend on, themselves included.
    pub fn needed(&self, roots: impl IntoIterator<Item = ValueId>) -> Vec<bool> {
        let mut needed = vec![false; self.ops.len()];
        for root in roots {
            if let Some(needed) = needed.get_mut(root.index()) {
                *needed = true;
            }
        }
        for i in (0..needed.len()).rev() {
            if needed[i] {
                self.ops[i].args().for_each(|arg| needed[arg.index()] = true);
            }
        }
        needed
    }
}

/// `value` with 0 for what is NaN, infinite or −0: functions that are the same to the eye then are so to
/// the bit, whatever was folded.
pub fn finite(value: Value) -> Value {
    value.map(|x| if x.is_finite() { x + 0.0 } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constants_fold_and_the_same_is_not_made_twice() {
        let mut graph = Graph::default();
        let (two, three) = (graph.number(2.0), graph.number(3.0));
        let five = graph.apply(Function::Math(Math::Add), &[two, three]);
        assert_eq!(graph.known(five), Some([5.0; 4]));
        let uv = graph.leaf(Leaf::Uv(0));
        let once = graph.apply(Function::Math(Math::Multiply), &[uv, two]);
        assert_eq!(graph.apply(Function::Math(Math::Multiply), &[uv, two]), once);
        assert_eq!(graph.known(once), None);
        assert_eq!(graph.needed([once]), [true, false, false, true, true]);
        let bad = graph.constant([f64::NAN, f64::INFINITY, 1.0, -1.0]);
        assert_eq!(graph.known(bad), Some([0.0, 0.0, 1.0, -1.0]));
    }

    #[test]
    fn arguments_come_before_what_uses_them_whatever_a_door_does() {
        let mut other = Graph::default();
        let far = (0..9).map(|i| other.number(f64::from(i))).last().unwrap();
        let mut graph = Graph::default();
        let uv = graph.leaf(Leaf::Uv(0));
        let id = graph.push(Op::Apply(Function::Math(Math::Sine), vec![far]));
        assert_eq!(graph.op(id), &Op::Apply(Function::Math(Math::Sine), vec![uv]));
    }
}
