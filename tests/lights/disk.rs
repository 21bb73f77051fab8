//! Disks and ellipses.

use std::f64::consts::PI;

use penumbra::light::{Disk, Emitter, Flat, Receiver, Spread};
use penumbra::math::{Bounds, DQuat, DVec2, DVec3, Vec3};

use crate::laws::{Case, hold, irradiance_holds};
use crate::plane::{Pose, cone_around, lambert, quadrature, spread_factor, window};

const TILTED: Vec3 = Vec3::new(0.6, 0.8, 0.0);

/// An ellipse of radiance 1 with its irradiance, as a polygon of many sides.
fn case(name: impl Into<String>, pose: &Pose, half: [f64; 2], p: Vec3, n: Vec3) -> Case {
    let polygon = pose.ellipse(half, 50_000);
    let (axis, angle) = cone_around(&polygon, p);
    Case::new(name, Disk::new(pose.flat(1.0), half), p, n, lambert(&polygon, p, n)).within(axis, angle)
}

/// A disk that faces its receiver: `E = π r² / (r² + d²)`.
fn facing(r: f64, d: f64) -> Case {
    let disk = Disk::new(Pose::down(DVec3::Y * d).flat(1.0), [r, r]);
    let exact = PI * r * r / (r * r + d * d);
    Case::new(format!("facing, radius {r:e} at {d:e}"), disk, Vec3::ZERO, Vec3::Y, exact)
        .within(Vec3::Y, 1.01 * (r / d).atan())
}

fn above(h: f64) -> Pose {
    Pose::down(DVec3::new(0.1237, h, 0.0412))
}

fn turned() -> Pose {
    Pose::turned(DVec3::new(0.4, 1.1, -0.3), DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7))
}

#[test]
fn near_and_tilted() {
    let round = [0.5, 0.5];
    hold(&[
        facing(0.5, 1.0),
        facing(2.0, 1.0),
        facing(0.1, 7.0),
        case("off centre", &above(1.0), round, Vec3::ZERO, Vec3::Y),
        case("tilted", &above(1.0), round, Vec3::ZERO, TILTED),
        case("partly below the horizon", &above(0.5), round, Vec3::ZERO, Vec3::new(0.96, -0.28, 0.0)),
        case("ellipse", &turned(), [0.6, 0.2], Vec3::ZERO, Vec3::Y),
        case("ellipse, tilted", &turned(), [0.2, 0.7], Vec3::new(0.1, -0.2, 0.3), TILTED),
        case("beside", &above(0.6), [0.25, 0.5], Vec3::new(1.2, 0.0, 0.9), Vec3::Y),
        case("at 0.1", &above(0.1), round, Vec3::ZERO, Vec3::Y),
        case("hundred away", &above(100.0), [0.3, 0.5], Vec3::ZERO, TILTED),
        case("under the rim", &above(0.05), round, Vec3::new(0.6, 0.0, 0.0), Vec3::Y),
    ]);
}

#[test]
fn touching() {
    let mut cases = Vec::new();
    for k in 1..=5 {
        let h = 10.0_f64.powi(-k);
        cases.push(facing(0.5, h));
        cases.push(case(format!("at {h:e}"), &above(h), [0.5, 0.3], Vec3::ZERO, Vec3::Y));
        cases.push(case(format!("tilted, at {h:e}"), &above(h), [0.5, 0.5], Vec3::ZERO, TILTED));
        cases.push(case(format!("beside, at {h:e}"), &above(h), [0.5, 0.5], Vec3::new(1.0, 0.0, 0.3), TILTED));
        cases.push(case(format!("near the rim, at {h:e}"), &above(h), [0.5, 0.5], Vec3::new(0.62, 0.0, 0.0), Vec3::Y));
    }
    irradiance_holds(&cases);
    hold(&[facing(0.5, 1e-3).within(Vec3::Y, 0.5 * PI), facing(0.5, 1e-5).within(Vec3::Y, 0.5 * PI)]);
}

