//! Walks a tree from a socket back to what it depends on, through links, groups, reroutes and muted
//! nodes, and builds the engine's graph on the way.

use std::collections::{HashMap, HashSet};

use super::super::image::Images;
use super::super::layers::UvSets;
use super::tree::{NodeData, SocketData, TreeData};
use super::values;
use crate::desc::graph::{Graph, Leaf, Quantity, Space, ValueId};
use crate::desc::{DecayDesc, DomeSun};
use crate::error::{Place, Warnings};

/// A node in its scope.
#[derive(Clone, Copy)]
pub struct At<'a> {
    /// Index of the scope.
    pub scope: usize,
    /// Index in the scope's tree.
    pub index: usize,
    /// The node.
    pub node: &'a NodeData,
}

/// Where a link leads to, past groups, reroutes and muted nodes.
#[derive(Clone, Copy)]
pub enum Source<'a> {
    /// An output of a node.
    Output(At<'a>, usize),
    /// An input that nothing is linked to: what its user set.
    Unlinked(&'a SocketData),
}

/// A tree as it is entered: a group that is used twice has two.
struct Scope<'a> {
    tree: &'a TreeData,
    /// The group node that it was entered by.
    group: Option<At<'a>>,
}

/// How deep groups may be nested.
const DEEPEST: usize = 64;

/// One material's, world's or lamp's tree on its way to a graph.
pub struct Flow<'a, 'i> {
    /// What was built so far.
    pub graph: Graph,
    /// The images that nodes ask for.
    pub images: &'a mut Images<'i>,
    /// UV sets by name.
    pub uv_sets: &'a UvSets,
    /// The version of Blender that the tree is from.
    pub version: [u32; 3],
    /// The material, world or lamp.
    pub place: Place,
    /// What a Light Falloff node says.
    pub falloff: Option<DecayDesc>,
    /// Suns of the skies so far.
    pub suns: Vec<DomeSun>,
    /// True for the tree of a world.
    pub is_world: bool,
    /// The shading normal that the displacement makes, where there is one.
    relief: Option<ValueId>,
    warnings: &'a mut Warnings,
    scopes: Vec<Scope<'a>>,
    entered: HashMap<(usize, usize), usize>,
    values: HashMap<(usize, usize, usize), ValueId>,
    /// Outputs whose value is being made: one that comes up again is a cycle.
    open: HashSet<(usize, usize, usize)>,
}

impl<'a, 'i> Flow<'a, 'i> {
    /// The flow of `tree`.
    pub fn new(
        tree: &'a TreeData,
        images: &'a mut Images<'i>,
        uv_sets: &'a UvSets,
        version: [u32; 3],
        place: Place,
        warnings: &'a mut Warnings,
    ) -> Self {
        Self {
            graph: Graph::default(),
            images,
            uv_sets,
            version,
            place,
            falloff: None,
            suns: Vec::new(),
            is_world: false,
            relief: None,
            warnings,
            scopes: vec![Scope { tree, group: None }],
            entered: HashMap::new(),
            values: HashMap::new(),
            open: HashSet::new(),
        }
    }

    /// Tells of something that was replaced or left out.
    pub fn warn(&mut self, what: impl Into<String>) {
        self.warnings.push(&self.place, what);
    }

    /// Where something of a node is told, and who takes it down.
    pub fn told_at(&mut self, node: &str) -> (Place, &mut Warnings) {
        (self.place.at(node), self.warnings)
    }

    /// The output node of the outermost tree: the active one, that of Cycles before that of others.
    pub fn output_node(&self, kind: &str) -> Option<At<'a>> {
        let tree = self.scopes[0].tree;
        let outputs = || tree.nodes.iter().enumerate().filter(|(_, node)| node.r#type == kind);
        let rank = |node: &NodeData| {
            let target = match node.text("target") {
                "CYCLES" => 4,
                "EEVEE" => 0,
                _ => 2,
            };
            target + u8::from(node.flag("is_active_output"))
        };
        let (index, node) = outputs().max_by_key(|(index, node)| (rank(node), std::cmp::Reverse(*index)))?;
        (node.text("target") != "EEVEE").then_some(At { scope: 0, index, node })
    }

