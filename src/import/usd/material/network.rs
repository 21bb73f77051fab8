//! A shading network as plain data: nodes with inputs that hold values or are connected. USD prims and
//! MaterialX documents both become one.

use std::collections::BTreeMap;

use super::super::images::File;
use crate::error::Place;

/// The nodes of one material.
#[derive(Clone, Debug, Default)]
pub(super) struct Network {
    pub nodes: Vec<Node>,
}

/// A node.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// What it does, as "image", "mix", "UsdUVTexture".
    pub category: String,
    /// The type in its identifier, as "color3"; empty where there is none.
    pub kind: String,
    /// True for a node that MaterialX defines; its defaults differ from USD's.
    pub materialx: bool,
    pub place: Place,
    pub inputs: BTreeMap<String, Input>,
}

/// An input of a node.
#[derive(Clone, Debug, Default)]
pub(super) struct Input {
    pub value: Option<Value>,
    pub source: Option<Source>,
    /// Color space of the value or of the file.
    pub color_space: Option<String>,
}

/// What an input is connected to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Source {
    pub node: usize,
    pub output: String,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// One to four numbers; booleans are 0 or 1.
    Numbers([f64; 4], u8),
    Text(String),
    File(File),
}

/// Categories whose names other ones begin with, or that hold an underscore, longest first.
const WITH_UNDERSCORE: &[&str] = &[
    "generalized_schlick_bsdf",
    "oren_nayar_diffuse_bsdf",
    "burley_diffuse_bsdf",
    "open_pbr_anisotropy",
    "open_pbr_surface",
    "roughness_anisotropy",
    "standard_surface",
    "translucent_bsdf",
    "dielectric_bsdf",
    "subsurface_bsdf",
    "conductor_bsdf",
    "surface_unlit",
    "artistic_ior",
    "uniform_edf",
    "sheen_bsdf",
    "gltf_pbr",
];

/// What types of MaterialX begin with; identifiers end with those of a node's output and, at times, inputs.
const TYPES: &[&str] = &[
    "float",
    "integer",
    "boolean",
    "color3",
    "color4",
    "vector2",
    "vector3",
    "vector4",
    "matrix33",
    "matrix44",
    "string",
    "filename",
    "surfaceshader",
    "displacementshader",
    "volumeshader",
    "lightshader",
    "bsdf",
    "edf",
    "vdf",
];

/// Types of USD's own readers of primvars that are not among them.
const TYPES_OF_READERS: &[&str] = &["int", "point", "normal", "vector", "matrix"];

/// Category and type of a node's identifier: `ND_mix_color3` is "mix" and "color3",
/// `UsdPrimvarReader_float2` "UsdPrimvarReader" and "float2".
pub(super) fn category(id: &str) -> (&str, &str) {
    let name = id.strip_prefix("ND_").unwrap_or(id);
    for known in WITH_UNDERSCORE {
        if let Some(rest) = name.strip_prefix(known)
            && (rest.is_empty() || rest.starts_with('_'))
        {
            return (known, rest.trim_start_matches('_'));
        }
    }
    let is_type = |rest: &str| TYPES.iter().any(|kind| rest.starts_with(kind)) || TYPES_OF_READERS.contains(&rest);
    let splits = name.match_indices('_').map(|(at, _)| (&name[..at], &name[at + 1..]));
    splits.into_iter().find(|(_, rest)| is_type(rest)).unwrap_or((name, ""))
}

impl Node {
    /// The text of an input.
    pub fn text(&self, input: &str) -> Option<&str> {
        match &self.inputs.get(input)?.value {
            Some(Value::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// True where an input has a value or a connection.
    pub fn has(&self, input: &str) -> bool {
        self.inputs.get(input).is_some_and(|input| input.value.is_some() || input.source.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::category;

    #[test]
    fn identifiers_are_category_and_type() {
        for (id, expected) in [
            ("ND_image_color3", ("image", "color3")),
            ("ND_standard_surface_surfaceshader", ("standard_surface", "surfaceshader")),
            ("ND_UsdPreviewSurface_surfaceshader", ("UsdPreviewSurface", "surfaceshader")),
            ("ND_convert_vector3_color3", ("convert", "vector3_color3")),
            ("UsdPrimvarReader_float2", ("UsdPrimvarReader", "float2")),
            ("UsdUVTexture", ("UsdUVTexture", "")),
            ("ND_surface", ("surface", "")),
            ("ND_oren_nayar_diffuse_bsdf", ("oren_nayar_diffuse_bsdf", "")),
            ("ND_mix_bsdf", ("mix", "bsdf")),
            ("ND_logical_and", ("logical_and", "")),
            ("arnold:standard_surface", ("arnold:standard_surface", "")),
            ("ND_gltf_image_color3_color3_1_0", ("gltf_image", "color3_color3_1_0")),
            ("ND_combine2_color4CF", ("combine2", "color4CF")),
            ("UsdPrimvarReader_normal", ("UsdPrimvarReader", "normal")),
        ] {
            assert_eq!(category(id), expected, "{id}");
        }
    }
}
