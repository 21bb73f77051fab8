//! Profiles: bounds that hold, means by quadrature, products of all that shapes light.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{
    AnyEmitter, Cone, Decay, Drawn, Emitter, Falloff, Ies, MeshEmitters, MeshLight, Point, Profile, Receiver,
    RoundEmitters, RoundLight, Shaping, Sphere,
};
use penumbra::math::{Affine3A, DMat3, DVec3, Rgb, Vec3};
use penumbra::shape::{Mesh, Rounds};

use crate::mesh::Constant;
use crate::quadrature::midpoints;

fn turned() -> DMat3 {
    DMat3::from_rotation_y(0.4) * DMat3::from_rotation_x(-1.3) * DMat3::from_rotation_z(2.0)
}

/// A profile that varies in both angles.
fn quadrants(scale: f64, keep_power: bool) -> Option<Ies> {
    let candela = [100.0, 80.0, 30.0, 0.0, 90.0, 70.0, 10.0, 0.0, 80.0, 60.0, 50.0, 0.0];
    Ies::new(&[0.0, 30.0, 60.0, 100.0], &[0.0, 45.0, 90.0], &candela, scale, keep_power)
}

/// A factor that is not the same around any axis.
fn drawn() -> Option<Drawn> {
    Some(Drawn::new(|w, _| Rgb::new(0.5 + 0.5 * w.x, 0.2, (1.0 + w.y * w.z) * 0.3)))
}

fn profiles() -> Vec<(&'static str, Profile)> {
    let cone = |cone| Shaping { cone: Some(cone), ..Shaping::default() };
    let stretch = Some(turned() * DMat3::from_diagonal(DVec3::new(3.0, 1.0, 0.7)));
    let sheared = Some(turned() * DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.5, 0.2, 1.0)));
    let upward = Ies::new(&[90.0, 130.0, 180.0], &[0.0], &[0.0, 0.0, 1.0], 0.0, false);
    let shapings = [
        ("even", Shaping::default()),
        ("ramp", cone(Cone::ramp(0.3, 0.7))),
        ("hard", cone(Cone::blend(0.2, 0.0))),
        ("tiny", cone(Cone::blend(1e-4, 0.5))),
        ("wide", cone(Cone::soft(2.5, 0.3))),
        ("whole", cone(Cone::soft(PI, 0.0))),
        ("stretched", Shaping { stretch, ..cone(Cone::blend(0.5, 0.5)) }),
        ("stretched wide", Shaping { stretch, ..cone(Cone::blend(1.5, 0.5)) }),
        ("sheared", Shaping { stretch: sheared, ..cone(Cone::blend(0.5, 0.5)) }),
        ("focus", Shaping { focus: 3.0, ..Shaping::default() }),
        ("sharp focus", Shaping { focus: 2000.0, ..Shaping::default() }),
        ("tinted", Shaping { focus: 4.0, focus_tint: [0.5, 0.0, 2.0], ..Shaping::default() }),
        ("measured", Shaping { ies: quadrants(0.0, false), ..Shaping::default() }),
        ("measured, power", Shaping { ies: quadrants(0.5, true), ..Shaping::default() }),
        ("measured, from above", Shaping { ies: quadrants(-1.5, true), ..Shaping::default() }),
        ("upward", Shaping { ies: upward, ..Shaping::default() }),
        ("drawn", Shaping { drawn: drawn(), ..Shaping::default() }),
        ("drawn, in a cone", Shaping { drawn: drawn(), ..cone(Cone::blend(0.4, 0.2)) }),
        ("all", Shaping { focus: 1.5, ies: quadrants(0.0, false), ..cone(Cone::soft(0.8, 0.5)) }),
    ];
    shapings.map(|(name, shaping)| (name, Profile::new(turned(), shaping, Decay::PHYSICAL))).into()
}

