//! ShapingAPI: cone, focus and measured distribution.

use std::f64::consts::PI;

use super::super::values::Values;
use super::{Light, Profiles};
use crate::desc::{ConeDesc, LightKind, ShapingDesc};

/// The shaping of a light of `kind`, and what its measured distribution multiplies its emission by.
pub(super) fn read(light: &Light<'_>, kind: &LightKind, profiles: &mut Profiles) -> (ShapingDesc, f64) {
    let values = &light.values;
    if matches!(kind, LightKind::Distant { .. } | LightKind::Dome { .. }) {
        // Some write it to every light, with a cone that takes nothing away.
        let shapes = cone(values, false).is_some() || values.number("inputs:shaping:focus").unwrap_or(0.0) > 0.0;
        if values.has_api("ShapingAPI") && (shapes || values.asset("inputs:shaping:ies:file").is_some()) {
            values.warn("ShapingAPI on a light that is infinitely far away is not rendered");
        }
        return (ShapingDesc::default(), 1.0);
    }
    of(values, matches!(kind, LightKind::Rect { .. } | LightKind::Disk { .. }), profiles)
}

/// The same of a light that is not infinitely far away; a `flat` one shines to one side at most.
pub(super) fn of(values: &Values<'_>, flat: bool, profiles: &mut Profiles) -> (ShapingDesc, f64) {
    let cone = cone(values, flat);
    // Below 0 it is ignored.
    let focus = values.number("inputs:shaping:focus").unwrap_or(0.0).max(0.0);
    let focus_tint = if focus > 0.0 { values.color("inputs:shaping:focusTint").unwrap_or_default() } else { [0.0; 3] };
    let ies = values.asset("inputs:shaping:ies:file").and_then(|file| profiles.load(values, &file));
    let (ies, factor) = ies.map_or((None, 1.0), |(ies, factor)| (Some(ies), factor));
    (ShapingDesc { cone, focus, focus_tint, ies, shader: None }, factor)
}

/// The cone; `None` where it takes nothing away.
fn cone(values: &Values<'_>, flat: bool) -> Option<ConeDesc> {
    let degrees = values.number("inputs:shaping:cone:angle")?;
    let angle = degrees.to_radians().clamp(0.0, PI);
    let softness = values.number("inputs:shaping:cone:softness").unwrap_or(0.0).clamp(0.0, 1.0);
    if softness == 0.0 && degrees >= if flat { 90.0 } else { 180.0 } {
        return None;
    }
    // Blender writes Cycles' spot blend as softness.
    let blender = values.reading.blender;
    Some(if blender { ConeDesc::Blend { angle, blend: softness } } else { ConeDesc::Soft { angle, softness } })
}
