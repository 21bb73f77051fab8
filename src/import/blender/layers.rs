//! UV maps by name.
//!
//! Materials name UV maps, meshes number them. Set 0 is the map that each mesh renders with; a map that
//! some material names has the same number in all meshes.

use std::collections::HashMap;

use super::mesh::NamedMesh;

/// Which set of UVs each name stands for.
#[derive(Debug, Default)]
pub struct UvSets {
    sets: HashMap<String, u32>,
    /// Names of the sets from 1 on.
    names: Vec<String>,
}

impl UvSets {
    /// Sets for the maps of `names` in `meshes`.
    pub fn new<'a>(
        names: impl IntoIterator<Item = String>,
        meshes: impl Iterator<Item = &'a NamedMesh> + Clone,
    ) -> Self {
        let mut sets = Self::default();
        for name in names {
            let has = |mesh: &NamedMesh| mesh.uv_names.iter().any(|known| **known == *name);
            if sets.sets.contains_key(&name) || !meshes.clone().any(has) {
                continue;
            }
            let is_first = |mesh: &NamedMesh| mesh.uv_names.first().is_none_or(|first| **first == *name);
            let set = if meshes.clone().all(is_first) {
                0
            } else {
                sets.names.push(name.clone());
                sets.names.len() as u32
            };
            sets.sets.insert(name, set);
        }
        sets
    }

    /// The set of a name; "" is the one to render with. `None` for a name that no material was known to use.
    pub fn set(&self, name: &str) -> Option<u32> {
        if name.is_empty() { Some(0) } else { self.sets.get(name).copied() }
    }

    /// Names of the sets from 1 on.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}
