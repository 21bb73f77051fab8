//! Light beneath surfaces against closed forms.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput, SubsurfaceDesc, SubsurfaceMethod as Method};
use penumbra::error::Warnings;
use penumbra::film::Picture;
use penumbra::import::blender::BlenderScene;
use penumbra::math::{DAffine3, DVec3};
use penumbra::settings::{EffectsMode, Settings};
use scene::{Builder, close, mean, picture, settings};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn subsurface(color: [f64; 3], radius: [f64; 3], method: Method) -> SubsurfaceDesc {
    SubsurfaceDesc {
        weight: ScalarInput::constant(1.0),
        color: ColorInput::constant(color),
        radius: ColorInput::constant(radius),
        anisotropy: ScalarInput::constant(0.0),
        ior: ScalarInput::constant(1.0),
        method,
        shallow: false,
    }
}

/// A surface through which light goes straight in: smooth, and of no index of its own.
fn beneath(subsurface: SubsurfaceDesc) -> MaterialDesc {
    MaterialDesc {
        base_color: subsurface.color,
        specular: ScalarInput::constant(0.0),
        roughness: ScalarInput::constant(0.0),
        ior: ScalarInput::constant(1.0),
        subsurface: Some(subsurface),
        ..MaterialDesc::default()
    }
}

