//! Light that insides absorb, against the law of Beer and Lambert, and what Blender's nodes mean by them.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput, SceneDesc, VolumeDesc};
use penumbra::error::Warnings;
use penumbra::import::blender::BlenderScene;
use penumbra::math::{DAffine3, DVec3};
use scene::{Builder, close, mean, picture, settings};
use serde_json::{Value, json};

const DOWN: [f64; 3] = [0.0, -1.0, 0.0];
/// Per metre.
const SIGMA: [f64; 3] = [0.4, 0.8, 0.0];

/// A volume that absorbs [`SIGMA`] times `strength`, and no surface.
fn fog(builder: &mut Builder, strength: f64) -> u32 {
    builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        transparency: ColorInput::constant([1.0; 3]),
        volume: Some(VolumeDesc {
            thickness: ScalarInput::constant(1.0),
            attenuation_distance: 1.0 / strength,
            attenuation_color: SIGMA.map(|sigma| (-sigma).exp()),
            adds: true,
        }),
        ..MaterialDesc::default()
    })
}

/// A box between two corners, its faces turned outwards, none of its diagonals near the middle.
fn block(builder: &mut Builder, from: [f64; 3], to: [f64; 3], material: u32) {
    let corner = |i: u32| -> [f32; 3] {
        let side = |k: usize| if (i >> k) & 1 == 0 { from[k] } else { to[k] };
        [side(0) * 1.1, side(1), side(2) * 0.9].map(|v| v as f32)
    };
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    builder.mesh((0..8).map(corner).collect(), triangles, material, DAffine3::IDENTITY);
}

fn glowing(builder: &mut Builder) -> u32 {
    builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.0; 3]),
        specular: ScalarInput::constant(0.0),
        emission: ColorInput::constant([1.0; 3]),
        ..MaterialDesc::default()
    })
}

/// `what` is left after `length` metres of strength 1.
fn left(what: &str, found: impl Fn(usize) -> f64, scale: f64, length: f64, tolerance: f64) {
    for (channel, sigma) in SIGMA.iter().enumerate() {
        close(&format!("{what}, channel {channel}"), found(channel), scale * (-sigma * length).exp(), tolerance);
    }
}

#[test]
fn what_lies_behind_a_volume_is_seen_by_its_thickness() {
    let mut builder = Builder::default();
    let (lamp, volume) = (glowing(&mut builder), fog(&mut builder, 1.0));
    builder.ground(9.0, lamp);
    block(&mut builder, [-3.0, 1.0, -3.0], [3.0, 2.5, 3.0], volume);
    builder.look([0.0, 3.5, 0.0], DOWN, 0.1);
    let seen = picture(&builder.desc, 4, &settings("combined", 4));
    left("behind fog", |c| mean(&seen, "Combined", c), 1.0, 1.5, 1e-4);
    // From inside, one metre beneath the top.
    let mut inside = builder.clone();
    inside.desc.cameras.clear();
    inside.look([0.0, 0.5, 0.0], DOWN, 0.1);
    let seen = picture(&inside.desc, 4, &settings("combined", 4));
    left("from inside", |c| mean(&seen, "Combined", c), 1.0, 0.5, 1e-4);
}

#[test]
fn volumes_that_overlap_add_up() {
    let mut builder = Builder::default();
    let (lamp, thin, thick) = (glowing(&mut builder), fog(&mut builder, 1.0), fog(&mut builder, 2.0));
    builder.ground(9.0, lamp);
    // 1 m alone, 0.5 m together, 0.75 m of the second alone.
    block(&mut builder, [-3.0, 1.0, -3.0], [3.0, 2.5, 3.0], thin);
    block(&mut builder, [-2.0, 0.25, -2.0], [2.0, 1.5, 2.0], thick);
    builder.look([0.0, 3.5, 0.0], DOWN, 0.1);
    let seen = picture(&builder.desc, 4, &settings("combined", 4));
    left("through both", |c| mean(&seen, "Combined", c), 1.0, 1.5 + 2.0 * 1.25, 1e-4);
}

