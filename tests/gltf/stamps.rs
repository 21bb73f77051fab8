//! PENUMBRA_blender: lamps, cameras and worlds that Blender's exporter can't write.

use std::f64::consts::PI;

use penumbra::desc::{DecayLaw, LightDesc, LightKind, ProjectionDesc, SceneDesc};
use penumbra::import::ImportOptions;
use penumbra::math::DVec3;
use serde_json::{Value, json};

use super::{Glb, load, load_warned, load_with};

/// Blender's quarter turn from z up to y up, as the exporter writes it for lamps and cameras that are not turned.
const DOWN: [f64; 4] = [-std::f64::consts::FRAC_1_SQRT_2, 0.0, 0.0, std::f64::consts::FRAC_1_SQRT_2];

fn stamp(what: &Value) -> Value {
    let mut stamp = json!({ "version": 1, "blender": [5, 0, 1], "fps": 24 });
    stamp.as_object_mut().unwrap().extend(what.as_object().unwrap().clone());
    json!({ "PENUMBRA_blender": stamp })
}

/// A node tree of `shader`, which is linked to an output of type `output`.
fn tree(output: &str, shader: &Value) -> Value {
    let nodes = json!([
        { "name": "Out", "type": output, "properties": { "is_active_output": true, "target": "ALL" },
          "inputs": [{ "id": "Surface", "name": "Surface", "type": "SHADER", "enabled": true, "link": [1, 0] }] },
        shader,
        { "name": "Falloff", "type": "ShaderNodeLightFalloff",
          "inputs": [
            { "id": "Strength", "name": "Strength", "type": "VALUE", "enabled": true, "value": 0.5 },
            { "id": "Smooth", "name": "Smooth", "type": "VALUE", "enabled": true, "value": 0.25 },
          ],
          "outputs": [
            { "id": "Quadratic", "name": "Quadratic", "type": "VALUE", "enabled": true },
            { "id": "Linear", "name": "Linear", "type": "VALUE", "enabled": true },
          ] },
        { "name": "Sky", "type": "ShaderNodeTexEnvironment",
          "properties": { "image": "sky", "projection": "EQUIRECTANGULAR", "interpolation": "Linear" },
          "inputs": [{ "id": "Vector", "name": "Vector", "type": "VECTOR", "enabled": true, "hide_value": true }],
          "outputs": [{ "id": "Color", "name": "Color", "type": "RGBA", "enabled": true }] },
    ]);
    json!({ "name": "Tree", "nodes": nodes })
}

fn emission(kind: &str, color: &Value, strength: &Value) -> Value {
    json!({
        "name": "Emission", "type": kind,
        "inputs": [
            { "id": "Color", "name": "Color", "type": "RGBA", "enabled": true, "value": [0.5, 1, 1, 1], "link": color },
            { "id": "Strength", "name": "Strength", "type": "VALUE", "enabled": true, "value": 2, "link": strength },
        ],
        "outputs": [{ "id": "Emission", "name": "Emission", "type": "SHADER", "enabled": true }],
    })
}

