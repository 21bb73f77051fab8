//! Inputs of materials: a constant, times a texture, times a value of the material's graph.

use super::TextureRef;
use super::graph::ValueId;

/// A colour: `factor × texture.rgb × graph.rgb`, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant part.
    pub factor: [f64; 3],
    /// Texture part; `None` for white.
    pub texture: Option<TextureRef>,
    /// Value of the material's graph; `None` for white.
    pub graph: Option<ValueId>,
}

impl ColorInput {
    /// The same colour everywhere.
    pub const fn constant(factor: [f64; 3]) -> Self {
        Self::textured(factor, None)
    }

    /// `factor × texture`.
    pub const fn textured(factor: [f64; 3], texture: Option<TextureRef>) -> Self {
        Self { factor, texture, graph: None }
    }

    /// What the material's graph says.
    pub const fn graph(value: ValueId) -> Self {
        Self { factor: [1.0; 3], texture: None, graph: Some(value) }
    }
}

/// A channel of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red or grey.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha; 1 for an image without.
    A,
}

/// A number: `factor × texture.channel × graph`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant part.
    pub factor: f64,
    /// Texture part and which channel of it; `None` for 1.
    pub texture: Option<(TextureRef, Channel)>,
    /// Value of the material's graph, its first place; `None` for 1.
    pub graph: Option<ValueId>,
}

impl ScalarInput {
    /// The same number everywhere.
    pub const fn constant(factor: f64) -> Self {
        Self::textured(factor, None)
    }

    /// `factor × texture`.
    pub const fn textured(factor: f64, texture: Option<(TextureRef, Channel)>) -> Self {
        Self { factor, texture, graph: None }
    }

    /// What the material's graph says.
    pub const fn graph(value: ValueId) -> Self {
        Self { factor: 1.0, texture: None, graph: Some(value) }
    }
}

/// Where a normal comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NormalInput {
    /// A tangent-space map, +y along the bitangent.
    Map {
        /// The map.
        texture: TextureRef,
        /// Factor of its x and y.
        scale: f64,
    },
    /// Value of the material's graph: a normal in world space, on the side of whoever looks.
    Graph(ValueId),
}

impl NormalInput {
    /// The map, where it is one.
    pub fn texture(&self) -> Option<TextureRef> {
        match self {
            Self::Map { texture, .. } => Some(*texture),
            Self::Graph(_) => None,
        }
    }

    fn value(&self) -> Option<ValueId> {
        match self {
            Self::Map { .. } => None,
            Self::Graph(value) => Some(*value),
        }
    }
}

/// What varies an input: a texture, a value of the graph.
pub(super) type Varying = (Option<TextureRef>, Option<ValueId>);

pub(super) fn of_color(input: &ColorInput) -> Varying {
    (input.texture, input.graph)
}

pub(super) fn of_scalar(input: &ScalarInput) -> Varying {
    (input.texture.map(|(texture, _)| texture), input.graph)
}

pub(super) fn of_normal(input: NormalInput) -> Varying {
    (input.texture(), input.value())
}
