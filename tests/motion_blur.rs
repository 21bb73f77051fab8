//! What moves while the shutter is open: whole renders against closed forms, and against the mean of many instants.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{
    AlphaMode, ColorInput, LightKind, MaterialDesc, Motion, ProjectionDesc, RoundsDesc, ScalarInput, SceneDesc, Strand,
    Visibility,
};
use penumbra::film::{Filter, Picture};
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::{EffectsMode, Settings};
use scene::{Builder, close, mean, picture, settings};

/// Samples of each pixel where shares are counted.
const SPP: u32 = 512;
/// Pixels on each side of a picture, which shows −1 to 1.
const SIZE: u32 = 32;

fn boxed(passes: &str, spp: u32) -> Settings {
    Settings { filter: Filter::parse("box").unwrap(), ..settings(passes, spp) }
}

fn glow(radiance: f64) -> MaterialDesc {
    MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission: ColorInput::constant([radiance; 3]),
        ..MaterialDesc::default()
    }
}

fn along(x: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, 0.0, 0.0))
}

/// Keys from the opening to the closing of the shutter, which the builder's cameras get, of what is given by the
/// share of the time that has passed.
fn keys<T>(count: usize, at: impl Fn(f64) -> T) -> Vec<Motion<T>> {
    let share = |i: usize| i as f64 / (count - 1) as f64;
    (0..count).map(|i| Motion { time: OPEN[0] + (OPEN[1] - OPEN[0]) * share(i), value: at(share(i)) }).collect()
}

const OPEN: [f64; 2] = [-0.5, 0.25];
/// Share of the time that has passed at the frame.
const FRAME: f64 = 2.0 / 3.0;

/// A camera one metre from the origin, which sees −1 to 1 through an open shutter: along −z, x to the right, turned by
/// `turn`.
fn look(builder: &mut Builder, turn: DAffine3) {
    builder.look([0.0; 3], [0.0, 0.0, -1.0], 1.0);
    let camera = builder.desc.cameras.last_mut().unwrap();
    (camera.transform, camera.shutter) = (turn * DAffine3::from_translation(DVec3::Z), OPEN);
}

/// A glowing square from `left` to `right` and −0.5 to 0.5.
fn square(left: f64, right: f64) -> Builder {
    let mut builder = Builder::default();
    let material = builder.material(glow(1.0));
    builder.quad([left, -0.5, 0.0], [right - left, 0.0, 0.0], [0.0, 1.0, 0.0], material);
    look(&mut builder, DAffine3::IDENTITY);
    builder
}

/// One row of a channel.
fn row(picture: &Picture, layer: &str, channel: usize, y: u32) -> Vec<f64> {
    let layer = picture.layer(layer).unwrap();
    let channels = layer.channels.len();
    (0..SIZE).map(|x| f64::from(layer.data[(y * SIZE + x) as usize * channels + channel])).collect()
}

/// Samples behind each value of a profile.
const IN_PROFILE: f64 = (12 * SPP) as f64;

/// The rows that see the middle of things.
const ROWS: std::ops::Range<u32> = 10..22;

/// Their mean.
fn profile(picture: &Picture, layer: &str, channel: usize) -> Vec<f64> {
    let mut sum = vec![0.0; SIZE as usize];
    for y in ROWS {
        sum.iter_mut().zip(row(picture, layer, channel, y)).for_each(|(sum, v)| *sum += v / ROWS.len() as f64);
    }
    sum
}

/// Share of the time for which a square from `left` to `right` that goes by `way` covers each pixel of a row: a
/// trapezoid, averaged over the pixel.
fn trapezoid(left: f64, right: f64, way: f64) -> Vec<f64> {
    // Integral of the share of the time at which an edge that starts at `edge` has been passed by x.
    let passed = |x: f64, edge: f64| {
        let share = (x - edge) / way;
        way * if share <= 0.0 {
            0.0
        } else if share < 1.0 {
            0.5 * share * share
        } else {
            share - 0.5
        }
    };
    let covered = |x: f64| passed(x, left) - passed(x, right);
    let pixel = 2.0 / f64::from(SIZE);
    (0..SIZE).map(|i| -1.0 + pixel * f64::from(i)).map(|x| (covered(x + pixel) - covered(x)) / pixel).collect()
}

