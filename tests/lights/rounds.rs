//! Emissive balls and strands. From inside a convex one every ray meets it once, and the irradiance is πL;
//! from outside they are rendered (`tests/hair.rs`), for half of them hides behind itself.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{AnyEmitter, Emitter, EmitterHit, Receiver, RoundEmitters, RoundLight};
use penumbra::math::{Affine3A, Ball, DVec3, Mat3, Rgb, RoundCone, Vec3, center_of};
use penumbra::shape::Rounds;

use crate::laws::{Case, hold};
use crate::mesh::Constant;

const L: f64 = 4.0;

/// The round cone that the hit function of [`Case`], which is no closure, finds its way in.
const CONES: [[Ball; 2]; 4] = [
    [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]],
    [[-1.0, 0.0, 0.0, 0.5], [1.0, 0.5, 0.0, 0.5]],
    [[-1.0, 0.0, 0.0, 0.9], [1.0, 0.5, 0.0, 0.2]],
    [[0.0, 0.0, 0.0, 0.3], [0.2, 0.0, 0.0, 1.0]],
];

fn light([first, last]: [Ball; 2], transform: Affine3A) -> RoundLight {
    let rounds = Rounds { balls: vec![first, last], segments: Some(vec![[0, 0, 1, 1]]), ..Rounds::default() };
    let emitters = RoundEmitters::new(Arc::new(rounds), Arc::new(Constant(Rgb::splat(L as f32)))).unwrap();
    RoundLight::new(Arc::new(emitters), transform).unwrap()
}

/// Steps to the wall of cone `I` from inside, by its distance.
fn hit<const I: usize>(case: &Case, wi: Vec3) -> Option<EmitterHit> {
    let [first, last] = CONES[I];
    let cone = RoundCone::new(first, last);
    let from = case.p.as_dvec3() - center_of(first);
    let (wi, mut t) = (wi.as_dvec3(), 0.0);
    for _ in 0..200 {
        t -= cone.foot(from + wi * t).distance;
    }
    let foot = cone.foot(from + wi * t);
    assert!(foot.distance.abs() < 1e-6, "{foot:?}");
    Some(EmitterHit { dist: t as f32, ng: foot.normal.as_vec3(), triangle: 0, uv: cone.coordinates(from + wi * t) })
}

fn radiance(case: &Case, _wi: Vec3, hit: &EmitterHit) -> Rgb {
    match &case.light {
        AnyEmitter::RoundLight(light) => light.emission().radiance(hit.triangle, hit.uv),
        _ => panic!("strands"),
    }
}

fn case<const I: usize>(name: &str, p: [f32; 3], n: [f32; 3]) -> Case {
    let light = light(CONES[I], Affine3A::IDENTITY);
    let case = Case::new(name, light, p.into(), Vec3::from(n).normalize(), PI * L);
    Case { hit: Some(hit::<I>), radiance: Some(radiance), ..case }
}

#[test]
fn rounds_hold_from_inside() {
    hold(&[
        case::<0>("ball, middle", [0.0; 3], [0.0, 1.0, 0.0]),
        case::<0>("ball, aside", [0.4, 0.2, -0.3], [1.0, 1.0, 0.5]),
        case::<1>("strand", [0.3, 0.2, 0.1], [0.0, 1.0, 0.2]),
        case::<2>("tapered strand", [-0.2, 0.1, 0.0], [1.0, 0.0, 0.2]),
        case::<3>("ball within a ball", [0.3, -0.2, 0.1], [1.0, 0.0, 0.2]),
    ]);
}

#[test]
fn areas_grow_as_the_transform_says() {
    // A ball that becomes an ellipsoid: what samples see of it from inside is all around.
    let turned = Mat3::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
    for scale in [Vec3::splat(20.0), Vec3::new(1.0, 2.0, -0.7), Vec3::splat(1e-3)] {
        let transform = Affine3A::from_mat3_translation(turned * Mat3::from_diagonal(scale), Vec3::new(3.0, 1.0, 0.0));
        let light = light(CONES[1], transform);
        let at = Receiver::everywhere(transform.transform_point3(Vec3::new(0.2, 0.1, 0.1)));
        let (n, mut solid_angle, mut mean) = (300, 0.0, DVec3::ZERO);
        for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
            let u = [(i as f32 + 0.5) / n as f32, (k as f32 + 0.5) / n as f32];
            let sample = light.sample_li(&at, 0.5, u).unwrap();
            solid_angle += 1.0 / f64::from(sample.pdf) / f64::from(n * n);
            mean += sample.wi.as_dvec3() / f64::from(sample.pdf) / f64::from(n * n);
        }
        assert!((solid_angle / (4.0 * PI) - 1.0).abs() < 2e-3, "{scale}: {solid_angle}");
        assert!(mean.length() < 2e-2, "{scale}: {mean}");
    }
}
