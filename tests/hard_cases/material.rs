//! Surfaces that are too smooth, too white, barely there or wrongly made.

use std::f64::consts::{FRAC_PI_2, PI};

use penumbra::desc::{
    AlphaMode, Attribute, Blending, ColorInput, ColorSpace, Filter, ImageDesc, LightKind, MaterialDesc, MeshDesc,
    NormalInput, PixelData, ScalarInput, TextureDesc, TextureRef, TextureTransform, VolumeDesc, Wrap,
};
use penumbra::error::Place;
use penumbra::math::DAffine3;

use crate::row::{Row, hold};
use crate::scene::Builder;

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];

fn number(value: f64) -> ScalarInput {
    ScalarInput::constant(value)
}

fn white(material: MaterialDesc) -> MaterialDesc {
    MaterialDesc { base_color: ColorInput::constant([1.0; 3]), ..material }
}

/// A floor of `material` in a world of radiance 1, seen from `degrees` off its normal: its albedo.
fn furnace(material: MaterialDesc, degrees: f64) -> Builder {
    let mut scene = Builder::default();
    let material = scene.material(material);
    scene.ground(10.0, material);
    scene.dome(1.0);
    let angle = degrees.to_radians();
    scene.look([0.0; 3], [angle.sin(), -angle.cos(), 0.0], 1e-4);
    scene
}

fn inside(distance: f64, color: f64) -> Option<VolumeDesc> {
    Some(VolumeDesc {
        thickness: number(1.0),
        attenuation_distance: distance,
        attenuation_color: [color; 3],
        adds: false,
    })
}

fn glass(ior: f64, roughness: f64) -> MaterialDesc {
    white(MaterialDesc {
        ior: number(ior),
        roughness: number(roughness),
        transmission: number(1.0),
        volume: inside(f64::INFINITY, 1.0),
        ..MaterialDesc::default()
    })
}

#[test]
fn roughness() {
    let mut rows = Vec::new();
    for roughness in [0.0, 1e-7, 1e-4, 1e-2, 0.1, 0.5, 1.0] {
        for degrees in [45.0, 89.999] {
            let metal =
                white(MaterialDesc { metallic: number(1.0), roughness: number(roughness), ..MaterialDesc::default() });
            let name =
                format!("white metal of roughness {roughness:e} in a white world, {degrees} degrees from its normal");
            let row = Row::new(name, furnace(metal, degrees), "Combined", 1024, 1.0, 3e-3);
            let narrow = roughness == 1e-2 && degrees > 45.0;
            rows.push(if narrow {
                row.open("energy tables have a node each 1/63 of cosine; here it matters within 1e-4")
            } else {
                row
            });
        }
    }
    hold("roughness", rows);
}

#[test]
fn index_of_refraction() {
    let mut rows = Vec::new();
    for ior in [1.0, 1.0 + 1e-6, 1.0 - 1e-6, 0.5, 3.0] {
        for roughness in [0.0, 0.3] {
            for degrees in [45.0, 89.999] {
                let name = format!(
                    "white glass of index {ior} and roughness {roughness} in a white world, {degrees} degrees from its normal"
                );
                rows.push(Row::new(name, furnace(glass(ior, roughness), degrees), "Combined", 1024, 1.0, 4e-3));
            }
        }
    }
    // Closed, so that paths go in and out of it, and round and round.
    for ior in [1.0, 1.0 + 1e-6, 0.5, 1.5, 3.0] {
        let mut scene = Builder::default();
        let material = scene.material(glass(ior, 0.0));
        scene.sphere(12, false, material, DAffine3::IDENTITY);
        scene.dome(1.0);
        scene.look([0.0; 3], DOWN, 0.9);
        scene.desc.cameras[0].transform.translation *= 3.0;
        let row = Row::new(format!("ball of glass of index {ior} in a white world"), scene, "Combined", 64, 1.0, 4e-3);
        rows.push(row.sized(8, 8).with(|settings| settings.max_bounces = 1000));
    }
    hold("index", rows);
}

#[test]
fn nested() {
    let mut rows = Vec::new();
    let layer = |distance: f64, color: f64| MaterialDesc {
        specular: number(0.0),
        volume: inside(distance, color),
        ..glass(1.0, 0.0)
    };
    // A metre of one, then a metre of another within it.
    let mut scene = Builder::default();
    let (outer, inner) = (scene.material(layer(1.0, 0.5)), scene.material(layer(1.0, 0.25)));
    let glow = scene.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: number(0.0),
        emission: ColorInput::constant([1.0; 3]),
        ..MaterialDesc::default()
    });
    for (y, half, material) in [(3.0, 9.0, outer), (2.0, 5.0, inner), (1.0, 1.0, glow)] {
        scene.quad([-half, y, half], [2.0 * half, 0.0, 0.0], [0.0, 0.0, -2.0 * half], material);
    }
    scene.look([0.0, 3.5, 0.0], DOWN, 0.1);
    rows.push(
        Row::new(
            "a metre of a medium that halves light, then one of a medium in it that quarters it",
            scene,
            "Combined",
            64,
            0.125,
            1e-3,
        )
        .with(|settings| settings.max_bounces = 12),
    );

    // Ball in ball in ball.
    let mut scene = Builder::default();
    for (i, ior) in [1.5, 1.33, 2.4].into_iter().enumerate() {
        let material = scene.material(glass(ior, 0.0));
        let radius = 1.0 - 0.3 * i as f64;
        scene.sphere(12, false, material, DAffine3::from_scale(penumbra::math::DVec3::splat(radius)));
    }
    scene.dome(1.0);
    scene.look([0.0; 3], DOWN, 0.9);
    scene.desc.cameras[0].transform.translation *= 3.0;
    rows.push(
        Row::new("balls of index 2.4 in 1.33 in 1.5 in a white world", scene, "Combined", 64, 1.0, 4e-3)
            .sized(8, 8)
            .with(|settings| settings.max_bounces = 1000),
    );
    hold("nested", rows);
}