/// Asserts that shares that were counted with `samples` are `expected`, but for five standard deviations.
fn assert_near(what: &str, found: &[f64], expected: &[f64], samples: f64) {
    for (x, (found, expected)) in found.iter().zip(expected).enumerate() {
        let variance = (expected * (1.0 - expected)).max(0.0) + 2.0 / samples;
        let off = (found - expected).abs() / (variance / samples).sqrt();
        assert!(off < 5.0, "{what}, value {x}: {found} instead of {expected}, off by {off} standard deviations");
    }
}

/// The same movement, told in every way that there is.
fn movements(left: f64, right: f64, way: f64) -> Vec<(&'static str, SceneDesc)> {
    let still = square(left + way * FRAME, right + way * FRAME).desc;
    let with = |change: &dyn Fn(&mut SceneDesc)| {
        let mut desc = still.clone();
        change(&mut desc);
        desc
    };
    let gone = |share: f64| along(way * (share - FRAME));
    let moved = |points: &[[f32; 3]], share: f64| {
        points.iter().map(|&[x, y, z]| [(f64::from(x) + way * (share - FRAME)) as f32, y, z]).collect()
    };
    vec![
        ("transform", with(&|desc| desc.instances[0].motion = keys(2, gone))),
        ("transform, many keys", with(&|desc| desc.instances[0].motion = keys(7, gone))),
        // Beyond the shutter on both sides.
        (
            "transform, wide keys",
            with(&|desc| {
                desc.instances[0].motion = [-2.0, 3.0]
                    .map(|share| Motion { time: OPEN[0] + (OPEN[1] - OPEN[0]) * share, value: gone(share) })
                    .into();
            }),
        ),
        (
            "deformation",
            with(&|desc| {
                let mut mesh = (*desc.meshes[0]).clone();
                mesh.motion = keys(2, |share| moved(&mesh.points, share));
                desc.meshes[0] = mesh.into();
            }),
        ),
        (
            "both",
            with(&|desc| {
                let mut mesh = (*desc.meshes[0]).clone();
                mesh.motion = keys(3, |share| moved(&mesh.points, 0.25 * share + 0.75 * FRAME));
                desc.meshes[0] = mesh.into();
                desc.instances[0].motion = keys(2, |share| along(0.75 * way * (share - FRAME)));
            }),
        ),
        (
            "camera",
            with(&|desc| {
                let transform = desc.cameras[0].transform;
                desc.cameras[0].motion = keys(2, |share| gone(share).inverse() * transform);
            }),
        ),
        // Twice as far, and the camera follows.
        (
            "object and camera",
            with(&|desc| {
                let transform = desc.cameras[0].transform;
                desc.cameras[0].motion = keys(3, |share| gone(share) * transform);
                desc.instances[0].motion = keys(2, |share| along(2.0 * way * (share - FRAME)));
            }),
        ),
    ]
}

#[test]
fn a_square_that_moves_leaves_a_trapezoid() {
    for (left, right, way) in
        [(-0.7, -0.2, 0.8), (-0.5, -0.4, 0.7), (-0.3, 0.4, 0.05), (0.2, 0.9, 3.0), (-1.9, -1.2, 2.5)]
    {
        let expected = trapezoid(left, right, way);
        for (how, desc) in movements(left, right, way) {
            let found = picture(&desc, SIZE, &boxed("combined", SPP));
            assert_near(&format!("{how} by {way}"), &profile(&found, "Combined", 0), &expected, IN_PROFILE);
            assert_near(&format!("{how}, alpha"), &profile(&found, "Combined", 3), &expected, IN_PROFILE);
            assert!(row(&found, "Combined", 0, 2).iter().all(|&v| v == 0.0), "{how}");
        }
    }
}

