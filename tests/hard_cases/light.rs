//! Lights that are too near, too far, edge-on, inside out, too weak, too bright or too many.

use std::f64::consts::{FRAC_PI_2, PI};

use penumbra::desc::{
    Blending, ColorSpace, ConeDesc, ImageDesc, LightKind, MaterialDesc, PixelData, ShapingDesc, TerminatorDesc,
};
use penumbra::error::Place;
use penumbra::film::PassSet;
use penumbra::math::{DAffine3, DVec3};

use crate::row::{Row, hold};
use crate::scene::Builder;
use crate::truth::polygon;

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

/// A white floor below the world's origin, seen from a metre above at one point.
fn floor() -> Builder {
    let mut scene = Builder::default();
    let white = scene.lambert(1.0);
    scene.ground(10.0, white);
    scene.look([0.0; 3], DOWN, 1e-9);
    scene
}

/// The floor and a lamp.
fn lit(kind: LightKind, transform: DAffine3) -> Builder {
    let mut scene = floor();
    scene.light(kind, transform);
    scene
}

/// A lamp at `at` that shines down.
fn down(at: DVec3) -> DAffine3 {
    DAffine3::from_translation(at) * DAffine3::from_rotation_x(-FRAC_PI_2)
}

/// A lamp at `at` that shines along x, its local x along z and its local y upwards.
fn along_x(at: DVec3) -> DAffine3 {
    DAffine3::from_translation(at) * DAffine3::from_rotation_y(-FRAC_PI_2)
}

fn rect(width: f64, height: f64, radiance: f64) -> LightKind {
    LightKind::Rect { width, height, radiance: [radiance; 3], spread: PI, two_sided: false, image: None }
}

fn disk(width: f64, radiance: f64) -> LightKind {
    LightKind::Disk { width, height: width, radiance: [radiance; 3], spread: PI, two_sided: false }
}

fn sphere(radius: f64, radiance: f64) -> LightKind {
    LightKind::Sphere { radius, radiance: [radiance; 3], facing: false }
}

fn direct(name: impl Into<String>, scene: Builder, spp: u32, truth: f64, tolerance: f64) -> Row {
    Row::new(name, scene, "Diffuse Direct", spp, truth, tolerance)
}

/// The form factor of a rectangle of z from −½ to ½ and heights from `low` to `high`, all at `x`, to the floor.
fn upright(x: f64, low: f64, high: f64) -> f64 {
    let corners = [[low, -0.5], [high, -0.5], [high, 0.5], [low, 0.5]].map(|[y, z]| DVec3::new(x, y, z));
    polygon(&corners, DVec3::ZERO, DVec3::Y)
}

#[test]
fn rectangles() {
    let mut rows = Vec::new();
    let aside = DVec3::new(-0.1237, 0.0, -0.0412);
    for gap in [1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        let middle = aside + gap * DVec3::Y;
        let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(|[x, z]| middle + DVec3::new(x, 0.0, z));
        let truth = polygon(&corners, DVec3::ZERO, DVec3::Y);
        rows.push(direct(
            format!("rectangle of 1 m, {gap:e} m above"),
            lit(rect(1.0, 1.0, 1.0), down(middle)),
            1024,
            truth,
            1e-4,
        ));
    }
    // A solid angle of 10⁻⁹.
    let far = 1e9_f64.sqrt();
    rows.push(direct(
        "rectangle of a solid angle of 1e-9",
        lit(rect(1.0, 1.0, 1e9), down(DVec3::Y * far)),
        64,
        1.0 / PI,
        1e-4,
    ));
    // What is seen of the floor is 2e-9 m wide, and half of it lies before the rectangle.
    rows.push(direct("rectangle edge-on", lit(rect(1.0, 1.0, 1.0), along_x(DVec3::Y)), 64, 0.0, 1e-9));
    for away in [1e-3, 1e-6] {
        let scene = lit(rect(1.0, 1.0, 1.0), along_x(DVec3::new(-away, 1.0, 0.0)));
        rows.push(direct(format!("rectangle {away:e} m from edge-on"), scene, 1024, upright(-away, 0.5, 1.5), 2e-3));
    }
    for away in [1.0, 1e-3, 1e-6] {
        let scene = lit(rect(1.0, 1.0, 1.0), along_x(DVec3::new(-away, 0.5, 0.0)));
        rows.push(direct(
            format!("rectangle that stands on the floor, {away:e} m away"),
            scene,
            4096,
            upright(-away, 0.0, 1.0),
            2e-3,
        ));
    }
    for away in [1.0, 1e-3] {
        let scene = lit(rect(1.0, 1.0, 1.0), along_x(DVec3::new(-away, 0.0, 0.0)));
        rows.push(direct(
            format!("rectangle that the floor cuts in half, {away:e} m away"),
            scene,
            4096,
            upright(-away, 0.0, 0.5),
            4e-3,
        ));
    }
    hold("rectangles", rows);
}

