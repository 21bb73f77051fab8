//! Emissive shapes: those that are partly open against closed forms, those whose emission is shaped against lamps.

#[path = "lights/plane.rs"]
#[allow(dead_code, reason = "the tests of lights need more of it")]
mod plane;
#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{
    AlphaMode, Attribute, Blending, Channel, ColorInput, ColorSpace, ConeDesc, Filter, IesDesc, IesRef, ImageDesc,
    InstanceDesc, LightKind, MaterialDesc, MeshDesc, PixelData, RoundsDesc, ScalarInput, ShapedDesc, ShapingDesc,
    TextureDesc, TextureRef, TextureTransform, Wrap,
};
use penumbra::math::{DAffine3, DVec3, Vec3};
use penumbra::settings::Settings;
use plane::lambert;
use scene::{Builder, close, mean, picture, settings};

const RADIANCE: f64 = 100.0;
const HALF: f64 = 0.05;

/// How much of a glowing square is there.
#[derive(Clone, Copy, Debug)]
enum Open {
    Not,
    Blend(f64),
    /// The alpha of the vertices.
    Vertices(f64),
    /// The alpha of the instance.
    Instance(f64),
    /// A mask whose texture has the half x < 0.
    Mask,
    /// A blend whose texture fades from 1 at the left to 0 at the right.
    Fade,
}

const CASES: [Open; 8] = [
    Open::Not,
    Open::Blend(0.99),
    Open::Blend(0.5),
    Open::Blend(0.01),
    Open::Vertices(0.25),
    Open::Instance(0.25),
    Open::Mask,
    Open::Fade,
];

/// Ground below a square of 0.1 m, one metre up, that glows.
fn square(open: Open) -> Builder {
    let mut builder = Builder::default();
    let floor = builder.lambert(0.5);
    builder.ground(10.0, floor);
    let (width, filter) = if matches!(open, Open::Mask) { (2, Filter::Nearest) } else { (256, Filter::Linear) };
    let alpha = (0..width).flat_map(|i| [1.0, 1.0 - (i as f32 + 0.5) / width as f32]).collect();
    let image = ImageDesc {
        name: "alpha".into(),
        place: Default::default(),
        width,
        height: 1,
        channels: 2,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(alpha),
    };
    builder.desc.images.push(image.into());
    let (wrap_u, wrap_v) = (Wrap::Clamp, Wrap::Clamp);
    builder.desc.textures.push(TextureDesc { place: Default::default(), image: 0, wrap_u, wrap_v, filter });
    let texture = TextureRef { texture: 0, uv_set: 0, transform: TextureTransform::IDENTITY };
    let textured = ScalarInput::textured(1.0, Some((texture, Channel::A)));
    let (alpha, alpha_mode) = match open {
        Open::Not => (ScalarInput::constant(1.0), AlphaMode::Opaque),
        Open::Blend(alpha) => (ScalarInput::constant(alpha), AlphaMode::Blend),
        Open::Vertices(_) | Open::Instance(_) => (ScalarInput::constant(1.0), AlphaMode::Blend),
        Open::Mask => (textured, AlphaMode::Mask { cutoff: 0.5 }),
        Open::Fade => (textured, AlphaMode::Blend),
    };
    let glow = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission: ColorInput::constant([RADIANCE; 3]),
        alpha,
        alpha_mode,
        ..MaterialDesc::default()
    });
    let h = HALF as f32;
    let mesh = MeshDesc {
        points: vec![[-h, 1.0, -h], [h, 1.0, -h], [h, 1.0, h], [-h, 1.0, h]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: vec![Attribute::Point(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])],
        colors: match open {
            Open::Vertices(alpha) => Some(Attribute::Point(vec![[1.0, 1.0, 1.0, alpha as f32]; 4])),
            _ => None,
        },
        ..MeshDesc::default()
    };
    builder.instance(mesh, glow, DAffine3::IDENTITY);
    if let Open::Instance(alpha) = open {
        // Another instance of the same mesh and materials stands far away and is shut.
        let shut = builder.desc.instances.last().unwrap().clone();
        let transform = DAffine3::from_translation(DVec3::new(0.0, -1e6, 0.0));
        builder.desc.instances.insert(0, InstanceDesc { transform, color: Some([1.0, 1.0, 1.0, 0.0]), ..shut });
        builder.desc.instances.last_mut().unwrap().color = Some([1.0, 1.0, 1.0, alpha as f32]);
    }
    builder.look([0.0; 3], [0.7, -0.7, 0.0], 1e-3);
    builder
}

