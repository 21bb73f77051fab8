//! The nodes of a network to expressions.

use std::collections::HashMap;
use std::sync::Arc;

use super::expr::{Exprs, Id, Op};
use super::network::{Network, Node, Source, Value};
use super::surface::Surface;
use super::{Materials, color, gltf, pattern, texture};
use crate::desc::graph::{Function, Value as V};

/// The longest chain of nodes that is followed.
const DEEPEST: usize = 256;

/// Works through one network.
pub(super) struct Evaluator<'m, 'a> {
    pub materials: &'m mut Materials<'a>,
    pub network: &'m Network,
    pub exprs: Exprs,
    known: HashMap<(usize, String), Id>,
    /// Nodes being worked on: one that is met again closes a cycle.
    open: Vec<usize>,
    /// BSDF and EDF nodes that are worked out, or being so: `None` and black.
    pub scattering: HashMap<usize, Option<Surface>>,
    pub emission: HashMap<usize, Id>,
}

impl<'m, 'a> Evaluator<'m, 'a> {
    pub fn new(materials: &'m mut Materials<'a>, network: &'m Network) -> Self {
        Self {
            materials,
            network,
            exprs: Exprs::default(),
            known: HashMap::new(),
            open: Vec::new(),
            scattering: HashMap::new(),
            emission: HashMap::new(),
        }
    }

    pub fn node(&self, node: usize) -> &'m Node {
        &self.network.nodes[node]
    }

    /// Tells of something replaced or left out at `node`.
    pub fn warn(&self, node: usize, what: impl Into<String>) {
        self.materials.reading.warnings.borrow_mut().push(&self.node(node).place, what);
    }

    /// What `input` of `node` is, `default` where nothing is said.
    pub fn input(&mut self, node: usize, input: &str, default: V) -> Id {
        self.optional(node, input).unwrap_or_else(|| self.exprs.constant(default))
    }

    /// A number; all four places hold it.
    pub fn scalar(&mut self, node: usize, input: &str, default: f64) -> Id {
        let id = self.input(node, input, [default; 4]);
        match self.exprs.known(id) {
            Some(value) => self.exprs.number(value[0]),
            None => id,
        }
    }

    /// A number that has to be the same everywhere; `default`, with a warning, for one that is not.
    pub fn uniform(&mut self, node: usize, input: &str, default: f64) -> f64 {
        let id = self.scalar(node, input, default);
        match self.exprs.known(id) {
            Some(value) => value[0],
            None => {
                self.warn(node, format!("{input} can't vary over the surface; {default} is used"));
                default
            }
        }
    }

    /// What `input` of `node` is; `None` where nothing is said.
    pub fn optional(&mut self, node: usize, input: &str) -> Option<Id> {
        let found = self.node(node).inputs.get(input)?;
        if let Some(source) = &found.source {
            return self.output(source);
        }
        match found.value.as_ref()? {
            Value::Numbers(values, count) => {
                let value = widen(*values, *count);
                let id = self.exprs.constant(value.map(|x| if x.is_finite() { x } else { 0.0 }));
                let space = found.color_space.as_deref().filter(|_| *count >= 3);
                Some(match space {
                    Some(space) => color::convert(&mut self.exprs, id, space).unwrap_or(id),
                    None => id,
                })
            }
            Value::Text(_) | Value::File(_) => None,
        }
    }

    /// The value of a node's output; `None`, with a warning, for a node that can't be computed.
    pub fn output(&mut self, source: &Source) -> Option<Id> {
        let key = (source.node, source.output.clone());
        if let Some(&known) = self.known.get(&key) {
            return Some(known);
        }
        if self.open.contains(&source.node) {
            self.warn(source.node, "is connected to itself in a circle; the connection is left out");
            return None;
        }
        if self.open.len() > DEEPEST {
            self.warn(source.node, format!("lies deeper than {DEEPEST} nodes; left out"));
            return None;
        }
        self.open.push(source.node);
        let id = self.compute(source.node, &source.output);
        self.open.pop();
        if let Some(id) = id {
            self.known.insert(key, id);
        }
        id
    }

    fn compute(&mut self, node: usize, output: &str) -> Option<Id> {
        let place = |name: &str| match name.trim_start_matches("out") {
            "r" | "x" => Some(0),
            "g" | "y" => Some(1),
            "b" | "z" => Some(2),
            "a" | "w" => Some(3),
            _ => None,
        };
        let category = self.node(node).category.as_str();
        match category {
            "image" | "tiledimage" => texture::image(self, node, category == "tiledimage"),
            "gltf_image" => gltf::image(self, node),
            "gltf_colorimage" => gltf::color_image(self, node, output),
            "gltf_normalmap" => gltf::normal_map(self, node),
            "UsdUVTexture" => {
                let id = texture::usd(self, node)?;
                Some(place(output).map_or(id, |place| self.exprs.extract(id, place)))
            }
            "texcoord" => Some(self.texcoord("st".into())),
            "UsdTransform2d" => texture::transform(self, node),
            "place2d" => texture::place(self, node),
            "geompropvalue" | "geompropvalueuniform" | "UsdPrimvarReader" | "geomcolor" => self.primvar(node),
            "separate2" | "separate3" | "separate4" => {
                let id = self.input(node, "in", [0.0; 4]);
                Some(self.exprs.extract(id, place(output)?))
            }
            "artistic_ior" => Some(pattern::artistic_ior(self, node, output == "extinction")),
            _ => pattern::compute(self, node),
        }
    }

    /// USD's texture coordinates in the primvar `name`.
    pub fn texcoord(&mut self, name: Arc<str>) -> Id {
        if self.materials.per_instance.contains(&name) {
            return self.exprs.push(Op::Primvar { name, fallback: [0.0, 0.0, 0.0, 1.0] });
        }
        let set = self.materials.uv_set(name);
        self.exprs.push(Op::Uv { set, rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] })
    }

    /// A primvar: texture coordinates, or something that only shapes know.
    fn primvar(&mut self, node: usize) -> Option<Id> {
        let data = self.node(node);
        let name = match data.category.as_str() {
            "geomcolor" => "displayColor",
            _ => data.text("varname").or(data.text("geomprop")).unwrap_or_default(),
        };
        let is_uv = matches!(data.kind.as_str(), "float2" | "vector2");
        let given = if data.has("fallback") { "fallback" } else { "default" };
        let name: Arc<str> = name.strip_prefix("primvars:").unwrap_or(name).into();
        if name.is_empty() {
            self.warn(node, "names no primvar; its fallback is used");
            return Some(self.input(node, given, [0.0; 4]));
        }
        if is_uv {
            return Some(self.texcoord(name));
        }
        let fallback = self.input(node, given, [0.0; 4]);
        let fallback = self.exprs.known(fallback).unwrap_or_default();
        Some(self.exprs.push(Op::Primvar { name, fallback }))
    }

    /// A function of inputs, each with its default.
    pub fn function(&mut self, node: usize, function: Function, inputs: &[(&str, f64)]) -> Id {
        let args: Vec<Id> = inputs.iter().map(|(name, default)| self.input(node, name, [*default; 4])).collect();
        self.exprs.apply(function, &args)
    }
}

/// One number to all four places; a color without alpha has alpha 1.
pub(super) fn widen(v: V, count: u8) -> V {
    match count {
        1 => [v[0]; 4],
        2 => [v[0], v[1], 0.0, 1.0],
        3 => [v[0], v[1], v[2], 1.0],
        _ => v,
    }
}
