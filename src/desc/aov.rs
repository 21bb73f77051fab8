//! AOVs as authored: what a scene wants to see of its surfaces under names of its own.

use std::sync::Arc;

use super::graph::{Graph, ValueId};
use super::{ColorInput, ScalarInput};

/// A pass that a scene declares.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AovDesc {
    /// Its name.
    pub name: Arc<str>,
    /// What it holds.
    pub kind: AovKind,
}

/// What an AOV holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AovKind {
    /// A color.
    Color,
    /// A number.
    Value,
}

/// What a material gives as an AOV. Surfaces of materials that do not name it give 0.
#[derive(Clone, Debug, PartialEq)]
pub struct AovOutput {
    /// Name of the AOV; one that no scene declares is not computed.
    pub name: Arc<str>,
    /// For an AOV of colors.
    pub color: ColorInput,
    /// For an AOV of numbers.
    pub value: ScalarInput,
}

/// What lies behind everything gives as AOVs where the camera sees it. In its graph points are directions, as in
/// that of a [`DomeShader`](super::DomeShader).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BackgroundAovs {
    /// How it is made.
    pub graph: Graph,
    /// Name of each AOV, and what it is for one of colors and for one of numbers.
    pub outputs: Vec<(Arc<str>, [ValueId; 2])>,
}