/// The mean of `count` pictures at instants of the shutter.
fn mean_of_instants(
    count: usize,
    spp: u32,
    passes: &str,
    at: impl Fn(f64) -> SceneDesc,
    of: impl Fn(&Picture) -> Vec<f64>,
) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    for i in 0..count {
        let settings = Settings { seed: i as u64, ..boxed(passes, spp) };
        let found = of(&picture(&at((i as f64 + 0.5) / count as f64), SIZE, &settings));
        sum.resize(found.len(), 0.0);
        sum.iter_mut().zip(found).for_each(|(sum, v)| *sum += v / count as f64);
    }
    sum
}

fn all_of(layer: &'static str) -> impl Fn(&Picture) -> Vec<f64> {
    move |picture| picture.layer(layer).unwrap().data.iter().map(|&v| f64::from(v)).collect()
}

/// Turned by `angle` about its own origin, which stands beside the middle.
fn spin(angle: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(-0.2, -0.1, 0.0)) * DAffine3::from_rotation_z(angle)
}

#[test]
fn a_bar_that_spins_is_the_mean_of_all_instants() {
    let still = square(-0.1, 0.9).desc;
    let turn = 1.9;
    let at = |share: f64| {
        let mut desc = still.clone();
        desc.instances[0].transform = spin(turn * (share - FRAME));
        desc
    };
    let expected = mean_of_instants(128, 16, "combined", at, all_of("Combined"));
    for count in [2, 5] {
        let mut desc = still.clone();
        desc.instances[0].transform = spin(0.0);
        desc.instances[0].motion = keys(count, |share| spin(turn * (share - FRAME)));
        let found = all_of("Combined")(&picture(&desc, SIZE, &boxed("combined", SPP)));
        assert_near(&format!("{count} keys"), &found, &expected, 1.0 / (1.0 / f64::from(SPP) + 1.0 / 2048.0));
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        close("sum", mean(&found), mean(&expected), 1e-3);
    }
}

/// The ground, lit from above by a sun of irradiance π, seen from above.
fn sunny(albedo: f64) -> Builder {
    let mut builder = Builder::default();
    let ground = builder.lambert(albedo);
    builder.ground(10.0, ground);
    let kind = LightKind::Distant { irradiance: [PI; 3], angle: 0.0 };
    builder.light(kind, DAffine3::from_rotation_x(-0.5 * PI));
    look(&mut builder, DAffine3::from_rotation_x(-0.5 * PI));
    builder
}

#[test]
fn shadows_move_with_what_casts_them() {
    for (opacity, mode) in [(1.0, AlphaMode::Opaque), (0.5, AlphaMode::Blend)] {
        let mut builder = sunny(1.0);
        let mut blocker = glow(0.0);
        (blocker.alpha, blocker.alpha_mode) = (ScalarInput::constant(opacity), mode);
        let blocker = builder.material(blocker);
        builder.quad([-0.7, 0.5, -0.5], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0], blocker);
        let desc = &mut builder.desc;
        desc.instances[1].visibility = Visibility { camera: false, ..Visibility::ALL };
        desc.instances[1].motion = keys(2, |share| along(0.8 * share));
        desc.instances[1].transform = along(0.8 * FRAME);
        let found = picture(desc, SIZE, &boxed("combined,shadow", SPP));
        let lit: Vec<f64> = trapezoid(-0.7, -0.2, 0.8).iter().map(|covered| 1.0 - opacity * covered).collect();
        assert_near("lit", &profile(&found, "Combined", 0), &lit, IN_PROFILE);
        assert_near("shadow", &profile(&found, "Shadow", 0), &lit, IN_PROFILE);
    }
}

