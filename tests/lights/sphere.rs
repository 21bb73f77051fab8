//! Spheres and Cycles' soft falloff against `E = πL (r/d)² cos θ` and its like.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{Cone, Decay, Emitter, Falloff, Profile, Receiver, Shaping, Sphere};
use penumbra::math::{Bounds, DMat3, DVec3, Rgb, Vec3};

use crate::laws::{Case, hold, irradiance_holds};
use crate::quadrature::{cap, cone};

const L: f64 = 3.0;

fn sphere(center: Vec3, radius: f32, facing: bool) -> Sphere {
    Sphere { center, radius, radiance: Rgb::splat(L as f32), facing, profile: None }
}

/// The cone that a sphere fills.
fn half_angle(light: &Sphere, p: Vec3) -> f64 {
    let d = (light.center.as_dvec3() - p.as_dvec3()).length();
    let r = f64::from(light.radius);
    if light.facing { r.atan2(d) } else { r.atan2(((d - r) * (d + r)).sqrt()) }
}

/// A case from outside; `n` any normal. The closed form where the light is wholly above the horizon,
/// else quadrature.
fn outside(name: &str, light: Sphere, p: Vec3, n: Vec3) -> Case {
    let n = n.normalize();
    let axis = (light.center.as_dvec3() - p.as_dvec3()).normalize();
    let half = half_angle(&light, p);
    let tilt = axis.cross(n.as_dvec3()).length().atan2(axis.dot(n.as_dvec3()));
    let irradiance = if half + tilt <= 0.5 * PI { PI * half.sin().powi(2) * tilt.cos() } else { cap(half, tilt) };
    Case::new(format!("{name}, facing {}", light.facing), light, p, n, L * irradiance)
        .within(axis.as_vec3(), (half * 1.01 + 1e-7).min(PI))
}

#[test]
fn spheres_hold() {
    let center = Vec3::new(0.3, 2.0, -0.4);
    let mut cases = Vec::new();
    for facing in [false, true] {
        for (name, radius, n) in [
            ("above", 0.5, Vec3::Y),
            ("tilted", 0.5, Vec3::new(-0.7, 0.6, 0.2)),
            ("small", 0.01, Vec3::new(0.2, 1.0, 0.3)),
            ("at the horizon", 0.9, Vec3::new(1.0, 0.1, 0.2)),
            ("below the horizon but for a part", 1.5, Vec3::new(0.7, -0.4, 0.6)),
            ("near", 2.0, Vec3::new(0.2, 1.0, 0.0)),
        ] {
            cases.push(outside(name, sphere(center, radius, facing), Vec3::ZERO, n));
        }
        let almost = sphere(Vec3::Y, 1.0 - 1e-4, facing);
        cases.push(outside("almost touching", almost.clone(), Vec3::ZERO, Vec3::Y));
        cases.push(outside("almost touching, at the horizon", almost, Vec3::ZERO, Vec3::X));
    }
    // From within the radius, the disk is nearly a half-space.
    cases.push(outside("inside", sphere(Vec3::Y, 20.0, true), Vec3::ZERO, Vec3::new(0.3, 1.0, 0.0)));
    hold(&cases);
}

#[test]
fn inside_there_is_light_all_around() {
    let light = sphere(Vec3::new(1.0, -2.0, 3.0), 2.0, false);
    let cases: Vec<Case> = [
        ("at the centre", Vec3::ZERO, Vec3::Y),
        ("off the centre", Vec3::new(0.5, -0.7, 0.3), Vec3::new(0.6, 0.0, 0.8)),
        ("near the surface", Vec3::new(1.999, 0.0, 0.0), Vec3::new(0.0, 0.6, -0.8)),
        ("near the surface, facing it", Vec3::new(0.0, -1.999, 0.0), Vec3::NEG_Y),
    ]
    .into_iter()
    .map(|(name, p, n)| Case::new(name, light.clone(), light.center + p, n, PI * L))
    .collect();
    hold(&cases);
}