#[test]
fn spheres_and_disks() {
    let mut rows = Vec::new();
    for (name, d) in [
        ("1e-6 radii from its skin", 1.0 + 1e-6),
        ("1e-3 radii from its skin", 1.0 + 1e-3),
        ("1e3 radii away", 1e3),
        ("1e6 radii away", 1e6),
    ] {
        // The floor as small and the camera as near as the lamp is small: positions are rounded by that.
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.ground(1e-2, white);
        scene.look([0.0; 3], DOWN, 1e-9);
        scene.desc.cameras[0].transform.translation *= 1e-2;
        scene.light(sphere(1e-3, d * d), DAffine3::from_translation(DVec3::Y * d * 1e-3));
        rows.push(direct(format!("sphere light {name}"), scene, 16384, 1.0, 1e-4));
    }
    rows.push(direct(
        "inside a sphere light",
        lit(sphere(1.0, 1.0), DAffine3::from_translation(DVec3::Y * 0.5)),
        1024,
        1.0,
        1e-3,
    ));
    for d in [1e-5, 1.0, 1e5] {
        let radiance = 1.0 + d * d;
        rows.push(direct(
            format!("disk of radius 1 m, {d:e} m above"),
            lit(disk(2.0, radiance), down(DVec3::Y * d)),
            1024,
            1.0,
            2e-4,
        ));
    }
    hold("spheres", rows);
}

#[test]
fn suns_and_domes() {
    let mut rows = Vec::new();
    let sun = |angle: f64, tilt: f64| {
        let towards = DAffine3::from_rotation_x(tilt - FRAC_PI_2);
        lit(LightKind::Distant { irradiance: [PI; 3], angle: angle.to_radians() }, towards)
    };
    rows.push(direct("sun of 0 degrees", sun(0.0, 0.5), 16, 0.5_f64.cos(), 1e-5));
    rows.push(direct("sun of 0.01 degrees", sun(0.01, 0.5), 64, 0.5_f64.cos(), 1e-5));
    rows.push(direct(
        "sun of 0.01 degrees, 89.99 degrees from the zenith",
        sun(0.01, 89.99_f64.to_radians()),
        4096,
        89.99_f64.to_radians().cos(),
        1e-3,
    ));
    rows.push(direct("sun of 180 degrees in the zenith", sun(180.0, 0.0), 1024, 1.0, 1e-3));
    // Half of the sky at even radiance, of which the horizon hides a lune.
    rows.push(direct("sun of 180 degrees, 60 degrees from the zenith", sun(180.0, PI / 3.0), 4096, 0.75, 2e-3));

    rows.push(Row::new(
        "black dome",
        lit(LightKind::Dome { radiance: [0.0; 3], image: None }, DAffine3::IDENTITY),
        "Combined",
        64,
        0.0,
        0.0,
    ));
    for bright in [1e2, 1e8] {
        let (scene, truth) = one_texel(bright);
        rows.push(direct(format!("dome of 1e-3 with one texel of {bright:e}"), scene, 1024, truth, 2e-3));
    }
    hold("suns", rows);
}

