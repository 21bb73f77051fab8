//! One authored light as an emitter in render space; what can't be so is replaced, with a warning.

use std::f64::consts::PI;

use super::lamp_shader::LampShader;
use super::mend::Mended;
use super::{dome, flat, shaping};
use crate::desc::{LightDesc, LightKind, SceneDesc};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Cylinder, Distant, Flat, Point, Sphere};
use crate::math::{DMat3, DVec3, Mat3, Rgb, Vec3};

/// The emitter of `light`, which is no shaded dome, with its `shader`; `None` where it emits nothing. All substitutes are
/// told in one warning.
pub fn prepare(
    desc: &SceneDesc,
    light: &LightDesc,
    origin: DVec3,
    shader: Option<&LampShader>,
    warnings: &mut Warnings,
) -> Option<AnyEmitter> {
    let mut mended = Mended::default();
    let emitter = emitter(desc, light, origin, shader, &mut mended);
    mended.tell(light, emitter.is_none(), warnings);
    emitter
}

fn emitter(
    desc: &SceneDesc,
    light: &LightDesc,
    origin: DVec3,
    shader: Option<&LampShader>,
    mended: &mut Mended,
) -> Option<AnyEmitter> {
    let color = mended.color("intensity", light.kind.color());
    if color.is_black() {
        return None;
    }
    let axes = axes(light, mended);
    let far = matches!(light.kind, LightKind::Distant { .. }) || light.kind.is_dome();
    let p = if far { Vec3::ZERO } else { position(light, origin, mended)? };
    let drawn = shader.filter(|shader| !shader.by_place()).map(LampShader::drawn);
    let profile = if far { None } else { shaping::profile(desc, light, axes, drawn, mended)? };
    Some(match light.kind {
        LightKind::Point { .. } => Point { p, intensity: color, profile }.into(),
        LightKind::Sphere { radius, facing, .. } => {
            Sphere { center: p, radius: mended.size("radius", radius)?, radiance: color, facing, profile }.into()
        }
        LightKind::Cylinder { radius, length, .. } => {
            let (radius, length) = (mended.size("radius", radius)?, mended.size("length", length)?);
            Cylinder::new(p, axes.x_axis.as_vec3(), radius, length, color, profile).into()
        }
        LightKind::Distant { angle, .. } => {
            let angle = mended.clamped("angle", angle, [0.0, PI]);
            let factor = shader.map_or(Rgb::WHITE, |shader| shader.of_sun(light, angle, mended));
            if factor.is_black() {
                return None;
            }
            Distant::new(axes.z_axis.as_vec3(), angle as f32, color * factor).into()
        }
        LightKind::Dome { image, .. } => {
            let orientation = Mat3::from_cols(axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), axes.z_axis.as_vec3());
            dome::prepare(desc, color, image, orientation, mended)?.into()
        }
        LightKind::ShadedDome { .. } | LightKind::Portal { .. } => return None,
        LightKind::Rect { .. } | LightKind::Disk { .. } => {
            let flat = Flat { profile, ..Flat::new(light.transform.translation - origin, axes, color) };
            flat::prepare(desc, light, flat, shader, mended)?
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
pub(super) fn axes(light: &LightDesc, mended: &mut Mended) -> DMat3 {
    if let Some(m) = proportions(light.transform.matrix3) {
        return orientation(m);
    }
    // A round light without shaping has no orientation to lose.
    let round = matches!(light.kind, LightKind::Point { .. } | LightKind::Sphere { .. });
    if !round || light.shaping != Default::default() {
        mended.note("its transform is singular or not finite: taken as not turned");
    }
    DMat3::IDENTITY
}

/// `m` scaled to 1 at its largest, so that no scale is too small or large for what follows; `None` for
/// what has no inverse.
pub(super) fn proportions(m: DMat3) -> Option<DMat3> {
    let largest = m.to_cols_array().iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    let m = DMat3::from_cols(m.x_axis / largest, m.y_axis / largest, m.z_axis / largest);
    let unit = |v: DVec3| v.try_normalize().unwrap_or(DVec3::ZERO);
    let directions = DMat3::from_cols(unit(m.x_axis), unit(m.y_axis), unit(m.z_axis));
    (m.is_finite() && directions.determinant().abs() > 1e-9).then_some(m)
}

/// The orthonormal axes nearest to those of `m`: z first, then x.
fn orientation(m: DMat3) -> DMat3 {
    let z = m.z_axis.normalize_or(DVec3::Z);
    let x = m.x_axis.normalize_or(DVec3::X);
    let x = (x - z * z.dot(x)).normalize_or(z.any_orthonormal_vector());
    let y = z.cross(x);
    DMat3::from_cols(x, if y.dot(m.y_axis) < 0.0 { -y } else { y }, z)
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{ConeDesc, DecayDesc, DecayLaw, IesDesc, IesRef, ShapingDesc};
    use crate::error::Place;
    use crate::light::{Emitter, Receiver};
    use crate::math::DAffine3;

    const NAN: f64 = f64::NAN;

    fn light(kind: LightKind) -> LightDesc {
        LightDesc::new("Key", Place::file("a.usda").at("/Key"), DAffine3::IDENTITY, kind)
    }

    fn point() -> LightDesc {
        light(LightKind::Point { intensity: [1.0; 3] })
    }

    fn sphere(radius: f64, radiance: [f64; 3]) -> LightDesc {
        light(LightKind::Sphere { radius, radiance, facing: false })
    }

    fn tube(radius: f64, length: f64) -> LightDesc {
        light(LightKind::Cylinder { radius, length, radiance: [1.0; 3] })
    }

    /// The emitter and what was said about it.
    fn prepared(light: &LightDesc) -> (Option<AnyEmitter>, String) {
        let profile = |candela: f64| IesDesc {
            name: "down.ies".into(),
            place: Place::default(),
            vertical: vec![0.0, 90.0],
            horizontal: vec![0.0],
            candela: vec![candela; 2],
        };
        let desc = SceneDesc { ies: vec![profile(5.0), profile(0.0)], ..SceneDesc::default() };
        let mut warnings = Warnings::new();
        let emitter = prepare(&desc, light, DVec3::ZERO, None, &mut warnings);
        assert!(warnings.len() <= 1);
        (emitter, warnings.iter().map(ToString::to_string).collect())
    }

    fn left_out(light: &LightDesc, why: &str) {
        let (emitter, said) = prepared(light);
        assert!(emitter.is_none(), "{said}");
        assert_eq!(said, format!("a.usda, /Key: light \"Key\": {why}; it emits nothing and is left out"));
    }

    /// Irradiance that arrives from above at the point two metres below, and the warning.
    fn mended(light: &LightDesc, what: &str) -> AnyEmitter {
        let (emitter, said) = prepared(light);
        assert_eq!(said, format!("a.usda, /Key: light \"Key\": {what}"));
        emitter.unwrap()
    }

    fn bounds(emitter: &AnyEmitter) -> Vec3 {
        emitter.bounds().unwrap().bounds.extent()
    }

    #[test]
    fn sizes_are_mended_or_the_light_is_left_out() {
        let negative = mended(&sphere(-2.0, [1.0; 3]), "its radius is negative: taken as 2");
        assert_eq!(bounds(&negative), Vec3::splat(4.0));
        let negative = mended(&tube(1.0, -6.0), "its length is negative: taken as 6");
        assert_eq!(bounds(&negative), Vec3::new(6.0, 2.0, 2.0));
        left_out(&sphere(0.0, [1.0; 3]), "its radius is 0");
        left_out(&sphere(NAN, [1.0; 3]), "its radius is NaN");
        left_out(
            &sphere(1e-60, [1.0; 3]),
            "its radius is 0.000000000000000000000000000000000000000000000000000000000001",
        );
        left_out(&tube(0.0, 1.0), "its radius is 0");
        left_out(&tube(1.0, f64::INFINITY), "its length is inf");
    }

    #[test]
    fn intensities_are_mended_channel_by_channel() {
        let luminance = |rgb: [f32; 3]| std::f32::consts::PI * crate::math::Rgb::from(rgb).luminance();
        let intensity = |emitter: AnyEmitter| emitter.bounds().unwrap().intensity;
        let taken = mended(&sphere(1.0, [-1.0, 2.0, 3.0]), "its intensity is negative: taken as 0");
        assert_eq!(intensity(taken), luminance([0.0, 2.0, 3.0]));
        let taken = mended(&sphere(1.0, [NAN, 2.0, 3.0]), "its intensity is not finite: taken as 0");
        assert_eq!(intensity(taken), luminance([0.0, 2.0, 3.0]));
        left_out(&sphere(1.0, [NAN; 3]), "its intensity is not finite: taken as 0");
        let taken = mended(&sphere(1.0, [1e300, 0.0, 0.0]), "its intensity is too bright: taken as 1e30");
        assert_eq!(intensity(taken), luminance([1e30, 0.0, 0.0]));
        let (emitter, said) = prepared(&sphere(1.0, [0.0; 3]));
        assert!(emitter.is_none() && said.is_empty());
    }

    #[test]
    fn angles_of_suns_are_mended() {
        let sun = |angle: f64| light(LightKind::Distant { irradiance: [1.0; 3], angle });
        for (angle, what, taken) in [
            (-1.0, "its angle is -1: taken as 0", 0.0),
            (NAN, "its angle is NaN: taken as 0", 0.0),
            (7.0, "its angle is 7: taken as 3.141592653589793", PI),
        ] {
            assert_eq!(format!("{:?}", mended(&sun(angle), what)), format!("{:?}", prepared(&sun(taken)).0.unwrap()));
        }
    }

    #[test]
    fn transforms_are_mended() {
        let placed = |matrix3: DMat3, light: LightDesc| LightDesc {
            transform: DAffine3 { matrix3, translation: DVec3::ZERO },
            ..light
        };
        let flat = DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0));
        let what = "its transform is singular or not finite: taken as not turned";
        assert_eq!(bounds(&mended(&placed(flat, tube(1.0, 6.0)), what)), Vec3::new(6.0, 2.0, 2.0));
        assert_eq!(bounds(&mended(&placed(DMat3::NAN, tube(1.0, 6.0)), what)), Vec3::new(6.0, 2.0, 2.0));
        // What is round has no orientation to lose.
        assert_eq!(prepared(&placed(flat, sphere(1.0, [1.0; 3]))).1, "");
        // Scale is none of a light's business, however small or large.
        for scale in [1e-200, 1e-8, 1e8, 1e100] {
            let turned = DMat3::from_rotation_z(std::f64::consts::FRAC_PI_2) * scale;
            let (emitter, said) = prepared(&placed(turned, tube(1.0, 6.0)));
            assert!(said.is_empty() && (bounds(&emitter.unwrap()) - Vec3::new(2.0, 6.0, 2.0)).length() < 1e-5);
        }
        let lost = LightDesc { transform: DAffine3::from_translation(DVec3::new(NAN, 0.0, 0.0)), ..point() };
        left_out(&lost, "its position is not finite");
    }

    #[test]
    fn shaping_and_decay_are_mended() {
        let shaped = |shaping: ShapingDesc| LightDesc { shaping, ..point() };
        let cone = |cone: ConeDesc| shaped(ShapingDesc { cone: Some(cone), ..ShapingDesc::default() });
        let decaying = |decay: DecayDesc| LightDesc { decay, ..point() };
        let arrives = |emitter: &AnyEmitter, p: Vec3| {
            emitter.sample_li(&Receiver::everywhere(p), 0.0, [0.0; 2]).map_or(0.0, |sample| sample.li.g)
        };
        let wide = mended(
            &cone(ConeDesc::Soft { angle: 7.0, softness: 0.0 }),
            "its cone angle is 7: taken as 3.141592653589793",
        );
        assert_eq!(arrives(&wide, Vec3::Z), 1.0);
        mended(&cone(ConeDesc::Blend { angle: 1.0, blend: 2.0 }), "its cone blend is 2: taken as 1");
        mended(&cone(ConeDesc::Ramp { inner: 2.0, outer: 1.0 }), "its inner cone angle is 2: taken as 1");
        mended(&cone(ConeDesc::Soft { angle: NAN, softness: 0.0 }), "its cone angle is NaN: taken as 180 degrees");
        left_out(
            &cone(ConeDesc::Blend { angle: -1.0, blend: 0.0 }),
            "its cone angle is -1: taken as 0; its shaping leaves no light",
        );
        mended(&shaped(ShapingDesc { focus: NAN, ..ShapingDesc::default() }), "its focus is NaN: taken as 0");

        let measured = |profile, angle_scale| {
            let ies = Some(IesRef { profile, angle_scale, keep_power: false });
            shaped(ShapingDesc { ies, ..ShapingDesc::default() })
        };
        let (emitter, said) = prepared(&measured(0, 0.0));
        assert!(said.is_empty());
        assert_eq!((arrives(emitter.as_ref().unwrap(), -Vec3::Z), arrives(&emitter.unwrap(), Vec3::Z)), (1.0, 0.0));
        mended(&measured(0, NAN), "its IES angle scale is NaN: taken as 0");
        let without = mended(&measured(1, 0.0), "IES profile \"down.ies\" gives no light: shines without it");
        assert_eq!(arrives(&without, Vec3::Z), 1.0);

        let polynomial =
            |kc, kl, kq| decaying(DecayDesc { law: DecayLaw::Polynomial { kc, kl, kq }, ..DecayDesc::default() });
        for bad in [polynomial(NAN, 0.0, 1.0), polynomial(0.0, 0.0, 0.0), polynomial(-1.0, 0.0, 0.0)] {
            let taken = mended(&bad, "its decay is no polynomial that falls off: taken as quadratic");
            assert_eq!(arrives(&taken, Vec3::Z * 2.0), 0.25);
        }
        let taken = mended(&polynomial(2.0, -1.0, 0.0), "its decay term is -1: taken as 0");
        assert_eq!(arrives(&taken, Vec3::Z * 8.0), 0.5);
        let smooth = DecayDesc { smooth: -1.0, range: NAN, ..DecayDesc::default() };
        let taken =
            mended(&decaying(smooth), "its decay smoothing is -1: taken as 0; its range is NaN: taken as endless");
        assert_eq!(arrives(&taken, Vec3::Z * 2.0), 0.25);
    }

    /// The scale of the transform reaches the cone of Cycles' spot, and no other.
    #[test]
    fn scale_distorts_the_cone_of_a_blend_alone() {
        let scaled = |cone: ConeDesc| {
            let transform = DAffine3::from_scale(DVec3::new(4.0, 1.0, 1.0));
            let shaping = ShapingDesc { cone: Some(cone), ..ShapingDesc::default() };
            prepared(&LightDesc { transform, shaping, ..point() }).0.unwrap()
        };
        let at = |emitter: &AnyEmitter, p: Vec3| emitter.sample_li(&Receiver::everywhere(p), 0.0, [0.0; 2]).is_some();
        let (along, across) = (Vec3::new(1.5, 0.0, -1.0), Vec3::new(0.0, 1.5, -1.0));
        let blend = scaled(ConeDesc::Blend { angle: 0.5, blend: 0.0 });
        assert!(at(&blend, along) && !at(&blend, across));
        for cone in [ConeDesc::Soft { angle: 0.5, softness: 0.0 }, ConeDesc::Ramp { inner: 0.4, outer: 0.5 }] {
            let emitter = scaled(cone);
            assert!(!at(&emitter, along) && !at(&emitter, across));
        }
    }
}
