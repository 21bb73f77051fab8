//! Suns: `E cos θ` for every width of the disk while all of it is above the horizon.

use std::f64::consts::PI;

use penumbra::light::{Distant, Emitter, Receiver};
use penumbra::math::{Bounds, DVec3, Rgb, Vec3};

use crate::laws::{Case, hold, irradiance_holds};

const IRRADIANCE: f64 = 2.0;

fn sun(to_light: Vec3, angle: f64, n: Vec3, irradiance: f64) -> Case {
    let light = Distant::new(to_light, angle as f32, Rgb::splat(IRRADIANCE as f32));
    let case = Case::new(format!("{angle} rad about {to_light} on {n}"), light, Vec3::ZERO, n, irradiance);
    // A little wider than the disk, so that its edge is between the cells.
    if angle > 0.0 { case.within(to_light, (angle * 0.55).min(PI)) } else { case }
}

/// Irradiance of a disk of constant radiance that the horizon cuts, by quadrature over its polar angle:
/// with a = cos θ cos γ and b = sin θ sin γ the azimuths above the horizon are |φ| < φ₀ = acos(−a/b), and
/// ∫ (a + b cos φ) dφ = 2 (a φ₀ + b sin φ₀).
fn partly_set(gamma: f64, half: f64) -> f64 {
    let n = 200_000;
    let ring = |i: u32| {
        let theta = half * (f64::from(i) + 0.5) / f64::from(n);
        let (a, b) = (theta.cos() * gamma.cos(), theta.sin() * gamma.sin());
        let phi = (-a / b).clamp(-1.0, 1.0).acos();
        2.0 * (a * phi + b * phi.sin()) * theta.sin() * half / f64::from(n)
    };
    IRRADIANCE / (PI * half.sin().powi(2)) * (0..n).map(ring).sum::<f64>()
}

#[test]
fn suns_hold_the_laws() {
    let tilted = Vec3::new(0.6, 0.8, 0.0);
    let oblique = Vec3::new(0.48, 0.6, -0.64);
    let mut cases = Vec::new();
    for angle in [0.0, 1e-6, 1e-4, 0.00918, 0.7] {
        cases.push(sun(tilted, angle, Vec3::Y, IRRADIANCE * 0.8));
        cases.push(sun(oblique, angle, Vec3::Y, IRRADIANCE * 0.6));
    }
    for degrees in [1.0_f64, 30.0, 90.0, 170.0, 180.0] {
        cases.push(sun(Vec3::Y, degrees.to_radians(), Vec3::Y, IRRADIANCE));
    }
    // Cycles, measured: at 180 degrees and a tilt of 45 it is S (1 + cos 45) / 2.
    let at_45 = DVec3::new(1.0, 1.0, 0.0).normalize();
    let law = IRRADIANCE * 0.5 * (1.0 + at_45.y);
    assert!((partly_set(0.25 * PI, 0.5 * PI) / law - 1.0).abs() < 1e-6);
    cases.push(sun(at_45.as_vec3(), PI, Vec3::Y, law));
    // Setting, and all but set.
    for (gamma, half) in [(85.0_f64, 20.0_f64), (90.0, 20.0), (105.0, 20.0), (89.0, 2.0)] {
        let (gamma, half) = (gamma.to_radians(), half.to_radians());
        let to_light = DVec3::new(gamma.sin(), gamma.cos(), 0.0).as_vec3();
        cases.push(sun(to_light, 2.0 * half, Vec3::Y, partly_set(gamma, half)));
    }
    cases.push(sun(Vec3::new(0.6, -0.8, 0.0), 0.5, Vec3::Y, 0.0));
    cases.push(sun(Vec3::new(0.6, -0.8, 0.0), 0.0, Vec3::Y, 0.0));
    hold(&cases);
}

#[test]
fn the_narrowest_disks_keep_their_energy() {
    let to_light = Vec3::new(0.48, 0.6, -0.64);
    let cases: Vec<Case> = [1.9e-5, 2.0e-5, 2.1e-5, 3e-5, 1e-4, 1e-3]
        .iter()
        .map(|&angle| sun(to_light, angle, Vec3::Y, IRRADIANCE * 0.6))
        .collect();
    irradiance_holds(&cases);
    // Along an axis directions have digits enough for the disk's density to be integrated.
    hold(&[sun(Vec3::Y, 2.1e-5, Vec3::Y, IRRADIANCE), sun(Vec3::Y, 1e-4, Vec3::Y, IRRADIANCE)]);
}

#[test]
fn a_disk_is_seen_and_a_direction_is_not() {
    let to_light = Vec3::new(0.48, 0.6, -0.64);
    for (angle, seen) in [(0.0, false), (1e-6, false), (f32::NAN, false), (-1.0, false), (1e-4, true), (9.0, true)] {
        let sun = Distant::new(to_light, angle, Rgb::WHITE);
        let le = sun.le(to_light, None);
        assert_eq!((sun.in_background(), !le.is_black()), (seen, seen), "{angle}");
        assert!(le.is_finite() && sun.bounds().is_none(), "{angle}");
    }
    // Radiance is E / (π sin²(angle / 2)), and stays finite.
    let le = Distant::new(Vec3::Y, 0.1, Rgb::splat(3.0)).le(Vec3::Y, None).r;
    assert!((f64::from(le) / (3.0 / (PI * 0.05_f64.sin().powi(2))) - 1.0).abs() < 1e-6);
    assert!(Distant::new(Vec3::Y, 1e-4, Rgb::splat(1e38)).le(Vec3::Y, None).is_finite());
    let scene = Bounds { min: Vec3::splat(-1e19), max: Vec3::splat(1e19) };
    assert!(Distant::new(Vec3::Y, 0.0, Rgb::splat(1e30)).power(scene).is_finite());
}

#[test]
fn importance_bounds_what_arrives() {
    for half in [0.0_f64, 1e-3, 0.2, 0.5 * PI] {
        for i in 0..=180 {
            let gamma = f64::from(i).to_radians();
            let to_light = DVec3::new(gamma.sin(), gamma.cos(), 0.0).as_vec3();
            let sun = Distant::new(to_light, 2.0 * half as f32, Rgb::splat(IRRADIANCE as f32));
            let at = Receiver { n: Some(Vec3::Y), ..Receiver::everywhere(Vec3::ZERO) };
            let importance = f64::from(sun.importance(&at));
            let arrives = if half > 0.0 { partly_set_coarse(gamma, half) } else { IRRADIANCE * gamma.cos().max(0.0) };
            assert!(importance >= arrives * (1.0 - 1e-3) && importance <= IRRADIANCE * 1.000_01, "{half} {gamma}");
            let below = gamma > half + 0.5 * PI + 1e-4;
            assert!(!below || importance == 0.0, "{half} {gamma}: {importance}");
            assert_eq!(sun.importance(&Receiver::everywhere(Vec3::ZERO)), IRRADIANCE as f32);
        }
    }
}

fn partly_set_coarse(gamma: f64, half: f64) -> f64 {
    if gamma + half < 0.5 * PI { IRRADIANCE * gamma.cos() } else { partly_set(gamma.min(PI - 1e-9), half) }
}