#[test]
fn lamps_shine_through_volumes_and_within_them() {
    let distant = LightKind::Distant { irradiance: [1.0; 3], angle: 0.0 };
    let mut builder = Builder::default();
    let (floor, volume) = (builder.lambert(0.5), fog(&mut builder, 1.0));
    builder.ground(9.0, floor);
    block(&mut builder, [-3.0, 1.0, -3.0], [3.0, 2.5, 3.0], volume);
    builder.light(distant, DAffine3::from_rotation_x(-std::f64::consts::FRAC_PI_2));
    // From below the volume.
    builder.look([0.0; 3], [0.0, -0.5, 0.2], 0.1);
    builder.desc.cameras[0].transform.translation *= 0.5;
    let lit = picture(&builder.desc, 4, &settings("combined,shadow,diffuse_direct", 16));
    let clear = 0.5 / std::f64::consts::PI;
    left("sun through fog", |c| mean(&lit, "Combined", c), clear, 1.5, 1e-3);
    left("its shadow", |c| mean(&lit, "Shadow", c), 1.0, 1.5, 1e-3);

    // A lamp and the floor in the same volume, seen from within: there and back.
    let mut builder = Builder::default();
    let (floor, volume) = (builder.lambert(0.5), fog(&mut builder, 1.0));
    builder.ground(9.0, floor);
    block(&mut builder, [-8.0, -1.0, -8.0], [8.0, 8.0, 8.0], volume);
    let lamp = LightKind::Point { intensity: [1.0; 3] };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(0.0, 2.0, 0.0)));
    builder.look([0.0; 3], DOWN, 0.01);
    let lit = picture(&builder.desc, 4, &settings("combined,shadow", 16));
    left("lamp within fog", |c| mean(&lit, "Combined", c), clear / 4.0, 3.0, 1e-3);
    left("its shadow", |c| mean(&lit, "Shadow", c), 1.0, 2.0, 1e-3);
}

#[test]
fn before_nothing_a_volume_covers_what_it_absorbs() {
    let mut builder = Builder::default();
    let volume = fog(&mut builder, 1.0);
    block(&mut builder, [-3.0, 1.0, -3.0], [3.0, 2.5, 3.0], volume);
    builder.dome(1.0);
    builder.desc.render.film_transparent = Some(true);
    builder.look([0.0, 3.5, 0.0], DOWN, 0.1);
    let seen = picture(&builder.desc, 4, &settings("combined,environment", 4));
    let lets_by = SIGMA.iter().map(|sigma| (-sigma * 1.5).exp()).sum::<f64>() / 3.0;
    close("alpha", mean(&seen, "Combined", 3), 1.0 - lets_by, 1e-4);
    left("environment", |c| mean(&seen, "Environment", c), 1.0, 1.5, 1e-4);
}

fn socket(id: &str, kind: &str, value: Value) -> Value {
    json!({"id": id, "name": id, "type": kind, "enabled": true, "value": value})
}

/// The material of a node at the Volume socket, by its type and inputs, with a glass at the Surface one if `surface`;
/// what is told.
fn of_blender(kind: &str, inputs: &[Value], surface: bool) -> (SceneDesc, Vec<String>) {
    let from = |id: &str, node: Option<u32>| {
        let link = node.map(|node| json!([node, 0]));
        json!({"id": id, "name": id, "type": "SHADER", "enabled": true, "link": link})
    };
    let output = json!([{"id": "Out", "name": "Out", "type": "SHADER", "enabled": true}]);
    let glass = [socket("Color", "RGBA", json!([1.0, 1.0, 1.0, 1.0])), socket("IOR", "VALUE", json!(1.5))];
    let nodes = json!([
        {
            "name": "Output", "type": "ShaderNodeOutputMaterial", "properties": {"is_active_output": true},
            "inputs": [from("Surface", surface.then_some(2)), from("Volume", Some(1))],
        },
        {"name": "V", "type": kind, "inputs": inputs, "outputs": output},
        {"name": "G", "type": "ShaderNodeBsdfGlass", "inputs": glass, "outputs": output},
        {
            "name": "Texture", "type": "ShaderNodeTexNoise", "inputs": [],
            "outputs": [{"id": "Fac", "name": "Fac", "type": "VALUE", "enabled": true}],
        },
    ]);
    let mut scene = BlenderScene::default();
    scene.set_document(&json!({"version": [5, 0, 1]}).to_string()).unwrap();
    scene.set_material(1, &json!({"name": "M", "nodes": {"nodes": nodes}}).to_string()).unwrap();
    scene.set_materials(&[1]).unwrap();
    let mut warnings = Warnings::new();
    let desc = scene.scene(&mut warnings).unwrap();
    (desc, warnings.iter().map(|warning| warning.what.clone()).collect())
}

