//! Surfaces that are too small, too large, too far, too thin, flat, doubled or on top of each other.

use std::f64::consts::{FRAC_PI_2, PI};

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, MeshDesc, RoundsDesc, ScalarInput, VolumeDesc};
use penumbra::error::{Place, Warnings};
use penumbra::import::{ImportOptions, gltf};
use penumbra::math::{DAffine3, DMat3, DVec3};
use serde_json::json;

use crate::glb::Glb;
use crate::row::{Row, hold};
use crate::scene::{Builder, mean};
use crate::truth::polygon;

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

/// The camera, `distance` metres from the middle instead of one.
fn from(scene: &mut Builder, distance: f64) {
    scene.desc.cameras[0].transform.translation *= distance;
}

/// A sun of irradiance π, `tilt` from the zenith.
fn sun(scene: &mut Builder, tilt: f64) {
    let kind = LightKind::Distant { irradiance: [PI; 3], angle: 0.0 };
    scene.light(kind, DAffine3::from_rotation_x(tilt - FRAC_PI_2));
}

/// A ball of light of radius 0.2 at a height of 1 above a white floor of 20, everything times `scale`: irradiance over
/// π is the square of its radius.
fn ball_above_floor(scale: f64) -> Builder {
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(10.0 * scale, white);
    let kind = LightKind::Sphere { radius: 0.2 * scale, radiance: [25.0; 3], facing: false };
    scene.light(kind, DAffine3::from_translation(DVec3::Y * scale));
    scene.look([0.0; 3], [0.3, -1.0, 0.2], 1e-3 * scale);
    from(&mut scene, scale);
    scene
}

fn direct(name: impl Into<String>, scene: Builder, spp: u32, truth: f64, tolerance: f64) -> Row {
    Row::new(name, scene, "Diffuse Direct", spp, truth, tolerance)
}

#[test]
fn scales_and_places() {
    let mut rows = Vec::new();
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9] {
        let row =
            direct(format!("floor under a ball of light, scale {scale:e}"), ball_above_floor(scale), 256, 1.0, 1e-4);
        rows.push(row.moved(Some(crate::row::MOVED * scale.max(1.0))));
    }
    for away in [1e6, 1e7] {
        let at = DVec3::new(0.6, -0.48, 0.64) * away;
        let row = direct(
            format!("floor under a ball of light, {away:e} m from the origin"),
            ball_above_floor(1.0),
            256,
            1.0,
            1e-4,
        );
        rows.push(row.moved(Some(at)));
    }
    // Vertices a kilometre off that their object's transform brings back.
    let mut scene = ball_above_floor(1.0);
    let instance = &mut scene.desc.instances[0];
    let mesh = std::sync::Arc::make_mut(&mut scene.desc.meshes[0]);
    mesh.points.iter_mut().for_each(|p| *p = [p[0] + 1024.0, p[1] + 2048.0, p[2] - 1024.0]);
    instance.transform = DAffine3::from_translation(DVec3::new(-1024.0, -2048.0, 1024.0));
    rows.push(direct("vertices 2.5 km off, brought back by their object", scene, 256, 1.0, 1e-4));
    hold("scales", rows);
}

