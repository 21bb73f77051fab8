//! One authored light as an emitter in render space; what can't be so is replaced, with a warning.

use std::sync::Arc;

use super::dome;
use crate::desc::{ConeDesc, DecayDesc, LightDesc, LightKind, SceneDesc};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Distant, Point, Profile};
use crate::math::{DMat3, DVec3, Mat3, Rgb};

/// The emitter of `light`; `None` where it emits nothing. Every substitute is told in one warning.
pub fn prepare(desc: &SceneDesc, light: &LightDesc, origin: DVec3, warnings: &mut Warnings) -> Option<AnyEmitter> {
    let finite = |rgb: &[f64; 3]| rgb.iter().all(|v| (*v as f32).is_finite() && *v >= 0.0);
    let color = light.kind.color();
    if !light.transform.is_finite() || !finite(&color) || light.decay.range.is_nan() {
        warnings.push(&light.place, "light with a negative or non-finite intensity or transform: left out");
        return None;
    }
    if color == [0.0; 3] {
        return None;
    }
    let p = (light.transform.translation - origin).as_vec3();
    let axes = orientation(light.transform.matrix3);
    let profile = profile(light);
    Some(match light.kind {
        LightKind::Point { intensity } => Point { p, intensity: Rgb::from(intensity), profile }.into(),
        LightKind::Distant { irradiance, angle } => {
            Distant::new(axes.z_axis.as_vec3(), angle as f32, Rgb::from(irradiance)).into()
        }
        LightKind::Dome { radiance, image } => {
            let orientation = Mat3::from_cols(axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), axes.z_axis.as_vec3());
            dome::prepare(desc, light, Rgb::from(radiance), image, orientation, warnings)?.into()
        }
        _ => {
            warnings.push(&light.place, "light of this shape: left out, not there yet");
            return None;
        }
    })
}

/// The orthonormal axes nearest to those of `m`: z first, then x.
fn orientation(m: DMat3) -> DMat3 {
    let z = m.z_axis.normalize_or(DVec3::Z);
    let x = (m.x_axis - z * z.dot(m.x_axis)).normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x);
    DMat3::from_cols(x, if y.dot(m.y_axis) < 0.0 { -y } else { y }, z)
}

/// Shaping and decay; `None` where there are none.
fn profile(light: &LightDesc) -> Option<Arc<Profile>> {
    let DecayDesc { range, .. } = light.decay;
    let range = if range > 0.0 { range as f32 } else { f32::INFINITY };
    let _: Option<ConeDesc> = light.shaping.cone;
    range.is_finite().then(|| Arc::new(Profile { range }))
}