/// A box of half sides `half` below the origin; none of its edges is near.
fn block(builder: &mut Builder, half: [f64; 3], material: u32) {
    let corner = |i: u32| {
        let side = |k: usize| if (i >> k) & 1 == 0 { -half[k] } else { half[k] };
        [side(0) * 1.1, side(1) - half[1], side(2) * 0.9].map(|v| v as f32)
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    builder.mesh((0..8).map(corner).collect(), triangles, material, DAffine3::IDENTITY);
}

/// What light straight down leaves a half space of isotropic scattering and `albedo` with, of all that comes in:
/// 1 − √(1 − ω) H(1), by Chandrasekhar's function (*Radiative Transfer*, 1950, chapter V).
fn half_space(albedo: f64) -> f64 {
    let n = 400;
    let mu = |i: usize| (i as f64 + 0.5) / n as f64;
    let root = (1.0 - albedo).sqrt();
    let mut h = vec![1.0; n];
    let at = |h: &[f64], x: f64| {
        let sum: f64 = h.iter().enumerate().map(|(i, h)| mu(i) * h / (x + mu(i))).sum();
        1.0 / (root + 0.5 * albedo * sum / n as f64)
    };
    for _ in 0..200 {
        h = (0..n).map(|i| at(&h, mu(i))).collect();
    }
    1.0 - root * at(&h, 1.0)
}

/// d'Eon's inversion: the albedo of a medium whose half space is of `color`.
fn albedo_of(color: f64) -> f64 {
    let s = 4.09712 + 4.20863 * color - (9.59217 + 41.6808 * color + 17.7126 * color * color).sqrt();
    1.0 - s * s
}

/// The mean of each channel of what is seen of the top of a deep block under a white dome.
fn seen_on_block(material: MaterialDesc, half: f64, spp: u32) -> [f64; 3] {
    let mut builder = Builder::default();
    let material = builder.material(material);
    block(&mut builder, [half; 3], material);
    builder.dome(1.0);
    builder.look([0.3, 0.0, -0.2], DOWN, 0.01);
    let picture = picture(&builder.desc, 16, &settings("combined", spp));
    [0, 1, 2].map(|channel| mean(&picture, "Combined", channel))
}

/// Every step and every weight: the light that comes in straight and out again is known.
#[test]
fn a_half_space_gives_back_what_chandrasekhar_says() {
    let colors = [0.3, 0.6, 0.75];
    let found = seen_on_block(beneath(subsurface(colors, [0.4, 0.2, 0.1], Method::FreePath)), 50.0, 1024);
    for (color, found) in colors.into_iter().zip(found) {
        close(&format!("color {color}"), found, half_space(albedo_of(color)), 5e-3);
    }
}

/// A half space is of the same color however short its free paths are, and wherever it stands: here the shortest are some
/// twenty times as long as what `f32` can tell apart at that distance from the camera.
#[test]
fn short_paths_far_from_the_camera_give_back_as_much() {
    let colors = [0.3, 0.6, 0.75];
    for (method, expected) in [
        (Method::FreePath, colors.map(|color| half_space(albedo_of(color)))),
        // A profile reflects the color itself.
        (Method::Burley, colors),
    ] {
        let length = if method == Method::Burley { 4.0 * std::f64::consts::PI } else { 1.0 };
        let radius = [3.2e-4, 1.6e-4, 8e-5].map(|radius| radius * length);
        let mut builder = Builder::default();
        let material = builder.material(beneath(subsurface(colors, radius, method)));
        block(&mut builder, [0.5; 3], material);
        builder.desc.instances[0].transform = DAffine3::from_translation(DVec3::new(31.0, 0.0, -17.0));
        builder.dome(1.0);
        builder.look([31.03, 0.0, -17.02], DOWN, 0.01);
        builder.desc.cameras[0].transform.translation.y += 40.0;
        let picture = picture(&builder.desc, 16, &settings("combined", 1024));
        for (channel, expected) in expected.into_iter().enumerate() {
            let found = mean(&picture, "Combined", channel);
            close(&format!("{method:?}, channel {channel}"), found, expected, 8e-3);
        }
    }
}

/// What Cycles 5.0.1 makes of a half space from straight above: Principled BSDF, Roughness 1, Specular IOR Level 0, Subsurface
/// IOR 1.4, Radius (0.4, 0.2, 0.1) m, a block of 8 m under a white
/// world, 16×16 pixels of 512 samples; standard errors up to 0.003. Its walks end where ours do: the white ones show it.
const OF_CYCLES: [(Method, f64, [f64; 3], [f64; 3]); 8] = [
    (Method::RandomWalk, 0.0, [0.2, 0.5, 0.8], [0.1604, 0.4410, 0.7711]),
    (Method::RandomWalk, 0.0, [0.9, 0.95, 1.0], [0.8807, 0.8995, 0.8953]),
    (Method::RandomWalk, 0.8, [0.2, 0.5, 0.8], [0.1291, 0.4419, 0.9077]),
    (Method::RandomWalk, 0.8, [0.9, 0.95, 1.0], [0.9024, 0.9089, 0.9069]),
    (Method::RandomWalkSkin, 0.0, [0.2, 0.5, 0.8], [0.1841, 0.4763, 0.7935]),
    (Method::RandomWalkSkin, 0.0, [0.9, 0.95, 1.0], [0.8950, 0.9079, 0.9089]),
    (Method::RandomWalkSkin, 0.8, [0.2, 0.5, 0.8], [0.1739, 0.4938, 0.9178]),
    (Method::RandomWalkSkin, 0.8, [0.9, 0.95, 1.0], [0.9148, 0.9211, 0.9120]),
];

#[test]
fn a_half_space_gives_back_what_cycles_does() {
    for (method, anisotropy, colors, expected) in OF_CYCLES {
        let beneath_it = SubsurfaceDesc {
            anisotropy: ScalarInput::constant(anisotropy),
            ior: ScalarInput::constant(1.4),
            ..subsurface(colors, [0.4, 0.2, 0.1], method)
        };
        let material = MaterialDesc {
            ior: ScalarInput::constant(1.4),
            specular_level: ScalarInput::constant(0.0),
            roughness: ScalarInput::constant(1.0),
            ..beneath(beneath_it)
        };
        let found = seen_on_block(material, 4.0, 512);
        for ((color, found), expected) in colors.into_iter().zip(found).zip(expected) {
            // Three standard errors of the difference.
            assert!((found - expected).abs() < 0.011, "{method:?}, {anisotropy}, {color}: {found} for {expected}");
        }
    }
}

/// A profile knows no losses: the plane is of the color itself.
#[test]
fn a_profile_on_a_plane_gives_back_the_color() {
    let colors = [0.2, 0.5, 1.0];
    let found = seen_on_block(beneath(subsurface(colors, [0.4, 0.2, 0.1], Method::Burley)), 50.0, 1024);
    for (color, found) in colors.into_iter().zip(found) {
        close(&format!("color {color}"), found, color, 8e-3);
    }
}

fn sphere_under_dome(material: MaterialDesc, spp: u32) -> Picture {
    let mut builder = Builder::default();
    let material = builder.material(material);
    builder.sphere(24, false, material, DAffine3::IDENTITY);
    builder.dome(1.0);
    builder.look([0.0, 1.0, 0.0], DOWN, 0.6);
    picture(&builder.desc, 16, &settings("combined", spp))
}

#[test]
fn a_white_solid_in_a_white_furnace_loses_nothing() {
    for method in [Method::RandomWalk, Method::RandomWalkSkin, Method::FreePath] {
        for anisotropy in [0.0, 0.7] {
            // Three mean free paths across: no walk is as long as the limit.
            let free = if method == Method::RandomWalk { 4.0 * std::f64::consts::PI } else { 1.0 } / 3.0;
            // Skin's paths are shorter by far where the color is white.
            let free = if method == Method::RandomWalkSkin { 200.0 } else { free };
            let white = SubsurfaceDesc {
                anisotropy: ScalarInput::constant(anisotropy),
                ior: ScalarInput::constant(1.4),
                ..subsurface([1.0; 3], [free; 3], method)
            };
            let found = mean(&sphere_under_dome(beneath(white), 256), "Combined", 0);
            close(&format!("{method:?}, {anisotropy}"), found, 1.0, 3e-3);
        }
    }
}

#[test]
fn without_radius_it_is_lamberts_surface() {
    let color = [0.2, 0.5, 0.8];
    let lambert = MaterialDesc {
        base_color: ColorInput::constant(color),
        specular: ScalarInput::constant(0.0),
        ..MaterialDesc::default()
    };
    let lambert = sphere_under_dome(lambert, 16);
    let profile = sphere_under_dome(beneath(subsurface(color, [1e-2; 3], Method::Burley)), 256);
    let none = sphere_under_dome(beneath(subsurface(color, [0.0; 3], Method::RandomWalk)), 16);
    let little = sphere_under_dome(beneath(subsurface(color, [1e-3; 3], Method::RandomWalkSkin)), 256);
    for channel in 0..3 {
        let expected = mean(&lambert, "Combined", channel);
        close("profile", mean(&profile, "Combined", channel), expected, 1e-2);
        close("none", mean(&none, "Combined", channel), expected, 1e-6);
        assert!((mean(&little, "Combined", channel) - expected).abs() < 0.02, "{channel}");
    }
}

/// A lamp, a sphere and something that stands before it.
fn half_in_shadow(material: MaterialDesc) -> Builder {
    let mut builder = Builder::default();
    let (material, black) = (builder.material(material), builder.lambert(0.0));
    builder.sphere(24, true, material, DAffine3::IDENTITY);
    builder.quad([0.0, 3.0, -2.0], [4.0, 0.0, 0.0], [0.0, 0.0, 4.0], black);
    let lamp = LightKind::Sphere { radiance: [40.0; 3], radius: 0.3, facing: false };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(0.0, 5.0, 0.0)));
    builder.look([0.0, 1.0, 0.0], DOWN, 1.1);
    builder
}

