//! Shadows and occlusion through the whole renderer against closed forms, block by block.

#[path = "lights/plane.rs"]
#[allow(dead_code, reason = "the tests of lights need more of it")]
mod plane;
#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{LightKind, ProjectionDesc};
use penumbra::film::Picture;
use penumbra::math::{DAffine3, DVec3, Vec3};
use penumbra::settings::Settings;
use plane::{Pose, lambert};
use scene::{Builder, close, mean, picture, settings};

/// Pixels on each side of a picture, and of a block.
const SIZE: u32 = 48;
const BLOCK: u32 = 8;

/// Samples a pixel: 64 pixels of a block then bring the scatter of a shadow's edge below a tenth of
/// what is asked.
const SPP: u32 = 512;

/// A share of full scale.
const TOLERANCE: f64 = 2e-3;

/// A lamp that shines down.
fn panel(builder: &mut Builder, width: f64, height: f64, center: DVec3) {
    let pose = Pose::down(center);
    let transform = DAffine3::from_mat3_translation(pose.axes, center);
    let radiance = [1.0; 3];
    builder.light(LightKind::Rect { width, height, radiance, spread: PI, two_sided: false, image: None }, transform);
}

/// Looks down at the ground about `target`, no more than `half` to each side.
fn look_down(builder: &mut Builder, target: [f64; 3], half: f64) {
    builder.look(target, [0.0, -1.0, 0.0], half);
}

/// Where the camera of `builder` sees the ground at `x`, `y` pixels from the top left.
fn seen(builder: &Builder, x: f64, y: f64) -> DVec3 {
    let camera = &builder.desc.cameras[0];
    let ProjectionDesc::Orthographic { half_width, half_height } = camera.projection else { panic!() };
    let screen = DVec3::new(2.0 * x / f64::from(SIZE) - 1.0, 1.0 - 2.0 * y / f64::from(SIZE), 0.0);
    let p = camera.transform.transform_point3(screen * DVec3::new(half_width, half_height, 0.0));
    DVec3::new(p.x, 0.0, p.z)
}

/// Holds each block of `layer` to `exact` at points of the ground.
fn blocks_match(what: &str, builder: &Builder, picture: &Picture, layer: &str, exact: &dyn Fn(Vec3) -> f64) {
    let layer = picture.layer(layer).unwrap();
    let (mut worst, mut place, mut squares) = (0.0_f64, [0, 0], 0.0);
    for (by, bx) in (0..SIZE / BLOCK).flat_map(|y| (0..SIZE / BLOCK).map(move |x| (y, x))) {
        let (mut found, mut expected) = (0.0, 0.0);
        for (j, i) in (0..BLOCK).flat_map(|j| (0..BLOCK).map(move |i| (j, i))) {
            let (x, y) = (bx * BLOCK + i, by * BLOCK + j);
            found += f64::from(layer.data[3 * (y * SIZE + x) as usize]);
            // The filter is three pixels wide and smooth; so is what it filters, but for two lines.
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                expected += 0.25 * exact(seen(builder, f64::from(x) + dx, f64::from(y) + dy).as_vec3());
            }
        }
        let error = (found - expected) / f64::from(BLOCK * BLOCK);
        squares += error * error;
        if error.abs() > worst.abs() {
            (worst, place) = (error, [bx, by]);
        }
    }
    let rms = (squares / f64::from((SIZE / BLOCK).pow(2))).sqrt();
    println!("{what}: worst block {worst:.1e}, rms {rms:.1e}");
    assert!(worst.abs() < TOLERANCE, "{what}: block {place:?} is off by {worst}");
}

#[test]
fn the_penumbra_of_a_half_plane_is_the_share_of_the_panel_seen() {
    let (lamp, edge) = (3.0, 1.5);
    let mut builder = Builder::default();
    let white = builder.lambert(0.8);
    builder.ground(50.0, white);
    panel(&mut builder, 1.0, 1.0, DVec3::new(0.0, lamp, 0.1));
    // All of x > 0.
    builder.quad([0.0, edge, -100.0], [100.0, 0.0, 0.0], [0.0, 0.0, 200.0], white);
    look_down(&mut builder, [0.03, 0.0, -0.2], 0.7);
    let irradiance = |p: Vec3, [from, to]: [f64; 2]| {
        let corners = [[from, -0.4], [to, -0.4], [to, 0.6], [from, 0.6]].map(|[x, z]| DVec3::new(x, lamp, z));
        if to > from { lambert(&corners, p, Vec3::Y) } else { 0.0 }
    };
    let exact = |p: Vec3| {
        // The ray over the edge meets the panel's plane here.
        let cut = f64::from(p.x) * (1.0 - lamp / edge);
        irradiance(p, [-0.5, cut.min(0.5)]) / irradiance(p, [-0.5, 0.5])
    };
    assert_eq!((exact(Vec3::X * -0.6), exact(Vec3::X * 0.6)), (1.0, 0.0));
    let picture = picture(&builder.desc, SIZE, &settings("shadow", SPP));
    blocks_match("penumbra", &builder, &picture, "Shadow", &exact);
}

