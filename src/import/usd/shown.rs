//! What RenderVars show that is no pass: AOVs that every material gives. Primvars, and the place and the normal as the
//! camera has them.

use std::sync::Arc;

use super::stage::Reading;
use crate::desc::graph::{Graph, Leaf, Math, Quantity, Space, ValueId};
use crate::desc::{AovDesc, AovOutput, ColorInput, MaterialDesc, ScalarInput, SceneDesc, ShapeRef};
use crate::error::Place;

/// What comes before the name of a primvar in that of an AOV.
const PREFIX: &str = "primvars:";

/// AOVs of the surface in the camera's space: x right, y up, z back, in units of the stage.
pub(super) const IN_CAMERA_SPACE: [&str; 2] = [PLACE, "Neye"];
const PLACE: &str = "Peye";

/// Has `material` give `aovs`, by a stage of which a unit is so many `meters`.
pub(super) fn add(material: &mut MaterialDesc, aovs: &[AovDesc], meters: f64) {
    for aov in aovs {
        let graph = &mut material.graph;
        let value = match aov.name.strip_prefix(PREFIX) {
            Some(name) => graph.leaf(Leaf::Attribute { name: name.into(), fallback: [0.0; 4] }),
            None => in_camera_space(graph, &aov.name, meters),
        };
        let (color, value) = (ColorInput::graph(value), ScalarInput::graph(value));
        material.aovs.push(AovOutput { name: aov.name.clone(), color, value });
    }
}

fn in_camera_space(graph: &mut Graph, name: &str, meters: f64) -> ValueId {
    let (quantity, leaf, unit) = match name {
        PLACE => (Quantity::Point, Leaf::Position, meters.recip()),
        _ => (Quantity::Normal, Leaf::Normal, 1.0),
    };
    let (value, units) = (graph.leaf(leaf), graph.constant([unit, unit, -unit, 1.0]));
    let seen = graph.transform(quantity, Space::World, Space::Camera, value);
    graph.math(Math::Multiply, &[seen, units])
}

/// Tells of primvars that shapes lack; `places` are where the scene asks for its AOVs.
pub(super) fn tell_of_missing(reading: &Reading<'_>, scene: &SceneDesc, places: &[Place]) {
    for (aov, place) in scene.render.aovs.iter().zip(places) {
        let Some(name) = aov.name.strip_prefix(PREFIX) else { continue };
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
