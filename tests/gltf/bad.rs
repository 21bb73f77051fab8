//! Bad input: one clear error or warning that names file and node, never a panic.

use penumbra::error::Error;
use penumbra::import::{ImportOptions, scene};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::glb::Glb;
use super::{load_warned, read, refused};

#[test]
fn a_missing_file_and_a_foreign_extension() {
    let open = |path: &str| scene(path.as_ref(), &ImportOptions::default(), &mut Default::default()).unwrap_err();
    let error = open("no/such/file.glb");
    assert!(matches!(error, Error::Io { .. }) && error.to_string().contains("no/such/file.glb"), "{error}");
    assert!(matches!(open("no/such/scene.usda"), Error::Io { .. }));
    assert!(matches!(open("scene.fbx"), Error::Unsupported { .. }));
}

#[test]
fn a_missing_buffer_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut glb = Glb::triangle();
    glb.json["buffers"] = json!([{"uri": "gone.bin", "byteLength": 36}]);
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, glb.json.to_string()).unwrap();
    let message = scene(&path, &ImportOptions::default(), &mut Default::default()).unwrap_err().to_string();
    assert!(message.contains("a.gltf") && message.contains("buffer 0") && message.contains("gone.bin"), "{message}");
}

#[test]
fn truncation_at_every_byte_is_an_error() {
    let bytes = Glb::triangle().bytes();
    for length in 0..bytes.len() {
        refused(&bytes[..length], &[]);
    }
}

/// Ways in which the structure of a triangle's file can be broken, and words of the message.
#[test]
fn broken_structure_is_refused_with_its_place() {
    let cases: &[(&str, Value, &[&str])] = &[
        ("/buffers", json!([{"byteLength": 1000}]), &["buffer 0", "truncated"]),
        ("/bufferViews/0/byteLength", json!(1000), &["'M'", "POSITION", "buffer view 0"]),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), &["'M'", "buffer view 0"]),
        ("/bufferViews/0/byteStride", json!(4), &["'M'", "stride"]),
        ("/bufferViews/0/buffer", json!(3), &["'M'", "buffer 3"]),
        ("/accessors/0/count", json!(4), &["'M'", "accessor 0"]),
        ("/accessors/0/count", json!(u64::MAX), &["'M'", "accessor 0"]),
        ("/accessors/0/byteOffset", json!(4), &["'M'", "accessor 0"]),
        ("/accessors/0/bufferView", json!(9), &["'M'", "buffer view 9"]),
        ("/accessors/0/componentType", json!(5124), &["'M'", "5124"]),
        ("/accessors/0/type", json!("VEC2"), &["'M'", "VEC2"]),
        ("/accessors/0/type", json!("VEC9"), &["'M'", "VEC9"]),
        ("/accessors/0", json!({"componentType": 5126, "type": "VEC3", "count": 1u64 << 40}), &["'M'", "accessor 0"]),
        ("/meshes/0/primitives/0/attributes/POSITION", json!(5), &["'M'", "accessor 5"]),
        ("/meshes/0/primitives/0/indices", json!(0), &["'M'", "indices"]),
        ("/asset/version", json!("3.0"), &["3.0"]),
        ("/nodes", json!([{"mesh": -1}]), &["glTF 2.0"]),
        ("/extensionsRequired", json!(["VENDOR_x", "VENDOR_y"]), &["VENDOR_x, VENDOR_y"]),
    ];
    for (pointer, value, words) in cases {
        let mut glb = Glb::triangle();
        glb.json["buffers"] = json!([{"byteLength": glb.bin.len()}]);
        glb.set(pointer, value.clone());
        refused(&glb.bytes(), words);
    }
}

#[test]
fn points_that_are_not_finite_lose_their_triangles() {
    let mut glb = Glb::new();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f32::NAN, f32::INFINITY, 0.0];
    let position = glb.floats("VEC3", &corners);
    let indices = glb.indices(&[0, 1, 2, 1, 2, 3]);
    let primitive = json!({"attributes": {"POSITION": position}, "indices": indices});
    glb.push("meshes", json!({"name": "Rock", "primitives": [primitive]}));
    glb.push("nodes", json!({"mesh": 0}));
    let scene = load_warned(&glb, &["'Rock'", "1 points", "1 triangles"]);
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2]]);
    assert!(scene.meshes[0].points.iter().flatten().all(|v| v.is_finite()));
}

#[test]
fn indices_out_of_range_lose_their_triangles() {
    let mut glb = Glb::triangle();
    let indices = glb.indices(&[0, 1, 2, 0, 1, 9]);
    glb.set("/meshes/0/primitives/0/indices", json!(indices));
    assert_eq!(load_warned(&glb, &["'M'", "1 triangles"]).meshes[0].triangles, [[0, 1, 2]]);
}

#[test]
fn triangles_without_area_are_dropped() {
    let mut glb = Glb::triangle();
    let indices = glb.indices(&[0, 1, 1, 0, 1, 2]);
    glb.set("/meshes/0/primitives/0/indices", json!(indices));
    assert_eq!(super::load(&glb).meshes[0].triangles, [[0, 1, 2]]);
    let indices = glb.indices(&[0, 1, 1]);
    glb.set("/meshes/0/primitives/0/indices", json!(indices));
    assert!(load_warned(&glb, &["'M'", "area"]).meshes.is_empty());
}

