//! The edge of an object's own shadow where few triangles stand for a smooth surface.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{LightKind, TerminatorDesc};
use penumbra::math::{DAffine3, DVec3};
use penumbra::settings::Settings;
use scene::{Builder, close, mean, picture, settings};

const SIZE: u32 = 96;
/// Direction to the sun, 80 degrees from the one to the camera.
const SUN: [f64; 3] = [0.985, 0.174, 0.0];

/// A white ball of `2 n²` triangles from above, and a sun low at its side.
fn ball(n: u32, smooth: bool, terminator: Option<TerminatorDesc>) -> Builder {
    let mut builder = Builder::default();
    let material = builder.lambert(1.0);
    // The pole, where the triangles are smallest, is at the side.
    builder.sphere(n, smooth, material, DAffine3::from_rotation_x(0.5 * PI));
    builder.desc.instances[0].terminator = terminator;
    let from = DVec3::from(SUN).normalize();
    let transform = DAffine3::from_quat(penumbra::math::DQuat::from_rotation_arc(DVec3::Z, from));
    builder.light(LightKind::Distant { irradiance: [PI; 3], angle: 0.0 }, transform);
    builder.look([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 1.1);
    builder
}

/// Pixels well inside the outline whose true cosine to the sun is at least 0.03: how many are black, and the largest
/// error and the mean of squares of what they show.
fn errors(builder: &Builder, settings: &Settings) -> (usize, f64, f64) {
    let picture = picture(&builder.desc, SIZE, settings);
    let combined = picture.layer("Combined").unwrap();
    let normal = picture.layer("Normal").unwrap();
    let sun = DVec3::from(SUN).normalize();
    let (mut black, mut worst, mut squares, mut count) = (0, 0.0_f64, 0.0, 0.0);
    for (color, n) in combined.data.chunks(combined.channels.len()).zip(normal.data.chunks(3)) {
        let n = DVec3::new(f64::from(n[0]), f64::from(n[1]), f64::from(n[2]));
        let expected = n.dot(sun);
        if n.length() < 0.99 || n.y < 0.3 || expected < 0.03 {
            continue;
        }
        let found = f64::from(color[0]);
        black += usize::from(found < 0.1 * expected);
        worst = worst.max((found - expected).abs());
        squares += (found - expected).powi(2);
        count += 1.0;
    }
    assert!(count > 2000.0, "{count}");
    (black, worst, squares / count)
}

fn none() -> Option<TerminatorDesc> {
    Some(TerminatorDesc { geometry: 0.0, shading: 0.0 })
}

#[test]
fn a_coarse_ball_is_lit_as_a_smooth_one() {
    let settings = Settings { max_bounces: 0, ..settings("combined,normal", 16) };
    let without = errors(&ball(8, true, none()), &settings);
    let with = errors(&ball(8, true, None), &settings);
    assert!(without.0 > 20, "{without:?}");
    assert!(with.0 == 0 && with.1 < 0.2 * without.1.max(0.05) && with.2 < 0.05 * without.2, "{with:?}, {without:?}");
}

#[test]
fn facets_keep_every_bit() {
    let settings = settings("combined,ao,shadow", 4);
    let render = |terminator| picture(&ball(8, false, terminator).desc, 24, &settings);
    let (with, without) = (render(Some(TerminatorDesc { geometry: 1.0, shading: 0.0 })), render(none()));
    for layer in ["Combined", "Ambient Occlusion", "Shadow"] {
        assert_eq!(with.layer(layer).unwrap().data, without.layer(layer).unwrap().data, "{layer}");
    }
}

#[test]
fn the_settings_hold_for_objects_that_say_nothing() {
    let base = Settings { max_bounces: 0, ..settings("combined", 4) };
    let render = |terminator, settings: &Settings| picture(&ball(8, true, terminator).desc, 24, settings);
    let set =
        Settings { shadow_terminator_geometry_offset: 0.0, shadow_terminator_shading_offset: 0.4, ..base.clone() };
    let said = render(Some(TerminatorDesc { geometry: 0.0, shading: 0.4 }), &base);
    assert_eq!(render(None, &set).layer("Combined").unwrap().data, said.layer("Combined").unwrap().data);
    assert_ne!(render(None, &base).layer("Combined").unwrap().data, said.layer("Combined").unwrap().data);
}

/// cos(f θ) in place of cos θ, f = 1 / (1 − s / 2), on a flat surface: there is no geometry about it.
#[test]
fn shading_is_drawn_towards_the_light_by_its_law() {
    for degrees in [0.0_f64, 40.0, 65.0, 80.0] {
        let mut builder = Builder::default();
        let material = builder.lambert(1.0);
        builder.ground(10.0, material);
        builder.desc.instances[0].terminator = Some(TerminatorDesc { geometry: 0.1, shading: 0.4 });
        let transform = DAffine3::from_rotation_z(degrees.to_radians()) * DAffine3::from_rotation_x(-0.5 * PI);
        builder.light(LightKind::Distant { irradiance: [PI; 3], angle: 0.0 }, transform);
        builder.look([0.0; 3], [0.0, -1.0, 0.0], 1e-3);
        let found = mean(&picture(&builder.desc, 2, &settings("combined", 4)), "Combined", 0);
        let expected = (degrees.to_radians() * 1.25).cos().max(0.0);
        if expected == 0.0 {
            assert_eq!(found, 0.0);
        } else {
            close(&format!("{degrees}"), found, expected, 1e-4);
        }
    }
}

/// Light that goes around the triangles that are there is none that comes from nowhere.
#[test]
fn a_white_ball_in_a_white_furnace_stays_white() {
    let mut builder = Builder::default();
    let material = builder.lambert(1.0);
    builder.sphere(8, true, material, DAffine3::IDENTITY);
    builder.dome(1.0);
    builder.look([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.6);
    let found = mean(&picture(&builder.desc, 16, &settings("combined", 256)), "Combined", 0);
    close("furnace", found, 1.0, 5e-3);
}
