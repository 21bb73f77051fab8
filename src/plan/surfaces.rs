//! What surfaces do with light.

use super::Facts;
use super::lobes::{self, LOBES};
use super::row::{Row, of};
use crate::desc::AlphaMode;

const SUBJECT: &str = "surface";

pub(super) fn rows(facts: &Facts<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = LOBES
        .iter()
        .map(|&(lobe, name)| {
            let list = facts.materials(|m| lobes::of(m).contains(&lobe));
            Row::new(SUBJECT, name, of("material", &list), "no surface has it")
                .adds("evaluated and sampled where it is hit")
        })
        .collect();
    rows.extend([cutouts(facts), absorption(facts), holdouts(facts), catchers(facts), terminator(facts)]);
    rows
}

fn cutouts(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.cutouts;
    let authored = facts.materials(|m| m.alpha_mode != AlphaMode::Opaque || m.transparency.factor != [0.0; 3]);
    let otherwise = match authored.is_empty() {
        true => "every surface is opaque".to_owned(),
        false => format!("{} is opaque everywhere", of("material", &authored)),
    };
    facts
        .flagged(SUBJECT, "cut-outs and transparency", on, of("material", &authored), otherwise)
        .adds(format!("shadow rays stop at each such surface; up to {} are passed", facts.settings.transparent_bounces))
        .probe("effect cut-outs")
}

fn absorption(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.absorption;
    let list = facts.materials(|m| m.volume.is_some_and(|v| v.attenuation_color.iter().any(|&c| c < 1.0)));
    facts
        .flagged(
            SUBJECT,
            "absorption inside",
            on,
            of("material", &list),
            "light that gets into surfaces is not absorbed there",
        )
        .adds("the media that a ray is in are kept")
        .probe("effect absorption")
}

fn holdouts(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.holdouts;
    let mut list = facts.materials(|m| m.holdout);
    list.extend(facts.desc.instances.iter().filter(|instance| instance.holdout).map(|instance| instance.name.clone()));
    facts.flagged(SUBJECT, "holdouts", on, of("hole:", &list), "nothing is a hole in the picture")
}

fn catchers(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.catchers;
    let objects = facts.desc.instances.iter().filter(|instance| instance.catcher);
    let list: Vec<_> = objects.map(|instance| instance.name.clone()).collect();
    facts
        .flagged(SUBJECT, "shadow catchers", on, of("object", &list), "no object catches shadows")
        .adds("light with and without the scene")
        .probe("effect shadow catchers")
}

fn terminator(facts: &Facts<'_>) -> Row {
    let settings = facts.settings;
    let offsets = [settings.shadow_terminator_geometry_offset, settings.shadow_terminator_shading_offset];
    let smooth: Vec<_> = facts
        .desc
        .instances
        .iter()
        .filter(|instance| facts.desc.mesh(instance).is_some_and(|mesh| mesh.normals.is_some()))
        .filter(|instance| {
            instance.terminator.map_or(offsets != [0.0; 2], |own| own.geometry > 0.0 || own.shading > 0.0)
        })
        .map(|instance| instance.name.clone())
        .collect();
    let otherwise = "no smooth mesh, or both offsets are 0";
    Row::new(SUBJECT, "softened edges of shadows", of("smooth mesh of", &smooth), otherwise)
        .adds("shadow rays of smooth meshes start off the facets")
}
