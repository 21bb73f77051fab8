//! Which light there is, and how it is found.

use std::sync::Arc;

use super::Facts;
use super::row::{Row, names, of};
use crate::desc::{DecayDesc, LightDesc, LightKind};
use crate::scene::{has_own_shadow, shines};
use crate::settings::{Integrator, LightSelection};

const SUBJECT: &str = "light";

/// Kinds of lamps and backgrounds, and how to tell them.
type Kind = (&'static str, fn(&LightDesc) -> bool);

const KINDS: &[Kind] = &[
    ("point lights", |l| matches!(l.kind, LightKind::Point { .. }) && l.shaping.cone.is_none()),
    ("spots", |l| l.shaping.cone.is_some()),
    ("sphere lights", |l| matches!(l.kind, LightKind::Sphere { .. }) && l.shaping.cone.is_none()),
    ("rectangle lights", |l| matches!(l.kind, LightKind::Rect { .. }) && l.shaping.cone.is_none()),
    ("disk lights", |l| matches!(l.kind, LightKind::Disk { .. }) && l.shaping.cone.is_none()),
    ("tube lights", |l| matches!(l.kind, LightKind::Cylinder { .. }) && l.shaping.cone.is_none()),
    ("parallel light", |l| matches!(l.kind, LightKind::Distant { angle, .. } if angle <= 0.0)),
    ("suns with a size", |l| matches!(l.kind, LightKind::Distant { angle, .. } if angle > 0.0)),
    ("domes", |l| matches!(l.kind, LightKind::Dome { .. })),
    ("domes by a graph", |l| matches!(l.kind, LightKind::ShadedDome { .. })),
];

pub(super) fn rows(facts: &Facts<'_>) -> Vec<Row> {
    let mut rows: Vec<Row> = KINDS.iter().map(|kind| of_kind(facts, kind)).collect();
    let names_of = |test: &dyn Fn(&LightDesc) -> bool| -> Vec<Arc<str>> {
        facts.desc.lights.iter().filter(|l| shines(l) && test(l)).map(|l| l.name.clone()).collect()
    };
    let simple =
        |effect, list: Vec<Arc<str>>, otherwise: &'static str| Row::new(SUBJECT, effect, of("light", &list), otherwise);
    rows.push(portals(facts));
    rows.push(emissive(facts));
    rows.push(tree(facts));
    let by_direction = |l: &LightDesc| l.shaping.focus != 0.0 || l.shaping.ies.is_some() || l.shaping.shader.is_some();
    rows.push(simple("light by direction", names_of(&by_direction), "no profile, focus or graph shapes a lamp"));
    rows.push(simple("decay", names_of(&|l| l.decay != DecayDesc::default()), "all light falls off by the square"));
    let linked = |l: &LightDesc| l.links.receivers.is_some() || l.links.response != [1.0; 2];
    rows.push(simple("light linking", names_of(&linked), "every light lights everything"));
    rows.push(own_shadows(facts));
    rows.push(indirect(facts));
    rows.push(caustics(facts));
    rows
}

fn of_kind(facts: &Facts<'_>, &(effect, is): &Kind) -> Row {
    let all: Vec<&LightDesc> = facts.desc.lights.iter().filter(|light| is(light)).collect();
    let (lit, dark): (Vec<&LightDesc>, Vec<&LightDesc>) = all.into_iter().partition(|light| shines(light));
    let list = |lights: &[&LightDesc]| names(&lights.iter().map(|light| light.name.clone()).collect::<Vec<_>>());
    let asked = !facts.scene.lights.is_empty() || facts.scene.effects.light;
    let because = match lit.len() {
        0 => String::new(),
        _ if !asked => String::new(),
        1 => list(&lit),
        n => format!("{n}: {}", list(&lit)),
    };
    let otherwise = match () {
        () if !lit.is_empty() => "no pass asks for light".to_owned(),
        () if !dark.is_empty() => format!("{} gives no light and is left out", list(&dark)),
        () => "none".to_owned(),
    };
    Row::new(SUBJECT, effect, because, otherwise).adds("may be chosen for a shadow ray at each hit")
}

fn portals(facts: &Facts<'_>) -> Row {
    let list: Vec<_> = facts.desc.lights.iter().filter(|l| l.kind.is_portal()).map(|l| l.name.clone()).collect();
    Row::new(SUBJECT, "portals", names(&list), "none").adds("domes are sampled through them")
}

fn emissive(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.emissive;
    let list: Vec<_> = facts.materials(|m| m.unlit || m.emission_strength != 0.0 && m.emission.factor != [0.0; 3]);
    facts
        .flagged(SUBJECT, "objects that emit", on, of("material", &list), "no material emits")
        .adds("their shapes as lights, light at hits")
}

fn tree(facts: &Facts<'_>) -> Row {
    let count = facts.scene.lights.len();
    let by_tree = facts.settings.light_selection == LightSelection::Tree;
    let because = if by_tree && count > 1 { format!("{count} lights to choose from") } else { String::new() };
    let otherwise = match count {
        0 => "there is no light to choose",
        1 => "there is one light",
        _ => "--light-selection says otherwise",
    };
    Row::new(SUBJECT, "light tree", because, otherwise).adds("a walk down it at each hit")
}

fn own_shadows(facts: &Facts<'_>) -> Row {
    let on = facts.scene.effects.own_shadows;
    let lamps = facts.desc.lights.iter().filter(|l| has_own_shadow(&l.links)).map(|l| l.name.clone());
    let objects = facts.desc.instances.iter().filter(|i| has_own_shadow(&i.links)).map(|i| i.name.clone());
    let list: Vec<_> = lamps.chain(objects).collect();
    facts
        .flagged(
            SUBJECT,
            "own shadows",
            on,
            of("shadow of", &list),
            "all shadows are of everything, black, and end nowhere",
        )
        .adds("a look at the light's rules for each shadow ray")
        .probe("effect own shadows")
}

fn indirect(facts: &Facts<'_>) -> Row {
    let bounces = facts.settings.max_bounces;
    let on = facts.scene.effects.indirect && facts.settings.integrator == Integrator::Path;
    let because = if on { format!("--max-bounces {bounces}") } else { String::new() };
    let otherwise = match () {
        () if facts.settings.integrator != Integrator::Path => "the integrator follows no paths",
        () if bounces == 0 => "--max-bounces 0",
        () => "no pass needs it",
    };
    Row::new(SUBJECT, "indirect light", because, otherwise)
        .adds(format!("up to {bounces} more rays a sample, each with its shadow ray"))
}

fn caustics(facts: &Facts<'_>) -> Row {
    let kinds =
        [(facts.settings.caustics_reflective, "reflective"), (facts.settings.caustics_refractive, "refractive")];
    let kinds: Vec<&str> = kinds.iter().filter(|(on, _)| *on).map(|(_, name)| *name).collect();
    let indirect = facts.scene.effects.indirect && facts.settings.integrator == Integrator::Path;
    let because = if indirect { kinds.join(" and ") } else { String::new() };
    let otherwise = if indirect { "both are switched off" } else { "there is no indirect light" };
    Row::new(SUBJECT, "caustics", because, otherwise).adds("nothing by themselves: light that paths find")
}