#[test]
fn far_and_small() {
    let mut cases = Vec::new();
    for k in -4..=6 {
        cases.push(facing(1.0, 10.0_f64.powi(k)));
        cases.push(facing(1e-4, 10.0_f64.powi(k - 4)));
        cases.push(facing(1e5, 10.0_f64.powi(k + 5)));
    }
    for k in -4..=5 {
        let s = 10.0_f64.powi(k);
        let p = Vec3::new(0.3, -0.2, 0.1) * s as f32;
        let pose = Pose { center: turned().center * s, ..turned() };
        cases.push(case(format!("scale {s:e}"), &pose, [0.6 * s, 0.2 * s], p, TILTED));
    }
    for k in 2..=6 {
        // Tilted and far: constant over the light, but for its square of size over distance.
        let d = 10.0_f64.powi(k);
        let way = DVec3::new(0.3, 0.9, 0.1) * d;
        let disk = Disk::new(Pose::down(way).flat(1.0), [1.0, 0.5]);
        let cos = way.normalize().dot(TILTED.as_dvec3()) * way.normalize().y;
        let exact = 0.5 * PI * cos / way.length_squared();
        cases.push(Case::new(format!("{d:e} radii away"), disk, Vec3::ZERO, TILTED, exact));
    }
    for half in [[0.5, 5e-3], [1e-4, 0.5]] {
        cases.push(case(format!("{half:?}"), &above(0.3), half, Vec3::ZERO, TILTED));
    }
    irradiance_holds(&cases);
}

#[test]
fn both_sides_or_one() {
    let pose = Pose { axes: Pose::down(DVec3::ZERO).axes * -1.0, ..above(1.0) };
    let behind = case("behind", &pose, [0.5, 0.3], Vec3::ZERO, Vec3::Y);
    let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
    assert!(behind.light.sample_li(&at, 0.5, [0.5, 0.5]).is_none() && behind.light.hit(Vec3::ZERO, Vec3::Y).is_none());
    let flat = Flat { two_sided: true, ..pose.flat(1.0) };
    hold(&[Case { light: Disk::new(flat, [0.5, 0.3]).into(), ..behind }]);
}

/// With a spread, by quadrature.
fn spread(name: String, pose: &Pose, half: [f64; 2], s: f64, p: Vec3, n: Vec3) -> Case {
    let window = window(pose, half, p, 0.5 * s);
    let exact = quadrature(pose, window, 3000, p, n, &|q, tan| {
        if (q / DVec2::from(half)).length_squared() <= 1.0 { spread_factor(s, tan) } else { 0.0 }
    });
    let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| pose.at(DVec2::new(window[i].x, window[j].y)));
    let (axis, angle) = cone_around(&corners, p);
    let flat = Flat { spread: Spread::new(s), ..pose.flat(1.0) };
    Case::new(name, Disk::new(flat, half), p, n, exact).within(axis, angle)
}

#[test]
fn spreads() {
    let mut cases = Vec::new();
    for s in [0.05, 0.5, 1.5, 2.5, PI - 1e-3] {
        cases.push(spread(format!("spread {s}"), &above(1.0), [0.5, 0.5], s, Vec3::ZERO, Vec3::Y));
        cases.push(spread(format!("spread {s}, tilted"), &above(1.0), [0.5, 0.2], s, Vec3::ZERO, TILTED));
    }
    hold(&cases);
    let narrow = [1e-3, 1e-2].map(|s| {
        let edge = Vec3::new(0.623_65, 0.0, 0.0412);
        [
            spread(format!("spread {s}"), &above(1.0), [0.5, 0.5], s, Vec3::ZERO, TILTED),
            spread(format!("spread {s}, at the rim"), &above(1.0), [0.5, 0.5], s, edge, Vec3::Y),
            spread(format!("spread {s}, thousand away"), &above(1e3), [0.5, 0.5], s, Vec3::ZERO, Vec3::Y),
        ]
    });
    irradiance_holds(&narrow.concat());
}

#[test]
fn power_and_bounds_are_exact() {
    for s in [0.0, 1.0, PI] {
        let flat = Flat { spread: Spread::new(s), ..turned().flat(3.0) };
        let disk = Disk::new(flat, [0.2, 0.7]);
        assert!((f64::from(disk.power(Bounds::EMPTY)) / (PI * 3.0 * PI * 0.14) - 1.0).abs() < 1e-6);
        let bounds = disk.bounds().unwrap();
        let points: Vec<Vec3> = turned().ellipse([0.2, 0.7], 1000).iter().map(|p| p.as_vec3()).collect();
        let around = Bounds::of_points(points);
        assert!((bounds.bounds.min - around.min).length() < 1e-4 && (bounds.bounds.max - around.max).length() < 1e-4);
    }
}