/// Fibonacci's points of the sphere.
fn directions(n: u32) -> impl Iterator<Item = Vec3> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    (0..n).map(move |i| {
        let z = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(n);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z).as_vec3()
    })
}

#[test]
fn the_cone_and_the_peak_hold_all_the_light() {
    for (name, profile) in profiles() {
        let (axis, half) = profile.cone();
        let peak = profile.peak();
        assert!((axis.length() - 1.0).abs() < 1e-6 && peak.is_finite() && !peak.is_black(), "{name}");
        for w in directions(40_000).chain(directions(1000).map(|w| (axis + w * 2e-4).normalize())) {
            let factor = profile.factor(w, 1.0);
            let most = factor.zip(peak, |f, p| f - p).max_component();
            assert!(factor.is_finite() && most <= 1e-6 * peak.max_component(), "{name} {factor:?} {peak:?}");
            let angle = axis.as_dvec3().cross(w.as_dvec3()).length().atan2(axis.dot(w).into());
            assert!(factor.is_black() || angle <= half + 1e-6, "{name}: {angle} {half}");
        }
    }
}

#[test]
fn a_light_is_never_without_importance_where_it_shines() {
    let receivers: Vec<Vec3> = directions(2000).collect();
    for (name, profile) in profiles() {
        let profile = Some(Arc::new(profile));
        let (axis, half) = profile.as_ref().unwrap().cone();
        let center = Vec3::new(1.0, 2.0, 3.0);
        let point = Point { p: center, intensity: Rgb::WHITE, profile: profile.clone() };
        let sphere = Sphere { center, radius: 0.3, radiance: Rgb::WHITE, facing: false, profile };
        // All around, and at the rim of the cone from both sides.
        let frame = penumbra::math::Frame::from_z(axis);
        let rim = receivers.iter().take(500).enumerate().map(|(i, w)| {
            let theta = half as f32 * (1.0 + (w.z * 1e-3));
            let phi = i as f32;
            frame.to_world(Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()))
        });
        let mut dark = 0;
        for w in receivers.iter().copied().chain(rim) {
            for dist in [0.5, 30.0] {
                let at = Receiver::everywhere(center + w * dist);
                let arrives = point.sample_li(&at, 0.0, [0.0; 2]).is_some();
                assert!(!arrives || point.importance(&at) > 0.0, "{name}: point at {w}");
                dark += u32::from(point.importance(&at) == 0.0);
                let arrives = directions(64)
                    .any(|u| sphere.sample_li(&at, 0.0, [0.5 + 0.499 * u.x, 0.5 + 0.499 * u.y]).is_some());
                assert!(!arrives || sphere.importance(&at) > 0.0, "{name}: sphere at {w}");
            }
        }
        // And it does tell where there is none.
        assert!(half > 1.5 || dark > 1000, "{name}: {dark}");
    }
}

/// Sheets across and along the axis of the profiles, a cube's corner and a ball.
fn shapes() -> Vec<(&'static str, AnyEmitter)> {
    let emission = || Arc::new(Constant(Rgb::WHITE));
    let mesh = |corners: &[[f64; 3]], triangles: &[[u32; 3]]| {
        let points = corners.iter().map(|&p| (turned() * DVec3::from(p)).as_vec3()).collect();
        let mesh = Mesh { points, triangles: triangles.to_vec(), ..Mesh::default() };
        let emitters = MeshEmitters::new(Arc::new(mesh), emission()).unwrap();
        MeshLight::new(Arc::new(emitters), Affine3A::IDENTITY).unwrap().into()
    };
    let sheet = [[-0.3, -0.2, 0.0], [0.3, -0.2, 0.0], [0.3, 0.2, 0.0], [-0.3, 0.2, 0.0]];
    let upright = sheet.map(|[x, y, z]| [x, z, y]);
    let corner = [[0.0; 3], [0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 0.3]];
    let ball = Rounds {
        center: DVec3::ZERO,
        balls: vec![[0.0, 0.0, 0.0, 0.3]],
        segments: None,
        uvs: Vec::new(),
        colors: None,
        material_slots: None,
        motion: None,
    };
    let ball = RoundEmitters::new(Arc::new(ball), emission()).unwrap();
    vec![
        ("across", mesh(&sheet, &[[0, 1, 2], [0, 2, 3]])),
        ("turned around", mesh(&sheet, &[[0, 2, 1], [0, 3, 2]])),
        ("along", mesh(&upright, &[[0, 1, 2], [0, 2, 3]])),
        ("corner", mesh(&corner, &[[0, 1, 2], [0, 2, 3], [0, 3, 1]])),
        ("ball", RoundLight::new(Arc::new(ball), Affine3A::IDENTITY).unwrap().into()),
    ]
}

