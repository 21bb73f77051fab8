//! The same graph where more is known: for the rays of one kind, or in one direction.

use super::{Blend, Function, Graph, Math, Op, Value, ValueId};

impl Graph {
    /// `root` where the operations that `known` names have the values that it gives, and what follows of that.
    pub fn replaced(&mut self, root: ValueId, known: impl Fn(ValueId, &Op) -> Option<Value>) -> ValueId {
        let needed = self.needed([root]);
        let mut replaced: Vec<ValueId> = (0..=root.0).map(ValueId).collect();
        for i in (0..=root.index()).filter(|i| needed[*i]) {
            let old = replaced[i];
            let mut op = self.ops[i].clone();
            if let Some(value) = known(old, &op) {
                replaced[i] = self.constant(value);
                continue;
            }
            let mut same = true;
            op.args_mut().for_each(|arg| {
                let new = replaced[arg.index()];
                same &= new == *arg;
                *arg = new;
            });
            if !same {
                replaced[i] = match op {
                    Op::Apply(function, args) => match self.shortcut(&function, &args) {
                        Some(value) => value,
                        None => self.apply(function, &args),
                    },
                    op => self.push(op),
                };
            }
        }
        replaced[root.index()]
    }

    /// What a function comes to that one argument decides: products with 0 and 1, sums with 0, mixes of one
    /// side.
    fn shortcut(&self, function: &Function, args: &[ValueId]) -> Option<ValueId> {
        let is = |i: usize, value: f64| args.get(i).is_some_and(|arg| self.known(*arg) == Some([value; 4]));
        let pick = |which: usize, yes: bool| if yes { args.get(which).copied() } else { None };
        match function {
            Function::Math(Math::Multiply) => pick(0, is(0, 0.0) || is(1, 1.0)).or(pick(1, is(1, 0.0) || is(0, 1.0))),
            Function::Math(Math::Add) => pick(1, is(0, 0.0)).or(pick(0, is(1, 0.0))),
            Function::Mix { blend: Blend::Mix, clamp_result: false, .. } => pick(1, is(0, 0.0)).or(pick(2, is(0, 1.0))),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::graph::{Leaf, PathInfo};

    #[test]
    fn what_is_known_decides_what_is_left() {
        let mut graph = Graph::default();
        let (camera, position) = (graph.leaf(Leaf::Path(PathInfo::IsCamera)), graph.leaf(Leaf::Position));
        let one = graph.number(1.0);
        let others = graph.subtract(one, camera);
        let sky = graph.math(Math::Sine, &[position]);
        let lit = graph.multiply(others, sky);
        let seen = graph.multiply(camera, position);
        let sum = graph.add(lit, seen);
        let is_camera = |op: &Op| *op == Op::Leaf(Leaf::Path(PathInfo::IsCamera));
        assert_eq!(graph.replaced(sum, |_, op| is_camera(op).then_some([1.0; 4])), position);
        assert_eq!(graph.replaced(sum, |_, op| is_camera(op).then_some([0.0; 4])), sky);
        // In one direction nothing is left to know.
        let there = graph.replaced(sum, |_, op| {
            Some(if is_camera(op) {
                [0.5; 4]
            } else if *op == Op::Leaf(Leaf::Position) {
                [2.0; 4]
            } else {
                return None;
            })
        });
        assert_eq!(graph.known(there), Some([0.5 * 2.0_f64.sin() + 1.0; 4]));
    }
}