/// A file with all that is stamped; the fuzzer starts from it, too.
pub fn rich() -> Glb {
    let world = tree("ShaderNodeOutputWorld", &emission("ShaderNodeBackground", &Value::Null, &Value::Null));
    let lamp = tree("ShaderNodeOutputLight", &emission("ShaderNodeEmission", &Value::Null, &json!([2, 1])));
    let json = json!({
        "asset": { "version": "2.0", "generator": "Khronos glTF Blender I/O v5.0.21" },
        "extensionsUsed": ["PENUMBRA_blender"],
        "scene": 0,
        "scenes": [{ "nodes": [0, 1, 2], "extensions": stamp(&json!({ "world": { "name": "World", "nodes": world } })) }],
        "nodes": [
            { "name": "Area", "rotation": DOWN, "translation": [0, 3, 0], "scale": [2, 1, 1], "extensions": stamp(&json!({
                "light": { "name": "Area", "type": "AREA", "energy": 100, "shape": "ELLIPSE", "size": 0.5, "size_y": 0.25,
                           "spread": 1, "use_shadow": false, "lightgroup": "key", "visibility": { "camera": false } },
                "frames": [{ "frame": 3, "changes": { "light": { "energy": 200 } } }, { "frame": 10 }],
            })) },
            { "name": "Point", "scale": [2, 2, 2], "extensions": stamp(&json!({
                "light": { "name": "Point", "type": "POINT", "energy": 100, "radius": 0.1, "nodes": lamp,
                           "matrix": [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]] },
                "images": { "sky": { "path": "textures/sky.exr", "colorspace": "Linear Rec.709" } },
            })) },
            { "name": "Camera", "rotation": DOWN, "extensions": stamp(&json!({
                "camera": { "name": "Camera", "type": "PANO", "dof": { "distance": 3 },
                            "panorama": { "panorama_type": "EQUIRECTANGULAR", "latitude_min": 0 } },
                "render": { "size": [400, 200], "film_transparent": true, "exposure": 2, "border": [10, 20, 110, 120] },
                "active": true,
            })) },
        ],
    });
    Glb { json, bin: vec![0; 4] }
}

fn light<'a>(scene: &'a SceneDesc, name: &str) -> &'a LightDesc {
    scene.lights.iter().find(|light| &*light.name == name).unwrap()
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-9, "{found} is not {expected}");
}

#[test]
fn lamps_are_what_blender_has() {
    let scene = load(&rich());
    let area = light(&scene, "Area");
    let LightKind::Disk { width, height, radiance, spread, .. } = area.kind else { panic!("{area:?}") };
    // L = P / (π A); the object's scale counts.
    near(width, 1.0);
    near(height, 0.25);
    near(radiance[0], 100.0 / (PI * 0.25 * PI * 0.25));
    assert_eq!((spread, area.links.cast_shadow, area.visibility.camera), (1.0, false, false));
    assert_eq!(area.links.group.as_deref(), Some("key"));
    assert!((area.transform.matrix3.z_axis - DVec3::Y).length() < 1e-9, "it shines down");
    // The point is as large as its object has it in Blender, where scale does nothing; L = P / (4 π² r²).
    let point = light(&scene, "Point");
    let LightKind::Sphere { radius, radiance, facing } = point.kind else { panic!("{point:?}") };
    near(radius, 0.1);
    near(radiance[0], 100.0 * 0.5 * 0.5 / (4.0 * PI * PI * 0.01));
    assert!(facing);
    assert_eq!((point.decay.law, point.decay.smooth), (DecayLaw::Linear, 0.25));
}

#[test]
fn worlds_and_cameras_are_what_blender_has() {
    let scene = load(&rich());
    let LightKind::Dome { radiance, image: None } = light(&scene, "World").kind else { panic!() };
    assert_eq!(radiance, [1.0, 2.0, 2.0]);
    let camera = &scene.cameras[0];
    let ProjectionDesc::Equirectangular { latitude, .. } = camera.projection else { panic!("{camera:?}") };
    assert_eq!((latitude[0], camera.exposure), (0.0, 2.0));
    assert_eq!(camera.lens.unwrap().focus_distance, 3.0);
    assert_eq!(
        (scene.render.framing.camera.as_deref(), scene.render.framing.resolution),
        (Some("Camera"), Some([400, 200]))
    );
    assert_eq!((scene.render.film_transparent, scene.render.crop), (Some(true), Some([10, 80, 100, 100])));
}

/// The stamp's frames are Blender's; glTF counts seconds.
#[test]
fn what_is_animated_has_the_frame_that_is_asked_for() {
    for (frame, fps, watts) in [
        (1.0, 24.0, 100.0),
        (2.9, 24.0, 100.0),
        (3.0, 24.0, 200.0),
        (9.0, 24.0, 200.0),
        (10.0, 24.0, 100.0),
        (3.0, 48.0, 100.0),
    ] {
        let scene = load_with(&rich(), &ImportOptions { frame: Some(frame), fps, ..ImportOptions::default() });
        near(light(&scene, "Area").kind.color()[0], watts / (PI * 0.25 * PI * 0.25));
    }
}