#[test]
fn mirrors_show_what_moves() {
    let mut builder = Builder::default();
    let mirror = builder.material(MaterialDesc {
        base_color: ColorInput::constant([1.0; 3]),
        metallic: ScalarInput::constant(1.0),
        roughness: ScalarInput::constant(0.0),
        ..MaterialDesc::default()
    });
    builder.quad([-3.0, -3.0, 0.0], [6.0, 0.0, 0.0], [0.0, 6.0, 0.0], mirror);
    let material = builder.material(glow(1.0));
    // Behind the camera.
    builder.quad([-0.7, -0.5, 3.0], [0.5, 0.0, 0.0], [0.0, 1.0, 0.0], material);
    look(&mut builder, DAffine3::IDENTITY);
    builder.desc.instances[1].motion = keys(2, |share| along(0.8 * share));
    builder.desc.instances[1].transform = along(0.8 * FRAME);
    let found = picture(&builder.desc, SIZE, &boxed("combined", SPP));
    assert_near("mirrored", &profile(&found, "Combined", 0), &trapezoid(-0.7, -0.2, 0.8), IN_PROFILE);
}

/// Strands of one segment, and balls, that glow or stand in the way.
fn rounds(material: u32, strands: bool, builder: &mut Builder) {
    let points = vec![[-0.3, 0.6, 0.0], [0.3, 0.7, 0.1]];
    let strands = if strands { vec![Strand { end: 2, closed: false }] } else { Vec::new() };
    builder.rounds(RoundsDesc { points, radii: vec![0.15, 0.2], strands, ..RoundsDesc::default() }, material);
}

/// A ball that grows evenly covers a place for the share of the time in which it is large enough; so does the end of a
/// strand.
#[test]
fn rounds_grow_while_the_shutter_is_open() {
    let (small, large) = (0.1, 0.6);
    for strands in [false, true] {
        let mut builder = Builder::default();
        let material = builder.material(glow(1.0));
        let radius = |share: f64| (small + (large - small) * share) as f32;
        // The strand leads away from the camera, behind its first ball.
        let points = if strands { vec![[0.0; 3], [0.0, 0.0, -0.01]] } else { vec![[0.0; 3]] };
        let strands = if strands { vec![Strand { end: 2, closed: false }] } else { Vec::new() };
        let (motion, count) = (keys(2, |_| points.clone()), points.len());
        let radii_motion = [0.0, 1.0].map(|share| vec![radius(share); count]).to_vec();
        let radii = vec![radius(FRAME); count];
        let rounds = RoundsDesc { points, radii, strands, motion, radii_motion, ..RoundsDesc::default() };
        builder.rounds(rounds, material);
        look(&mut builder, DAffine3::IDENTITY);
        let found = picture(&builder.desc, SIZE, &boxed("combined", 2048));
        let covered = |x: f64, y: f64| ((large - x.hypot(y)) / (large - small)).clamp(0.0, 1.0);
        let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(SIZE) - 1.0;
        let middle = SIZE / 2;
        let expected: Vec<f64> = (0..SIZE).map(|x| covered(place(x), place(middle))).collect();
        // But for the pixels in which the smallest ball ends.
        let of = |row: Vec<f64>| -> Vec<f64> { row[middle as usize + 3..].to_vec() };
        assert_near("grown", &of(row(&found, "Combined", 0, middle)), &of(expected), 2048.0);
    }
}

/// Scenes with the one thing that moves last, in every kind of shape, and its movement.
fn moving_things(base: &Builder, material: &MaterialDesc) -> Vec<(String, Builder)> {
    let mut list = Vec::new();
    for kind in ["square", "strand", "balls"] {
        let mut builder = base.clone();
        let material = builder.material(material.clone());
        match kind {
            "square" => builder.quad([-0.4, 0.6, -0.3], [0.6, 0.2, 0.0], [0.0, 0.0, 0.6], material),
            kind => rounds(material, kind == "strand", &mut builder),
        }
        list.push((kind.to_string(), builder));
    }
    list
}

fn flight(share: f64) -> DAffine3 {
    let turn = DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.6 * share);
    DAffine3::from_translation(DVec3::new(0.8 * share - 0.4, 0.3 * share, 0.0))
        * turn
        * DAffine3::from_scale(DVec3::splat(1.0 + 0.5 * share))
}

/// `desc` with its last thing where it is when `share` of the time has passed.
fn stopped(desc: &SceneDesc, share: f64) -> SceneDesc {
    let mut desc = desc.clone();
    desc.instances.last_mut().unwrap().transform = flight(share);
    desc
}

