//! Rectangles.

use std::f64::consts::PI;
use std::sync::Arc;

use penumbra::light::{Emission, Emitter, Flat, Receiver, Rect, Spread};
use penumbra::math::{Bounds, DQuat, DVec2, DVec3, Rgb, Vec3};

use crate::laws::{Case, hold, irradiance_holds};
use crate::plane::{Pose, cone_around, lambert, quadrature, spread_factor, window};

const TILTED: Vec3 = Vec3::new(0.6, 0.8, 0.0);

/// A rectangle of radiance 1 with its exact irradiance.
fn case(name: impl Into<String>, pose: &Pose, half: [f64; 2], p: Vec3, n: Vec3) -> Case {
    let (axis, angle) = cone_around(&pose.corners(half), p);
    let exact = lambert(&pose.corners(half), p, n);
    Case::new(name, Rect::new(pose.flat(1.0), half), p, n, exact).within(axis, angle)
}

/// The same far away, where Lambert's formula cancels.
fn far(name: String, pose: &Pose, half: [f64; 2], p: Vec3, n: Vec3) -> Case {
    let corner = DVec2::from(half);
    let exact = quadrature(pose, [-corner, corner], 64, p, n, &|_, _| 1.0);
    Case::new(name, Rect::new(pose.flat(1.0), half), p, n, exact)
}

fn above(h: f64) -> Pose {
    Pose::down(DVec3::new(0.1237, h, 0.0412))
}

fn turned() -> Pose {
    Pose::turned(DVec3::new(0.4, 1.1, -0.3), DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7))
}

#[test]
fn near_and_tilted() {
    let square = [0.5, 0.5];
    hold(&[
        case("facing", &above(1.0), square, Vec3::ZERO, Vec3::Y),
        case("tilted", &above(1.0), square, Vec3::ZERO, TILTED),
        case("partly below the horizon", &above(0.5), square, Vec3::ZERO, Vec3::new(0.96, -0.28, 0.0)),
        case("turned", &turned(), [0.6, 0.2], Vec3::ZERO, Vec3::Y),
        case("turned, tilted", &turned(), [0.6, 0.2], Vec3::new(0.1, -0.2, 0.3), TILTED),
        case("beside", &above(0.6), [0.25, 0.5], Vec3::new(1.2, 0.0, 0.9), Vec3::Y),
        case("at 0.1", &above(0.1), square, Vec3::ZERO, Vec3::Y),
        case("ten away", &above(10.0), square, Vec3::ZERO, Vec3::Y),
        case("hundred away", &above(100.0), square, Vec3::ZERO, TILTED),
        case("under a corner", &above(0.05), square, Vec3::new(0.6, 0.0, 0.5), Vec3::Y),
    ]);
}

#[test]
fn touching() {
    let square = [0.5, 0.5];
    let mut cases: Vec<Case> = (2..=10)
        .map(|k| 10.0_f64.powf(-0.5 * f64::from(k)))
        .map(|h| case(format!("at {h:e}"), &above(h), square, Vec3::ZERO, Vec3::Y))
        .collect();
    let last = cases.last().unwrap().irradiance;
    assert!((last / PI - 1.0).abs() < 1e-3);
    for h in [1e-1, 1e-3, 1e-5] {
        cases.push(case(format!("tilted, at {h:e}"), &above(h), square, Vec3::ZERO, TILTED));
        cases.push(case(format!("beside, at {h:e}"), &above(h), square, Vec3::new(1.0, 0.0, 0.3), TILTED));
        cases.push(case(format!("near the edge, at {h:e}"), &above(h), square, Vec3::new(0.6230, 0.0, 0.3), Vec3::Y));
    }
    irradiance_holds(&cases);
    hold(&[
        case("at 1e-3", &above(1e-3), square, Vec3::ZERO, Vec3::Y).within(Vec3::Y, 0.5 * PI),
        case("at 1e-5", &above(1e-5), square, Vec3::ZERO, Vec3::Y).within(Vec3::Y, 0.5 * PI),
    ]);
}

