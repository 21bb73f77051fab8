//! Units and the up axis. OpenUSD composes layers as they are and leaves it to whoever references a layer
//! in other units to scale it; so do we, and say so.

use openusd::sdf;
use openusd::usd::Stage;

use super::stage::Reading;
use crate::error::{Place, Warnings};
use crate::math::{DAffine3, DMat3, DVec3};

/// OpenUSD's fallback: centimetres.
const METERS: f64 = 0.01;

/// In what a layer is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Units {
    /// Metres per unit.
    pub meters: f64,
    /// True where +z is up, else +y.
    pub z_up: bool,
}

impl Units {
    /// Those of the stage.
    pub fn of_root(stage: &Stage, place: &Place, warnings: &mut Warnings) -> Self {
        let meters = number(stage.stage_metadata("metersPerUnit").ok().flatten());
        if let Some(meters) = meters.filter(|m| !usable(*m)) {
            warnings.push(place, format!("metersPerUnit is {meters}; taken for {METERS}"));
        }
        let axis = text(stage.stage_metadata("upAxis").ok().flatten());
        if let Some(axis) = axis.as_deref().filter(|axis| !matches!(*axis, "Y" | "Z")) {
            warnings.push(place, format!("upAxis is '{axis}', which is neither Y nor Z; taken for Y"));
        }
        Self { meters: meters.filter(|m| usable(*m)).unwrap_or(METERS), z_up: axis.as_deref() == Some("Z") }
    }

    /// To our space: y up, metres.
    pub fn to_world(self) -> DAffine3 {
        // z up to y up: (x, y, z) is (x, z, −y).
        let turn = if self.z_up { DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y) } else { DMat3::IDENTITY };
        DAffine3::from_mat3(turn * DMat3::from_diagonal(DVec3::splat(self.meters)))
    }
}

/// Tells of layers that are measured otherwise than the root layer.
pub(super) fn warn_of_layers(reading: &Reading<'_>) {
    let root = reading.stage.root_layer().identifier().to_owned();
    let z_up = reading.to_world.matrix3.z_axis.y != 0.0;
    for identifier in reading.stage.layer_identifiers() {
        if identifier == root {
            continue;
        }
        let Some(layer) = reading.stage.layer(&identifier) else { continue };
        let field = |key| layer.data().try_field(&sdf::Path::abs_root(), key).ok().flatten().map(|v| v.into_owned());
        let meters = number(field("metersPerUnit")).filter(|m| usable(*m) && !near(*m, reading.meters));
        let axis = text(field("upAxis")).filter(|axis| (axis == "Z") != z_up);
        let place = Place::file(&identifier);
        let mut warnings = reading.warnings.borrow_mut();
        if let Some(meters) = meters {
            let ours = reading.meters;
            let what = format!(
                "metersPerUnit is {meters}, that of the stage {ours}; its units are taken for the stage's, as OpenUSD does"
            );
            warnings.push(&place, what);
        }
        if let Some(axis) = axis {
            let ours = if z_up { "Z" } else { "Y" };
            let what = format!("upAxis is {axis}, that of the stage {ours}; it is not turned, as in OpenUSD");
            warnings.push(&place, what);
        }
    }
}

fn usable(meters: f64) -> bool {
    meters.is_finite() && meters > 0.0
}

/// UsdGeomLinearUnitsAre, whose tolerance is 1e-5.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-5 * a.abs().max(b.abs())
}

fn number(value: Option<sdf::Value>) -> Option<f64> {
    match value? {
        sdf::Value::Double(value) => Some(value),
        sdf::Value::Float(value) => Some(f64::from(value)),
        sdf::Value::Int(value) => Some(f64::from(value)),
        _ => None,
    }
}

fn text(value: Option<sdf::Value>) -> Option<String> {
    match value? {
        sdf::Value::Token(value) => Some(value.to_string()),
        sdf::Value::String(value) => Some(value),
        _ => None,
    }
}