/// `desc` with its last thing on its flight, as a transform or as points that move.
fn flying(desc: &SceneDesc, deforms: bool) -> SceneDesc {
    let mut desc = stopped(desc, FRAME);
    if !deforms {
        desc.instances.last_mut().unwrap().motion = keys(2, flight);
        return desc;
    }
    // Straight lines between many keys are near the arc; radii do not move.
    let at = |points: &[[f32; 3]], share: f64| -> Vec<[f32; 3]> {
        let place = flight(share);
        points.iter().map(|p| place.transform_point3(DVec3::from(p.map(f64::from))).as_vec3().to_array()).collect()
    };
    let instance = desc.instances.last_mut().unwrap();
    instance.transform = DAffine3::IDENTITY;
    let mut mesh = (**desc.meshes.last().unwrap()).clone();
    let points = mesh.points.clone();
    mesh.motion = keys(17, |share| at(&points, share));
    mesh.points = at(&points, FRAME);
    *desc.meshes.last_mut().unwrap() = mesh.into();
    desc
}

fn mean_over(passes: &str, layer: &'static str, desc: &SceneDesc, spp: u32) -> f64 {
    mean(&picture(desc, SIZE, &boxed(passes, spp)), layer, 0)
}

#[test]
fn light_of_what_moves_is_the_mean_of_all_instants() {
    let mut base = Builder::default();
    let ground = base.lambert(0.8);
    base.ground(10.0, ground);
    look(&mut base, DAffine3::from_rotation_x(-0.5 * PI));
    for (kind, builder) in moving_things(&base, &glow(3.0)) {
        let mut desc = builder.desc;
        desc.instances.last_mut().unwrap().visibility = Visibility { camera: false, ..Visibility::ALL };
        let of = |picture: &Picture| vec![mean(picture, "Combined", 0)];
        let expected = mean_of_instants(32, 32, "combined", |share| stopped(&desc, share), of)[0];
        for deforms in [false, true] {
            if deforms && kind != "square" {
                continue;
            }
            let desc = flying(&desc, deforms);
            for selection in ["tree", "power"] {
                let mut settings = boxed("combined", 512);
                let defs = penumbra::settings::SETTINGS;
                defs.iter().find(|d| d.name == "light_selection").unwrap().set(&mut settings, selection).unwrap();
                let found = mean(&picture(&desc, SIZE, &settings), "Combined", 0);
                close(&format!("{kind}, deforms: {deforms}, {selection}"), found, expected, 4e-3);
            }
        }
    }
}

#[test]
fn openness_beside_what_moves_is_the_mean_of_all_instants() {
    let mut base = Builder::default();
    let ground = base.lambert(0.8);
    base.ground(10.0, ground);
    look(&mut base, DAffine3::from_rotation_x(-0.5 * PI));
    for (kind, builder) in moving_things(&base, &glow(0.0)) {
        let mut desc = builder.desc;
        desc.instances.last_mut().unwrap().visibility = Visibility { camera: false, ..Visibility::ALL };
        let of = |picture: &Picture| vec![mean(picture, "Ambient Occlusion", 0)];
        let expected = mean_of_instants(32, 32, "ao", |share| stopped(&desc, share), of)[0];
        assert!(expected < 0.95, "{kind} hides nothing: {expected}");
        close(&kind, mean_over("ao", "Ambient Occlusion", &flying(&desc, false), 512), expected, 2e-3);
        if kind == "square" {
            close("deformed", mean_over("ao", "Ambient Occlusion", &flying(&desc, true), 512), expected, 2e-3);
        }
    }
}