#[test]
fn faces_in_one_place() {
    let mut rows = Vec::new();
    let tilt = 0.5_f64;
    let pair = |cover: DAffine3| {
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(1.0, white);
        let mesh = scene.desc.meshes[0].as_ref().clone();
        scene.instance(mesh, white, cover);
        sun(&mut scene, tilt);
        scene.look([0.01, 0.0, 0.02], DOWN, 0.1);
        scene
    };
    for gap in [0.0, 1e-7, 1e-6, 1e-5, 1e-4] {
        let scene = pair(DAffine3::from_translation(DVec3::Y * gap));
        rows.push(direct(format!("two faces, {gap:e} m apart, under a sun"), scene, 16, tilt.cos(), 1e-5));
    }
    for lean in [1e-7_f64, 1e-6, 1e-4] {
        // Turned about a line well aside of what is seen, so that the cover is above.
        let about = DAffine3::from_translation(DVec3::X * -0.5);
        let scene = pair(about * DAffine3::from_rotation_z(lean) * about.inverse());
        rows.push(direct(format!("two faces that lean by {lean:e}"), scene, 16, tilt.cos(), 2e-4));
    }
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    let h = 1.0;
    // The same triangle many times, among those that are points and lines.
    let points = vec![[-h, 0.0, h], [3.0 * h, 0.0, h], [-h, 0.0, -3.0 * h], [0.0, 0.0, 0.0]];
    let mut triangles = vec![[0, 1, 2]; 1000];
    triangles.extend(vec![[0, 0, 0]; 5000]);
    triangles.extend(vec![[0, 3, 3]; 5000]);
    scene.mesh(points, triangles, white, DAffine3::IDENTITY);
    sun(&mut scene, tilt);
    scene.look([0.01, 0.0, 0.02], DOWN, 0.1);
    rows.push(direct("1,000 triangles in one place and 10,000 without area", scene, 16, tilt.cos(), 1e-5));

    // 10⁵ instances, all over each other.
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(1.0, white);
    let instance = scene.desc.instances[0].clone();
    scene.desc.instances = vec![instance; 100_000];
    sun(&mut scene, tilt);
    scene.look([0.01, 0.0, 0.02], DOWN, 0.1);
    rows.push(direct("100,000 instances in one place", scene, 4, tilt.cos(), 1e-5).sized(2, 2));
    hold("coincident", rows);
}

#[test]
fn grazing_and_thin() {
    let mut rows = Vec::new();
    for degrees in [89.0_f64, 89.99, 89.999] {
        let tilt = degrees.to_radians();
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(10.0, white);
        sun(&mut scene, tilt);
        scene.look([0.0; 3], DOWN, 0.1);
        rows.push(direct(format!("sun {degrees} degrees from the zenith"), scene, 16, tilt.cos(), 1e-3));

        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(10.0, white);
        scene.dome(1.0);
        scene.look([0.0; 3], [tilt.sin(), -tilt.cos(), 0.0], 1e-6);
        rows.push(direct(
            format!("floor in a white world, seen {degrees} degrees from its normal"),
            scene,
            256,
            1.0,
            1e-3,
        ));
    }
    // A floor of strips: 1 µm wide and 1 m long, each cut along its diagonal.
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    let count = 1000_u32;
    let points = (0..=count).flat_map(|i| {
        let x = (f64::from(i) - 0.5 * f64::from(count)) * 1e-6;
        [[x as f32, 0.0, 0.5], [x as f32, 0.0, -0.5]]
    });
    let triangles = (0..count).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]);
    scene.mesh(points.collect(), triangles.collect(), white, DAffine3::IDENTITY);
    sun(&mut scene, 0.5);
    scene.look([0.0, 0.0, 0.1], DOWN, 4e-4);
    rows.push(
        direct("floor of 2,000 needles, 1 m long and 1 um wide", scene.clone(), 64, 0.5_f64.cos(), 1e-5).sized(16, 16),
    );
    let holes = Row::new("the same floor: alpha", scene, "Combined", 64, 1.0, 0.0).sized(16, 16);
    rows.push(holes.by(|picture, _| mean(picture, "Combined", 3)));
    hold("thin", rows);
}

