//! Who is who: the index passes and Cryptomatte.

use std::sync::Arc;

use crate::desc::{MaterialDesc, SceneDesc};
use crate::film::cryptomatte::{CryptoKind, Manifest, id_from_name};

/// Identity of one object.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectId {
    /// Value of the object index pass.
    pub index: u32,
    /// Cryptomatte id of its name.
    pub object: f32,
    /// Cryptomatte id of its asset's name.
    pub asset: f32,
}

/// Identity of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialId {
    /// Value of the material index pass.
    pub index: u32,
    /// Cryptomatte id of its name.
    pub material: f32,
}

/// Identities of a scene, and the names behind them.
#[derive(Clone, Debug, Default)]
pub struct Ids {
    /// One for each instance.
    pub objects: Vec<ObjectId>,
    /// One for each material.
    pub materials: Vec<MaterialId>,
    /// Distinct names of objects, materials and assets.
    names: [Vec<Arc<str>>; 3],
}

impl Ids {
    /// Identities of everything in `desc`, of which the instances `placed` are traced.
    pub fn of(desc: &SceneDesc, placed: &[u32]) -> Self {
        let mut names: [Vec<Arc<str>>; 3] = Default::default();
        let objects = placed
            .iter()
            .map(|&i| {
                let instance = &desc.instances[i as usize];
                names[0].push(instance.name.clone());
                names[2].push(instance.asset.clone());
                ObjectId {
                    index: instance.object_index,
                    object: id_from_name(&instance.name),
                    asset: id_from_name(&instance.asset),
                }
            })
            .collect();
        // The default material stands last, as in the traced scene.
        let fallback = MaterialDesc::default();
        let materials = desc
            .materials
            .iter()
            .chain([&fallback])
            .map(|material| {
                names[1].push(material.name.clone());
                MaterialId { index: material.material_index, material: id_from_name(&material.name) }
            })
            .collect();
        for list in &mut names {
            list.sort_unstable();
            list.dedup();
        }
        Self { objects, materials, names }
    }

    /// The names behind the ids, for the file's header.
    pub fn manifests(&self) -> Vec<Manifest> {
        let names = |i: usize| self.names[i].iter().map(ToString::to_string).collect();
        CryptoKind::ALL.into_iter().enumerate().map(|(i, kind)| Manifest { kind, names: names(i) }).collect()
    }
}
