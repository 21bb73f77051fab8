//! How the shadows of a light look, its bad numbers mended.

use super::mend::Mended;
use crate::desc::{LightLinks, ShadowDesc};
use crate::light::ShadowLook;

/// The look of the shadows of a light with `links`; `None` where they are black and without end, or it casts none.
pub fn prepare(links: &LightLinks, mended: &mut Mended) -> Option<ShadowLook> {
    let ShadowDesc { color, distance, falloff, gamma } = links.shadow;
    if !links.cast_shadow || links.shadow == ShadowDesc::default() {
        return None;
    }
    const LENGTH: [f64; 2] = [0.0, f64::INFINITY];
    let color = mended.color("shadow color", color);
    let distance = if distance.is_nan() {
        mended.note("its shadow distance is NaN: taken as endless");
        f64::INFINITY
    } else {
        mended.clamped("shadow distance", distance, LENGTH)
    };
    let falloff = mended.clamped("shadow falloff", falloff, LENGTH);
    let gamma = mended.clamped("shadow falloff gamma", gamma, LENGTH);
    ShadowLook::new(color, distance as f32, falloff as f32, gamma as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Place, Warnings};
    use crate::math::Rgb;

    fn prepared(shadow: ShadowDesc) -> (Option<ShadowLook>, String) {
        let mut mended = Mended::default();
        let look = prepare(&LightLinks { shadow, ..LightLinks::default() }, &mut mended);
        let mut warnings = Warnings::new();
        mended.tell_at(&Place::default(), &mut warnings);
        (look, warnings.iter().map(|warning| warning.what.clone()).collect())
    }

    #[test]
    fn bad_numbers_are_mended_and_told() {
        let default = ShadowDesc::default();
        assert_eq!(prepared(default), (None, String::new()));
        let (look, said) = prepared(ShadowDesc { color: [-1.0, 0.5, f64::NAN], distance: f64::NAN, ..default });
        assert_eq!(look, ShadowLook::new(Rgb::new(0.0, 0.5, 0.0), f32::INFINITY, 0.0, 1.0));
        for told in ["shadow color is negative", "shadow color is not finite", "shadow distance is NaN"] {
            assert!(said.contains(told), "{told}: {said}");
        }
        let (look, said) = prepared(ShadowDesc { distance: -3.0, falloff: f64::NAN, gamma: -1.0, ..default });
        assert_eq!(look, ShadowLook::new(Rgb::BLACK, 0.0, 0.0, 0.0));
        for told in ["distance is -3: taken as 0", "falloff is NaN: taken as 0", "gamma is -1: taken as 0"] {
            assert!(said.contains(told), "{told}: {said}");
        }
        // What casts no shadow has none to look at.
        let links =
            LightLinks { cast_shadow: false, shadow: ShadowDesc { distance: 1.0, ..default }, ..LightLinks::default() };
        assert_eq!(prepare(&links, &mut Mended::default()), None);
    }
}
