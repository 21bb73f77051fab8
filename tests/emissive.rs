//! Emissive meshes that are partly open against closed forms.

#[path = "lights/plane.rs"]
#[allow(dead_code, reason = "the tests of lights need more of it")]
mod plane;
#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::f64::consts::PI;

use penumbra::desc::{
    AlphaMode, Attribute, Channel, ColorInput, ColorSpace, Filter, ImageDesc, InstanceDesc, MaterialDesc, MeshDesc,
    PixelData, ScalarInput, TextureDesc, TextureRef, TextureTransform, Wrap,
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