/// The same of emissive shapes, for the choice among few lights and for the tree over many.
#[test]
fn a_shape_is_never_without_importance_where_it_shines() {
    let receivers: Vec<Vec3> = directions(400).collect();
    let half_space = Shaping { cone: Some(Cone::soft(0.5 * PI, 0.0)), ..Shaping::default() };
    let half_space = ("half space", Profile::new(turned(), half_space, Decay::PHYSICAL));
    for (name, profile) in profiles().into_iter().chain([half_space]) {
        let (axis, half) = profile.cone();
        let peak = profile.peak();
        let profile = Some(Arc::new(profile));
        for (shape, light) in shapes() {
            let light: AnyEmitter = match light {
                AnyEmitter::MeshLight(light) => light.shaped(profile.clone()).into(),
                AnyEmitter::RoundLight(light) => light.shaped(profile.clone()).into(),
                other => other,
            };
            let bounds = light.bounds().unwrap();
            let mut dark = [0, 0];
            for (w, dist) in receivers.iter().flat_map(|&w| [(w, 0.5), (w, 30.0), ((axis + w * 0.1).normalize(), 3.0)])
            {
                let at = Receiver::everywhere(w * dist);
                let importance = [light.importance(&at), bounds.importance(&at)];
                let brings = directions(64)
                    .filter_map(|u| light.sample_li(&at, 0.0, [0.5 + 0.499 * u.x, 0.5 + 0.499 * u.y]))
                    .inspect(|sample| {
                        assert!(sample.li.zip(peak, |l, p| l - p).max_component() <= 1e-6 * peak.max_component())
                    })
                    .any(|sample| sample.li.max_component() > 0.0);
                assert!(!brings || importance.iter().all(|i| *i > 0.0), "{name}, {shape} at {w}: {importance:?}");
                dark[0] += u32::from(importance[0] == 0.0);
                dark[1] += u32::from(importance[1] == 0.0);
            }
            assert!(half > 0.9 || dark.iter().all(|dark| *dark > 100), "{name}, {shape}: {dark:?}");
            // The tree, too, knows that the back of a sheet is dark.
            if name == "half space" && (shape == "across" || shape == "turned around") {
                assert!(dark[1] > 100, "{shape}: {dark:?}");
            }
        }
    }
}

#[test]
fn means_are_those_of_quadrature() {
    let axes = turned();
    for (name, profile) in profiles() {
        let (axis, half) = profile.cone();
        let (s, t) = axis.as_dvec3().any_orthonormal_pair();
        let mean = |channel: usize, weight: &dyn Fn(Vec3) -> f64| {
            midpoints(0.0, half, 700, |theta| {
                0.5 / PI
                    * 0.5
                    * theta.sin()
                    * midpoints(0.0, 2.0 * PI, 700, |phi| {
                        let (sin, cos) = theta.sin_cos();
                        let w = (s * phi.cos() + t * phi.sin()) * sin + axis.as_dvec3() * cos;
                        f64::from(profile.factor(w.as_vec3(), 1.0)[channel]) * weight(w.as_vec3())
                    })
            })
        };
        for channel in [0, 2] {
            let (found, expected) = (f64::from(profile.mean()[channel]), mean(channel, &|_| 1.0));
            assert!((found / expected - 1.0).abs() < 3e-3, "{name}: {found} {expected}");
            let weight = |w: Vec3| f64::from(w.dot(axes.x_axis.as_vec3()).abs()) + 0.1;
            let (found, expected) = (f64::from(profile.mean_weighted(&weight)[channel]), mean(channel, &weight));
            assert!((found / expected - 1.0).abs() < 3e-3, "{name}, weighted: {found} {expected}");
        }
    }
}

