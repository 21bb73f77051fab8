//! Offsets of layers that stretch time by nothing or run it backwards: as in OpenUSD they count for none.

use std::borrow::Cow;

use openusd::sdf::{self, AbstractData, FieldKey, LayerOffset, Value};

use super::stage::Reading;
use crate::error::Place;

/// Tells of those that the prim, or the root, at `spec` of `layer` has.
pub(super) fn tell(reading: &Reading<'_>, layer: &str, data: &dyn AbstractData, spec: &sdf::Path) {
    let field = |key: FieldKey| {
        let has = data.has_field(spec, key.as_str());
        has.then(|| data.try_field(spec, key.as_str()).ok().flatten()).flatten()
    };
    let told = |arc: &str, offset: &LayerOffset| {
        if !offset.is_valid_composition() {
            let what = format!(
                "{arc} has the offset {} and the scale {}, which can't be: its times are left as they are",
                offset.offset, offset.scale
            );
            let place = Place::file(layer);
            let place = if spec.is_abs_root() { place } else { place.at(spec.as_str()) };
            reading.warnings.borrow_mut().push(&place, what);
        }
    };
    if let Some(Value::ReferenceListOp(list)) = field(FieldKey::References).as_deref() {
        list.flatten().iter().for_each(|arc| told(&format!("its reference @{}@", arc.asset_path), &arc.layer_offset));
    }
    let payloads = match field(FieldKey::Payload).map(Cow::into_owned) {
        Some(Value::PayloadListOp(list)) => list.flatten(),
        Some(Value::Payload(payload)) => vec![payload],
        _ => Vec::new(),
    };
    payloads.iter().for_each(|arc| told(&format!("its payload @{}@", arc.asset_path), &arc.layer_offset));
    if spec.is_abs_root()
        && let Some(Value::LayerOffsetVec(offsets)) = field(FieldKey::SubLayerOffsets).as_deref()
    {
        let names =
            field(FieldKey::SubLayers).and_then(|value| value.into_owned().try_as_string_vec()).unwrap_or_default();
        for (name, offset) in names.iter().zip(offsets) {
            told(&format!("its sublayer @{name}@"), offset);
        }
    }
}