fn wax() -> MaterialDesc {
    let wax = SubsurfaceDesc {
        weight: ScalarInput::constant(0.7),
        ..subsurface([0.8, 0.6, 0.4], [2.0, 1.0, 0.5], Method::RandomWalk)
    };
    MaterialDesc { specular: ScalarInput::constant(1.0), ior: ScalarInput::constant(1.5), ..beneath(wax) }
}

#[test]
fn diffuse_direct_is_the_shadow_times_what_would_be_without() {
    let builder = half_in_shadow(wax());
    let picture = picture(&builder.desc, 24, &settings("diffuse_direct,shadow,unshadowed,combined", 64));
    let layer = |name: &str| &picture.layer(name).unwrap().data;
    let (direct, shadow) = (layer("Diffuse Direct"), layer("Shadow"));
    let largest = direct.iter().copied().fold(0.0, f32::max);
    assert!(largest > 0.1 && shadow.iter().any(|&s| s < 0.5));
    for ((direct, shadow), unshadowed) in direct.iter().zip(shadow).zip(layer("Diffuse Direct Unshadowed")) {
        assert!((direct - shadow * unshadowed).abs() <= 1e-4 * largest, "{direct}, {shadow}, {unshadowed}");
    }
}

#[test]
fn walks_meet_the_surface_of_their_own_object_alone() {
    let bare = half_in_shadow(wax());
    let mut with_core = bare.clone();
    let core = with_core.lambert(0.5);
    with_core.sphere(8, false, core, DAffine3::from_scale(DVec3::splat(0.7)));
    let settings = settings("combined", 16);
    let [bare, with_core] = [bare, with_core].map(|builder| picture(&builder.desc, 16, &settings));
    assert_eq!(bare.layer("Combined").unwrap().data, with_core.layer("Combined").unwrap().data);
}

