//! Primvars that RenderVars show: AOVs that every material gives.

use std::sync::Arc;

use super::stage::Reading;
use crate::desc::graph::Leaf;
use crate::desc::{AovDesc, AovOutput, ColorInput, MaterialDesc, ScalarInput, SceneDesc, ShapeRef};
use crate::error::Place;

/// What comes before the name of a primvar in that of an AOV.
const PREFIX: &str = "primvars:";

/// The primvar that `aov` shows.
fn primvar(aov: &AovDesc) -> &str {
    aov.name.strip_prefix(PREFIX).unwrap_or(&aov.name)
}

/// Has `material` give `aovs`.
pub(super) fn add(material: &mut MaterialDesc, aovs: &[AovDesc]) {
    for aov in aovs {
        let leaf = Leaf::Attribute { name: primvar(aov).into(), fallback: [0.0; 4] };
        let value = material.graph.leaf(leaf);
        let (color, value) = (ColorInput::graph(value), ScalarInput::graph(value));
        material.aovs.push(AovOutput { name: aov.name.clone(), color, value });
    }
}

/// Tells of primvars that shapes lack; `places` are where the scene asks for its AOVs.
pub(super) fn tell_of_missing(reading: &Reading<'_>, scene: &SceneDesc, places: &[Place]) {
    for (aov, place) in scene.render.aovs.iter().zip(places) {
        let name = primvar(aov);
        let is_it = |known: &Arc<str>| **known == *name;
        let of_mesh: Vec<bool> =
            scene.meshes.iter().map(|mesh| mesh.attributes.iter().any(|a| is_it(&a.name))).collect();
        let of_rounds: Vec<bool> =
            scene.rounds.iter().map(|rounds| rounds.attributes.iter().any(|(name, _)| is_it(name))).collect();
        let lacks = scene.instances.iter().filter(|instance| {
            let of_shape = match instance.shape {
                ShapeRef::Mesh(i) => of_mesh[i as usize],
                ShapeRef::Rounds(i) => of_rounds[i as usize],
            };
            !of_shape && !instance.info.attributes.iter().any(|(known, _)| is_it(known))
        });
        let (all, count) = (scene.instances.len(), lacks.count());
        let mut warnings = reading.warnings.borrow_mut();
        if count == all && all > 0 {
            warnings.push(place, format!("no shape has the primvar {name}: it is 0 everywhere"));
        } else if count > 0 {
            warnings.note(place, format!("{count} of {all} shapes have no primvar {name}: it is 0 there"));
        }
    }
}