/// More lamps than are weighed one by one, so that a tree over their ways is asked.
#[test]
fn many_lights_that_move_are_found_by_their_ways() {
    let mut builder = Builder::default();
    let ground = builder.lambert(0.8);
    builder.ground(10.0, ground);
    look(&mut builder, DAffine3::from_rotation_x(-0.5 * PI));
    let material = builder.material(glow(3.0));
    let place = |i: u32, share: f64| {
        let (x, z) = (f64::from(i % 7) - 3.0, f64::from(i / 7) - 3.0);
        DAffine3::from_translation(DVec3::new(0.5 * x + share, 0.4, 0.5 * z)) * DAffine3::from_rotation_x(2.0 * share)
    };
    let quad = |builder: &mut Builder| builder.quad([-0.1, 0.0, -0.1], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2], material);
    (0..49).for_each(|_| quad(&mut builder));
    let at = |share: f64| {
        let mut desc = builder.desc.clone();
        for (i, instance) in desc.instances[1..].iter_mut().enumerate() {
            instance.transform = place(i as u32, share);
            instance.visibility = Visibility { camera: false, ..Visibility::ALL };
        }
        desc
    };
    let of = |picture: &Picture| vec![mean(picture, "Combined", 0)];
    let expected = mean_of_instants(32, 32, "combined", at, of)[0];
    let mut desc = at(FRAME);
    for (i, instance) in desc.instances[1..].iter_mut().enumerate() {
        instance.motion = keys(2, |share| place(i as u32, share));
    }
    close("49 lamps", mean_over("combined", "Combined", &desc, 512), expected, 4e-3);
}

#[test]
fn smooth_surfaces_shade_alike_however_they_turn() {
    let mut builder = Builder::default();
    let material = builder.lambert(0.7);
    builder.sphere(12, true, material, DAffine3::from_scale(DVec3::new(0.8, 0.4, 0.8)));
    let kind = LightKind::Distant { irradiance: [PI; 3], angle: 0.1 };
    builder.light(kind, DAffine3::from_rotation_y(0.7));
    look(&mut builder, DAffine3::IDENTITY);
    let turn = |share: f64| DAffine3::from_rotation_z(1.2 * (share - FRAME));
    let mut by_transform = builder.desc.clone();
    let shape = by_transform.instances[0].transform;
    by_transform.instances[0].motion = keys(2, |share| turn(share) * shape);
    let mut by_points = builder.desc.clone();
    let mut mesh = (*by_points.meshes[0]).clone();
    let points = mesh.points.clone();
    // In object space, which is squashed.
    mesh.motion = keys(33, |share| {
        let place = shape.inverse() * turn(share) * shape;
        points.iter().map(|p| place.transform_point3(DVec3::from(p.map(f64::from))).as_vec3().to_array()).collect()
    });
    by_points.meshes[0] = mesh.into();
    let settings = boxed("combined,normal", 256);
    let [a, b] = [by_transform, by_points].map(|desc| picture(&desc, SIZE, &settings));
    for layer in ["Combined", "Normal"] {
        let [a, b] = [&a, &b].map(all_of(layer));
        let off = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum::<f64>() / a.len() as f64;
        assert!(off < 2e-3, "{layer}: {off}");
        assert!(a.iter().any(|v| v.abs() > 0.2));
    }
}

#[test]
fn one_ray_passes_show_the_middle_of_the_shutter() {
    // At −0.5 to 0 when it opens, at 0.5 to 1 when it closes.
    for (how, desc) in movements(-0.5, 0.0, 1.0) {
        let found = picture(&desc, SIZE, &boxed("depth,object_index", 4));
        let covered: Vec<f64> = (0..SIZE).map(|x| f64::from(u8::from((SIZE / 2..SIZE * 3 / 4).contains(&x)))).collect();
        assert_near(how, &row(&found, "Object Index", 0, SIZE / 2), &covered, 1e12);
        let depth = row(&found, "Depth", 0, SIZE / 2);
        assert!(depth.iter().zip(covered).all(|(&d, covered)| (d < 1e3) == (covered == 1.0)), "{how}: {depth:?}");
    }
}

fn bits(desc: &SceneDesc, settings: &Settings) -> Vec<u32> {
    let picture = picture(desc, 16, settings);
    picture.layers.iter().flat_map(|layer| layer.data.iter().map(|v| v.to_bits())).collect()
}

fn effect_is_on(desc: &SceneDesc, settings: &Settings) -> bool {
    let view = View { camera: None, size: Some([4, 4]) };
    prepare(desc.clone(), &view, settings).unwrap().scene.effects.motion_blur
}