/// Where a node was moved and scaled after Blender, so was its lamp.
#[test]
fn edits_of_the_node_count() {
    let mut glb = rich();
    glb.json["nodes"][1]["scale"] = json!([6, 6, 6]);
    glb.json["nodes"][1]["translation"] = json!([1, 2, 3]);
    let scene = load(&glb);
    let LightKind::Sphere { radius, .. } = light(&scene, "Point").kind else { panic!() };
    near(radius, 0.3);
    assert_eq!(light(&scene, "Point").transform.translation, DVec3::new(1.0, 2.0, 3.0));
}

/// The image's centre is Blender's +x, its top +z: our +x and +y.
#[test]
fn the_image_of_a_world_is_upright() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    image::RgbImage::new(4, 2).save(folder.path().join("textures/sky.png")).unwrap();
    let mut glb = rich();
    let world = tree("ShaderNodeOutputWorld", &emission("ShaderNodeBackground", &json!([3, 0]), &Value::Null));
    glb.json["scenes"][0]["extensions"] = stamp(&json!({
        "world": { "name": "World", "nodes": world },
        "images": { "sky": { "path": "textures/sky.png", "colorspace": "sRGB" } },
    }));
    let path = folder.path().join("file.glb");
    std::fs::write(&path, glb.bytes()).unwrap();
    let mut warnings = penumbra::error::Warnings::new();
    let scene = penumbra::import::scene(&path, &ImportOptions::default(), &mut warnings).unwrap();
    assert_eq!(warnings.len(), 0, "{warnings:?}");
    let world = light(&scene, "World");
    let LightKind::Dome { radiance, image: Some(image) } = world.kind else { panic!("{world:?}") };
    assert_eq!((radiance, scene.images[image as usize].width), ([2.0; 3], 4));
    let turned = |v: DVec3| (world.transform.transform_vector3(v) - v).length() < 1e-9;
    assert!(turned(DVec3::X) && turned(DVec3::Y), "{:?}", world.transform);
}

#[test]
fn broken_stamps_leave_plain_gltf() {
    for broken in [json!(3), json!({}), json!({ "version": 2 }), json!({ "version": 1, "light": { "energy": "much" } })]
    {
        let mut glb = rich();
        let nodes = glb.json["nodes"].as_array_mut().unwrap();
        nodes.truncate(1);
        nodes[0]["extensions"]["PENUMBRA_blender"] = broken;
        nodes[0]["extensions"]["KHR_lights_punctual"] = json!({ "light": 0 });
        glb.json["scenes"][0] = json!({ "nodes": [0] });
        glb.json["asset"]["generator"] = json!("hand");
        glb.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([{ "type": "point", "intensity": 683 }]);
        let scene = load_warned(&glb, &["Area", "PENUMBRA_blender is left out"]);
        assert!(matches!(light(&scene, "Area").kind, LightKind::Point { intensity: [1.0, ..] }));
    }
}

#[test]
fn a_camera_that_sees_nothing_is_told() {
    let mut glb = rich();
    glb.json["nodes"][2]["extensions"]["PENUMBRA_blender"]["camera"]["clip_end"] = json!(0);
    assert!(load_warned(&glb, &["Camera", "not above 0"]).cameras.is_empty());
}

/// Blender's own export: the cone is Blender's, and what is lost is told once.
#[test]
fn plain_files_of_blender_are_told_of() {
    let mut glb = rich();
    glb.json["nodes"] = json!([
        { "name": "Spot", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "name": "Other", "extensions": { "KHR_lights_punctual": { "light": 0 } } },
    ]);
    glb.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    let spot = json!({ "type": "spot", "intensity": 683, "spot": { "innerConeAngle": 0.3, "outerConeAngle": 0.4 } });
    glb.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([spot]);
    let scene = load_warned(&glb, &["exported by Blender alone", "area lamps"]);
    let Some(penumbra::desc::ConeDesc::Blend { angle, blend }) = light(&scene, "Spot").shaping.cone else { panic!() };
    near(angle, 0.4);
    near(blend, 0.25);
}
