//! One authored light as an emitter in render space; what can't be so is replaced, with a warning.

use super::mend::Mended;
use super::{dome, flat, shaping};
use crate::desc::{LightDesc, LightKind, SceneDesc};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Cylinder, Distant, Flat, Point, Sphere};
use crate::math::{DMat3, DVec3, Mat3, Vec3};

/// The emitter of `light`; `None` where it emits nothing. All substitutes are told in one warning.
pub fn prepare(desc: &SceneDesc, light: &LightDesc, origin: DVec3, warnings: &mut Warnings) -> Option<AnyEmitter> {
    let mut mended = Mended::default();
    let emitter = emitter(desc, light, origin, &mut mended, warnings);
    mended.tell(light, emitter.is_none(), warnings);
    emitter
}

fn emitter(
    desc: &SceneDesc,
    light: &LightDesc,
    origin: DVec3,
    mended: &mut Mended,
    warnings: &mut Warnings,
) -> Option<AnyEmitter> {
    let color = mended.color(light.kind.color())?;
    let axes = axes(light, mended);
    let far = matches!(light.kind, LightKind::Distant { .. } | LightKind::Dome { .. });
    let p = if far { Vec3::ZERO } else { position(light, origin, mended)? };
    let profile = if far { None } else { shaping::profile(desc, light, axes, mended)? };
    Some(match light.kind {
        LightKind::Point { .. } => Point { p, intensity: color, profile }.into(),
        LightKind::Sphere { radius, facing, .. } => {
            Sphere { center: p, radius: mended.size("radius", radius)?, radiance: color, facing, profile }.into()
        }
        LightKind::Cylinder { radius, length, .. } => {
            let (radius, length) = (mended.size("radius", radius)?, mended.size("length", length)?);
            Cylinder::new(p, axes.x_axis.as_vec3(), radius, length, color, profile).into()
        }
        LightKind::Distant { angle, .. } => Distant::new(axes.z_axis.as_vec3(), angle as f32, color).into(),
        LightKind::Dome { image, .. } => {
            let orientation = Mat3::from_cols(axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), axes.z_axis.as_vec3());
            dome::prepare(desc, light, color, image, orientation, warnings)?.into()
        }
        LightKind::Rect { .. } | LightKind::Disk { .. } => {
            let flat = Flat { profile, ..Flat::new(light.transform.translation - origin, axes, color) };
            flat::prepare(desc, light, flat, mended, warnings)?
        }
    })
}

/// Where it stands in render space.
fn position(light: &LightDesc, origin: DVec3, mended: &mut Mended) -> Option<Vec3> {
    let p = (light.transform.translation - origin).as_vec3();
    if !p.is_finite() {
        mended.note("its position is not finite");
    }
    p.is_finite().then_some(p)
}

/// Its orthonormal axes in render space.
fn axes(light: &LightDesc, mended: &mut Mended) -> DMat3 {
    let m = light.transform.matrix3;
    if is_regular(m) {
        return orientation(m);
    }
    // A round light without shaping has no orientation to lose.
    let round = matches!(light.kind, LightKind::Point { .. } | LightKind::Sphere { .. });
    if !round || light.shaping != Default::default() {
        mended.note("its transform is singular or not finite: taken as not turned");
    }
    DMat3::IDENTITY
}

/// True for a matrix that has an inverse, whatever its scale.
pub(super) fn is_regular(m: DMat3) -> bool {
    let unit = |v: DVec3| v.try_normalize().unwrap_or(DVec3::ZERO);
    let directions = DMat3::from_cols(unit(m.x_axis), unit(m.y_axis), unit(m.z_axis));
    m.is_finite() && directions.determinant().abs() > 1e-9
}

/// The orthonormal axes nearest to those of `m`: z first, then x.
fn orientation(m: DMat3) -> DMat3 {
    let z = m.z_axis.normalize_or(DVec3::Z);
    let x = m.x_axis.normalize_or(DVec3::X);
    let x = (x - z * z.dot(x)).normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x);
    DMat3::from_cols(x, if y.dot(m.y_axis) < 0.0 { -y } else { y }, z)
}