    /// Where input `input` of a node comes from.
    pub fn source(&mut self, at: At<'a>, input: usize) -> Source<'a> {
        let (mut at, mut input) = (at, input);
        // Each step goes back along one link; a chain of reroutes may be a ring.
        for _ in 0..10_000 {
            let socket = &at.node.inputs[input];
            let Some([index, output]) = socket.link else { return Source::Unlinked(socket) };
            let Some(node) = self.scopes[at.scope].tree.nodes.get(index) else { return Source::Unlinked(socket) };
            let from = At { scope: at.scope, index, node };
            let passed = match node.r#type.as_str() {
                _ if node.mute => {
                    let link = node.internal_links.iter().find(|link| link[1] == output);
                    match link.filter(|link| link[0] < node.inputs.len()) {
                        Some(link) => Some((from, link[0])),
                        None => return Source::Unlinked(socket),
                    }
                }
                "NodeReroute" => Some((from, 0)),
                "ShaderNodeGroup" => self.group_output(from, output),
                "NodeGroupInput" => self.scopes[at.scope].group.and_then(|group| {
                    let id = &node.outputs.get(output)?.id;
                    Some((group, group.node.inputs.iter().position(|socket| socket.id == *id)?))
                }),
                _ => return Source::Output(from, output),
            };
            match passed {
                Some((next, of)) if of < next.node.inputs.len() => (at, input) = (next, of),
                _ => return Source::Unlinked(socket),
            }
        }
        self.warn("links run in a ring; the socket's own value is taken");
        Source::Unlinked(&at.node.inputs[input])
    }

    /// The input of a group's output node that its output `output` shows.
    fn group_output(&mut self, group: At<'a>, output: usize) -> Option<(At<'a>, usize)> {
        let id = &group.node.outputs.get(output)?.id;
        let scope = self.enter(group)?;
        let tree = self.scopes[scope].tree;
        let is_output = |node: &NodeData| node.r#type == "NodeGroupOutput";
        let outputs = || tree.nodes.iter().enumerate().filter(|(_, node)| is_output(node));
        let active = outputs().find(|(_, node)| node.flag("is_active_output")).or_else(|| outputs().next());
        let (index, node) = active?;
        Some((At { scope, index, node }, node.inputs.iter().position(|socket| socket.id == *id)?))
    }

    /// The scope of a group's tree; `None` for one without, or that is nested too deep.
    fn enter(&mut self, group: At<'a>) -> Option<usize> {
        let tree = group.node.tree.as_deref()?;
        if let Some(scope) = self.entered.get(&(group.scope, group.index)) {
            return Some(*scope);
        }
        if self.depth(group.scope) >= DEEPEST {
            self.warn(format!("groups are nested more than {DEEPEST} deep; the inner ones are left out"));
            return None;
        }
        self.scopes.push(Scope { tree, group: Some(group) });
        self.entered.insert((group.scope, group.index), self.scopes.len() - 1);
        Some(self.scopes.len() - 1)
    }

