//! Names of layers: those that Blender 5.0 writes and the short ones of 4.5 and before mean the same.

use std::collections::BTreeMap;

use super::side::Layer;
use crate::film::PASSES;

/// What versions up to 4.5 call a pass, and its name today.
const SHORT: &[(&str, &str)] = &[
    ("Z", "Depth"),
    ("Vec", "Vector"),
    ("IndexOB", "Object Index"),
    ("IndexMA", "Material Index"),
    ("DiffDir", "Diffuse Direct"),
    ("DiffInd", "Diffuse Indirect"),
    ("DiffCol", "Diffuse Color"),
    ("GlossDir", "Glossy Direct"),
    ("GlossInd", "Glossy Indirect"),
    ("GlossCol", "Glossy Color"),
    ("TransDir", "Transmission Direct"),
    ("TransInd", "Transmission Indirect"),
    ("TransCol", "Transmission Color"),
    ("VolumeDir", "Volume Direct"),
    ("VolumeInd", "Volume Indirect"),
    ("Emit", "Emission"),
    ("Env", "Environment"),
    ("AO", "Ambient Occlusion"),
];

/// The view layer and the pass that a layer's name stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Names {
    /// Empty where the file has none.
    pub view_layer: String,
    /// As Blender 5.0 calls it.
    pub pass: String,
}

impl Names {
    /// Of the full name in a file: `ViewLayer.DiffDir` is Diffuse Direct of ViewLayer. Names of passes may have dots.
    pub fn of(full: &str) -> Self {
        let (view_layer, pass) = full.split_once('.').unwrap_or(("", full));
        Self { view_layer: view_layer.to_owned(), pass: long(pass).to_owned() }
    }
}

fn long(pass: &str) -> &str {
    SHORT.iter().find(|(short, _)| *short == pass).map_or(pass, |(_, long)| long)
}

/// Name of the layer that `name` asks for: a pass of PASSES ("ao"), or a layer by its long or short name.
pub fn pass_of(name: &str) -> String {
    let row = PASSES.iter().find_map(|row| match row.prefix() {
        None => (row.name == name).then(|| row.layer.to_owned()),
        Some(prefix) if row.is_of_aovs() => name.strip_prefix(prefix).map(str::to_owned),
        Some(prefix) => {
            let group = name.strip_prefix(prefix)?;
            row.layer.rsplit_once('<').map(|(stem, _)| format!("{stem}{group}"))
        }
    });
    row.unwrap_or_else(|| long(name).to_owned())
}

/// The layers of two pictures by their names.
pub(super) struct Matched {
    /// Name, and the layers of both.
    pub pairs: Vec<(String, Layer, Layer)>,
    pub only_a: Vec<String>,
    pub only_b: Vec<String>,
}

/// Pairs the layers that have the same pass; where a picture has more than one view layer, of the same one. Passes
/// other than the `wanted` are left out, if any are.
pub(super) fn matched(a: Vec<Layer>, b: Vec<Layer>, wanted: &[String]) -> Matched {
    let many = has_many_view_layers(&a) || has_many_view_layers(&b);
    let wanted: Vec<String> = wanted.iter().map(|name| pass_of(name)).collect();
    let key = |layer: &Layer| match (many, layer.names.view_layer.as_str()) {
        (true, view_layer) if !view_layer.is_empty() => format!("{view_layer}.{}", layer.names.pass),
        _ => layer.names.pass.clone(),
    };
    let is_wanted = |layer: &Layer| wanted.is_empty() || wanted.contains(&layer.names.pass);
    let mut of_b: BTreeMap<String, Layer> = b.into_iter().filter(is_wanted).map(|layer| (key(&layer), layer)).collect();
    let (mut pairs, mut only_a) = (Vec::new(), Vec::new());
    for a in a.into_iter().filter(is_wanted) {
        let name = key(&a);
        match of_b.remove(&name) {
            Some(b) => pairs.push((name, a, b)),
            None => only_a.push(name),
        }
    }
    Matched { pairs, only_a, only_b: of_b.into_keys().collect() }
}

fn has_many_view_layers(layers: &[Layer]) -> bool {
    layers.iter().any(|layer| layer.names.view_layer != layers[0].names.view_layer)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_names_and_names_of_the_command_line_are_known() {
        let of = |full| Names::of(full).pass;
        assert_eq!(of("ViewLayer.DiffDir"), "Diffuse Direct");
        assert_eq!(of("ViewLayer.Diffuse Direct"), "Diffuse Direct");
        assert_eq!(of("AO"), "Ambient Occlusion");
        assert_eq!(of("Layer.my.aov"), "my.aov");
        assert_eq!(Names::of("Layer.my.aov").view_layer, "Layer");
        assert_eq!(pass_of("ao"), "Ambient Occlusion");
        assert_eq!(pass_of("shadow"), "Shadow");
        assert_eq!(pass_of("shadow_key"), "Shadow_key");
        assert_eq!(pass_of("combined_key"), "Combined_key");
        assert_eq!(pass_of("GlossCol"), "Glossy Color");
        assert_eq!(pass_of("Glossy Color"), "Glossy Color");
    }

    /// Every short name stands for a pass that is known, but for those of volumes.
    #[test]
    fn short_names_stand_for_passes() {
        for (_, long) in SHORT.iter().filter(|(_, long)| !long.starts_with("Volume")) {
            assert!(PASSES.iter().any(|row| row.layer == *long), "{long}");
        }
    }
}
