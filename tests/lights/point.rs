//! Points and spots against `E = I cos θ / d²`.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{Cone, Decay, Emitter, Falloff, Point, Profile, Receiver, Shaping};
use penumbra::math::{Bounds, DMat3, DVec3, Rgb, Vec3};

use crate::laws::{Case, hold};
use crate::quadrature::midpoints;

const I: f64 = 3.0;

fn point(p: Vec3, profile: Option<Profile>) -> Point {
    Point { p, intensity: Rgb::splat(I as f32), profile: profile.map(Arc::new) }
}

/// A point at `light` with the profile, and the factor that it should have at the origin.
fn case(name: &str, light: Vec3, n: Vec3, profile: Option<Profile>, factor: f64) -> Case {
    let n = n.normalize();
    let d = light.as_dvec3();
    let irradiance = I * factor * n.as_dvec3().dot(d.normalize()).max(0.0) / d.length_squared();
    Case::new(name, point(light, profile), Vec3::ZERO, n, irradiance)
}

fn cone(axes: DMat3, cone: Cone) -> Option<Profile> {
    Some(Profile::new(axes, Shaping { cone: Some(cone), ..Shaping::default() }, Decay::PHYSICAL))
}

/// Axes whose −z points down.
fn down() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)
}

fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[test]
fn points_hold() {
    let at = Vec3::new(1.0, 2.0, -0.5);
    let mut cases = vec![
        case("plain", at, Vec3::Y, None, 1.0),
        case("far", Vec3::new(0.0, 1e8, 0.0), Vec3::Y, None, 1.0),
        case("near", Vec3::new(0.0, 1e-8, 0.0), Vec3::Y, None, 1.0),
    ];
    let d = at.as_dvec3().length();
    for (name, decay, factor) in [
        ("constant", Decay { falloff: Falloff::Constant, ..Decay::PHYSICAL }, d * d),
        ("linear", Decay { falloff: Falloff::Linear, ..Decay::PHYSICAL }, d),
        (
            "polynomial",
            Decay { falloff: Falloff::Polynomial { kc: 1.0, kl: 0.5, kq: 0.2 }, ..Decay::PHYSICAL },
            d * d / (1.0 + 0.5 * d + 0.2 * d * d),
        ),
        ("smooth", Decay { smooth: 2.0, ..Decay::PHYSICAL }, d * d / (2.0 + d * d)),
        ("range", Decay { range: 3.0, ..Decay::PHYSICAL }, 1.0 - (d / 3.0).powi(4)),
    ] {
        cases.push(case(name, at, Vec3::Y, Some(Profile::new(down(), Shaping::default(), decay)), factor));
    }
    hold(&cases);
}