    /// Every node of a kind, those in groups that are not muted included; of a group that is used twice both.
    pub fn all_of(&mut self, kind: &str) -> Vec<At<'a>> {
        let (mut found, mut scopes) = (Vec::new(), vec![0]);
        while let Some(scope) = scopes.pop() {
            let tree = self.scopes[scope].tree;
            for (index, node) in tree.nodes.iter().enumerate() {
                let at = At { scope, index, node };
                if node.r#type == kind {
                    found.push(at);
                } else if node.r#type == "ShaderNodeGroup" && !node.mute {
                    scopes.extend(self.enter(at));
                }
            }
        }
        found
    }

    fn depth(&self, scope: usize) -> usize {
        std::iter::successors(self.scopes[scope].group, |group| self.scopes[group.scope].group).count()
    }

    /// Lets all that follows see the normal that the displacement makes.
    pub fn set_relief(&mut self, relief: Option<ValueId>) {
        self.relief = relief;
        // Values so far go by the normal without it.
        self.values.clear();
    }

    /// The normal that the displacement makes.
    pub fn relief(&self) -> Option<ValueId> {
        self.relief
    }

    /// The shading normal, world space.
    pub fn normal(&mut self) -> ValueId {
        self.relief.unwrap_or_else(|| self.graph.leaf(Leaf::Normal))
    }

    /// The shading normal, object space.
    pub fn object_normal(&mut self) -> ValueId {
        match self.relief {
            Some(normal) => self.graph.transform(Quantity::Normal, Space::World, Space::Object, normal),
            None => self.graph.leaf(Leaf::ObjectNormal),
        }
    }

    /// True where something is linked to the input.
    pub fn is_linked(&mut self, at: At<'a>, name: &str) -> bool {
        at.node.input(name).is_some_and(|input| matches!(self.source(at, input), Source::Output(..)))
    }

    /// True where something is linked to the output.
    pub fn is_used(&self, at: At<'a>, output: usize) -> bool {
        let from = Some([at.index, output]);
        self.scopes[at.scope].tree.nodes.iter().flat_map(|node| &node.inputs).any(|input| input.link == from)
    }

    /// The value of an input, as its socket's type has it; 0 for a socket that this version of the node
    /// does not have.
    pub fn input(&mut self, at: At<'a>, name: &str) -> ValueId {
        match at.node.input(name) {
            Some(input) => self.input_at(at, input),
            None => self.graph.number(0.0),
        }
    }

    /// The value of an input that this version of the node may lack.
    pub fn input_or(&mut self, at: At<'a>, name: &str, otherwise: f64) -> ValueId {
        match at.node.input(name) {
            Some(input) => self.input_at(at, input),
            None => self.graph.number(otherwise),
        }
    }

    /// The value of an input whose default is not its own value: a normal, a texture's coordinates.
    pub fn linked_or(&mut self, at: At<'a>, name: &str, otherwise: impl FnOnce(&mut Self) -> ValueId) -> ValueId {
        match at.node.input(name) {
            Some(input) if matches!(self.source(at, input), Source::Output(..)) => self.input_at(at, input),
            _ => otherwise(self),
        }
    }

    /// The value of the input of this index.
    pub fn input_at(&mut self, at: At<'a>, input: usize) -> ValueId {
        let kind = at.node.inputs[input].r#type.as_str();
        match self.source(at, input) {
            Source::Unlinked(socket) => {
                let value = self.graph.constant(socket.value.places());
                self.converted(value, &socket.r#type, kind)
            }
            Source::Output(from, output) => {
                let value = self.output(from, output);
                let from = from.node.outputs.get(output).map_or("", |socket| socket.r#type.as_str());
                self.converted(value, from, kind)
            }
        }
    }

    /// The value of an output as a color.
    pub fn color_of(&mut self, at: At<'a>, output: usize) -> ValueId {
        let value = self.output(at, output);
        let from = at.node.outputs.get(output).map_or("", |socket| socket.r#type.as_str());
        self.converted(value, from, "RGBA")
    }

    fn output(&mut self, at: At<'a>, output: usize) -> ValueId {
        let key = (at.scope, at.index, output);
        if let Some(value) = self.values.get(&key) {
            return *value;
        }
        if !self.open.insert(key) {
            self.warn(format!("the node \"{}\" depends on itself; 0 is taken for it", at.node.name));
            return self.graph.number(0.0);
        }
        let value = values::output(self, at, output);
        self.open.remove(&key);
        self.values.insert(key, value);
        value
    }

    /// A value between sockets of two types, as Blender converts it.
    fn converted(&mut self, value: ValueId, from: &str, to: &str) -> ValueId {
        match (from, to) {
            ("RGBA", "VALUE" | "INT" | "BOOLEAN") => self.graph.luminance(value),
            ("VECTOR", "VALUE" | "INT" | "BOOLEAN") => self.graph.average(value),
            _ => value,
        }
    }
}
