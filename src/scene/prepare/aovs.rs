//! AOVs: from what a scene declares to what a render keeps.

use crate::desc::{self, ColorInput, ScalarInput, SceneDesc};
use crate::film::{Aov, AovKind};

/// What `desc` declares, as the film has it.
pub fn declared(desc: &SceneDesc) -> Vec<Aov> {
    let film = |aov: &desc::AovDesc| {
        let kind = match aov.kind {
            desc::AovKind::Color => AovKind::Color,
            desc::AovKind::Value => AovKind::Value,
        };
        Aov { name: aov.name.clone(), kind }
    };
    desc.render.aovs.iter().map(film).collect()
}

/// Drops what materials and the background give beyond `wanted`: nothing of it is prepared then.
pub fn keep(desc: &mut SceneDesc, wanted: &[Aov]) {
    for material in &mut desc.materials {
        material.aovs.retain_mut(|output| {
            let Some(aov) = wanted.iter().find(|aov| aov.name == output.name) else { return false };
            match aov.kind {
                AovKind::Color => output.value = ScalarInput::constant(0.0),
                AovKind::Value => output.color = ColorInput::constant([0.0; 3]),
            }
            true
        });
    }
    desc.background_aovs.outputs.retain(|(name, _)| wanted.iter().any(|aov| aov.name == *name));
    if desc.render.film_transparent == Some(true) {
        desc.background_aovs.outputs.clear();
    }
}