#[test]
fn transforms() {
    let mut rows = Vec::new();
    let placed = |matrix: DMat3, unit: f64| {
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(unit, white);
        scene.desc.instances[0].transform = DAffine3::from_mat3(matrix);
        sun(&mut scene, 0.5);
        scene.look([0.0; 3], DOWN, 1e-3);
        scene
    };
    let truth = 0.5_f64.cos();
    for (name, matrix, unit) in [
        ("mirrored", DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)), 10.0),
        ("turned inside out", DMat3::from_diagonal(DVec3::splat(-1.0)), 10.0),
        ("of 1e8 m, scaled by 1e-8", DMat3::from_diagonal(DVec3::splat(1e-8)), 1e9),
        ("of 1e-8 m, scaled by 1e8", DMat3::from_diagonal(DVec3::splat(1e8)), 1e-7),
        ("scaled to 0 along its normal", DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0)), 10.0),
        ("scaled by 1e6 and 1e-6", DMat3::from_diagonal(DVec3::new(1e6, 1.0, 1e-6)), 1e4),
        ("sheared by 1000", DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(1000.0, 0.0, 1.0)), 1e4),
    ] {
        rows.push(direct(format!("floor {name}"), placed(matrix, unit), 16, truth, 1e-5));
    }
    // What has no volume and no area is not there.
    let mut scene = placed(DMat3::IDENTITY, 10.0);
    let mesh = scene.desc.meshes[0].as_ref().clone();
    for matrix in [DMat3::ZERO, DMat3::from_diagonal(DVec3::X), DMat3::from_cols(DVec3::X, DVec3::X, DVec3::X)] {
        scene.instance(mesh.clone(), 0, DAffine3::from_mat3_translation(matrix, DVec3::Y * 0.5));
    }
    rows.push(direct("beside instances that are points and lines", scene, 16, truth, 1e-5));

    let mut scene = placed(DMat3::IDENTITY, 10.0);
    scene.desc.instances[0].transform = chain(720);
    rows.push(direct("at the end of a chain of 720 nodes of a glTF file", scene, 16, truth, 1e-5));
    hold("transforms", rows);
}

/// Where a file puts a mesh under so many nodes, each a degree and a metre on from the one that holds it: after every
/// 360 where it began.
fn chain(count: usize) -> DAffine3 {
    let mut glb = Glb::triangle();
    let (sin, cos) = 0.5_f64.to_radians().sin_cos();
    for i in 0..count {
        glb.push("nodes", json!({"rotation": [0, sin, 0, cos], "translation": [1, 0, 0], "children": [i]}));
    }
    glb.push("scenes", json!({"nodes": [count]}));
    glb.set("/scene", json!(0));
    let (place, options, mut warnings) = (Place::default(), ImportOptions::default(), Warnings::new());
    let desc = gltf::from_bytes(&glb.bytes(), None, &place, &options, &mut warnings).unwrap();
    assert_eq!(desc.instances.len(), 1);
    desc.instances[0].transform
}

/// The share of the sky that a wall 1 m high leaves open to the floor beside it.
#[test]
fn occlusion() {
    let mut rows = Vec::new();
    for (size, away) in [(20.0, 1e-5), (20.0, 1e-3), (2000.0, 1e-3), (2000.0, 1e-4)] {
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(0.3 * size, white);
        let corners =
            [[-0.37, 0.0], [0.63, 0.0], [0.63, 1.0], [-0.37, 1.0]].map(|[x, y]| DVec3::new(x * size, y, -away));
        scene.quad(corners[0].into(), [size, 0.0, 0.0], [0.0, 1.0, 0.0], white);
        scene.look([0.0; 3], DOWN, 0.1 * away);
        let truth = 1.0 - polygon(&corners, DVec3::ZERO, DVec3::Y);
        let name = format!("ambient occlusion {away:e} m from a wall of {size} m");
        let row = Row::new(name, scene, "Ambient Occlusion", 4096, truth, 2e-3);
        rows.push(row);
    }
    hold("occlusion", rows);
}

/// A floor of 200 km and a million specks of a millimetre that cover a quarter of what is seen.
#[test]
fn stadium() {
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(1e5, white);
    let side = 50_u32;
    let mut mesh = MeshDesc::default();
    for i in 0..side * side {
        let [x, z] = [i % side, i / side].map(|k| (2 * k) as f32 * 1e-3);
        let first = mesh.points.len() as u32;
        mesh.points.extend([[x, 0.0, z], [x + 1e-3, 0.0, z], [x + 1e-3, 0.0, z + 1e-3], [x, 0.0, z + 1e-3]]);
        mesh.triangles.extend([[first, first + 2, first + 1], [first, first + 3, first + 2]]);
    }
    // 20 × 20 patches of 2,500 squares.
    scene.desc.meshes.push(mesh.into());
    let shape = penumbra::desc::ShapeRef::Mesh(1);
    for i in 0..400 {
        let [x, z] = [i % 20, i / 20].map(|k| f64::from(k) * 0.1 - 1.0);
        let mut instance = scene.desc.instances[0].clone();
        (instance.shape, instance.transform) = (shape, DAffine3::from_translation(DVec3::new(x, 0.5, z)));
        scene.desc.instances.push(instance);
    }
    sun(&mut scene, 0.0);
    scene.look([0.0, 0.0, 0.0], DOWN, 0.5);
    // The camera looks the way of the light: what a speck shades it hides, too.
    let row = direct("a million specks of 1 mm above a floor of 200 km, seen from the sun", scene, 256, 1.0, 2e-3);
    hold("stadium", vec![row.sized(32, 32)]);
}

