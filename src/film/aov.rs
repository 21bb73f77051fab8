//! Passes that a scene brings along: what its materials say of their surfaces, under names of its own (arbitrary
//! output variables, AOVs).

use std::sync::Arc;

/// One of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Aov {
    /// Its name, which is that of the layer.
    pub name: Arc<str>,
    /// What it holds.
    pub kind: AovKind,
}

/// What an AOV holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AovKind {
    /// Red, green, blue, and how many surfaces have given them.
    Color,
    /// A number.
    Value,
}

impl AovKind {
    /// One letter per channel, as Blender writes them.
    pub const fn channels(self) -> &'static str {
        match self {
            Self::Color => "RGBA",
            Self::Value => "X",
        }
    }

    /// How many numbers it is.
    pub const fn width(self) -> usize {
        self.channels().len()
    }
}
