//! A node tree as plain data.

use std::collections::HashMap;

use serde::Deserialize;
use serde_json::Value as Json;

/// A node tree; groups hold trees of their own.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct TreeData {
    /// Its name.
    pub name: String,
    /// Its nodes, muted ones included.
    pub nodes: Vec<NodeData>,
}

/// A node.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct NodeData {
    /// Its name, unique within the tree.
    pub name: String,
    /// `bl_idname`.
    pub r#type: String,
    /// True where it passes its inputs on.
    pub mute: bool,
    /// Its inputs, those that are switched off included, in their order.
    pub inputs: Vec<SocketData>,
    /// Its outputs, likewise.
    pub outputs: Vec<SocketData>,
    /// Pairs of an input and the output that it goes on to where the node is muted.
    pub internal_links: Vec<[usize; 2]>,
    /// Every property of the node that is no socket: numbers, strings, arrays, curves, ramps.
    pub properties: HashMap<String, Json>,
    /// The tree of a group.
    pub tree: Option<Box<TreeData>>,
}

/// An input or output of a node.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub struct SocketData {
    /// `identifier`.
    pub id: String,
    /// `name`, which the user sees.
    pub name: String,
    /// `VALUE`, `INT`, `BOOLEAN`, `VECTOR`, `RGBA`, `SHADER`, …
    pub r#type: String,
    /// False where the node's settings have switched it off.
    pub enabled: bool,
    /// True where nothing but a link gives it a value (the normal of a BSDF).
    pub hide_value: bool,
    /// `default_value`, where it has one.
    pub value: Value,
    /// Where an input comes from: index of the node, index of its output.
    pub link: Option<[usize; 2]>,
}

/// A socket's value.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A number, or a flag.
    Number(f64),
    /// A vector or a colour.
    Vector(Vec<f64>),
    /// A flag.
    Flag(bool),
    /// A string.
    Text(String),
    /// None.
    #[default]
    Nothing,
}

impl TreeData {
    /// Names of all UV maps that the tree or a group in it may mean.
    pub fn uv_map_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        for node in &self.nodes {
            let name = match node.r#type.as_str() {
                "ShaderNodeUVMap" | "ShaderNodeNormalMap" | "ShaderNodeTangent" => node.text("uv_map"),
                "ShaderNodeAttribute" => node.text("attribute_name"),
                _ => "",
            };
            if !name.is_empty() {
                names.push(name.to_owned());
            }
            names.extend(node.tree.iter().flat_map(|tree| tree.uv_map_names()));
        }
        names
    }
}

impl TreeData {
    /// Names of all UV maps whose tangents the tree or a group in it asks for; "" for the one to render with.
    pub fn tangent_map_names(&self) -> Vec<String> {
        let mut names = Vec::new();
        for node in &self.nodes {
            let asks = match node.r#type.as_str() {
                "ShaderNodeNormalMap" => node.text("space") == "TANGENT",
                "ShaderNodeTangent" => node.text("direction_type") == "UV_MAP",
                _ => false,
            };
            if asks {
                names.push(node.text("uv_map").to_owned());
            }
            names.extend(node.tree.iter().flat_map(|tree| tree.tangent_map_names()));
        }
        names
    }
}

impl NodeData {
    /// Index of the input of this identifier, or of this name.
    pub fn input(&self, name: &str) -> Option<usize> {
        find(&self.inputs, name)
    }

    /// Index of the output of this identifier, or of this name.
    pub fn output(&self, name: &str) -> Option<usize> {
        find(&self.outputs, name)
    }

    /// A property that is a text or an enum; "" where there is none.
    pub fn text(&self, name: &str) -> &str {
        self.properties.get(name).and_then(Json::as_str).unwrap_or_default()
    }

    /// A property that is a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.properties.get(name).and_then(Json::as_f64)
    }

    /// A property that is three numbers.
    pub fn vector(&self, name: &str) -> Option<[f64; 3]> {
        let list = self.properties.get(name)?.as_array()?;
        let place = |i: usize| list.get(i).and_then(Json::as_f64);
        Some([place(0)?, place(1)?, place(2)?])
    }

    /// A property that is a flag; false where there is none.
    pub fn flag(&self, name: &str) -> bool {
        self.properties.get(name).and_then(Json::as_bool).unwrap_or(false)
    }
}

fn find(sockets: &[SocketData], name: &str) -> Option<usize> {
    sockets.iter().position(|s| s.id == name).or_else(|| sockets.iter().position(|s| s.name == name && s.enabled))
}

impl Value {
    /// As the four places of a graph's value: a number in all of them.
    pub fn places(&self) -> [f64; 4] {
        match self {
            Self::Number(x) => [*x; 4],
            Self::Flag(flag) => [f64::from(u8::from(*flag)); 4],
            Self::Vector(v) => {
                let place = |i: usize| v.get(i).copied().unwrap_or(if i == 3 { 1.0 } else { 0.0 });
                [place(0), place(1), place(2), place(3)]
            }
            Self::Text(_) | Self::Nothing => [0.0; 4],
        }
    }
}