#[test]
fn spots_hold() {
    let off = |theta: f64| Vec3::new((2.0 * theta.sin()) as f32, (2.0 * theta.cos()) as f32, 0.0);
    let mut cases = Vec::new();
    for theta in [0.0_f64, 0.1, 0.3, 0.45, 0.55] {
        let (inner, outer) = (0.2_f64, 0.6_f64);
        let ramp = ((theta.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0).powi(2);
        let blend = smoothstep((theta.cos() - outer.cos()) / ((1.0 - outer.cos()) * 0.5));
        let soft = 1.0 - smoothstep((theta - outer * 0.6) / (outer * 0.4));
        for (name, edge, factor) in [
            ("ramp", Cone::ramp(inner, outer), ramp),
            ("blend", Cone::blend(outer, 0.5), blend),
            ("soft", Cone::soft(outer, 0.4), soft),
            ("hard", Cone::blend(outer, 0.0), 1.0),
        ] {
            cases.push(case(&format!("{name} at {theta}"), off(theta), Vec3::Y, cone(down(), edge), factor));
        }
    }
    // Narrow: on the axis everything is there whatever the edge (0.02 rad in Cycles' full angle).
    for blend in [0.0, 1.0] {
        cases.push(case("narrow", Vec3::Y * 2.0, Vec3::Y, cone(down(), Cone::blend(0.01, blend)), 1.0));
    }
    hold(&cases);
}

#[test]
fn outside_of_the_cone_there_is_nothing() {
    for edge in [Cone::ramp(0.1, 0.3), Cone::blend(0.3, 0.5), Cone::soft(0.3, 0.0), Cone::blend(0.3, 0.0)] {
        let light = point(Vec3::ZERO, cone(down(), edge));
        let at = |theta: f32| Receiver::everywhere(Vec3::new(2.0 * theta.sin(), -2.0 * theta.cos(), 0.0));
        assert!(light.sample_li(&at(0.299), 0.0, [0.0; 2]).is_some(), "{edge:?}");
        for theta in [0.301, 1.0, 1.6, 3.1] {
            assert!(light.sample_li(&at(theta), 0.0, [0.0; 2]).is_none(), "{edge:?} {theta}");
        }
        assert_eq!(light.importance(&at(0.4)), 0.0);
    }
}

/// Cycles: a spot of 100 W has the intensity P/(4π) of the point; the scale of the object distorts
/// its cone, since the direction is that in its local space.
#[test]
fn scaled_spots_are_those_of_cycles() {
    let (half, blend) = (0.5_f64, 0.3);
    let turned = DMat3::from_rotation_x(-1.1) * DMat3::from_rotation_y(0.6);
    for scale in [DVec3::new(2.0, 1.0, 1.0), DVec3::new(1.0, 1.0, 2.0), DVec3::new(-0.3, 7.0, 0.9), DVec3::splat(5.0)] {
        let stretch = turned * DMat3::from_diagonal(scale);
        let shaping = Shaping { cone: Some(Cone::blend(half, blend)), stretch: Some(stretch), ..Shaping::default() };
        let profile = Profile::new(turned, shaping, Decay::PHYSICAL);
        let (mut lit, mut mean, n) = (0, 0.0, 400_u32);
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        for i in 0..n * n {
            // Fibonacci's points of the sphere.
            let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n * n);
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            let w = DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z).as_vec3();
            let local = ((turned.transpose() * w.as_dvec3()) / scale).normalize();
            let expected = smoothstep((-local.z - half.cos()) / ((1.0 - half.cos()) * blend));
            let found = f64::from(profile.factor(w, 1.0).g);
            assert!((found - expected).abs() < 1e-5, "{scale} {w}: {found} {expected}");
            mean += expected / f64::from(n * n);
            let (axis, rim) = profile.cone();
            if found > 0.0 {
                lit += 1;
                assert!(axis.as_dvec3().angle_between(w.as_dvec3()) <= rim + 1e-6, "{scale} {w}");
            }
        }
        assert!(lit > 100, "{scale}");
        assert!((f64::from(profile.mean().g) / mean - 1.0).abs() < 5e-3, "{scale}: {} {mean}", profile.mean().g);
        // Twice as long along the axis is half as wide.
        if scale.z == 2.0 {
            let tan = 0.5 * half.tan();
            assert!((profile.cone().1 - tan.atan()).abs() < 1e-2);
        }
    }
}

#[test]
fn power_is_the_integral_of_what_leaves() {
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let lamp = point(Vec3::ZERO, None);
    assert!((f64::from(lamp.power(scene)) / (4.0 * PI * I) - 1.0).abs() < 1e-6);
    let spot = point(Vec3::ZERO, cone(down(), Cone::ramp(0.4, 0.9)));
    let integral = midpoints(0.0, PI, 100_000, |theta| {
        let ramp = ((theta.cos() - 0.9_f64.cos()) / (0.4_f64.cos() - 0.9_f64.cos())).clamp(0.0, 1.0).powi(2);
        I * ramp * 2.0 * PI * theta.sin()
    });
    assert!((f64::from(spot.power(scene)) / integral - 1.0).abs() < 1e-6);
}

#[test]
fn a_receiver_at_the_point_gets_nothing_that_is_no_number() {
    let light = point(Vec3::ONE, None);
    assert!(light.sample_li(&Receiver::everywhere(Vec3::ONE), 0.0, [0.0; 2]).is_none());
    assert!(light.importance(&Receiver::everywhere(Vec3::ONE)).is_finite());
}