#[test]
fn no_ratio_of_radius_and_distance_is_too_small_or_too_near_one() {
    let mut cases = Vec::new();
    for facing in [false, true] {
        for ratio in [1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.1, 0.5, 0.9, 0.99, 0.999, 0.99999, 1.0 - 1e-6] {
            for scale in [1e-4, 1e-2, 1.0, 1e2, 1e5] {
                // From the origin the distance is exact.
                let light = sphere(Vec3::new(0.0, scale, 0.0), scale * ratio, facing);
                let name = format!("r/d {ratio}, scale {scale}");
                cases.push(outside(&name, light.clone(), Vec3::ZERO, Vec3::Y));
                cases.push(outside(&name, light.clone(), Vec3::ZERO, Vec3::new(0.8, 0.6, 0.0)));
                // Elsewhere it is the one of the coordinates as they were rounded.
                let p = Vec3::new(1.7, -0.3, 0.9) * scale;
                let light = Sphere { center: p + Vec3::new(0.36, 0.48, 0.8) * scale, ..light };
                cases.push(outside(&name, light, p, Vec3::new(0.3, 0.5, 0.9)));
            }
        }
    }
    // A radius of the rounded distance may be within it.
    cases.retain(|case| case.irradiance.is_finite());
    assert!(cases.len() > 380);
    irradiance_holds(&cases);
}

#[test]
fn a_point_on_the_surface_sees_the_inside_alone() {
    let light = sphere(Vec3::ZERO, 1.0, false);
    assert!(light.hit(Vec3::X, Vec3::X).is_none() && light.hit(Vec3::X, Vec3::NEG_X).is_some());
    assert!(light.hit(Vec3::X, Vec3::Y).is_none());
    let at = Receiver { n: Some(Vec3::X), ..Receiver::everywhere(Vec3::X) };
    assert!(light.sample_li(&at, 0.0, [0.3, 0.7]).is_none());
    assert_eq!(light.hit(Vec3::new(0.5, 0.0, 0.0), Vec3::X).unwrap().dist, 0.5);
    assert_eq!(light.hit(Vec3::new(3.0, 0.0, 0.0), Vec3::NEG_X).unwrap().dist, 2.0);
    assert!(light.hit(Vec3::new(3.0, 0.0, 0.0), Vec3::X).is_none());
    // At the very centre of a disk nothing faces.
    let disk = sphere(Vec3::ZERO, 1.0, true);
    assert!(disk.hit(Vec3::ZERO, Vec3::X).is_none());
    assert!(disk.sample_li(&Receiver::everywhere(Vec3::ZERO), 0.0, [0.3, 0.7]).is_none());
}

#[test]
fn normals_and_distances_are_those_of_the_surface() {
    let light = sphere(Vec3::new(0.3, 2.0, -0.4), 0.5, false);
    let at = Receiver::everywhere(Vec3::new(5.0, -1e4, 3.0));
    for i in 0..100 {
        let s = light.sample_li(&at, 0.0, [i as f32 / 100.0, (i as f32 * 0.618).fract()]).unwrap();
        let Some(hit) = light.hit(at.p, s.wi) else { continue };
        // Rounded in f32 is the direction alone: 1e4 m away that is a millimetre.
        let on = at.p.as_dvec3() + s.wi.as_dvec3().normalize() * f64::from(hit.dist) - light.center.as_dvec3();
        assert!((on.length() - 0.5).abs() < 2e-3 && (hit.ng.length() - 1.0).abs() < 1e-6 && hit.ng.dot(s.wi) <= 0.0);
    }
}