/// Irradiance over π at the origin.
fn exact(open: Open) -> f64 {
    let strip = |from: f64, to: f64| {
        let corners = [[from, -HALF], [to, -HALF], [to, HALF], [from, HALF]];
        lambert(&corners.map(|[x, z]| DVec3::new(x, 1.0, z)), Vec3::ZERO, Vec3::Y)
    };
    let share = match open {
        Open::Not => strip(-HALF, HALF),
        Open::Blend(alpha) | Open::Vertices(alpha) | Open::Instance(alpha) => alpha * strip(-HALF, HALF),
        Open::Mask => strip(-HALF, 0.0),
        // Symmetric about the origin.
        Open::Fade => 0.5 * strip(-HALF, HALF),
    };
    RADIANCE * share / PI
}

#[test]
fn a_partly_open_emitter_is_sampled_like_any_other() {
    let mut wrong = Vec::new();
    for (open, seed) in CASES.into_iter().flat_map(|open| [(open, 0), (open, 1)]) {
        let settings = Settings { seed, ..settings("diffuse_direct,shadow,combined", 256) };
        let picture = picture(&square(open).desc, 4, &settings);
        let (found, expected) = (mean(&picture, "Diffuse Direct", 0), exact(open));
        println!("{open:?}: {found:.5}, {expected:.5}, shadow {}", mean(&picture, "Shadow", 0));
        let lit = picture.layer("Shadow").unwrap().data.iter().all(|shadow| (shadow - 1.0).abs() < 1e-6);
        if !lit || (found - expected).abs() > 0.01 * expected {
            wrong.push(format!("{open:?}: {found} instead of {expected}"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Combined of a shiny ground below a wide square of opacity `alpha`, and that of the square itself.
fn seen_and_reflected(alpha: f64, radiance: f64, roughness: f64) -> [f64; 2] {
    let mut builder = Builder::default();
    let material = |base: f64, specular: f64| MaterialDesc {
        base_color: ColorInput::constant([base; 3]),
        specular: ScalarInput::constant(specular),
        roughness: ScalarInput::constant(roughness),
        ..MaterialDesc::default()
    };
    let shiny = builder.material(material(0.5, 1.0));
    let glow = builder.material(MaterialDesc {
        emission: ColorInput::constant([radiance; 3]),
        alpha: ScalarInput::constant(alpha),
        alpha_mode: AlphaMode::Blend,
        ..material(0.0, 0.0)
    });
    builder.ground(10.0, shiny);
    builder.quad([-2.0, 0.5, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], glow);
    builder.look([0.0; 3], [0.2, -0.3, 0.1], 0.1);
    // Below the square.
    builder.desc.cameras[0].transform.translation *= 0.4;
    let settings = |spp| Settings { max_bounces: 0, ..settings("combined", spp) };
    let reflected = mean(&picture(&builder.desc, 8, &settings(512)), "Combined", 0);
    builder.desc.cameras.clear();
    builder.look([0.0, 1.0, 0.0], [0.0, -1.0, 0.0], 0.1);
    builder.desc.instances.remove(0);
    [reflected, mean(&picture(&builder.desc, 8, &settings(16)), "Combined", 0)]
}

#[test]
fn half_of_twice_the_light_is_the_same_light_whichever_strategy_finds_it() {
    for roughness in [0.0, 0.1, 0.5, 1.0] {
        let [half, half_seen] = seen_and_reflected(0.5, 2.0, roughness);
        let [whole, whole_seen] = seen_and_reflected(1.0, 1.0, roughness);
        close(&format!("reflected, roughness {roughness}"), half, whole, 0.01);
        close("seen", half_seen, whole_seen, 1e-6);
    }
}

/// A lamp, or the shape of the same size that glows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum As {
    Lamp,
    Shape,
}

const SIZE: [f64; 2] = [0.8, 0.5];
const RADIUS: f64 = 0.3;

/// Adds a rectangle or a sphere that is shaped by `shaping`.
fn add_shaped(builder: &mut Builder, sphere: bool, how: As, shaping: ShapingDesc, transform: DAffine3) {
    let (radiance, [width, height]) = ([RADIANCE, 0.5 * RADIANCE, RADIANCE], SIZE);
    if how == As::Lamp {
        builder.light(
            match sphere {
                true => LightKind::Sphere { radius: RADIUS, radiance, facing: false },
                false => LightKind::Rect { width, height, radiance, spread: PI, two_sided: false, image: None },
            },
            transform,
        );
        builder.desc.lights.last_mut().unwrap().shaping = shaping;
        return;
    }
    let glow = builder.lambert(0.0);
    builder.desc.materials[glow as usize].emission = ColorInput::constant(radiance);
    if sphere {
        let radii = vec![RADIUS as f32];
        builder.rounds(RoundsDesc { points: vec![[0.0; 3]], radii, ..RoundsDesc::default() }, glow);
    } else {
        let [x, y] = SIZE.map(|size| 0.5 * size as f32);
        let points = vec![[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]];
        builder.mesh(points, vec![[0, 1, 2], [0, 2, 3]], glow, DAffine3::IDENTITY);
    }
    let instance = builder.desc.instances.last_mut().unwrap();
    instance.transform = transform;
    instance.shaped = Some(ShapedDesc { shaping, transform }.into());
}

/// Ground that is half diffuse and half glossy, and a distribution that is not the same all around.
fn shaped_scene(roughness: f64) -> Builder {
    let mut builder = Builder::default();
    let ground = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.5; 3]),
        roughness: ScalarInput::constant(roughness),
        ..MaterialDesc::default()
    });
    builder.ground(40.0, ground);
    builder.desc.ies.push(IesDesc {
        name: "lamp".into(),
        place: Default::default(),
        vertical: vec![0.0, 30.0, 90.0],
        horizontal: vec![0.0, 90.0, 180.0, 270.0, 360.0],
        candela: vec![9.0, 6.0, 0.0, 9.0, 3.0, 1.0, 9.0, 1.0, 0.0, 9.0, 8.0, 2.0, 9.0, 6.0, 0.0],
    });
    builder
}

