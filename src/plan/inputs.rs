//! What varies over surfaces.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Facts;
use super::row::{Row, names, of};
use crate::desc::graph::{Leaf, Op, Procedural};
use crate::desc::{MaterialDesc, NormalInput};

const SUBJECT: &str = "input";

pub(super) fn rows(facts: &Facts<'_>) -> Vec<Row> {
    vec![
        textures(facts),
        graphs(facts),
        procedurals(facts),
        normal_maps(facts),
        bumps(facts),
        occlusion(facts),
        paths(facts),
    ]
}

/// Operations of the graph of `material` that its inputs ask for.
fn ops(material: &MaterialDesc) -> impl Iterator<Item = &Op> {
    let needed = material.graph.needed(material.graph_values());
    material.graph.ops().iter().zip(needed).filter_map(|(op, needed)| needed.then_some(op))
}

fn with_op(facts: &Facts<'_>, test: impl Fn(&Op) -> bool) -> Vec<Arc<str>> {
    facts.materials(|material| ops(material).any(&test))
}

fn textures(facts: &Facts<'_>) -> Row {
    let mut images = BTreeSet::new();
    for material in &facts.materials {
        let of_graph = ops(material).filter_map(|op| match op {
            Op::Image { texture, .. } => Some(*texture),
            _ => None,
        });
        let all = material.textures().map(|texture| texture.texture).chain(of_graph);
        images.extend(all.filter_map(|t| facts.desc.textures.get(t as usize)).map(|texture| texture.image));
    }
    let list: Vec<_> =
        images.iter().filter_map(|&i| facts.desc.images.get(i as usize)).map(|i| i.name.clone()).collect();
    let because = match list.len() {
        0 => String::new(),
        n => format!("{n} images: {}", names(&list)),
    };
    let [_, _, bytes] = facts.scene.bytes();
    Row::new(SUBJECT, "textures", because, "no surface has an image")
        .adds("filtered lookups by the ray's footprint")
        .bytes(bytes)
}

fn graphs(facts: &Facts<'_>) -> Row {
    let varying = |op: &Op| !matches!(op, Op::Constant(_));
    let list = with_op(facts, varying);
    let count: usize = facts.materials.iter().map(|m| ops(m).filter(|op| varying(op)).count()).sum();
    Row::new(SUBJECT, "shader graphs", of("material", &list), "all inputs are constants and plain images")
        .adds(format!("{count} operations in all, those of the surface hit at each hit"))
}

fn procedurals(facts: &Facts<'_>) -> Row {
    let mut kinds = BTreeSet::new();
    for op in facts.materials.iter().flat_map(|material| ops(material)) {
        match op {
            Op::Procedural(procedural, _) => _ = kinds.insert(name(procedural)),
            Op::Sky { .. } => _ = kinds.insert("sky"),
            _ => {}
        }
    }
    let because = kinds.into_iter().collect::<Vec<_>>().join(", ");
    Row::new(SUBJECT, "procedural textures", because, "no graph has one").adds("computed at each hit")
}

fn name(procedural: &Procedural) -> &'static str {
    match procedural {
        Procedural::Noise(_) => "noise",
        Procedural::Voronoi(_) => "voronoi",
        Procedural::Wave(_) => "wave",
        Procedural::Magic { .. } => "magic",
        Procedural::Brick(_) => "brick",
        Procedural::Checker => "checker",
        Procedural::Gradient(_) => "gradient",
        Procedural::WhiteNoise { .. } => "white noise",
        Procedural::Cell { .. } => "cells",
        Procedural::VectorNoise { .. } => "vector noise",
        Procedural::Worley { .. } => "worley",
        Procedural::Gabor { .. } => "gabor",
    }
}

fn normal_maps(facts: &Facts<'_>) -> Row {
    let flat = |normal: NormalInput| matches!(normal, NormalInput::Map { scale, .. } if scale == 0.0);
    let mapped = |m: &MaterialDesc| {
        let all = [m.normal, m.coat.and_then(|coat| coat.normal)];
        all.into_iter().flatten().chain(m.parts.iter().filter_map(|part| part.normal)).any(|normal| !flat(normal))
    };
    Row::new(SUBJECT, "bent normals", of("material", &facts.materials(mapped)), "no map or graph bends one")
        .adds("another frame at each hit")
}

fn bumps(facts: &Facts<'_>) -> Row {
    let list = with_op(facts, |op| matches!(op, Op::Bump(_) | Op::Relief(_)));
    Row::new(SUBJECT, "bumps", of("material", &list), "no height bends a normal")
        .adds("the height at two more points a hit")
}

fn occlusion(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.occlusion_maps;
    let list = facts.materials(|m| m.occlusion.is_some());
    let otherwise = match (list.is_empty(), facts.settings.occlusion_maps) {
        (true, _) => "no material has one",
        (_, false) => "--occlusion-maps off",
        _ => "their strength is 0",
    };
    facts.flagged(SUBJECT, "baked occlusion", on, of("material", &list), otherwise).probe("effect occlusion maps")
}

fn paths(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.light_path;
    let list = with_op(facts, |op| matches!(op, Op::Leaf(Leaf::Path(_))));
    facts
        .flagged(SUBJECT, "questions of the light path", on, of("material", &list), "no graph asks which ray it is")
        .adds("the path's history is kept")
}
