//! Views that are too narrow, too wide, too small, empty or out of focus.

use penumbra::desc::{CameraDesc, ColorInput, LensDesc, MaterialDesc, ProjectionDesc, ScalarInput};
use penumbra::film::Picture;
use penumbra::math::DVec3;
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

use crate::row::{Found, MOVED, Row, hold, judge};
use crate::scene::{Builder, mean, settings};
use crate::truth::beyond;

/// A wall `away` metres before a camera that looks along −z from the origin.
fn wall(away: f64, projection: ProjectionDesc) -> Builder {
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    let half = 1e3 * away;
    scene.quad([-0.7 * half, -0.9 * half, -away], [2.0 * half, 0.0, 0.0], [0.0, 2.0 * half, 0.0], white);
    scene.look([0.0; 3], [0.0, 0.0, -1.0], 1.0);
    let camera = &mut scene.desc.cameras[0];
    *camera = CameraDesc { transform: penumbra::math::DAffine3::IDENTITY, projection, ..camera.clone() };
    scene
}

fn perspective(degrees: f64) -> ProjectionDesc {
    ProjectionDesc::Perspective { fov_y: degrees.to_radians(), aspect: None }
}

/// The largest distance of a pixel's position from where it should be on the wall, in halves of the picture's height.
fn astray(picture: &Picture, at: DVec3, half: [f64; 2]) -> f64 {
    let layer = picture.layer("Position").unwrap();
    let (w, h) = (f64::from(picture.width), f64::from(picture.height));
    let off = layer.data.chunks(3).enumerate().map(|(i, p)| {
        let (x, y) = (i % picture.width as usize, i / picture.width as usize);
        let x = ((2.0 * x as f64 + 1.0) / w - 1.0) * half[0];
        let y = (1.0 - (2.0 * y as f64 + 1.0) / h) * half[1];
        (f64::from(p[0]) - at.x - x).abs().max((f64::from(p[1]) - at.y - y).abs())
    });
    off.fold(0.0, f64::max) / half[1]
}

#[test]
fn projections() {
    let mut rows = Vec::new();
    let places = |name: String, scene: Builder, half: [f64; 2], moved: DVec3, tolerance: f64| {
        let row = Row::new(
            format!("{name}: largest error of a position, in halves of the picture"),
            scene,
            "Position",
            1,
            0.0,
            tolerance,
        );
        row.sized(15, 15).moved(Some(moved)).by(move |picture, at| astray(picture, at, half))
    };
    // Positions are stored in f32: the place moved to is one of which it has the digits.
    for (degrees, away, moved) in [(0.01_f64, 1000.0, DVec3::new(1.0, -2.0, 1e3)), (179.0, 1.0, MOVED)] {
        let half = away * (0.5 * degrees.to_radians()).tan();
        rows.push(places(
            format!("field of view of {degrees} degrees"),
            wall(away, perspective(degrees)),
            [half; 2],
            moved,
            1e-4,
        ));
    }
    let tiny = ProjectionDesc::Orthographic { half_width: 1e-6, half_height: 1e-6 };
    rows.push(places(
        "orthographic, 2e-6 m wide".into(),
        wall(1.0, tiny),
        [1e-6; 2],
        DVec3::new(1e-6, -1e-6, 1e3),
        1e-4,
    ));
    for aspect in [0.01, 100.0] {
        let mut scene = wall(1.0, perspective(60.0));
        scene.desc.render.framing.pixel_aspect = aspect;
        let half = 30_f64.to_radians().tan();
        rows.push(places(
            format!("pixel aspect of {aspect}"),
            scene,
            [half * aspect, half],
            DVec3::new(1.0, -2.0, 3.0),
            2e-4,
        ));
    }
    for [width, height] in [[1, 1], [32768, 8]] {
        let mut scene = wall(1.0, perspective(1.0));
        scene.dome(1.0);
        let row = Row::new(
            format!("picture of {width} x {height} of a wall in a white world"),
            scene,
            "Diffuse Direct",
            1,
            1.0,
            1e-6,
        );
        rows.push(row.sized(width, height));
    }
    hold("projections", rows);
}

/// What glows, from `edge` metres to the right of the axis on.
fn glowing(edge: f64, away: f64, lens: LensDesc) -> Builder {
    let mut scene = wall(1e6, perspective(1e-4));
    scene.desc.instances.clear();
    let glow = scene.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission: ColorInput::constant([1.0; 3]),
        ..MaterialDesc::default()
    });
    scene.quad([edge, -50.0, -away], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], glow);
    scene.desc.cameras[0].lens = Some(lens);
    scene
}

#[test]
fn lenses() {
    let mut rows = Vec::new();
    for edge in [-0.6, 0.0, 0.3] {
        let scene = glowing(edge, 1.0, LensDesc::round(1.0, f64::INFINITY));
        rows.push(Row::new(
            format!("lens of a metre, focus at infinity, edge {edge} m aside"),
            scene,
            "Combined",
            1024,
            beyond(edge),
            2e-3,
        ));
        // From two metres rays of a lens in focus at four are half as far aside.
        let scene = glowing(edge, 2.0, LensDesc::round(1.0, 4.0));
        rows.push(Row::new(
            format!("lens of a metre, focus at 4 m, edge {edge} m aside at 2 m"),
            scene,
            "Combined",
            1024,
            beyond(2.0 * edge),
            2e-3,
        ));
    }
    for (name, lens) in [("of 0", LensDesc::round(0.0, 1.0)), ("in focus at 0", LensDesc::round(1.0, 0.0))] {
        for edge in [-0.01, 0.01] {
            let truth = if edge < 0.0 { 1.0 } else { 0.0 };
            rows.push(Row::new(
                format!("lens {name}, edge {edge} m aside"),
                glowing(edge, 1.0, lens),
                "Combined",
                16,
                truth,
                0.0,
            ));
        }
    }
    hold("lenses", rows);
}

/// What makes no picture is told, and another is made.
#[test]
fn told() {
    let warned = |scene: &Builder, part: &str| {
        let view = View { camera: None, size: Some([4; 2]) };
        let settings = Settings { max_bounces: 0, ..settings("combined", 4) };
        let prepared = prepare(scene.desc.clone(), &view, &settings).unwrap();
        let told = prepared.warnings.iter().any(|warning| warning.what.contains(part));
        let picture = penumbra::render::render(&prepared.scene, &settings, &()).unwrap().film.develop();
        if told && mean(&picture, "Combined", 3).is_finite() { 1.0 } else { 0.0 }
    };
    let mut rows = Vec::new();
    let mut row = |name: &str, scene: Builder, part: &str| {
        let values = [Some(warned(&scene, part)), None];
        rows.push(Found { name: name.into(), truth: 1.0, tolerance: 0.0, values, open: None });
    };
    let mut scene = wall(1.0, perspective(60.0));
    (scene.desc.cameras[0].clip_near, scene.desc.cameras[0].clip_far) = (2.0, 2.0);
    row("clip planes in one place: told, and a camera that frames the scene", scene, "empty clip range");
    for degrees in [0.0, 180.0] {
        row(
            &format!("field of view of {degrees} degrees: told, and a camera that frames the scene"),
            wall(1.0, perspective(degrees)),
            "impossible field of view",
        );
    }
    row("lens of a metre in focus at 0: told, and a pinhole", glowing(0.0, 1.0, LensDesc::round(1.0, 0.0)), "pinhole");
    judge("told", rows);
}