/// Per metre.
fn sigma(desc: &SceneDesc) -> [f64; 3] {
    let volume = desc.materials[0].volume.unwrap();
    assert!(volume.adds);
    volume.attenuation_color.map(|color| (-color.ln() / volume.attenuation_distance * 1e6).round() / 1e6 + 0.0)
}

#[test]
fn nodes_of_blender_say_what_their_volume_absorbs() {
    let color = json!([0.75, 0.5, 1.0, 1.0]);
    let absorption = [socket("Color", "RGBA", color), socket("Density", "VALUE", json!(4.0))];
    let (desc, told) = of_blender("ShaderNodeVolumeAbsorption", &absorption, false);
    assert_eq!(sigma(&desc), [1.0, 2.0, 0.0]);
    assert_eq!((desc.materials[0].transparency.factor, told.len()), ([1.0; 3], 0), "{told:?}");
    let (desc, told) = of_blender("ShaderNodeVolumeAbsorption", &absorption, true);
    assert_eq!(sigma(&desc), [1.0, 2.0, 0.0]);
    assert_eq!((desc.materials[0].transparency.factor, told.len()), ([0.0; 3], 0), "{told:?}");

    // (1 − color) (1 − √absorption color) × density, and what it scatters and emits is told once.
    let principled = [
        socket("Color", "RGBA", json!([0.5, 0.5, 0.0, 1.0])),
        socket("Absorption Color", "RGBA", json!([0.25, 0.0, 0.81, 1.0])),
        socket("Density", "VALUE", json!(2.0)),
        socket("Emission Strength", "VALUE", json!(1.0)),
        socket("Blackbody Intensity", "VALUE", json!(0.0)),
    ];
    let (desc, told) = of_blender("ShaderNodeVolumePrincipled", &principled, false);
    assert_eq!(sigma(&desc), [0.5, 1.0, 0.2]);
    assert!(told.len() == 1 && told[0].contains("scatters and emits"), "{told:?}");

    let coefficients = [
        socket("Absorption Coefficients", "VECTOR", json!([1.0, 2.0, 3.0])),
        socket("Scatter Coefficients", "VECTOR", json!([0.0, 0.0, 0.0])),
        socket("Emission Coefficients", "VECTOR", json!([0.0, 0.0, 0.0])),
    ];
    let (desc, told) = of_blender("ShaderNodeVolumeCoefficients", &coefficients, false);
    assert_eq!((sigma(&desc), told.len()), ([1.0, 2.0, 3.0], 0), "{told:?}");

    // A density that varies: that of the socket.
    let mut density = socket("Density", "VALUE", json!(4.0));
    density["link"] = json!([3, 0]);
    let (desc, told) = of_blender("ShaderNodeVolumeAbsorption", &[absorption[0].clone(), density], false);
    assert_eq!(sigma(&desc), [1.0, 2.0, 0.0]);
    assert!(told.len() == 1 && told[0].contains("Density"), "{told:?}");
}

#[test]
fn the_volume_of_a_world_is_told() {
    let output = json!([{"id": "Out", "name": "Out", "type": "SHADER", "enabled": true}]);
    let nodes = json!([
        {
            "name": "Output", "type": "ShaderNodeOutputWorld", "properties": {"is_active_output": true},
            "inputs": [
                {"id": "Surface", "name": "Surface", "type": "SHADER", "enabled": true},
                {"id": "Volume", "name": "Volume", "type": "SHADER", "enabled": true, "link": [1, 0]},
            ],
        },
        {"name": "V", "type": "ShaderNodeVolumeScatter", "inputs": [], "outputs": output},
    ]);
    let mut scene = BlenderScene::default();
    let document = json!({"version": [5, 0, 1], "world": {"name": "W", "nodes": {"nodes": nodes}}});
    scene.set_document(&document.to_string()).unwrap();
    let mut warnings = Warnings::new();
    scene.scene(&mut warnings).unwrap();
    assert!(warnings.iter().any(|warning| warning.what.contains("the world's volume")), "{warnings:?}");
}