/// The largest distance of what is hit from the true surface of a ball of light-grey, in radii.
#[test]
fn balls() {
    let mut rows = Vec::new();
    for radius in [1e-5, 1.0, 1e6] {
        for away in [2.0, 1e3, 1e6] {
            let mut scene = Builder::default();
            let white = scene.lambert(1.0);
            let rounds = RoundsDesc { points: vec![[0.0; 3]], radii: vec![radius as f32], ..RoundsDesc::default() };
            scene.rounds(rounds, white);
            scene.dome(1.0);
            scene.look([0.0; 3], [0.0, 0.0, -1.0], 0.999 * radius);
            scene.desc.cameras[0].transform.translation *= radius * away;
            let row = Row::new(
                format!("ball of radius {radius:e} m, seen from {away:e} radii: radiance in a white world"),
                scene,
                "Diffuse Direct",
                64,
                1.0,
                1e-3,
            );
            rows.push(
                row.sized(16, 16).moved(Some(crate::row::MOVED * radius.min(1.0))).by(|picture, _| covered(picture)),
            );
        }
    }
    hold("balls", rows);
}

/// The mean of diffuse light where the ball fills the pixel.
fn covered(picture: &penumbra::film::Picture) -> f64 {
    let values = picture.layer("Diffuse Direct").unwrap().data.iter().step_by(3).map(|v| f64::from(*v));
    let lit: Vec<f64> = values.filter(|v| *v > 0.0).collect();
    assert!(lit.len() > 150, "{} pixels", lit.len());
    lit.iter().sum::<f64>() / lit.len() as f64
}

#[test]
fn cameras_within() {
    let mut rows = Vec::new();
    let glass = MaterialDesc {
        base_color: ColorInput::constant([1.0; 3]),
        roughness: ScalarInput::constant(0.0),
        transmission: ScalarInput::constant(1.0),
        volume: Some(VolumeDesc {
            thickness: ScalarInput::constant(1.0),
            attenuation_distance: f64::INFINITY,
            attenuation_color: [1.0; 3],
            adds: false,
        }),
        ..MaterialDesc::default()
    };
    let mut scene = Builder::default();
    let material = scene.material(glass);
    scene.sphere(16, false, material, DAffine3::from_scale(DVec3::splat(5.0)));
    scene.dome(1.0);
    scene.look([0.3, 0.1, 0.2], DOWN, 0.5);
    rows.push(
        Row::new("camera inside glass in a white world", scene, "Combined", 256, 1.0, 1e-3)
            .with(|settings| settings.max_bounces = 1000),
    );

    // The camera stands on the floor, to the digit, and looks up, along it and down into it.
    for (name, forward, truth) in [("up", [0.0, 1.0, 0.0], 1.0), ("into it", DOWN, 1.0)] {
        let mut scene = Builder::default();
        let white = scene.lambert(0.0);
        scene.ground(10.0, white);
        scene.dome(1.0);
        scene.look([0.0; 3], forward, 0.1);
        scene.desc.cameras[0].transform.translation = DVec3::ZERO;
        rows.push(Row::new(
            format!("camera on a black floor, looking {name}, in a white world"),
            scene,
            "Combined",
            16,
            truth,
            0.0,
        ));
    }
    hold("within", rows);
}