#[test]
fn far_and_small() {
    let mut cases = Vec::new();
    for k in 0..=6 {
        let ratio = 10.0_f64.powi(-k);
        let half = [0.5 * ratio, 0.3 * ratio];
        for (n, normal) in [("facing", Vec3::Y), ("tilted", TILTED)] {
            cases.push(far(format!("size/d {ratio:e}, {n}"), &turned(), half, Vec3::ZERO, normal));
        }
    }
    for k in -4..=6 {
        let d = 10.0_f64.powi(k);
        let pose = Pose::turned(DVec3::new(0.3 * d, d, 0.1 * d), DQuat::from_rotation_z(0.3));
        let name = format!("{d:e} radii away");
        // Each where it is exact.
        cases.push(if d < 10.0 {
            case(name, &pose, [1.0, 1.0], Vec3::ZERO, TILTED)
        } else {
            far(name, &pose, [1.0, 1.0], Vec3::ZERO, TILTED)
        });
    }
    for k in -4..=5 {
        let s = 10.0_f64.powi(k);
        let p = Vec3::new(0.3, -0.2, 0.1) * s as f32;
        let pose = Pose { center: turned().center * s, ..turned() };
        cases.push(case(format!("scale {s:e}"), &pose, [0.6 * s, 0.2 * s], p, TILTED));
    }
    for (x, y) in [(0.5, 5e-4), (0.5, 5e-5), (5e-6, 0.5), (50.0, 5e-7)] {
        let pose = above(0.3);
        let (half, corner) = ([x, y], DVec2::new(x, y));
        // A wire: the midpoint rule is exact across it and needs many steps along.
        let exact = wire(&pose, corner);
        cases.push(Case::new(format!("{x} by {y}"), Rect::new(pose.flat(1.0), half), Vec3::ZERO, TILTED, exact));
    }
    irradiance_holds(&cases);
}

/// Irradiance at the origin, normal `TILTED`, of a rectangle much longer than wide.
fn wire(pose: &Pose, half: DVec2) -> f64 {
    let pieces = 4000;
    let long = if half.x > half.y { DVec2::X } else { DVec2::Y };
    (0..pieces)
        .map(|i| {
            let from = -half + 2.0 * half * long * (f64::from(i) / f64::from(pieces));
            let to = from + 2.0 * half * (1.0 - long) + 2.0 * half * long / f64::from(pieces);
            quadrature(pose, [from, to], 4, Vec3::ZERO, TILTED, &|_, _| 1.0)
        })
        .sum()
}

#[test]
fn both_sides_or_one() {
    let pose = Pose { axes: Pose::down(DVec3::ZERO).axes * -1.0, ..above(1.0) };
    let behind = case("behind", &pose, [0.5, 0.5], Vec3::ZERO, Vec3::Y);
    let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
    assert!(behind.light.sample_li(&at, 0.5, [0.5, 0.5]).is_none() && behind.light.hit(Vec3::ZERO, Vec3::Y).is_none());
    assert_eq!(behind.light.importance(&at), 0.0);
    let flat = Flat { two_sided: true, ..pose.flat(1.0) };
    hold(&[Case { light: Rect::new(flat, [0.5, 0.5]).into(), ..behind }]);
}

/// With a spread, by quadrature.
fn spread(name: String, pose: &Pose, half: [f64; 2], s: f64, p: Vec3, n: Vec3) -> Case {
    let window = window(pose, half, p, 0.5 * s);
    let exact = quadrature(pose, window, 1500, p, n, &|_, tan| spread_factor(s, tan));
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| pose.at(DVec2::new(window[i].x, window[j].y)));
    let (axis, angle) = cone_around(&corners, p);
    let flat = Flat { spread: Spread::new(s), ..pose.flat(1.0) };
    Case::new(name, Rect::new(flat, half), p, n, exact).within(axis, angle)
}

#[test]
fn spreads() {
    let mut cases = Vec::new();
    for s in [0.01, 0.1, 0.5, 1.0, 2.0, 2.5, 3.0, PI - 1e-3] {
        cases.push(spread(format!("spread {s}"), &above(1.0), [0.5, 0.5], s, Vec3::ZERO, Vec3::Y));
        cases.push(spread(format!("spread {s}, tilted"), &above(1.0), [0.5, 0.4], s, Vec3::ZERO, TILTED));
        let beside = Vec3::new(0.6, 0.0, 0.1);
        if window(&above(1.0), [0.5, 0.5], beside, 0.5 * s).map(|c| c.x)[0] < 0.5 {
            cases.push(spread(format!("spread {s}, at the edge"), &above(1.0), [0.5, 0.5], s, beside, Vec3::Y));
        }
    }
    hold(&cases);
    let narrow = [1e-3, 3e-3, 0.01].map(|s| {
        let edge = Vec3::new(0.623_65, 0.0, 0.0);
        [
            spread(format!("spread {s}"), &above(1.0), [0.5, 0.5], s, Vec3::ZERO, TILTED),
            spread(format!("spread {s}, at the edge"), &above(1.0), [0.5, 0.5], s, edge, Vec3::Y),
            spread(format!("spread {s}, thousand away"), &above(1e3), [0.5, 0.5], s, Vec3::ZERO, Vec3::Y),
            spread(format!("spread {s}, touching"), &above(1e-4), [0.5, 0.5], s, Vec3::ZERO, Vec3::Y),
        ]
    });
    irradiance_holds(&narrow.concat());
}

