//! The material of a card that shows a picture of a model, as UsdImaging makes it.

use std::collections::BTreeMap;

use openusd::sdf;

use super::super::shape::CARDS_UV;
use super::super::stage::Reading;
use super::network::{Input, Network, Node, Source, Value};
use super::{Found, shade};

/// The network of the card whose picture the attribute at `path` names: the picture's color and opacity,
/// cut out where that is below a tenth; model:drawModeColor where there is no such picture.
pub(super) fn network(reading: &Reading<'_>, path: &sdf::Path) -> Option<Found> {
    let attribute = reading.stage.attribute(path).ok()?;
    let [r, g, b] = reading.value::<[f32; 3]>(&attribute.prim(), "model:drawModeColor").unwrap_or([0.18; 3]);
    let value = |value| Input { value, ..Input::default() };
    let text = |text: &str| value(Some(Value::Text(text.to_string())));
    let from = |node: usize, output: &str| {
        let source = Some(Source { node, output: output.to_string() });
        Input { source, ..Input::default() }
    };
    let node = |category: &str, kind: &str, inputs: Vec<(&str, Input)>| Node {
        category: category.to_string(),
        kind: kind.to_string(),
        materialx: false,
        place: reading.place_of(path),
        inputs: inputs.into_iter().map(|(name, input)| (name.to_string(), input)).collect::<BTreeMap<_, _>>(),
    };
    let nodes = vec![
        node(
            "UsdPreviewSurface",
            "",
            vec![
                ("diffuseColor", from(1, "rgb")),
                ("opacity", from(1, "a")),
                ("opacityThreshold", value(Some(Value::Numbers([0.1, 0.0, 0.0, 0.0], 1)))),
            ],
        ),
        node(
            "UsdUVTexture",
            "",
            vec![
                ("file", value(shade::value(reading, &attribute))),
                ("fallback", value(Some(Value::Numbers([r.into(), g.into(), b.into(), 1.0], 4)))),
                ("wrapS", text("clamp")),
                ("wrapT", text("clamp")),
                ("st", from(2, "result")),
            ],
        ),
        node("UsdPrimvarReader", "float2", vec![("varname", text(CARDS_UV))]),
    ];
    Some(Found { network: Network { nodes }, surface: Source { node: 0, output: "surface".to_string() } })
}
