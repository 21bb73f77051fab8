//! UV maps by name.
//!
//! Materials name UV maps, meshes number them. Set 0 is the map that each mesh renders with; a map that
//! some material names has the same number in all meshes.

use std::collections::HashMap;
use std::sync::Arc;

/// Which set of UVs each name stands for.
#[derive(Debug, Default)]
pub struct UvSets {
    sets: HashMap<String, u32>,
    /// Names of the sets from 1 on.
    names: Vec<String>,
}

impl UvSets {
    /// Sets for those of `names` that a shape has, by the maps of each shape, the one to render with first.
    pub fn new<'a>(
        names: impl IntoIterator<Item = String>,
        shapes: impl Iterator<Item = &'a [Arc<str>]> + Clone,
    ) -> Self {
        let mut sets = Self::default();
        for name in names {
            let has = |maps: &[Arc<str>]| maps.iter().any(|known| **known == *name);
            if sets.sets.contains_key(&name) || !shapes.clone().any(has) {
                continue;
            }
            let is_first = |maps: &[Arc<str>]| maps.first().is_none_or(|first| **first == *name);
            let set = if shapes.clone().all(is_first) {
                0
            } else {
                sets.names.push(name.clone());
                sets.names.len() as u32
            };
            sets.sets.insert(name, set);
        }
        sets
    }

    /// The set of a name; "" is the one to render with. `None` for a name that no shape has, or that no
    /// material was known to use.
    pub fn set(&self, name: &str) -> Option<u32> {
        if name.is_empty() { Some(0) } else { self.sets.get(name).copied() }
    }

    /// Names of the sets from 1 on.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}
