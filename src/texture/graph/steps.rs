//! The steps of a program in the making: shared where they are the same.

use std::collections::HashMap;

use super::affine::Affine;
use super::hit::{is_number, sees};
use super::program::{Action, Asks};
use crate::desc::graph::{Blend, Function, Leaf, Math, Value, finite};

/// What a step is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Arg {
    /// Index of a constant.
    Constant(u32),
    /// Index of a step.
    Step(u32),
}

/// A step in the making.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub action: Action,
    pub args: Vec<Arg>,
    /// True where the result stands in all four places.
    number: bool,
    affine: Option<Affine>,
}

/// All steps so far, arguments first.
#[derive(Debug, Default)]
pub(super) struct Steps {
    pub nodes: Vec<Node>,
    pub constants: Vec<Value>,
    /// Constants by their bits.
    known_constants: HashMap<[u64; 4], u32>,
    /// Steps by their arguments.
    known: HashMap<Vec<Arg>, Vec<u32>>,
}

impl Steps {
    pub fn constant(&mut self, value: Value) -> Arg {
        let value = finite(value);
        let constants = &mut self.constants;
        Arg::Constant(*self.known_constants.entry(value.map(f64::to_bits)).or_insert_with(|| {
            constants.push(value);
            constants.len() as u32 - 1
        }))
    }

    /// The value of a constant.
    pub fn value(&self, arg: Arg) -> Option<Value> {
        match arg {
            Arg::Constant(i) => Some(self.constants[i as usize]),
            Arg::Step(_) => None,
        }
    }

    /// How `arg` comes from a UV set, where it does so by an affine map.
    pub fn affine(&self, arg: Arg) -> Option<Affine> {
        match arg {
            Arg::Constant(i) => Some(Affine::constant(self.constants[i as usize])),
            Arg::Step(i) => self.nodes[i as usize].affine,
        }
    }

    fn is_number(&self, arg: &Arg) -> bool {
        match arg {
            Arg::Constant(i) => {
                let [x, y, z, w] = self.constants[*i as usize];
                x == y && y == z && z == w
            }
            Arg::Step(i) => self.nodes[*i as usize].number,
        }
    }

    /// A function of `args`, folded where it can be.
    pub fn apply(&mut self, function: &Function, args: Vec<Arg>) -> Arg {
        let values: Option<Vec<Value>> = args.iter().map(|arg| self.value(*arg)).collect();
        if let Some(values) = values {
            return self.constant(function.eval(&values));
        }
        if let Some(same) = self.simpler(function, &args) {
            return same;
        }
        let number = match function {
            Function::Math(_) | Function::MapRange { .. } | Function::Mix { blend: Blend::Mix, .. } => {
                args.iter().all(|arg| self.is_number(arg))
            }
            Function::IfGreater | Function::IfGreaterOrEqual | Function::IfEqual => {
                args.iter().skip(2).all(|arg| self.is_number(arg)) && args.len() == 4
            }
            Function::Dot(_)
            | Function::Length(_)
            | Function::Distance
            | Function::Fresnel
            | Function::LayerFresnel
            | Function::LayerFacing
            | Function::Ies(_) => true,
            Function::Swizzle(places) => places.iter().all(|place| *place == places[0]),
            _ => false,
        };
        let affine = args.iter().map(|arg| self.affine(*arg)).collect::<Option<Vec<_>>>();
        let affine = affine.and_then(|args| Affine::apply(function, &args));
        let action = match function {
            Function::Math(math) if number => Action::Number(*math),
            function => Action::Apply(function.clone()),
        };
        self.push(Node { action, args, number, affine })
    }

    /// What a function is without computing it, exactly.
    fn simpler(&self, function: &Function, args: &[Arg]) -> Option<Arg> {
        let is = |arg: Arg, value: f64| self.value(arg) == Some([value; 4]);
        match (function, args) {
            (Function::Math(Math::Add), &[a, b]) if is(b, 0.0) => Some(a),
            (Function::Math(Math::Add), &[a, b]) if is(a, 0.0) => Some(b),
            (Function::Math(Math::Subtract), &[a, b]) if is(b, 0.0) => Some(a),
            (Function::Math(Math::Multiply), &[a, b]) if is(b, 1.0) || is(a, 0.0) => Some(a),
            (Function::Math(Math::Multiply), &[a, b]) if is(a, 1.0) || is(b, 0.0) => Some(b),
            (Function::Math(Math::Divide), &[a, b]) if is(b, 1.0) => Some(a),
            (Function::Math(Math::MultiplyAdd), &[a, b, c]) if is(b, 1.0) && is(c, 0.0) => Some(a),
            (Function::Swizzle([0, 1, 2, 3]), &[a]) => Some(a),
            (Function::Swizzle(_), &[a]) if self.is_number(&a) => Some(a),
            (Function::Mix { blend: Blend::Mix, clamp_result: false, .. }, &[t, a, b]) => match () {
                () if is(t, 0.0) => Some(a),
                () if is(t, 1.0) => Some(b),
                () => None,
            },
            (Function::IfGreater, &[a, b, yes, no]) if yes == no || a == b => Some(no),
            _ => None,
        }
    }

    /// A step that is no function.
    pub fn step(&mut self, action: Action, args: Vec<Arg>) -> Arg {
        let (number, affine) = match &action {
            Action::Leaf(Leaf::Uv(set), _) => (false, Some(Affine::uv(*set))),
            Action::Leaf(leaf, _) => (is_number(leaf), None),
            Action::Albedo(_) => (true, None),
            _ => (false, None),
        };
        self.push(Node { action, args, number, affine })
    }

    fn push(&mut self, node: Node) -> Arg {
        let alike = self.known.entry(node.args.clone()).or_default();
        if let Some(&same) = alike.iter().find(|i| self.nodes[**i as usize].action == node.action) {
            return Arg::Step(same);
        }
        alike.push(self.nodes.len() as u32);
        self.nodes.push(node);
        Arg::Step(self.nodes.len() as u32 - 1)
    }

    /// What the steps that `needed` marks go by.
    pub fn asks(&self, needed: &[bool]) -> Asks {
        let mut asks = Asks::default();
        for (node, _) in self.nodes.iter().zip(needed).filter(|(_, needed)| **needed) {
            match &node.action {
                Action::Leaf(leaf, _) => {
                    asks.view |= sees(leaf);
                    asks.path |= matches!(leaf, Leaf::Path(_));
                }
                Action::Bump { .. } | Action::Relief | Action::Albedo(_) => asks.view = true,
                _ => {}
            }
        }
        asks
    }
}