#[test]
fn what_does_not_move_is_as_without_a_shutter() {
    let mut builder = sunny(0.5);
    let glowing = builder.material(glow(1.0));
    builder.quad([-0.7, 0.5, -0.5], [0.5, 0.0, 0.0], [0.0, 0.0, 1.0], glowing);
    rounds(glowing, true, &mut builder);
    let still = builder.desc;
    let settings = settings("combined,ao,shadow,normal", 8);
    let mut shut = still.clone();
    shut.cameras[0].shutter = [0.0; 2];
    let expected = bits(&shut, &settings);
    let mut scenes = vec![("open", still.clone())];
    let mut with = |what, change: &dyn Fn(&mut SceneDesc)| {
        let mut desc = still.clone();
        change(&mut desc);
        scenes.push((what, desc));
    };
    with("equal keys", &|desc| {
        for i in 0..desc.instances.len() {
            desc.instances[i].motion = keys(3, |_| desc.instances[i].transform);
        }
        let camera = &mut desc.cameras[0];
        camera.motion = keys(2, |_| camera.transform);
        let mut mesh = (*desc.meshes[1]).clone();
        mesh.motion = keys(4, |_| mesh.points.clone());
        desc.meshes[1] = mesh.into();
        let mut rounds = (*desc.rounds[0]).clone();
        rounds.motion = keys(2, |_| rounds.points.clone());
        desc.rounds[0] = rounds.into();
    });
    let moves = |desc: &mut SceneDesc| {
        desc.instances[1].motion = keys(2, |share| along(share) * desc.instances[1].transform);
        let mut rounds = (*desc.rounds[0]).clone();
        rounds.motion = keys(2, |share| rounds.points.iter().map(|p| [p[0] + share as f32, p[1], p[2]]).collect());
        desc.rounds[0] = rounds.into();
    };
    with("the shutter is shut", &|desc| {
        moves(desc);
        desc.cameras[0].shutter = [0.1; 2];
    });
    with("it stands still while it is open", &|desc| {
        let place = desc.instances[1].transform;
        let times = [-3.0, -1.0, 1.0, 2.0];
        let values = [along(2.0), place, place, along(-3.0)];
        desc.instances[1].motion = times.into_iter().zip(values).map(|(time, value)| Motion { time, value }).collect();
    });
    for (what, desc) in &scenes {
        assert!(!effect_is_on(desc, &settings), "{what}");
        assert!(bits(desc, &settings) == expected, "{what}");
        assert!(bits(desc, &Settings { effects: EffectsMode::All, ..settings.clone() }) == expected, "{what}, all");
    }
    let mut moving = still.clone();
    moves(&mut moving);
    assert!(effect_is_on(&moving, &settings));
    assert!(bits(&moving, &settings) != expected);
    assert!(bits(&moving, &Settings { effects: EffectsMode::All, ..settings.clone() }) == bits(&moving, &settings));
    let off = Settings { motion_blur: false, ..settings.clone() };
    assert!(!effect_is_on(&moving, &off) && bits(&moving, &off) == expected);
    // What no ray meets has no part in it.
    for instance in &mut moving.instances[1..] {
        instance.visibility =
            Visibility { camera: false, diffuse: false, glossy: false, transmission: false, shadow: false };
        instance.materials = vec![Some(0)];
    }
    assert!(!effect_is_on(&moving, &settings));
}