/// A dome of 10⁻³ with one texel of `bright`, and irradiance over π of the floor.
fn one_texel(bright: f64) -> (Builder, f64) {
    let (width, height, column, row) = (256_usize, 128_usize, 100_usize, 30_usize);
    let mut texels = vec![1e-3_f32; 3 * width * height];
    texels[3 * (row * width + column)..][..3].fill(bright as f32);
    let mut scene = floor();
    scene.desc.images.push(std::sync::Arc::new(ImageDesc {
        name: "sky".into(),
        place: Place::default(),
        width: width as u32,
        height: height as u32,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(texels),
    }));
    scene.light(LightKind::Dome { radiance: [1.0; 3], image: Some(0) }, DAffine3::IDENTITY);
    // Texels are blended in between: a tent over two rows and columns.
    let (steps, step) = (2000, PI / height as f64);
    let tent = (0..2 * steps).map(|i| {
        let x = (f64::from(i) + 0.5) / f64::from(steps) - 1.0;
        let theta = (row as f64 + 0.5 + x) * step;
        (1.0 - x.abs()) * theta.cos() * theta.sin() / f64::from(steps) * step
    });
    let across = 2.0 * PI / width as f64;
    let irradiance = PI * 1e-3 + (bright - 1e-3) * across * tent.sum::<f64>();
    (scene, irradiance / PI)
}

#[test]
fn many_and_unlike() {
    let mut rows = Vec::new();
    let point = |intensity: f64| LightKind::Point { intensity: [intensity; 3] };
    let pair = |group: bool| {
        let mut scene = floor();
        scene.light(point(1e-12 * PI), DAffine3::from_translation(DVec3::Y));
        scene.light(point(1e12 * PI), DAffine3::from_translation(DVec3::Y * 2.0));
        if group {
            for (light, name) in scene.desc.lights.iter_mut().zip(["dim", "bright"]) {
                light.links.group = Some(name.into());
            }
        }
        scene
    };
    rows.push(direct("lamps of 1e-12 and 1e12 W/sr, together", pair(false), 64, 0.25e12 + 1e-12, 1e-5));
    for (name, layer, truth) in [("dim", "Combined_dim", 1e-12), ("bright", "Combined_bright", 0.25e12)] {
        let row = Row::new(
            format!("lamps of 1e-12 and 1e12 W/sr, the {name} one's layer"),
            pair(true),
            "Combined",
            64,
            truth,
            1e-5,
        );
        let row = row
            .with(|settings| settings.passes = PassSet::parse(&format!("combined_{name}")).unwrap())
            .by(move |picture, _| crate::scene::mean(picture, layer, 0));
        rows.push(match name {
            "dim" => row.open("layers of groups are made of Combined's samples, none of which asks a lamp that gives 1e-24 of the light"),
            _ => row,
        });
    }

    // In a spiral, so that no two are at one place.
    let (mut scene, mut truth) = (floor(), 0.0);
    let count = 100_000;
    for i in 0..count {
        let share = (f64::from(i) + 0.5) / f64::from(count);
        let (r, phi) = (5.0 * share.sqrt(), f64::from(i) * 2.399_963);
        let at = DVec3::new(r * phi.cos(), 1.0 + 3.0 * share, r * phi.sin());
        scene.light(point(1e-5), DAffine3::from_translation(at));
        truth += 1e-5 * at.y / at.length().powi(3) / PI;
    }
    rows.push(direct("100,000 lamps", scene, 4096, truth, 1e-2));
    hold("many", rows);
}