/// Cycles with 100 W: `L = P/(4π² r²)`.
#[test]
fn cycles_soft_falloff_is_matched() {
    let (p, r) = (100.0_f64, 0.5_f64);
    let radiance = Rgb::splat((p / (4.0 * PI * PI * r * r)) as f32);
    let mut cases = Vec::new();
    for (d, cos) in [(1.0, 1.0), (2.0, 0.8), (0.6, 1.0), (30.0, 0.6)] {
        let n = Vec3::new((1.0_f64 - cos * cos).sqrt() as f32, cos as f32, 0.0);
        let soft = Sphere { center: Vec3::Y * d, radius: r as f32, radiance, facing: true, profile: None };
        let hard = Sphere { facing: false, ..soft.clone() };
        let d = f64::from(d);
        cases.push(Case::new(format!("soft {d}"), soft, Vec3::ZERO, n, p * cos / (4.0 * PI * (d * d + r * r))));
        if (r / d).asin() < 0.5 * PI - cos.acos() {
            cases.push(Case::new(format!("hard {d}"), hard, Vec3::ZERO, n, p * cos / (4.0 * PI * d * d)));
        }
    }
    irradiance_holds(&cases);
}

/// A light that shines down −z of `axes` into a cone.
fn spot(axes: DMat3, decay: Decay) -> (Arc<Profile>, impl Fn(DVec3, f64) -> f64) {
    let half = 0.6_f64;
    let shaping = Shaping { cone: Some(Cone::blend(half, 0.7)), ..Shaping::default() };
    let factor = move |w: DVec3, d: f64| {
        let cos = -axes.z_axis.dot(w);
        let t = ((cos - half.cos()) / ((1.0 - half.cos()) * 0.7)).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t) * decay.factor(d)
    };
    (Arc::new(Profile::new(axes, shaping, decay)), factor)
}

#[test]
fn profiles_act_where_light_leaves() {
    let axes = DMat3::from_rotation_x(-1.2) * DMat3::from_rotation_z(0.4);
    let mut cases = Vec::new();
    for facing in [false, true] {
        for falloff in [Falloff::Quadratic, Falloff::Linear] {
            let (profile, factor) = spot(axes, Decay { falloff, smooth: 0.3, range: 5.0 });
            let light = Sphere { profile: Some(profile), ..sphere(Vec3::new(0.2, 2.0, 0.8), 0.7, facing) };
            let p = Vec3::new(0.1, 0.2, -0.3);
            let (center, r) = (light.center.as_dvec3() - p.as_dvec3(), f64::from(light.radius));
            let (axis, d) = (center.normalize(), center.length());
            let dist = |wi: DVec3| {
                let cos = axis.dot(wi);
                let root = (r * r - d * d * (1.0 - cos * cos)).max(0.0).sqrt();
                if facing { d / cos } else { d * cos - root }
            };
            let half = half_angle(&light, p);
            let n = Vec3::new(0.1, 0.9, 0.4).normalize();
            let irradiance = L * cone(axis, half, n.as_dvec3(), |wi| factor(-wi, dist(wi)));
            let name = format!("spot, facing {facing}, {falloff:?}");
            cases.push(Case::new(name, light, p, n, irradiance).within(axis.as_vec3(), half * 1.01));
        }
    }
    hold(&cases);
}

#[test]
fn power_is_the_integral_of_what_leaves() {
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let light = sphere(Vec3::ZERO, 0.5, false);
    assert!((f64::from(light.power(scene)) / (4.0 * PI * 0.25 * PI * L) - 1.0).abs() < 1e-6);
    let (profile, factor) = spot(DMat3::IDENTITY, Decay::PHYSICAL);
    let share = cone(DVec3::NEG_Z, PI, DVec3::ZERO, |_| 0.0)
        + crate::quadrature::midpoints(0.0, PI, 100_000, |theta| {
            0.5 * theta.sin() * factor(DVec3::new(theta.sin(), 0.0, -theta.cos()), 1.0)
        });
    let spot = Sphere { profile: Some(profile), ..light.clone() };
    assert!((f64::from(spot.power(scene) / light.power(scene)) / share - 1.0).abs() < 1e-6);
}
