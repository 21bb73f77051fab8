//! AOVs as authored: what a scene wants to see of its surfaces under names of its own.

use std::sync::Arc;

use super::material::{ColorInput, ScalarInput};

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
