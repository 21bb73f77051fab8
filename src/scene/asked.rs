//! What graphs ask of meshes and objects beyond what every render needs; empty where no material has one.

use std::sync::Arc;

use crate::desc::graph::Value;
use crate::math::DVec3;
use crate::shape::Attribute;

/// Data of all meshes and objects that graphs ask for.
#[derive(Debug, Default)]
pub struct Asked {
    /// One for each shape.
    pub shapes: Vec<OfMesh>,
    /// One for each instance.
    pub objects: Vec<OfObject>,
}

/// Data of a shape.
#[derive(Debug, Default)]
pub struct OfMesh {
    /// By the slots of the programs.
    pub attributes: Vec<Option<Attribute<[f32; 4]>>>,
    /// Slot of the attribute that stands for generated coordinates, and the box that does otherwise: its
    /// least corner and one by its size, 0 along flat axes. Object space.
    pub generated: (Option<u16>, [DVec3; 2]),
}

/// Data of an object.
#[derive(Debug, Default)]
pub struct OfObject {
    /// Its origin in world space.
    pub location: DVec3,
    /// Its color.
    pub color: Value,
    /// Its own number.
    pub random: f64,
    /// Its index.
    pub index: f64,
    /// By the slots of the programs.
    pub attributes: Vec<Option<Value>>,
}

/// Names of attributes by slot.
#[derive(Debug, Default)]
pub struct Names(Vec<Arc<str>>);

/// The attribute that comes before the box for generated coordinates.
const GENERATED: &str = "generated";

impl Names {
    /// The slot of `name`.
    pub fn slot(&mut self, name: &Arc<str>) -> u16 {
        let known = self.0.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.0.push(name.clone());
            self.0.len() - 1
        }) as u16
    }

    /// With a slot for what stands for generated coordinates.
    pub fn with_generated(mut self) -> Self {
        self.slot(&GENERATED.into());
        self
    }

    /// All names.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<str>> {
        self.0.iter()
    }

    /// The slot that stands for generated coordinates.
    pub fn generated(&self) -> Option<u16> {
        self.0.iter().position(|name| **name == *GENERATED).map(|slot| slot as u16)
    }
}
