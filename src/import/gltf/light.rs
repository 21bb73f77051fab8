//! KHR_lights_punctual, from its units to watts.
//!
//! The extension has candela for points and spots and lux for distant lights; 1 W is 683 lm here,
//! as in Blender's exporter. That exporter has two further modes, in which point and spot carry
//! P/(4π) ("unitless", compat) or P ("raw") for a lamp of P watts, and the sun its strength in W/m².

use std::f64::consts::{FRAC_PI_2, PI};

use super::super::LightUnits;
use super::json::Light;
use crate::desc::LightKind;

/// Lumens of a watt, by which physical glTF units and radiometric ones are exchanged.
const LUMENS_PER_WATT: f64 = 683.0;

/// What `light` emits, or why it can't.
pub(super) fn kind(light: &Light, units: LightUnits) -> Result<LightKind, String> {
    let (radial, distant) = match units {
        LightUnits::Spec => (1.0 / LUMENS_PER_WATT, 1.0 / LUMENS_PER_WATT),
        LightUnits::Compat => (1.0, 1.0),
        LightUnits::Raw => (1.0 / (4.0 * PI), 1.0),
    };
    let scaled = |factor: f64| light.color.map(|c| (c * light.intensity * factor).max(0.0));
    let range = light.range.filter(|range| *range > 0.0).unwrap_or(f64::INFINITY);
    match light.kind.as_str() {
        "point" => Ok(LightKind::Point { intensity: scaled(radial), range }),
        "spot" => {
            let outer = light.spot.outer_cone_angle;
            if outer.is_nan() || outer <= 0.0 {
                return Err(format!("a spot light with an outer cone of {outer} radians emits nothing"));
            }
            let outer = outer.min(FRAC_PI_2);
            let inner = light.spot.inner_cone_angle.clamp(0.0, outer);
            Ok(LightKind::Spot { intensity: scaled(radial), inner, outer, range })
        }
        "directional" => Ok(LightKind::Distant { irradiance: scaled(distant), angle: 0.0 }),
        kind => Err(format!("light type '{kind}' is not known")),
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
            let Ok(LightKind::Point { intensity, range }) = kind(&light("point", written), units) else { panic!() };
            assert!((intensity[0] / expected - 1.0).abs() < 1e-9, "{units:?} {intensity:?}");
            assert!((intensity[1] / expected - 0.5).abs() < 1e-9 && intensity[2] == 0.0 && range.is_infinite());
            let Ok(LightKind::Distant { irradiance, angle }) = kind(&light("directional", sun), units) else {
                panic!()
            };
            assert!((irradiance[0] - 3.0).abs() < 1e-12 && angle == 0.0, "{units:?}");
        }
    }

    #[test]
    fn cones_are_ordered() {
        let mut spot = light("spot", 1.0);
        spot.spot.inner_cone_angle = 2.0;
        spot.spot.outer_cone_angle = 3.0;
        let Ok(LightKind::Spot { inner, outer, .. }) = kind(&spot, LightUnits::Spec) else { panic!() };
        assert_eq!((inner, outer), (FRAC_PI_2, FRAC_PI_2));
        spot.spot.outer_cone_angle = 0.0;
        assert!(kind(&spot, LightUnits::Spec).is_err());
        assert!(kind(&light("tube", 1.0), LightUnits::Spec).is_err());
    }
}