#[test]
fn a_large_collimated_panel_brings_its_power_by_its_area() {
    let panel = |s: f64, d: f64| {
        let flat = Flat { spread: Spread::new(s), ..above(d).flat(2.0) };
        let rect = Rect::new(flat, [50.0, 50.0]);
        let power = f64::from(rect.power(Bounds::EMPTY));
        Case::new(format!("spread {s} from {d}"), rect, Vec3::ZERO, TILTED, 0.8 * power / 1e4)
    };
    irradiance_holds(&[panel(0.0, 1.0), panel(0.0, 1e3), panel(0.0, 1e-3), panel(1e-3, 2.0), panel(0.05, 5.0)]);
    // Beside the panel there is no light.
    let flat = Flat { spread: Spread::new(0.0), ..above(1.0).flat(2.0) };
    let rect = Rect::new(flat, [0.5, 0.5]);
    let beside = Receiver::everywhere(Vec3::new(0.6241, 0.0, 0.0));
    assert!(rect.sample_li(&beside, 0.5, [0.5, 0.5]).is_none());
}

#[derive(Debug)]
struct Ramp;

impl Emission for Ramp {
    fn radiance(&self, _triangle: u32, [u, v]: [f32; 2]) -> Rgb {
        Rgb::splat(1.0 + 2.0 * u + 6.0 * v * v)
    }

    fn mean(&self, _triangle: u32) -> Rgb {
        Rgb::splat(4.0)
    }
}

#[test]
fn textures_stand_upright_before_who_looks() {
    // The light shines down −z at a viewer who looks along +z, y up: his right is −x.
    let pose = Pose { center: DVec3::new(0.0, 0.0, 1.0), axes: penumbra::math::DMat3::IDENTITY };
    let rect = Rect::new(pose.flat(0.0), [0.5, 0.25]).textured(Arc::new(Ramp));
    let uv = |x: f32, y: f32| rect.hit(Vec3::ZERO, Vec3::new(x, y, 1.0).normalize()).unwrap().uv;
    let close = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).abs() < 1e-5 && (a[1] - b[1]).abs() < 1e-5;
    assert!(close(uv(-0.4999, 0.2499), [0.9999, 0.0002]) && close(uv(0.4999, -0.2499), [0.0001, 0.9998]));
    assert!(close(uv(0.0, 0.0), [0.5, 0.5]));
    assert!((f64::from(rect.power(Bounds::EMPTY)) / (PI * 0.5 * 4.0) - 1.0).abs() < 1e-6);

    let half = DVec2::new(0.5, 0.25);
    let n = Vec3::new(0.0, -0.6, 0.8);
    let exact = quadrature(&pose, [-half, half], 1000, Vec3::ZERO, n, &|q, _| {
        let [u, v] = [0.5 - q.x, 0.5 - 2.0 * q.y];
        1.0 + 2.0 * u + 6.0 * v * v
    });
    let (axis, angle) = cone_around(&pose.corners([0.5, 0.25]), Vec3::ZERO);
    hold(&[Case::new("textured", rect, Vec3::ZERO, n, exact).within(axis, angle)]);
}

#[test]
fn the_spread_keeps_the_power() {
    for s in [0.0, 1e-3, 0.3, 2.0, PI] {
        for (two_sided, sides) in [(false, 1.0), (true, 2.0)] {
            let flat = Flat { spread: Spread::new(s), two_sided, ..above(1.0).flat(3.0) };
            let power = Rect::new(flat, [0.2, 0.7]).power(Bounds::EMPTY);
            assert!((f64::from(power) / (sides * PI * 3.0 * 0.56) - 1.0).abs() < 1e-6);
        }
    }
}
