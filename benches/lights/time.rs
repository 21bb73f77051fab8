//! Seconds that a picture with 10,000 small lamps takes to a given error, by each choice of lights.

use std::f64::consts::{PI, TAU};

use penumbra::desc::LightKind;
use penumbra::math::{DAffine3, DQuat, DVec3};
use penumbra::scene::{Prepared, View, prepare};
use penumbra::settings::{LightSelection, Settings};

use crate::clock::process_seconds;
use crate::scene::Builder;
use crate::scenes::Random;

const SIZE: [u32; 2] = [48, 36];
const LAMPS: usize = 10_000;
/// Samples per pixel of the reference, and of the pictures that it judges.
const REFERENCE: u32 = 4096;
const SPP: [u32; 4] = [4, 16, 64, 256];

/// Half of them spheres, half rectangles of any direction, of 2 cm and uneven strength, above a floor
/// of 20 m with boxes and walls that stand among them.
fn lamps() -> Builder {
    let mut scene = Builder::default();
    let grey = scene.lambert(0.5);
    scene.ground(10.0, grey);
    let mut random = Random(5);
    let mut between = |from: f64, to: f64| from + (to - from) * f64::from(random.unit());
    for i in 0..60 {
        let size = if i < 50 { DVec3::new(0.6, 0.8, 0.6) } else { DVec3::new(0.1, 2.5, 6.0) };
        let [x, z] = [(); 2].map(|()| between(-9.0, 9.0));
        let turn = DQuat::from_rotation_y(between(0.0, PI));
        let side = |normal: DVec3| {
            let (a, b) = (DVec3::new(normal.z, normal.x, normal.y), DVec3::new(normal.y, normal.z, normal.x));
            [0.5 * (normal - a - b), a, b]
        };
        for normal in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
            let [corner, a, b] = side(normal).map(|v| turn * (v * size));
            let middle = DVec3::new(x, 0.5 * size.y, z);
            scene.quad((middle + corner).to_array(), a.to_array(), b.to_array(), grey);
        }
    }
    for i in 0..LAMPS {
        let place = DVec3::new(between(-10.0, 10.0), between(0.1, 3.0), between(-10.0, 10.0));
        let turn = DQuat::from_rotation_y(between(0.0, TAU)) * DQuat::from_rotation_x(between(0.0, PI));
        let radiance = [(2.0 * between(-1.0, 1.0)).exp(); 3];
        let kind = if i % 2 == 0 {
            LightKind::Sphere { radius: 0.01, radiance, facing: false }
        } else {
            LightKind::Rect { width: 0.02, height: 0.02, radiance, spread: PI, two_sided: false, image: None }
        };
        scene.light(kind, DAffine3::from_rotation_translation(turn, place));
    }
    for light in &mut scene.desc.lights {
        // Seen by the camera they would be noise that no choice changes.
        light.visibility.camera = false;
    }
    let forward = DVec3::new(0.3, -1.0, -0.6).normalize();
    scene.look((-20.0 * forward).to_array(), forward.to_array(), 7.0);
    scene
}

/// The red channel, which is like the others, and CPU seconds of its rendering.
fn picture(prepared: &Prepared, settings: &Settings) -> (Vec<f32>, f64) {
    let start = process_seconds();
    let rendered = penumbra::render::render(&prepared.scene, settings, &()).expect("threads start");
    let seconds = process_seconds() - start;
    let picture = rendered.film.develop();
    let layer = picture.layer("Combined").expect("it is asked for");
    (layer.data.iter().copied().step_by(layer.channels.len()).collect(), seconds)
}

/// Root of the mean square of the difference, relative to the mean of `truth`.
fn error(picture: &[f32], truth: &[f32]) -> f64 {
    let squares: f64 = picture.iter().zip(truth).map(|(a, b)| f64::from(a - b).powi(2)).sum();
    let sum: f64 = truth.iter().map(|v| f64::from(*v)).sum();
    (squares * truth.len() as f64).sqrt() / sum
}

pub fn run() {
    let desc = lamps().desc;
    let render = |selection: LightSelection, spp: u32, seed: u64| {
        let settings = Settings { light_selection: selection, spp, seed, max_bounces: 2, ..Settings::default() };
        let prepared = prepare(desc.clone(), &View { camera: None, size: Some(SIZE) }, &settings);
        picture(&prepared.expect("the scene is sound"), &settings)
    };
    println!("{LAMPS} lamps, {} x {} pixels, against {REFERENCE} spp by the tree", SIZE[0], SIZE[1]);
    let (truth, seconds) = render(LightSelection::Tree, REFERENCE, 1);
    println!("  reference {seconds:.1} s of CPU");
    let mut aim = None;
    for (name, selection) in
        [("tree", LightSelection::Tree), ("power", LightSelection::Power), ("uniform", LightSelection::Uniform)]
    {
        let mut points = Vec::new();
        for spp in SPP {
            let (picture, seconds) = render(selection, spp, 0);
            points.push((seconds, error(&picture, &truth)));
            println!(
                "  {name:<8}{spp:>5} spp {seconds:>8.3} s, error {:>8.3} %",
                100.0 * points.last().expect("one").1
            );
        }
        let (first, last) = (points[0], points[points.len() - 1]);
        let slope = (last.1 / first.1).ln() / (last.0 / first.0).ln();
        // Seconds to the error of the tree's longest picture, from one's own longest on.
        let (aimed, of_tree) = *aim.get_or_insert((last.1, last.0));
        let seconds = last.0 * (last.1 / aimed).powi(2);
        println!(
            "  {name:<8}slope {slope:.2}; to {:.2} %, by −1/2 from its last picture: {seconds:.1} s, {:.1} times the tree's",
            100.0 * aimed,
            seconds / of_tree
        );
    }
}