/// Everything glows a little and loses nothing: radiance grows with every bounce.
#[test]
fn thousand_bounces() {
    let mut scene = Builder::default();
    let material = scene.material(white(MaterialDesc {
        specular: number(0.0),
        roughness: number(1.0),
        emission: ColorInput::constant([1e-3; 3]),
        ..MaterialDesc::default()
    }));
    scene.sphere(8, false, material, DAffine3::IDENTITY);
    scene.look([0.0, -0.5, 0.0], DOWN, 0.4);
    let row = Row::new("closed box of albedo 1, 1,000 bounces", scene, "Combined", 16, 1.002, 5e-3);
    hold("bounces", vec![row.with(|settings| settings.max_bounces = 1000)]);
}

/// An image of float RGB on the floor, by its constant coordinates.
fn textured(texels: Vec<f32>, size: u32, change: impl FnOnce(TextureRef) -> MaterialDesc) -> Builder {
    let mut scene = Builder::default();
    scene.desc.images.push(std::sync::Arc::new(ImageDesc {
        name: "image".into(),
        place: Place::default(),
        width: size,
        height: size,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::F32(texels),
    }));
    let [wrap_u, wrap_v] = [Wrap::Repeat; 2];
    scene.desc.textures.push(TextureDesc {
        place: Place::default(),
        image: 0,
        wrap_u,
        wrap_v,
        filter: Filter::Nearest,
    });
    let material = scene.material(change(TextureRef { texture: 0, uv_set: 0, transform: TextureTransform::IDENTITY }));
    let points = vec![[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0]];
    let uvs = vec![Attribute::Point(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])];
    let mesh = MeshDesc { points, triangles: vec![[0, 1, 2], [0, 2, 3]], uvs, ..MeshDesc::default() };
    scene.instance(mesh, material, DAffine3::IDENTITY);
    scene
}

#[test]
fn maps() {
    let mut rows = Vec::new();
    // Normals that point along the surface, into it, and nowhere; from 60 degrees aside.
    for (name, normal) in [
        ("along the surface", [1.0, 0.5, 0.5]),
        ("into the surface", [0.5, 0.5, 0.0]),
        ("aside and into it", [1.0, 0.5, 0.2]),
        ("nowhere", [0.5; 3]),
    ] {
        for (kind, metallic) in [("matte", 0.0), ("metal", 1.0)] {
            let mut scene = textured(normal.to_vec(), 1, |texture| {
                white(MaterialDesc {
                    specular: number(0.0),
                    metallic: number(metallic),
                    roughness: number(if metallic > 0.0 { 0.2 } else { 1.0 }),
                    normal: Some(NormalInput::Map { texture, scale: 1.0 }),
                    ..MaterialDesc::default()
                })
            });
            scene.dome(1.0);
            scene.look([0.0; 3], [0.866, -0.5, 0.0], 0.1);
            let row = Row::new(
                format!("normals {name}, white {kind} in a white world: light above 1"),
                scene,
                "Combined",
                256,
                0.0,
                4e-3,
            );
            rows.push(row.by(|picture, _| {
                let values = picture.layer("Combined").unwrap().data.chunks(4).map(|pixel| f64::from(pixel[0]));
                let values: Vec<f64> = values.collect();
                assert!(values.iter().all(|v| *v >= 0.0));
                (values.iter().sum::<f64>() / values.len() as f64 - 1.0).max(0.0)
            }));
        }
    }
    // Three texels of four are of no use.
    for (name, bad) in
        [("NaN", f32::NAN), ("infinity", f32::INFINITY), ("-infinity", f32::NEG_INFINITY), ("1e-40", 1e-40)]
    {
        let texels = [vec![bad; 9], vec![0.5; 3]].concat();
        let mut scene = textured(texels, 2, |texture| MaterialDesc {
            base_color: ColorInput::textured([1.0; 3], Some(texture)),
            specular: number(0.0),
            roughness: number(1.0),
            ..MaterialDesc::default()
        });
        scene.dome(1.0);
        scene.look([0.0; 3], DOWN, 0.9);
        rows.push(
            Row::new(format!("texture with three texels of four {name}"), scene, "Combined", 256, 0.125, 5e-3)
                .sized(16, 16),
        );
    }
    hold("maps", rows);
}

#[test]
fn opacity() {
    let mut rows = Vec::new();
    for (opacity, truth) in [(0.0, 0.25), (1.0, 0.75)] {
        let mut scene = Builder::default();
        let floor = scene.lambert(0.25);
        let film = scene.material(MaterialDesc {
            base_color: ColorInput::constant([0.75; 3]),
            specular: number(0.0),
            alpha: number(opacity),
            alpha_mode: AlphaMode::Blend,
            ..MaterialDesc::default()
        });
        scene.ground(10.0, floor);
        scene.quad([-1.0, 0.5, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.0], film);
        scene.light(LightKind::Distant { irradiance: [PI; 3], angle: 0.0 }, DAffine3::from_rotation_x(-FRAC_PI_2));
        scene.look([0.0; 3], DOWN, 0.1);
        rows.push(Row::new(format!("film of opacity {opacity} above a floor"), scene, "Combined", 16, truth, 1e-6));
    }
    hold("opacity", rows);
}