#[test]
fn an_open_surface_gives_back_no_more_than_it_gets() {
    let mut builder = Builder::default();
    let material = builder.material(beneath(subsurface([1.0; 3], [0.5; 3], Method::FreePath)));
    builder.quad([-1.0, 0.0, -1.0], [0.0, 0.0, 2.0], [2.0, 0.0, 0.0], material);
    builder.dome(1.0);
    builder.look([0.0; 3], DOWN, 1.0);
    let found = mean(&picture(&builder.desc, 16, &settings("combined", 64)), "Combined", 0);
    assert!(found > 0.3 && found < 1.0, "{found}");
}

#[test]
fn all_effects_give_the_same_bits() {
    let builder = half_in_shadow(wax());
    let auto = settings("combined,diffuse_direct", 4);
    let all = Settings { effects: EffectsMode::All, ..auto.clone() };
    let [auto, all] = [auto, all].map(|settings| picture(&builder.desc, 16, &settings));
    assert_eq!(auto.layer("Combined").unwrap().data, all.layer("Combined").unwrap().data);
}

/// What Blender's nodes mean: radius times scale, the base color, and since 5.0 a walk whoever looks.
#[test]
fn nodes_of_blender_say_what_is_beneath() {
    use serde_json::json;
    let socket = |id: &str, kind: &str, value: serde_json::Value| json!({"id": id, "name": id, "type": kind, "enabled": true, "value": value});
    let numbers = [
        ("Subsurface Weight", 0.5),
        ("Subsurface Scale", 0.2),
        ("Subsurface Anisotropy", 0.3),
        ("Subsurface IOR", 1.3),
    ];
    for (version, name, method, shallow) in [
        ([5, 0, 1], "RANDOM_WALK", Method::RandomWalk, false),
        ([4, 5, 0], "RANDOM_WALK_SKIN", Method::RandomWalkSkin, true),
        ([5, 0, 1], "BURLEY", Method::Burley, true),
    ] {
        let mut inputs: Vec<_> = numbers.map(|(id, value)| socket(id, "VALUE", json!(value))).into();
        inputs.push(socket("Base Color", "RGBA", json!([0.8, 0.5, 0.25, 1.0])));
        inputs.push(socket("Subsurface Radius", "VECTOR", json!([1.0, 0.5, 0.25])));
        let nodes = json!([
            {
                "name": "Output", "type": "ShaderNodeOutputMaterial", "properties": {"is_active_output": true},
                "inputs": [{"id": "Surface", "name": "Surface", "type": "SHADER", "enabled": true, "link": [1, 0]}],
            },
            {
                "name": "P", "type": "ShaderNodeBsdfPrincipled", "properties": {"subsurface_method": name},
                "inputs": inputs, "outputs": [{"id": "BSDF", "name": "BSDF", "type": "SHADER", "enabled": true}],
            },
        ]);
        let mut scene = BlenderScene::default();
        scene.set_document(&json!({"version": version}).to_string()).unwrap();
        scene.set_material(1, &json!({"name": "M", "nodes": {"nodes": nodes}}).to_string()).unwrap();
        scene.set_materials(&[1]).unwrap();
        let mut warnings = Warnings::new();
        let desc = scene.scene(&mut warnings).unwrap();
        let found = desc.materials[0].subsurface.unwrap();
        assert_eq!((found.method, found.shallow), (method, shallow), "{name}");
        assert_eq!(found.color, ColorInput::constant([0.8, 0.5, 0.25]));
        let radius = found.radius.factor.map(|r| (r * 1e4).round() / 1e4);
        assert_eq!(radius, [0.2, 0.1, 0.05]);
        let number = |input: ScalarInput| (input.factor * 1e4).round() / 1e4;
        assert_eq!([found.weight, found.anisotropy, found.ior].map(number), [0.5, 0.3, 1.3]);
        assert!(warnings.iter().all(|warning| !warning.what.contains("ubsurface")), "{warnings:?}");
    }
}
