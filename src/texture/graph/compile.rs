//! From the graph as authored to programs.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use super::allocate;
use super::hit::{Beside, HERE, varies};
use super::program::{Action, LEVEL, MOST_ARGS, NEAR, Program};
use super::sky::Sky;
use super::steps::{Arg, Steps};
use crate::desc::graph::{Bump, Graph, Leaf, Op, Relief, Value, ValueId};
use crate::texture::TextureRef;

/// Images and bumps within the coordinates of images and the heights of bumps are filtered so deep.
const DEEPEST: u32 = 12;

/// And until a material has so many steps.
const MOST_STEPS: usize = 1 << 16;

/// What a texture of the description is to the programs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Resolved {
    /// The same everywhere.
    Constant(Value),
    /// Index of a texture of the scene.
    Texture(u32),
}

/// Where names and indices of the description lead.
pub trait Resolve {
    /// Texture `texture` of the `SceneDesc`.
    fn texture(&mut self, texture: u32) -> Resolved;

    /// Slot of the named attribute.
    fn attribute(&mut self, name: &Arc<str>) -> u16;

    /// `MaterialDesc::material_index`.
    fn material_index(&self) -> u32;
}

/// Compiles values of one material's graph.
pub struct Compiler<'a, R> {
    graph: &'a Graph,
    resolve: &'a mut R,
    steps: Steps,
    known: HashMap<(ValueId, [u32; 2]), Arg>,
}

impl<'a, R: Resolve> Compiler<'a, R> {
    /// For `graph`, whose indices `desc::check` has found to be right.
    pub fn new(graph: &'a Graph, resolve: &'a mut R) -> Self {
        Self { graph, resolve, steps: Steps::default(), known: HashMap::new() }
    }

    /// A value that is the same everywhere.
    pub fn constant(&mut self, id: ValueId) -> Option<Value> {
        let arg = self.lower(id, HERE, 0);
        self.steps.value(arg)
    }

    /// A program for `values`; what they share is computed once.
    pub fn program(&mut self, values: &[ValueId]) -> Program {
        let outputs: Vec<Arg> = values.iter().map(|id| self.lower(*id, HERE, 0)).collect();
        allocate::program(&self.steps, &outputs)
    }

    /// The step that makes `root` at a point, and all those before it.
    fn lower(&mut self, root: ValueId, at: Beside, depth: u32) -> Arg {
        let key = |id: ValueId| (id, at.map(f32::to_bits));
        // What is not there yet, found without recursion: chains of operations may be long.
        let (mut missing, mut seen, mut open) = (Vec::new(), HashSet::new(), vec![root]);
        while let Some(id) = open.pop() {
            if !self.known.contains_key(&key(id)) && seen.insert(id) {
                missing.push(id);
                open.extend(self.graph.op(id).args());
            }
        }
        missing.sort_unstable();
        for id in missing {
            let arg = self.one(id, at, depth);
            self.known.insert(key(id), arg);
        }
        self.known[&key(root)]
    }

    /// One operation whose arguments are there.
    fn one(&mut self, id: ValueId, at: Beside, depth: u32) -> Arg {
        let graph = self.graph;
        let args = |c: &Self, ids: &[ValueId]| -> Vec<Arg> {
            ids.iter().take(MOST_ARGS).map(|id| c.known[&(*id, at.map(f32::to_bits))]).collect()
        };
        match graph.op(id) {
            Op::Constant(value) => self.steps.constant(*value),
            Op::Leaf(Leaf::MaterialIndex) => {
                let index = f64::from(self.resolve.material_index());
                self.steps.constant([index; 4])
            }
            Op::Leaf(Leaf::Attribute { name, fallback }) => {
                let slot = self.resolve.attribute(name);
                self.steps.step(Action::Attribute(slot, *fallback, at), Vec::new())
            }
            Op::Leaf(leaf) => {
                let at = if varies(leaf) { at } else { HERE };
                self.steps.step(Action::Leaf(leaf.clone(), at), Vec::new())
            }
            Op::Apply(function, ids) => {
                let args = args(self, ids);
                self.steps.apply(function, args)
            }
            Op::Procedural(texture, ids) => {
                let args = args(self, ids);
                self.steps.step(Action::Procedural(*texture), args)
            }
            Op::Sky { sky, direction } => {
                let args = args(self, &[*direction]);
                self.steps.step(Action::Sky(Sky::new(sky)), args)
            }
            Op::Transform { quantity, from, to, value } => {
                let args = args(self, &[*value]);
                self.steps.step(Action::Transform(*quantity, *from, *to), args)
            }
            Op::Image { texture, uv } => self.image(*texture, *uv, at, depth),
            Op::Bump(bump) => self.bump(bump, depth),
            Op::Relief(relief) => self.relief(relief, depth),
            Op::Albedo { layer, roughness, ior, normal } => {
                let args = args(self, &[*roughness, *ior, *normal]);
                self.steps.step(Action::Albedo(*layer), args)
            }
        }
    }

    fn image(&mut self, texture: u32, uv: ValueId, at: Beside, depth: u32) -> Arg {
        let texture = match self.resolve.texture(texture) {
            Resolved::Constant(value) => return self.steps.constant(value),
            Resolved::Texture(texture) => texture,
        };
        let looked_up = self.known[&(uv, at.map(f32::to_bits))];
        if let Some((uv_set, transform)) = self.steps.affine(looked_up).and_then(|affine| affine.placement()) {
            let texture = TextureRef { texture, uv_set, transform: transform.into() };
            return self.steps.step(Action::Texture(texture, at), Vec::new());
        }
        let [here, x, y] = self.around(uv, NEAR, depth);
        self.steps.step(Action::Image(texture), vec![looked_up, here, x, y])
    }

    /// The normal bent at the hit: no bump is bent by another one that is beside it.
    fn bump(&mut self, bump: &Bump, depth: u32) -> Arg {
        let [strength, distance, normal] =
            [bump.strength, bump.distance, bump.normal].map(|id| self.lower(id, HERE, depth + 1));
        let width = if bump.filter_width > 0.0 { bump.filter_width.min(1e3) } else { 1.0 };
        let [here, x, y] = self.around(bump.height, width as f32, depth);
        if here == x && here == y {
            return normal;
        }
        let action = Action::Bump { filter_width: f64::from(width as f32), object_space: bump.object_space };
        self.steps.step(action, vec![here, x, y, strength, distance, normal])
    }

    /// The slope at the hit, as [`Compiler::bump`] has it.
    fn relief(&mut self, relief: &Relief, depth: u32) -> Arg {
        let scale = self.lower(relief.scale, HERE, depth + 1);
        let heights = self.around(relief.height, 1.0, depth);
        if heights[0] == heights[1] && heights[0] == heights[2] {
            return self.steps.constant(LEVEL);
        }
        let uvs = self.around(relief.uv, 1.0, depth);
        self.steps.step(Action::Relief, heights.into_iter().chain(uvs).chain([scale]).collect())
    }

    /// A value at the hit and at two points beside it.
    fn around(&mut self, id: ValueId, width: f32, depth: u32) -> [Arg; 3] {
        let here = self.lower(id, HERE, depth + 1);
        if depth >= DEEPEST || self.steps.nodes.len() >= MOST_STEPS {
            return [here; 3];
        }
        [here, self.lower(id, [width, 0.0], depth + 1), self.lower(id, [0.0, width], depth + 1)]
    }
}
