//! Shaping and decay of a light, its bad numbers mended.

use std::f64::consts::PI;
use std::sync::Arc;

use super::lamp::{axes, proportions};
use super::mend::Mended;
use crate::desc::{ConeDesc, DecayDesc, DecayLaw, IesRef, InstanceDesc, LightDesc, LightKind, SceneDesc};
use crate::error::Warnings;
use crate::light::{Cone, Decay, Drawn, Falloff, Ies, Profile, Shaping};
use crate::math::DMat3;

/// Sharpest focus: a cone of about a tenth of a degree.
const SHARPEST_FOCUS: f64 = 1e6;

/// The profile of `light`, whose orthonormal axes in render space are `axes`, with what its graph has `drawn`:
/// `Some(None)` where it has neither shaping nor decay, `None` where they leave no light.
pub fn profile(
    desc: &SceneDesc,
    light: &LightDesc,
    axes: DMat3,
    drawn: Option<Drawn>,
    mended: &mut Mended,
) -> Option<Option<Arc<Profile>>> {
    let profile = made(desc, light, axes, drawn, mended);
    if profile.as_ref().is_some_and(|profile| profile.peak().is_black()) {
        mended.note("its shaping leaves no light");
        return None;
    }
    Some(profile)
}

/// The profile of what `instance` emits, and whether it leaves any light; bad numbers are told.
pub fn of_instance(desc: &SceneDesc, instance: &InstanceDesc, warnings: &mut Warnings) -> (Option<Arc<Profile>>, bool) {
    let Some(shaped) = &instance.shaped else { return (None, true) };
    // As that of a lamp which stands there.
    let point = LightKind::Point { intensity: [1.0; 3] };
    let lamp = LightDesc::new(instance.name.clone(), instance.place.clone(), shaped.transform, point);
    let lamp = LightDesc { shaping: shaped.shaping, ..lamp };
    let mut mended = Mended::default();
    let axes = axes(&lamp, &mut mended);
    let profile = made(desc, &lamp, axes, None, &mut mended);
    let shines = profile.as_ref().is_none_or(|profile| !profile.peak().is_black());
    if !shines {
        mended.note("its shaping leaves no light");
    }
    mended.tell(&lamp, false, warnings);
    (profile, shines)
}

fn made(
    desc: &SceneDesc,
    light: &LightDesc,
    axes: DMat3,
    drawn: Option<Drawn>,
    mended: &mut Mended,
) -> Option<Arc<Profile>> {
    let decay = decay(light.decay, mended);
    let of = &light.shaping;
    let matrix = light.transform.matrix3;
    let focus = mended.clamped("focus", of.focus, [0.0, SHARPEST_FOCUS]);
    let shaping = Shaping {
        cone: of.cone.map(|cone| self::cone(cone, mended)),
        stretch: matches!(of.cone, Some(ConeDesc::Blend { .. })).then(|| proportions(matrix)).flatten(),
        focus,
        focus_tint: of.focus_tint.map(|tint| mended.clamped("focus tint", tint, [0.0, f64::from(f32::MAX)])),
        ies: of.ies.and_then(|ies| self::ies(desc, ies, mended)),
        drawn,
    };
    let plain = shaping.cone.is_none() && focus == 0.0 && shaping.ies.is_none() && shaping.drawn.is_none();
    if plain && decay == Decay::PHYSICAL {
        return None;
    }
    Some(Arc::new(Profile::new(axes, shaping, decay)))
}

fn cone(cone: ConeDesc, mended: &mut Mended) -> Cone {
    const SHARE: [f64; 2] = [0.0, 1.0];
    match cone {
        ConeDesc::Ramp { inner, outer } => {
            let outer = half_angle(outer, mended);
            Cone::ramp(mended.clamped("inner cone angle", inner, [0.0, outer]), outer)
        }
        ConeDesc::Blend { angle, blend } => {
            Cone::blend(half_angle(angle, mended), mended.clamped("cone blend", blend, SHARE))
        }
        ConeDesc::Soft { angle, softness } => {
            Cone::soft(half_angle(angle, mended), mended.clamped("cone softness", softness, SHARE))
        }
    }
}

/// No number is no cone.
fn half_angle(angle: f64, mended: &mut Mended) -> f64 {
    if angle.is_nan() {
        mended.note("its cone angle is NaN: taken as 180 degrees");
        return PI;
    }
    mended.clamped("cone angle", angle, [0.0, PI])
}

fn ies(desc: &SceneDesc, of: IesRef, mended: &mut Mended) -> Option<Ies> {
    let source = &desc.ies[of.profile as usize];
    let mut scale = of.angle_scale;
    if !scale.is_finite() {
        mended.note(format!("its IES angle scale is {scale}: taken as 0"));
        scale = 0.0;
    }
    let ies = Ies::new(&source.vertical, &source.horizontal, &source.candela, scale, of.keep_power);
    if ies.is_none() {
        mended.note(format!("IES profile \"{}\" gives no light: shines without it", source.name));
    }
    ies
}

fn decay(of: DecayDesc, mended: &mut Mended) -> Decay {
    let smooth = mended.clamped("decay smoothing", of.smooth, [0.0, f64::MAX]);
    let mut range = of.range;
    if range.is_nan() || range <= 0.0 {
        mended.note(format!("its range is {range}: taken as endless"));
        range = f64::INFINITY;
    }
    let falloff = match of.law {
        DecayLaw::Constant => Falloff::Constant,
        DecayLaw::Linear => Falloff::Linear,
        DecayLaw::Quadratic => Falloff::Quadratic,
        DecayLaw::Polynomial { kc, kl, kq } => polynomial([kc, kl, kq], mended),
    };
    Decay { falloff, smooth, range }
}

fn polynomial(terms: [f64; 3], mended: &mut Mended) -> Falloff {
    let sum: f64 = terms.iter().map(|term| term.max(0.0)).sum();
    if terms.iter().any(|term| term.is_nan()) || !(sum > 0.0 && sum.is_finite()) {
        mended.note("its decay is no polynomial that falls off: taken as quadratic");
        return Falloff::Quadratic;
    }
    let [kc, kl, kq] = terms.map(|term| mended.clamped("decay term", term, [0.0, f64::MAX]));
    Falloff::Polynomial { kc, kl, kq }
}