fn shapings() -> [(&'static str, ShapingDesc); 6] {
    let soft = |degrees: f64, softness: f64| Some(ConeDesc::Soft { angle: degrees.to_radians(), softness });
    let focused = ShapingDesc { focus: 3.0, ..ShapingDesc::default() };
    let ies = Some(IesRef { profile: 0, angle_scale: 0.0, keep_power: false });
    [
        // What ShapingAPI has from the start: of a sheet one side is dark.
        ("half space", ShapingDesc { cone: soft(90.0, 0.0), ..ShapingDesc::default() }),
        ("wide", ShapingDesc { cone: soft(75.0, 0.3), ..ShapingDesc::default() }),
        ("narrow", ShapingDesc { cone: soft(25.0, 0.5), ..ShapingDesc::default() }),
        ("focus", focused),
        ("tint", ShapingDesc { focus_tint: [0.25, 0.0, 0.5], cone: soft(90.0, 0.0), ..focused }),
        ("measured", ShapingDesc { ies, cone: soft(60.0, 0.0), ..ShapingDesc::default() }),
    ]
}

/// Down, a little tilted.
fn above(p: [f64; 3], tilt: f64) -> DAffine3 {
    DAffine3::from_translation(p.into()) * DAffine3::from_rotation_x(-0.5 * PI) * DAffine3::from_rotation_y(tilt)
}

/// UsdLux' ShapingAPI on shapes: light sampling and the rays that find the shape agree with the lamp of its size.
#[test]
fn shapes_are_shaped_like_lamps() {
    for sphere in [false, true] {
        for ((name, shaping), roughness) in shapings().into_iter().flat_map(|s| [(s, 0.1), (s, 0.5)]) {
            let arrives = |how: As| {
                let mut builder = shaped_scene(roughness);
                add_shaped(&mut builder, sphere, how, shaping, above([0.3, 1.2, 0.1], 0.2));
                builder.look([0.0; 3], [0.2, -0.5, 0.1], 0.3);
                builder.desc.cameras[0].transform.translation *= 0.5;
                let settings = Settings { max_bounces: 0, ..settings("all", 1024) };
                let picture = picture(&builder.desc, 6, &settings);
                ["Diffuse Direct", "Glossy Direct"].map(|layer| [0, 1, 2].map(|c| mean(&picture, layer, c)))
            };
            let (lamp, shape) = (arrives(As::Lamp), arrives(As::Shape));
            for (lamp, shape) in lamp.as_flattened().iter().zip(shape.as_flattened()) {
                assert!(*lamp > 0.0, "{name}");
                close(&format!("{name}, sphere {sphere}, roughness {roughness}"), *shape, *lamp, 0.02);
            }
        }
    }
}

#[test]
fn the_camera_sees_shapes_as_they_are_shaped() {
    for ((name, shaping), sphere) in shapings().into_iter().flat_map(|s| [(s, false), (s, true)]) {
        for degrees in [5.0_f64, 20.0, 40.0, 70.0, 85.0] {
            let seen = |how: As| {
                let mut builder = shaped_scene(0.5);
                builder.desc.instances.clear();
                add_shaped(&mut builder, sphere, how, shaping, above([0.0; 3], 0.0));
                let (sin, cos) = degrees.to_radians().sin_cos();
                builder.look([0.0; 3], [0.8 * sin, cos, -0.6 * sin], 1e-3);
                let picture = picture(&builder.desc, 2, &settings("combined", 16));
                [0, 1, 2].map(|c| mean(&picture, "Combined", c))
            };
            for (lamp, shape) in seen(As::Lamp).into_iter().zip(seen(As::Shape)) {
                assert!((lamp - shape).abs() <= 1e-3 * lamp.max(1e-3), "{name} at {degrees}: {shape}, not {lamp}");
            }
        }
    }
}

/// So many that a tree chooses among them.
#[test]
fn many_shaped_shapes_light_like_as_many_lamps() {
    for sphere in [false, true] {
        let arrives = |how: As| {
            let mut builder = shaped_scene(0.5);
            for i in 0..42 {
                let (_, shaping) = shapings()[i % 6];
                let place = [(i % 7) as f64 - 3.0, 1.0 + 0.1 * (i % 5) as f64, (i / 7) as f64 - 2.5];
                add_shaped(&mut builder, sphere, how, shaping, above(place, 0.3 * (i % 4) as f64 - 0.4));
            }
            builder.look([0.0; 3], [0.1, -0.5, 0.1], 1.5);
            builder.desc.cameras[0].transform.translation *= 0.1;
            mean(&picture(&builder.desc, 12, &settings("unshadowed", 4096)), "Diffuse Direct Unshadowed", 0)
        };
        // Shapes stand in each other's way, lamps do not. Without shadows a ball shines through from its far side, too.
        let sides = if sphere { 2.0 } else { 1.0 };
        close(&format!("sphere {sphere}"), arrives(As::Shape), sides * arrives(As::Lamp), 0.03);
    }
}

#[test]
fn shaping_that_leaves_no_light_is_told() {
    let shaping = ShapingDesc { cone: Some(ConeDesc::Soft { angle: 0.0, softness: 0.0 }), ..ShapingDesc::default() };
    let mut builder = shaped_scene(0.5);
    add_shaped(&mut builder, false, As::Shape, shaping, above([0.0, 1.0, 0.0], 0.0));
    builder.look([0.0; 3], [0.1, -0.5, 0.1], 0.3);
    let view = penumbra::scene::View { camera: None, size: Some([4, 4]) };
    let warnings = penumbra::scene::prepare(builder.desc.clone(), &view, &settings("combined", 1)).unwrap().warnings;
    assert!(warnings.iter().any(|w| w.to_string().contains("its shaping leaves no light")), "{warnings:?}");
    assert_eq!(mean(&picture(&builder.desc, 4, &settings("combined", 16)), "Combined", 0), 0.0);
}