#[test]
fn focus_and_tint_are_those_of_usd() {
    let shaping = Shaping { focus: 3.0, focus_tint: [0.25, 0.0, 1.0], ..Shaping::default() };
    let profile = Profile::new(DMat3::IDENTITY, shaping, Decay::PHYSICAL);
    for i in 0..=36 {
        let theta = PI * f64::from(i) / 36.0;
        // Behind as well as in front.
        let focus = theta.cos().abs().powi(3);
        let factor = profile.factor(Vec3::new(theta.sin() as f32, 0.0, -theta.cos() as f32), 1.0);
        for (found, expected) in factor.to_array().into_iter().zip([0.25 + 0.75 * focus, focus, 1.0]) {
            assert!((f64::from(found) - expected).abs() < 1e-6, "{theta}");
        }
    }
}

/// A measured distribution of 100, 60 and 0 candela at 0, 45 and 90 degrees; and, by quadrants, the
/// azimuth: 0 is +x, 90 degrees +y.
#[test]
fn measured_distributions_are_looked_up_around_the_axis() {
    let ies = Ies::new(&[0.0, 45.0, 90.0], &[0.0, 90.0], &[100.0, 60.0, 0.0, 100.0, 20.0, 0.0], 0.0, false);
    let axes = turned();
    let profile = Profile::new(axes, Shaping { ies, ..Shaping::default() }, Decay::PHYSICAL);
    let half = 0.5_f64.sqrt();
    for (local, expected) in [
        (DVec3::new(0.0, 0.0, -1.0), 1.0),
        (DVec3::new(half, 0.0, -half), 0.6),
        (DVec3::new(-half, 0.0, -half), 0.6),
        (DVec3::new(0.0, half, -half), 0.2),
        (DVec3::new(0.5, -0.5, -half), 0.4),
        (DVec3::new(1.0, 0.0, 0.0), 0.0),
        (DVec3::new(0.0, 0.0, 1.0), 0.0),
    ] {
        let found = f64::from(profile.factor((axes * local).as_vec3(), 1.0).r);
        assert!((found - expected).abs() < 1e-6, "{local}: {found}");
    }
}

#[test]
fn decay_multiplies_shape_and_bounds_hold() {
    let decay = Decay { falloff: Falloff::Linear, smooth: 0.2, range: 8.0 };
    let shaping = Shaping { focus: 1.0, ..Shaping::default() };
    let profile = Profile::new(DMat3::IDENTITY, shaping, decay);
    for d in [0.01_f32, 0.5, 2.0, 7.9, 8.0, 20.0] {
        let x = f64::from(d);
        let expected = 0.6 * x * (x * x / (0.2 + x * x)) * (1.0 - (x / 8.0).powi(4)).max(0.0);
        let found = f64::from(profile.factor(Vec3::new(0.8, 0.0, -0.6), d).g);
        assert!((found - expected).abs() <= 1e-6 * expected.max(1e-6), "{d}: {found} {expected}");
    }
    let light = Point { p: Vec3::ZERO, intensity: Rgb::WHITE, profile: Some(Arc::new(profile)) };
    assert_eq!(light.importance(&Receiver::everywhere(Vec3::Z * -9.0)), 0.0);
    assert!(light.importance(&Receiver::everywhere(Vec3::Z * -7.0)) > 0.0);
}
