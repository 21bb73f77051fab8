//! Laws that every emitter obeys, each light one line in [`cases`].

use std::f64::consts::PI;

use penumbra::light::{Emission, EmissiveTriangle, Emitter, EmitterHit, Light, LightSet};
use penumbra::light::{MeshLight, Point, Spot};
use penumbra::math::{Bounds, DVec3, Rgb, Vec3};
use penumbra::sampling::{Decision, Dimension, Pattern, Sampler, warp};

/// A light, the point that it lights, and the irradiance there on a surface that faces +y.
struct Case {
    name: &'static str,
    light: Light,
    p: Vec3,
    irradiance: f64,
}

fn cases() -> Vec<Case> {
    let case = |name, light: Light, p, irradiance| Case { name, light, p, irradiance };
    let lamp = Point { p: Vec3::new(1.0, 2.0, -0.5), intensity: Rgb::splat(3.0), range: f32::INFINITY };
    let to_lamp = lamp.p.as_dvec3();
    let lamp_irradiance = 3.0 * to_lamp.normalize().y / to_lamp.length_squared();
    // Half way down the ramp between the cosines of 0 and 60 degrees.
    let spot = Spot { point: lamp, axis: Vec3::new(0.0, -1.0, 0.0), cos_inner: 1.0, cos_outer: 0.5 };
    let ramp = ((to_lamp.normalize().y - 0.5) / 0.5).powi(2);
    vec![
        case("point", lamp.into(), Vec3::ZERO, lamp_irradiance),
        case("point, far", lamp.into(), Vec3::new(0.0, -1e4, 0.0), 3.0 / 10_002.0_f64.powi(2)),
        case("spot", spot.into(), Vec3::ZERO, lamp_irradiance * ramp),
        case("rectangle of triangles", rectangle(0.5, None), Vec3::ZERO, rectangle_irradiance(0.5, Vec3::ZERO)),
        case(
            "rectangle near",
            rectangle(0.1, None),
            Vec3::new(0.2, 0.0, 0.1),
            rectangle_irradiance(0.1, Vec3::new(0.2, 0.0, 0.1)),
        ),
        case("rectangle, textured", rectangle(0.5, Some(())), Vec3::ZERO, rectangle_irradiance(0.5, Vec3::ZERO) * 1.5),
    ]
}

const CORNERS: [[f32; 2]; 4] = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];

/// A unit square above the origin, radiance 4, as two triangles.
fn rectangle(height: f32, textured: Option<()>) -> Light {
    let corner = |i: usize| Vec3::new(CORNERS[i][0], height, CORNERS[i][1]);
    let triangle = |index: u32, i: [usize; 3]| EmissiveTriangle {
        p: i.map(corner),
        mean: Rgb::splat(4.0),
        p_err: Vec3::ZERO,
        index,
    };
    let triangles = vec![triangle(0, [0, 1, 2]), triangle(1, [0, 2, 3])];
    let emission = textured.map(|()| std::sync::Arc::new(Stronger) as std::sync::Arc<dyn Emission>);
    MeshLight::new(triangles, 2, emission).unwrap().into()
}

/// Emits half as much again as the triangles' means say, which must not matter.
#[derive(Debug)]
struct Stronger;

impl Emission for Stronger {
    fn radiance(&self, _triangle: u32, _uv: [f32; 2]) -> Rgb {
        Rgb::splat(6.0)
    }
}

/// Lambert's formula for a polygon, `E = L/2 Σ θᵢ (γᵢ · n)`, in f64.
fn rectangle_irradiance(height: f64, p: Vec3) -> f64 {
    let corners = CORNERS.map(|c| (DVec3::new(c[0].into(), height, c[1].into()) - p.as_dvec3()).normalize());
    let sum: f64 = (0..4)
        .map(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            a.dot(b).acos() * a.cross(b).normalize().y
        })
        .sum();
    4.0 * 0.5 * sum.abs()
}

fn samples(case: &Case, n: u64) -> impl Iterator<Item = penumbra::light::LightSample> {
    let sampler = Sampler::new(Pattern::Sobol, 7);
    (0..n).filter_map(move |i| {
        let sampler = sampler.for_sample(0, 0, i);
        let uc = sampler.get_1d(Dimension::at_bounce(0, Decision::LightChoice));
        case.light.sample_li(case.p, uc, sampler.get_2d(Dimension::at_bounce(0, Decision::LightPoint)))
    })
}

#[test]
fn irradiance_equals_the_closed_form() {
    let n = 1 << 17;
    for case in cases() {
        let sum: f64 = samples(&case, n).map(|s| f64::from(s.li.r * s.wi.y.max(0.0) / s.pdf)).sum();
        let error = sum / n as f64 / case.irradiance - 1.0;
        assert!(error.abs() < 2e-3, "{}: off by {:.3}%", case.name, 100.0 * error);
    }
}