#[test]
fn occlusion_beside_a_wall_is_its_form_factor() {
    let mut builder = Builder::default();
    let white = builder.lambert(0.8);
    builder.ground(50.0, white);
    builder.quad([0.0, 0.0, -0.7], [0.0, 0.6, 0.0], [0.0, 0.0, 1.2], white);
    // From the wall's foot on.
    look_down(&mut builder, [0.45, 0.0, 0.1], 0.44);
    let wall = [[0.0, -0.7], [0.6, -0.7], [0.6, 0.5], [0.0, 0.5]].map(|[y, z]| DVec3::new(0.0, y, z));
    let picture = picture(&builder.desc, SIZE, &settings("ao", SPP));
    blocks_match("wall", &builder, &picture, "Ambient Occlusion", &|p| 1.0 - lambert(&wall, p, Vec3::Y) / PI);
}

#[test]
fn a_panel_that_touches_the_ground_lights_it_with_its_radiance() {
    for (k, bounces) in (1..=5).flat_map(|k| [(k, 0), (k, 4)]) {
        let h = 10.0_f64.powi(-k);
        let mut builder = Builder::default();
        let floor = builder.lambert(0.5);
        builder.ground(10.0, floor);
        panel(&mut builder, 1.0, 1.0, DVec3::new(0.0, h, 0.0));
        look_down(&mut builder, [0.1237, 0.0, 0.0412], 1e-3);
        let corners = Pose::down(DVec3::Y * h).corners([0.5, 0.5]);
        let exact = lambert(&corners, Vec3::new(0.1237, 0.0, 0.0412), Vec3::Y) / PI;
        let settings = Settings { max_bounces: bounces, ..settings("diffuse_direct,shadow", 1024) };
        let picture = picture(&builder.desc, 8, &settings);
        let found = mean(&picture, "Diffuse Direct", 0);
        println!("panel at {h:e}: {found}, {exact}");
        close(&format!("panel at {h:e}, {bounces} bounces"), found, exact, 1e-3);
        assert_eq!(mean(&picture, "Shadow", 0), 1.0, "panel at {h:e}");
    }
}

/// A key three metres up and a fill behind a slat, which are `ratio` to one in power; both groups' names.
fn key_and_fill(ratio: f64) -> Builder {
    let mut builder = Builder::default();
    let white = builder.lambert(0.8);
    builder.ground(50.0, white);
    let mut lamp = |group: &str, center: DVec3, side: f64, radiance: f64| {
        let transform = DAffine3::from_mat3_translation(Pose::down(center).axes, center);
        let [width, height] = [side; 2];
        let kind =
            LightKind::Rect { width, height, radiance: [radiance; 3], spread: PI, two_sided: false, image: None };
        builder.light(kind, transform);
        builder.desc.lights.last_mut().unwrap().links.group = Some(group.into());
    };
    lamp("key", DVec3::new(0.4, 3.0, 0.0), 1.0, ratio);
    lamp("fill", DVec3::new(0.0, 1.5, 0.0), 0.5, 4.0);
    builder.quad([-0.15, 0.7, -100.0], [0.3, 0.0, 0.0], [0.0, 0.0, 200.0], white);
    look_down(&mut builder, [0.05, 0.0, -0.1], 0.6);
    builder
}

/// Means of the blocks of a layer's first channel.
fn block_means(picture: &Picture, layer: &str) -> Vec<f64> {
    let data = &picture.layer(layer).unwrap().data;
    let blocks = (0..SIZE / BLOCK).flat_map(|y| (0..SIZE / BLOCK).map(move |x| (x, y)));
    let block = |(bx, by)| {
        let pixels = (0..BLOCK).flat_map(|j| (0..BLOCK).map(move |i| (bx * BLOCK + i, by * BLOCK + j)));
        pixels.map(|(x, y)| f64::from(data[3 * (y * SIZE + x) as usize])).sum::<f64>() / f64::from(BLOCK * BLOCK)
    };
    blocks.map(block).collect()
}

#[test]
fn the_shadow_of_a_dim_group_is_as_good_as_that_of_a_bright_one() {
    let mut wrong = Vec::new();
    for group in ["key", "fill"] {
        // How bright a light is does not matter where it is alone.
        let mut alone = key_and_fill(1.0);
        alone.desc.lights.retain(|light| light.links.group.as_deref() == Some(group));
        let truth = block_means(&picture(&alone.desc, SIZE, &settings("shadow", SPP)), "Shadow");
        for ratio in [1.0, 100.0, 1000.0] {
            let passes = settings("shadow_*", 64);
            let found = picture(&key_and_fill(ratio).desc, SIZE, &passes);
            let found = block_means(&found, &format!("Shadow_{group}"));
            let worst = found.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            println!("{group}, {ratio} to 1: worst block {worst:.1e}");
            if worst > 8e-3 {
                wrong.push(format!("{group}, {ratio} to 1: a block is off by {worst}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
