//! Which layer what is told of stands in: prims are named by their path on the stage, and are seldom of its root layer.

use openusd::sdf::{FieldKey, Path, Specifier, Value};
use openusd::usd::SpecSite;

use super::stage::Reading;
use crate::error::{Warning, Warnings};

/// `told` with the layer where a prim is defined, or a property has its value, where that is not the root layer.
pub(super) fn with_layers(reading: &Reading<'_>, told: Warnings) -> Warnings {
    let mut named = Warnings::new();
    for warning in told.iter() {
        let mut place = warning.place.clone();
        if place.file == reading.place.file
            && let Some(layer) = place.node.as_deref().and_then(|node| layer_of(reading, node))
        {
            place = place.at(format!("{} (in {layer})", place.node.as_deref().unwrap_or_default()));
        }
        named.add(Warning { place, ..warning.clone() });
    }
    named
}

fn layer_of(reading: &Reading<'_>, node: &str) -> Option<String> {
    let path = Path::new(node).ok()?;
    let site = if path.is_property_path() {
        reading.stage.attribute(path).ok()?.property_stack().ok()?.into_iter().next()?
    } else {
        let sites = reading.stage.prim(path).ok()?.prim_stack().ok()?;
        sites.into_iter().find(|site| defines(reading, site))?
    };
    let root = reading.stage.layer_identifiers().into_iter().next()?;
    (site.layer != root).then_some(site.layer)
}

fn defines(reading: &Reading<'_>, site: &SpecSite) -> bool {
    let Some(layer) = reading.stage.layer(&site.layer) else { return false };
    let specifier = layer.data().try_field(&site.path, FieldKey::Specifier.as_str()).ok().flatten();
    matches!(specifier.as_deref(), Some(Value::Specifier(Specifier::Def)))
}