#[test]
fn the_density_of_a_sample_is_the_one_that_is_asked_for() {
    for case in cases() {
        for s in samples(&case, 2000) {
            if s.delta {
                assert_eq!((s.pdf, case.light.pdf_li(case.p, s.wi, None)), (1.0, 0.0), "{}", case.name);
                continue;
            }
            // Both triangles of the rectangle have the same density, so either will do.
            let dist = (if s.wi.y > 0.0 { rectangle_height(&case) / s.wi.y } else { 0.0 }) - case.p.y;
            let at = EmitterHit { dist, ng: Vec3::Y, triangle: 0 };
            let pdf = case.light.pdf_li(case.p, s.wi, Some(&at));
            assert!((pdf / s.pdf - 1.0).abs() < 5e-3, "{}: sampled {}, asked {pdf}", case.name, s.pdf);
        }
    }
}

fn rectangle_height(case: &Case) -> f32 {
    if case.name == "rectangle near" { 0.1 } else { 0.5 }
}

#[test]
fn power_is_the_integral_of_what_leaves() {
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let square = rectangle(0.5, None);
    assert!((square.power(scene) / (2.0 * std::f32::consts::PI * 4.0) - 1.0).abs() < 1e-5);
    let lamp = Point { p: Vec3::ZERO, intensity: Rgb::splat(3.0), range: f32::INFINITY };
    assert!((lamp.power(scene) / (12.0 * std::f32::consts::PI) - 1.0).abs() < 1e-5);
    let spot = Spot { point: lamp, axis: Vec3::Y, cos_inner: 0.9, cos_outer: 0.6 };
    // ∫ I(θ) dω by f64 quadrature over the cosine.
    let n = 10_000;
    let integral: f64 = (0..n)
        .map(|i| {
            let cos = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            3.0 * ((cos - 0.6) / 0.3).clamp(0.0, 1.0).powi(2) * 2.0 * PI * 2.0 / f64::from(n)
        })
        .sum();
    assert!((f64::from(spot.power(scene)) / integral - 1.0).abs() < 1e-3);
}

#[test]
fn the_choice_among_lights_has_the_odds_that_it_tells() {
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    for count in [1, 3, 32, 33, 500] {
        let lights = (0..count).map(|i| {
            let p = Vec3::new(i as f32, 1.0, 0.0);
            Light::from(Point { p, intensity: Rgb::splat(1.0 + i as f32), range: f32::INFINITY })
        });
        let set = LightSet::new(lights.collect(), scene);
        let (n, p) = (1 << 18, Vec3::new(2.0, 0.0, 0.0));
        let mut seen = vec![0_u32; count];
        for i in 0..n {
            let choice = set.choose(p, (i as f32 + 0.5) / n as f32).unwrap();
            assert!((set.pmf(p, choice.light) / choice.pmf - 1.0).abs() < 1e-5);
            assert!((0.0..1.0).contains(&choice.u));
            seen[choice.light as usize] += 1;
        }
        for (i, seen) in seen.iter().enumerate() {
            let pmf = f64::from(set.pmf(p, i as u32));
            assert!((f64::from(*seen) / f64::from(n) - pmf).abs() < 2e-5 * count as f64 + 1e-4, "{count} lights, {i}");
        }
    }
}

#[test]
fn a_black_mesh_is_no_light() {
    let triangle =
        EmissiveTriangle { p: [Vec3::ZERO, Vec3::X, Vec3::Y], mean: Rgb::BLACK, p_err: Vec3::ZERO, index: 0 };
    assert!(MeshLight::new(vec![triangle], 1, None).is_none());
    let flat =
        EmissiveTriangle { p: [Vec3::ZERO, Vec3::X, Vec3::X * 2.0], mean: Rgb::WHITE, p_err: Vec3::ZERO, index: 0 };
    assert!(MeshLight::new(vec![flat], 1, None).is_none());
}

#[test]
fn many_lights_without_power_are_still_chosen() {
    let scene = Bounds { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    let point = Point { p: Vec3::Y, intensity: Rgb::splat(1.0), range: f32::INFINITY };
    let needle = Light::from(Spot { point, axis: Vec3::NEG_Y, cos_inner: 1.0, cos_outer: 1.0 });
    let set = LightSet::new(vec![needle.clone(); 40], scene);
    assert!((set.choose(Vec3::ZERO, 0.5).unwrap().pmf - 1.0 / 40.0).abs() < 1e-6);
    // Among others a light that loses its power to rounding keeps a share.
    let set = LightSet::new([vec![point.into(); 39], vec![needle]].concat(), scene);
    assert!(set.pmf(Vec3::ZERO, 39) > 0.0);
}