#[test]
fn normals_without_direction_are_mended() {
    let mut glb = Glb::triangle();
    let normal = glb.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 1.0, 0.0]);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    let scene = load_warned(&glb, &["'M'", "2 normals"]);
    let normals = super::points(scene.meshes[0].normals.as_ref().unwrap());
    assert_eq!(normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn nodes_that_cannot_be_placed_are_named() {
    let cases: &[(Value, &[&str])] = &[
        (json!({"name": "Flat", "mesh": 0, "scale": [1, 0, 1]}), &["Flat", "singular"]),
        (json!({"name": "Far", "mesh": 0, "translation": [1e300, 0, 0]}), &["Far", "finite"]),
        (json!({"name": "Loop", "mesh": 0, "children": [0]}), &["Loop", "ancestor"]),
        (json!({"name": "Kids", "children": [77]}), &["77"]),
        (json!({"name": "Lost", "mesh": 8}), &["Lost", "mesh 8"]),
        (json!({"name": "Blind", "camera": 8}), &["Blind", "camera 8"]),
        (json!({"name": "Dark", "extensions": {"KHR_lights_punctual": {"light": 8}}}), &["Dark", "light 8"]),
    ];
    for (node, words) in cases {
        let mut glb = Glb::triangle();
        glb.json["nodes"][0] = node.clone();
        glb.push("scenes", json!({"nodes": [0]}));
        load_warned(&glb, words);
    }
}

#[test]
fn cameras_and_lights_that_mean_nothing_are_named() {
    let mut glb = Glb::triangle();
    glb.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0, "znear": 0.1}}));
    glb.set("/nodes/0/camera", json!(0));
    assert!(load_warned(&glb, &["N", "field of view"]).cameras.is_empty());
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "tube"}]}});
    glb.set("/nodes/0/extensions", json!({"KHR_lights_punctual": {"light": 0}}));
    assert!(load_warned(&glb, &["N", "tube"]).lights.is_empty());
}

#[test]
fn instances_without_end_are_refused() {
    // 300 nodes × 300 primitives × 4096 instances of zeros in a file of some kilobytes.
    let mut glb = Glb::triangle();
    let zeros = glb.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 4096}));
    let primitive = glb.json["meshes"][0]["primitives"][0].clone();
    glb.json["meshes"][0]["primitives"] = json!(vec![primitive; 300]);
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": zeros}}});
    glb.json["nodes"] = json!(vec![json!({"mesh": 0, "extensions": instancing}); 300]);
    refused(&glb.bytes(), &["instances"]);
}

#[test]
fn animation_that_does_not_fit_is_told() {
    for (output, words) in [(vec![1.0; 5], &["channel 0", "translation"][..]), (vec![f32::NAN; 6], &["finite"][..])] {
        let mut glb = Glb::triangle();
        let times = glb.floats("SCALAR", &[0.0, 1.0]);
        let kind = if output.len() == 6 { "VEC3" } else { "SCALAR" };
        let output = glb.floats(kind, &output);
        let samplers = json!([{"input": times, "output": output}]);
        let channels = json!([{"sampler": 0, "target": {"node": 0, "path": "translation"}}]);
        glb.push("animations", json!({"samplers": samplers, "channels": channels}));
        let (scene, warnings) = read(&glb.bytes(), &ImportOptions { frame: Some(3.0), ..ImportOptions::default() });
        assert_eq!((scene.unwrap().instances.len(), warnings.len()), (1, 1), "{warnings:?}");
        for word in words {
            assert!(warnings[0].contains(word), "'{word}' in '{}'", warnings[0]);
        }
    }
}

#[test]
fn an_animation_pointer_to_what_holds_no_number_is_told() {
    let mut glb = Glb::triangle();
    let (times, values) = (glb.floats("SCALAR", &[0.0]), glb.floats("SCALAR", &[0.5]));
    let position = glb.floats("VEC3", &[3.0, 0.0, 0.0]);
    let pointer = json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/0/mesh"}}});
    let samplers = json!([{"input": times, "output": values}, {"input": times, "output": position}]);
    let channels =
        json!([{"sampler": 0, "target": pointer}, {"sampler": 1, "target": {"node": 0, "path": "translation"}}]);
    glb.push("animations", json!({"samplers": samplers, "channels": channels}));
    let (scene, warnings) = read(&glb.bytes(), &ImportOptions { frame: Some(0.0), ..ImportOptions::default() });
    assert!(warnings.len() == 1 && warnings[0].contains("KHR_animation_pointer"), "{warnings:?}");
    assert_eq!(scene.unwrap().instances[0].transform.translation.x, 3.0);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, rng_seed: proptest::test_runner::RngSeed::Fixed(7), ..ProptestConfig::default() })]

    /// Flipped bytes anywhere, and a cut: an error or a scene that keeps its rules.
    #[test]
    fn damaged_files_never_panic(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        cut in prop::option::weighted(0.1, any::<prop::sample::Index>()),
        frame in prop::option::of(0.0..48.0),
        file in 0_usize..3,
    ) {
        let files: [&[u8]; 3] = [
            include_bytes!("../data/gltf/rig.glb"),
            include_bytes!("../data/gltf/tangents.glb"),
            include_bytes!("../data/gltf/draco.glb"),
        ];
        let mut bytes = files[file].to_vec();
        for (at, value) in flips {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = read(&bytes, &ImportOptions { frame, ..ImportOptions::default() });
    }
}
