//! KHR_lights_punctual, from its units to watts.
//!
//! The extension has candela for points and spots and lux for distant lights; 1 W is 683 lm here,
//! as in Blender's exporter. That exporter has two further modes, in which point and spot carry
//! P/(4π) ("unitless", compat) or P ("raw") for a lamp of P watts, and the sun its strength in W/m².

use std::f64::consts::PI;

use serde_json::Value;

use super::super::LightUnits;
use super::json::Light;
use crate::desc::{ConeDesc, DecayDesc, LightKind, ShapingDesc};

/// Lumens of a watt, by which physical glTF units and radiometric ones are exchanged.
pub(super) const LUMENS_PER_WATT: f64 = 683.0;

/// A strength times a channel of a color, negative where either is: two wrongs make no light.
pub(super) fn tinted(strength: f64, color: f64) -> f64 {
    let product = strength * color;
    if strength < 0.0 { -product.abs() } else { product }
}

/// What `light` emits, or why it can't; bad numbers stay, and are mended and told where the light is
/// prepared. `extras` are those of its node: the extension has no size for
/// the sun, which stands there as `angle`, the full angle in radians (Blender's exporter writes an
/// object's custom properties so).
pub(super) fn kind(
    light: &Light,
    extras: &Value,
    units: LightUnits,
) -> Result<(LightKind, ShapingDesc, DecayDesc), String> {
    let (radial, distant) = match units {
        LightUnits::Spec => (1.0 / LUMENS_PER_WATT, 1.0 / LUMENS_PER_WATT),
        LightUnits::Compat => (1.0, 1.0),
        LightUnits::Raw => (1.0 / (4.0 * PI), 1.0),
    };
    let scaled = |factor: f64| light.color.map(|c| tinted(light.intensity * factor, c));
    let decay = DecayDesc { range: light.range.unwrap_or(f64::INFINITY), ..DecayDesc::default() };
    let point = LightKind::Point { intensity: scaled(radial) };
    match light.kind.as_str() {
        "point" => Ok((point, ShapingDesc::default(), decay)),
        "spot" => {
            let cone = ConeDesc::Ramp { inner: light.spot.inner_cone_angle, outer: light.spot.outer_cone_angle };
            let cone = Some(cone);
            Ok((point, ShapingDesc { cone, ..ShapingDesc::default() }, decay))
        }
        "directional" => {
            let angle = extras["angle"].as_f64().unwrap_or(0.0);
            let kind = LightKind::Distant { irradiance: scaled(distant), angle };
            Ok((kind, ShapingDesc::default(), DecayDesc::default()))
        }
        kind => Err(format!("light type '{kind}' is not known")),
    }
}

/// The cone that Blender's exporter made of a spot: its outer angle, and the inner one by what the blend leaves.
pub(super) fn cone_of_blender(cone: ConeDesc) -> ConeDesc {
    match cone {
        ConeDesc::Ramp { inner, outer } if outer > 0.0 => {
            ConeDesc::Blend { angle: outer, blend: (1.0 - inner / outer).clamp(0.0, 1.0) }
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(kind: &str, intensity: f64) -> Light {
        Light { kind: kind.into(), intensity, color: [1.0, 0.5, 0.0], ..Light::default() }
    }

    /// The numbers that Blender's exporter writes for a 100 W lamp and a sun of strength 3.
    #[test]
    fn each_of_blenders_modes_comes_back_to_watts() {
        let expected = 100.0 / (4.0 * PI);
        for (units, written, sun) in [
            (LightUnits::Spec, 5_435.141_306_588, 2049.0),
            (LightUnits::Compat, 7.957_747_154_6, 3.0),
            (LightUnits::Raw, 100.0, 3.0),
        ] {
            let point = kind(&light("point", written), &Value::Null, units);
            let Ok((LightKind::Point { intensity }, _, DecayDesc { range, .. })) = point else { panic!() };
            assert!((intensity[0] / expected - 1.0).abs() < 1e-9, "{units:?} {intensity:?}");
            assert!((intensity[1] / expected - 0.5).abs() < 1e-9 && intensity[2] == 0.0 && range.is_infinite());
            let distant = kind(&light("directional", sun), &Value::Null, units);
            let Ok((LightKind::Distant { irradiance, angle }, ..)) = distant else { panic!() };
            assert!((irradiance[0] - 3.0).abs() < 1e-12 && angle == 0.0, "{units:?}");
        }
    }

    #[test]
    fn a_light_of_unknown_type_is_none() {
        assert!(kind(&light("tube", 1.0), &Value::Null, LightUnits::Spec).is_err());
    }

    #[test]
    fn a_negative_factor_is_not_made_good_by_another() {
        assert_eq!(
            [(2.0, 3.0), (-2.0, 3.0), (2.0, -3.0), (-2.0, -3.0)].map(|(a, b)| tinted(a, b)),
            [6.0, -6.0, -6.0, -6.0]
        );
    }

    #[test]
    fn the_suns_size_stands_in_the_extras() {
        for (extras, expected) in [(r#"{"angle": 0.5}"#, 0.5), (r#"{"angle": "1"}"#, 0.0), ("[]", 0.0), ("null", 0.0)] {
            let extras: Value = serde_json::from_str(extras).unwrap();
            let distant = kind(&light("directional", 1.0), &extras, LightUnits::Spec);
            let Ok((LightKind::Distant { angle, .. }, ..)) = distant else { panic!() };
            assert_eq!(angle, expected);
        }
    }
}
