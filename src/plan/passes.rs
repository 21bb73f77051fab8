//! What passes ask for beyond the picture.

use super::Facts;
use super::row::Row;

const SUBJECT: &str = "pass";

pub(super) fn rows(facts: &Facts<'_>) -> Vec<Row> {
    let (effects, settings) = (facts.scene.effects, facts.settings);
    let row = |effect, on: bool, probe, adds: String| {
        let because = if on { asking(facts, effect) } else { String::new() };
        Row::new(SUBJECT, effect, because, "no pass asks for it").adds(adds).probe(probe)
    };
    let lights = settings.light_samples;
    vec![
        row("ambient occlusion", effects.ao, "pass ao", format!("{} rays a sample", settings.ao_samples)),
        row("shadow", effects.shadow, "pass shadow", format!("light kept with and without shadow, {lights} rays")),
        row("shadow by light group", effects.group_shadows, "pass shadow of groups", "rays for each group".to_owned()),
        row("colors", effects.color, "pass colors", "albedo by kind of lobe at the first hit".to_owned()),
        row("normal, uv, vector", effects.geometry, "pass normal, uv, vector", "sums of the first hit".to_owned()),
        row("denoising", effects.denoising, "pass denoising", "albedo and normal, in mirrors too".to_owned()),
        row("mist", effects.mist, "pass mist", "a distance a sample".to_owned()),
        row("aovs", effects.aovs, "pass aovs", "what materials give at the first hit".to_owned()),
        row("depth, position, index", effects.first_hit, "", "one ray a pixel, through its centre".to_owned()),
        row("cryptomatte", effects.cryptomatte, "pass cryptomatte", "ids and coverage of each pixel".to_owned()),
        errors(facts),
    ]
}

/// The passes that are rendered and belong to an effect, by name.
fn asking(facts: &Facts<'_>, effect: &str) -> String {
    let starts: &[&str] = match effect {
        "ambient occlusion" => &["ao", "error_ao"],
        "shadow" | "shadow by light group" => &["shadow", "unshadowed", "error_shadow"],
        "colors" => &["diffuse_color", "glossy_color", "transmission_color"],
        "normal, uv, vector" => &["normal", "uv", "vector"],
        "denoising" => &["denoising_"],
        "mist" => &["mist"],
        "aovs" => &["aov"],
        "depth, position, index" => &["depth", "position", "object_index", "material_index"],
        _ => &["crypto"],
    };
    let names = facts.scene.passes.iter().map(|chosen| chosen.name());
    let names: Vec<String> = names.filter(|name| starts.iter().any(|start| name.starts_with(start))).collect();
    // A catcher, say, asks for shadows without the user's having named the pass.
    if names.is_empty() { "another effect".to_owned() } else { format!("--passes {}", names.join(",")) }
}

fn errors(facts: &Facts<'_>) -> Row {
    let settings = facts.settings;
    let because = match () {
        () if settings.error.is_some() => "--error",
        () if settings.adaptive => "--adaptive on",
        () if facts.scene.passes.has_error() => "--passes error",
        () => "",
    };
    Row::new(SUBJECT, "error estimate", because, "no pass asks for it").adds("sums of independent parts of the samples")
}