/// Instances of a PointInstancer that velocities move, and one that moves with all of them.
#[test]
fn instances_of_usd_move_by_their_velocities() {
    let file = |velocities: &str, xform: &str| {
        format!(
            r#"#usda 1.0
( upAxis = "Y"
  metersPerUnit = 1
  timeCodesPerSecond = 2 )
def Camera "C" {{
  double shutter:open = -0.5
  double shutter:close = 0.25
  token projection = "orthographic"
  float horizontalAperture = 20
  float verticalAperture = 20
  double3 xformOp:translate = (0, 0, 5)
  uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def Xform "All" {{
  {xform}
  uniform token[] xformOpOrder = ["xformOp:translate"]
  def PointInstancer "P" {{
    rel prototypes = </All/P/Square>
    int[] protoIndices = [0, 0]
    point3f[] positions.timeSamples = {{ 0: [(0, 0, 0), (50, 0, 0)] }}
    {velocities}
    def Mesh "Square" {{
      int[] faceVertexCounts = [4]
      int[] faceVertexIndices = [0, 1, 2, 3]
      point3f[] points = [(-0.25, -0.5, 0), (0.25, -0.5, 0), (0.25, 0.5, 0), (-0.25, 0.5, 0)]
      rel material:binding = </Glow>
    }}
  }}
}}
def Material "Glow" {{
  token outputs:surface.connect = </Glow/S.outputs:surface>
  def Shader "S" {{
    uniform token info:id = "UsdPreviewSurface"
    color3f inputs:emissiveColor = (1, 1, 1)
    color3f inputs:diffuseColor = (0, 0, 0)
    token outputs:surface
  }}
}}
"#
        )
    };
    let still = "double3 xformOp:translate = (0, 0, 0)";
    // Half a second is a frame: 2 per second is 1 per frame, for three quarters of one.
    let by_velocity = file("vector3f[] velocities.timeSamples = { 0: [(2, 0, 0), (0, 0, 0)] }", still);
    let by_parent = file("", "double3 xformOp:translate.timeSamples = { -1: (-1, 0, 0), 1: (1, 0, 0) }");
    let halves = file(
        "vector3f[] velocities.timeSamples = { 0: [(1, 0, 0), (0, 0, 0)] }",
        "double3 xformOp:translate.timeSamples = { -1: (-0.5, 0, 0), 1: (0.5, 0, 0) }",
    );
    let expected = trapezoid(-0.25 - 0.5, 0.25 - 0.5, 0.75);
    for (what, text) in [("velocities", by_velocity), ("parent", by_parent), ("both", halves)] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moving.usda");
        std::fs::write(&path, text).unwrap();
        let options = penumbra::import::ImportOptions { frame: Some(0.0), ..Default::default() };
        let mut warnings = penumbra::error::Warnings::new();
        let desc = penumbra::import::scene(&path, &options, &mut warnings).unwrap();
        let found = picture(&desc, SIZE, &boxed("combined", SPP));
        assert_near(what, &profile(&found, "Combined", 0), &expected, IN_PROFILE);
    }
}

/// Tangents of half the field of view go straight from 1 to 2: a pixel sees the square while its own tangent times that is
/// within half of the square's size.
#[test]
fn a_zoom_is_blurred() {
    let frame = |share: f64| ProjectionDesc::Perspective { fov_y: 2.0 * (1.0 + share).atan(), aspect: Some(1.0) };
    let mut desc = square(-0.5, 0.5).desc;
    (desc.cameras[0].projection, desc.cameras[0].zoom) = (frame(FRAME), keys(3, frame));
    let blurred = picture(&desc, SIZE, &boxed("combined", SPP));
    let pixel = 2.0 / f64::from(SIZE);
    let seen = |x: f64| (0.5 / x.abs().max(1e-9) - 1.0).clamp(0.0, 1.0);
    let of_pixel =
        |i: u32| (0..64).map(|k| seen(-1.0 + pixel * (f64::from(i) + (f64::from(k) + 0.5) / 64.0))).sum::<f64>() / 64.0;
    let expected: Vec<f64> = (0..SIZE).map(of_pixel).collect();
    // Rows that see the square all the time.
    for y in [14, 15, 16, 17] {
        assert_near("zoom", &row(&blurred, "Combined", 0, y), &expected, f64::from(SPP));
    }
    let parallel = |share: f64| ProjectionDesc::Orthographic { half_width: 1.0 + share, half_height: 1.0 + share };
    (desc.cameras[0].projection, desc.cameras[0].zoom) = (parallel(FRAME), keys(3, parallel));
    let sharp = picture(&desc, SIZE, &boxed("combined", 16));
    assert!(row(&sharp, "Combined", 0, 16).iter().filter(|v| **v > 0.01 && **v < 0.99).count() <= 2);
}