#[test]
fn without_size_or_behind() {
    let mut rows = Vec::new();
    let point = LightKind::Point { intensity: [PI; 3] };
    let above = DAffine3::from_translation(DVec3::Y);
    // What a lamp without size adds to one that is sound: nothing, and no harm.
    for (name, kind) in [
        ("rectangle without width", rect(0.0, 1.0, 5.0)),
        ("disk without size", disk(0.0, 5.0)),
        ("sphere of radius 0", sphere(0.0, 5.0)),
        ("cylinder without length", LightKind::Cylinder { radius: 0.1, length: 0.0, radiance: [5.0; 3] }),
    ] {
        let mut scene = lit(point, above);
        scene.light(kind, down(DVec3::new(0.3, 0.5, 0.0)));
        rows.push(direct(format!("emitter of zero area: {name}"), scene, 16, 1.0, 1e-5));
    }
    let mut scene = lit(point, above);
    let glow = scene
        .material(MaterialDesc { emission: penumbra::desc::ColorInput::constant([5.0; 3]), ..MaterialDesc::default() });
    scene.mesh(vec![[0.5, 0.5, 0.0], [0.5, 0.7, 0.0], [0.5, 0.9, 0.0]], vec![[0, 1, 2]], glow, DAffine3::IDENTITY);
    rows.push(direct("emitter of zero area: triangle", scene, 16, 1.0, 1e-5));

    for (degrees, truth, tolerance) in [(0.0, 0.0, 0.0), (0.02, 1.0, 1e-5), (180.0, 1.0, 1e-5)] {
        for blend in [0.0, 1.0] {
            let mut scene = lit(point, down(DVec3::Y));
            let cone = ConeDesc::Blend { angle: f64::to_radians(0.5 * degrees), blend };
            scene.desc.lights[0].shaping = ShapingDesc { cone: Some(cone), ..ShapingDesc::default() };
            rows.push(direct(
                format!("spot of {degrees} degrees, blend {blend}, on its axis"),
                scene,
                16,
                truth,
                tolerance,
            ));
        }
    }
    for (name, kind, at) in [
        ("point", point, DAffine3::from_translation(-DVec3::Y)),
        ("rectangle", rect(1.0, 1.0, 1.0), down(-DVec3::Y)),
        ("sphere", sphere(0.5, 1.0), DAffine3::from_translation(-DVec3::Y)),
        ("sun", LightKind::Distant { irradiance: [1.0; 3], angle: 0.1 }, DAffine3::from_rotation_x(FRAC_PI_2)),
    ] {
        rows.push(direct(format!("light behind the surface: {name}"), lit(kind, at), 64, 0.0, 0.0));
    }
    hold("sizes", rows);
}

/// A ball of 16 × 8 faces under a sun that is 80 degrees from where it is looked at.
#[test]
fn terminator() {
    let ball = |geometry: f64| {
        let mut scene = Builder::default();
        let white = scene.lambert(1.0);
        scene.sphere(8, true, white, DAffine3::IDENTITY);
        scene.desc.instances[0].terminator = Some(TerminatorDesc { geometry, shading: 0.0 });
        let towards = DAffine3::from_rotation_x(80_f64.to_radians() - FRAC_PI_2);
        scene.light(LightKind::Distant { irradiance: [PI; 3], angle: 0.0 }, towards);
        scene.look([0.0; 3], DOWN, 1.1);
        scene.desc.cameras[0].transform.translation *= 3.0;
        scene
    };
    // The sun's direction, by which pixels are lit whose normal leans towards it.
    let sun = DVec3::new(0.0, 80_f64.to_radians().cos(), 80_f64.to_radians().sin());
    let row = Row::new(
        "terminator on a ball of 16 x 8 faces: share of lit pixels that are black",
        ball(0.1),
        "Combined",
        4,
        0.0,
        0.0,
    );
    let row = row.sized(96, 96).with(|settings| settings.passes = PassSet::parse("combined,normal").unwrap());
    hold(
        "terminator",
        vec![row.by(move |picture, _| {
            let (color, normal) = (picture.layer("Combined").unwrap(), picture.layer("Normal").unwrap());
            let pixels = (0..96 * 96).map(|i| {
                let n = DVec3::from(std::array::from_fn(|k| f64::from(normal.data[3 * i + k])));
                (n.dot(sun) > 0.05 && n.length() > 0.99, color.data[4 * i] <= 0.0)
            });
            let lit: Vec<bool> = pixels.filter(|(lit, _)| *lit).map(|(_, black)| black).collect();
            assert!(lit.len() > 1000, "{} lit pixels", lit.len());
            lit.iter().filter(|black| **black).count() as f64 / lit.len() as f64
        })],
    );
}
