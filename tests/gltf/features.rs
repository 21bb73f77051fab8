//! Geometry, nodes, cameras and lights.

use std::f64::consts::FRAC_PI_2;

use penumbra::desc::{ConeDesc, LightKind, ProjectionDesc};
use penumbra::import::{ImportOptions, LightUnits};
use serde_json::json;

use super::glb::Glb;
use super::{load, load_warned, load_with, points};

#[test]
fn a_triangle_without_anything() {
    let scene = load(&Glb::triangle());
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.points, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert!(mesh.normals.is_none(), "flat without NORMAL");
    assert_eq!((&*scene.instances[0].name, scene.instances[0].object_index), ("N", 1));
    // The specification's default material is a white, rough metal.
    let material = &scene.materials[scene.instances[0].materials[0].unwrap() as usize];
    assert_eq!((material.base_color.factor, material.metallic.factor, material.roughness.factor), ([1.0; 3], 1.0, 1.0));
}

#[test]
fn every_mode_with_area_indexed_or_not() {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];
    for (mode, indices, expected) in [
        (4, None, vec![[0, 1, 2]]),
        (4, Some(vec![0, 1, 2, 2, 1, 3]), vec![[0, 1, 2], [2, 1, 3]]),
        (5, None, vec![[0, 1, 2], [1, 3, 2]]),
        (5, Some(vec![3, 2, 1, 0]), vec![[3, 2, 1], [2, 0, 1]]),
        (6, Some(vec![0, 1, 3, 2]), vec![[1, 3, 0], [3, 2, 0]]),
    ] {
        let mut glb = Glb::new();
        // Three points make the unindexed list one triangle.
        let used = if mode == 4 && indices.is_none() { &corners[..9] } else { &corners[..] };
        let position = glb.floats("VEC3", used);
        let mut primitive = json!({"attributes": {"POSITION": position}, "mode": mode});
        if let Some(indices) = &indices {
            primitive["indices"] = json!(glb.indices(indices));
        }
        glb.push("meshes", json!({"primitives": [primitive]}));
        glb.push("nodes", json!({"mesh": 0}));
        assert_eq!(load(&glb).meshes[0].triangles, expected, "mode {mode} {indices:?}");
    }
}

#[test]
fn points_and_lines_are_told_and_left_out() {
    for (mode, name) in [(0, "points"), (1, "lines"), (3, "line strip")] {
        let mut glb = Glb::triangle();
        glb.set("/meshes/0/primitives/0/mode", json!(mode));
        let scene = load_warned(&glb, &["'M'", name]);
        assert!(scene.meshes.is_empty() && scene.instances.is_empty());
    }
}

#[test]
fn quantized_normalized_and_interleaved_attributes() {
    let mut glb = Glb::new();
    // 16 bytes a vertex: i16 ×3 position, padding, i8 ×3 normalized normal, padding, u8 ×2 normalized UV, padding.
    let mut bytes = Vec::new();
    for [x, y] in [[0_i16, 0], [32767, 0], [0, -32767]] {
        for v in [x, y, 7] {
            bytes.extend(v.to_le_bytes());
        }
        bytes.extend([0, 0, 0, 0, 129, 0]); // normal 0 0 −127
        bytes.extend([255, 51, 0, 0]);
    }
    let view = glb.view(&bytes);
    glb.json["bufferViews"][view]["byteStride"] = json!(16);
    let accessor = |offset: usize, component: u32, kind: &str, normalized: bool| json!({"bufferView": view, "byteOffset": offset, "componentType": component, "type": kind, "count": 3, "normalized": normalized});
    let position = glb.push("accessors", accessor(0, 5122, "VEC3", false));
    let normal = glb.push("accessors", accessor(8, 5120, "VEC3", true));
    let uv = glb.push("accessors", accessor(12, 5121, "VEC2", true));
    glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let attributes = json!({"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv});
    glb.push("meshes", json!({"primitives": [{"attributes": attributes}]}));
    glb.push("nodes", json!({"mesh": 0}));
    let mesh = &load(&glb).meshes[0];
    assert_eq!(mesh.points, [[0.0, 0.0, 7.0], [32767.0, 0.0, 7.0], [0.0, -32767.0, 7.0]]);
    assert_eq!(points(mesh.normals.as_ref().unwrap()), [[0.0, 0.0, -1.0]; 3]);
    assert_eq!(points(&mesh.uvs[0]), [[1.0, 0.2]; 3]);
}

#[test]
fn sparse_accessors_over_data_and_over_nothing() {
    for with_data in [true, false] {
        let mut glb = Glb::triangle();
        let indices = glb.view(bytemuck::cast_slice(&[1_u16, 2]));
        let values = glb.view(bytemuck::cast_slice(&[5.0_f32, 0.0, 0.0, 0.0, 6.0, 0.0]));
        glb.json["accessors"][0]["sparse"] = json!({
            "count": 2, "indices": {"bufferView": indices, "componentType": 5123}, "values": {"bufferView": values}
        });
        if !with_data {
            glb.json["accessors"][0].as_object_mut().unwrap().remove("bufferView");
        }
        assert_eq!(load(&glb).meshes[0].points, [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 6.0, 0.0]]);
    }
}

#[test]
fn vertex_colors_of_three_and_four_components() {
    let mut glb = Glb::triangle();
    let color = glb.accessor(5121, "VEC4", 3, &[255, 0, 51, 102].repeat(3));
    glb.json["accessors"][color]["normalized"] = json!(true);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(color);
    assert_eq!(points(load(&glb).meshes[0].colors.as_ref().unwrap()), [[1.0, 0.0, 0.2, 0.4]; 3]);
    let color = glb.floats("VEC3", &[0.5, 2.0, 0.0].repeat(3));
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(color);
    assert_eq!(points(load(&glb).meshes[0].colors.as_ref().unwrap()), [[0.5, 2.0, 0.0, 1.0]; 3]);
}

#[test]
fn primitives_that_share_a_long_list_keep_only_their_points() {
    let mut glb = Glb::new();
    let many: Vec<f32> = (0..300).map(|i| (i * i % 17) as f32).collect();
    let position = glb.floats("VEC3", &many);
    let indices = glb.indices(&[90, 40, 7]);
    glb.push("meshes", json!({"primitives": [{"attributes": {"POSITION": position}, "indices": indices}]}));
    glb.push("nodes", json!({"mesh": 0}));
    let mesh = &load(&glb).meshes[0];
    assert_eq!((mesh.points.len(), &mesh.triangles[..]), (3, &[[0, 1, 2]][..]));
    assert_eq!(mesh.points[1], [many[120], many[121], many[122]]);
}

#[test]
fn nodes_share_meshes_and_mirrors_stay_in_the_transform() {
    let mut glb = Glb::triangle();
    glb.push("nodes", json!({"mesh": 0, "scale": [-1, 1, 1], "translation": [1, 2, 3]}));
    let matrix = json!([0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 4, 5, 6, 1]);
    glb.push("nodes", json!({"mesh": 0, "matrix": matrix}));
    let scene = load(&glb);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 3));
    assert!(scene.instances[1].transform.matrix3.determinant() < 0.0);
    let p = scene.instances[2].transform.transform_point3(penumbra::math::DVec3::X);
    assert_eq!(p.to_array(), [4.0, 7.0, 6.0]);
}

#[test]
fn only_the_default_scene_and_only_what_is_visible() {
    let mut glb = Glb::triangle();
    glb.push("nodes", json!({"name": "hidden", "mesh": 0, "extensions": {"KHR_node_visibility": {"visible": false}}}));
    glb.push("nodes", json!({"name": "elsewhere", "mesh": 0}));
    glb.push("scenes", json!({"nodes": [2]}));
    glb.push("scenes", json!({"nodes": [0, 1]}));
    glb.json["scene"] = json!(1);
    let scene = load(&glb);
    assert_eq!(scene.instances.iter().map(|i| &*i.name).collect::<Vec<_>>(), ["N"]);
}

#[test]
fn gpu_instancing_places_the_mesh_many_times() {
    let mut glb = Glb::triangle();
    let translation = glb.floats("VEC3", &[1.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    let rotation = glb.accessor(5122, "VEC4", 2, bytemuck::cast_slice(&[0_i16, 0, 0, 32767, 0, 0, 32767, 0]));
    glb.json["accessors"][rotation]["normalized"] = json!(true);
    let attributes = json!({"TRANSLATION": translation, "ROTATION": rotation});
    glb.set("/nodes/0/extensions", json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}}));
    glb.set("/nodes/0/scale", json!([10, 10, 10]));
    let scene = load(&glb);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 2));
    let p = |i: usize| scene.instances[i].transform.transform_point3(penumbra::math::DVec3::X).to_array();
    assert_eq!(p(0), [20.0, 0.0, 0.0]);
    // Half a turn about z at x = 2.
    assert!((p(1)[0] - 10.0).abs() < 1e-12 && p(1)[1].abs() < 1e-12, "{:?}", p(1));
}

#[test]
fn cameras_of_both_kinds() {
    let mut glb = Glb::new();
    let perspective = json!({"yfov": 0.8, "znear": 0.1, "aspectRatio": 1.5});
    glb.push("cameras", json!({"type": "perspective", "perspective": perspective}));
    let orthographic = json!({"xmag": 2, "ymag": 1.5, "znear": 0.5, "zfar": 50});
    glb.push("cameras", json!({"type": "orthographic", "orthographic": orthographic}));
    glb.push("nodes", json!({"name": "Rail", "children": [1], "translation": [0, 0, 9]}));
    glb.push("nodes", json!({"name": "Eye", "camera": 0}));
    glb.push("nodes", json!({"camera": 1}));
    let scene = load(&glb);
    let eye = &scene.cameras[0];
    assert_eq!(eye.projection, ProjectionDesc::Perspective { fov_y: 0.8, aspect: Some(1.5) });
    assert_eq!((eye.clip_near, eye.clip_far, eye.transform.translation.z), (0.1, f64::INFINITY, 9.0));
    assert_eq!(eye.place.node.as_deref(), Some("Rail/Eye"));
    let plan = &scene.cameras[1];
    assert_eq!(plan.projection, ProjectionDesc::Orthographic { half_width: 2.0, half_height: 1.5 });
    assert_eq!((plan.clip_near, plan.clip_far), (0.5, 50.0));
}

#[test]
fn lights_of_each_kind_in_watts() {
    let mut glb = Glb::new();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 683, "color": [1, 0.5, 0], "range": 4},
        {"type": "spot", "intensity": 1366, "spot": {"innerConeAngle": 0.3}},
        {"type": "directional", "intensity": 68.3},
    ]}});
    for light in 0..3 {
        glb.push("nodes", json!({"extensions": {"KHR_lights_punctual": {"light": light}}}));
    }
    let lights = |units| {
        let options = ImportOptions { light_units: units, ..ImportOptions::default() };
        load_with(&glb, &options).lights
    };
    let spec = lights(LightUnits::Spec);
    assert_eq!((spec[0].kind, spec[0].decay.range), (LightKind::Point { intensity: [1.0, 0.5, 0.0] }, 4.0));
    let outer = std::f64::consts::FRAC_PI_4;
    assert_eq!((spec[1].kind, spec[1].decay.range), (LightKind::Point { intensity: [2.0; 3] }, f64::INFINITY));
    assert_eq!(spec[1].shaping.cone, Some(ConeDesc::Ramp { inner: 0.3, outer }));
    let LightKind::Distant { irradiance, angle } = spec[2].kind else { panic!() };
    assert!((irradiance[0] - 0.1).abs() < 1e-15 && angle == 0.0);
    let LightKind::Distant { irradiance, .. } = lights(LightUnits::Raw)[2].kind else { panic!() };
    assert_eq!(irradiance, [68.3; 3]);
}

#[test]
fn animation_of_nodes_lights_and_visibility_at_a_frame() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 683}]}});
    glb.push("nodes", json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    glb.push("nodes", json!({"name": "blinks", "mesh": 0}));
    let times = glb.floats("SCALAR", &[0.0, 1.0]);
    let position = glb.floats("VEC3", &[0.0, 0.0, 0.0, 24.0, 0.0, 0.0]);
    let intensity = glb.floats("SCALAR", &[683.0, 1366.0]);
    let s = 0.5_f32.sqrt();
    let turn = glb.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, s, s]);
    let visible = glb.accessor(5121, "SCALAR", 2, &[1, 0]);
    let pointer = |p: &str| json!({"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": p}}});
    glb.push(
        "animations",
        json!({
            "samplers": [
                {"input": times, "output": position},
                {"input": times, "output": intensity},
                {"input": times, "output": turn},
                {"input": times, "output": visible, "interpolation": "STEP"},
            ],
            "channels": [
                {"sampler": 0, "target": {"node": 0, "path": "translation"}},
                {"sampler": 1, "target": pointer("/extensions/KHR_lights_punctual/lights/0/intensity")},
                {"sampler": 2, "target": {"node": 0, "path": "rotation"}},
                {"sampler": 3, "target": pointer("/nodes/2/extensions/KHR_node_visibility/visible")},
            ],
        }),
    );
    let at = |frame| load_with(&glb, &ImportOptions { frame, ..ImportOptions::default() });
    let rest = at(None);
    assert_eq!(rest.instances[0].transform, penumbra::math::DAffine3::IDENTITY);
    assert_eq!(rest.instances.len(), 2);
    let middle = at(Some(12.0));
    assert_eq!(middle.instances[0].transform.translation.to_array(), [12.0, 0.0, 0.0]);
    let x = middle.instances[0].transform.matrix3.x_axis;
    assert!((x.y.atan2(x.x) - FRAC_PI_2 / 2.0).abs() < 1e-7, "{x:?}");
    assert_eq!(middle.lights[0].kind, LightKind::Point { intensity: [1.5; 3] });
    assert_eq!((middle.instances.len(), at(Some(99.0)).instances.len()), (2, 1));
    let slow = load_with(&glb, &ImportOptions { frame: Some(12.0), fps: 48.0, ..ImportOptions::default() });
    assert_eq!(slow.instances[0].transform.translation.x, 6.0);
}

/// Views compressed by meshoptimizer's own encoder, among them normals through its octahedral filter.
#[cfg(feature = "meshopt")]
#[test]
fn meshopt_compression_gives_back_what_went_in() {
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
        let triangles = [0_u32, 1, 2, 2, 1, 3];
        let up = meshopt::encode_filter_oct::<i8>(&[[0.0, 0.6, 0.8, 1.0]; 4], 8);
        let pieces = [
            (meshopt::encode_vertex_buffer(&corners).unwrap(), 12, 4, "ATTRIBUTES", "NONE"),
            (meshopt::encode_vertex_buffer(&up).unwrap(), 4, 4, "ATTRIBUTES", "OCTAHEDRAL"),
            (meshopt::encode_index_buffer(&triangles, 4).unwrap(), 4, 6, "TRIANGLES", "NONE"),
            (meshopt::encode_index_sequence(&triangles, 4).unwrap(), 2, 6, "INDICES", "NONE"),
        ];
        let mut glb = Glb::new();
        for (bytes, stride, count, mode, filter) in &pieces {
            let view = glb.view(bytes);
            let mut compressed = glb.json["bufferViews"][view].clone();
            for (key, value) in [
                ("byteStride", json!(stride)),
                ("count", json!(count)),
                ("mode", json!(mode)),
                ("filter", json!(filter)),
            ] {
                compressed[key] = value;
            }
            // What the view says of itself is about the fallback buffer, which has no data.
            let length = stride * count;
            glb.json["bufferViews"][view] =
                json!({"buffer": 1, "byteLength": length, "extensions": {(name): compressed}});
            if *mode == "ATTRIBUTES" {
                glb.json["bufferViews"][view]["byteStride"] = json!(stride);
            }
        }
        let position =
            glb.push("accessors", json!({"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4}));
        let normal = json!({"bufferView": 1, "componentType": 5120, "normalized": true, "type": "VEC3", "count": 4});
        let normal = glb.push("accessors", normal);
        let attributes = json!({"POSITION": position, "NORMAL": normal});
        for (view, component) in [(2, 5125), (3, 5123)] {
            let accessor = json!({"bufferView": view, "componentType": component, "type": "SCALAR", "count": 6});
            let indices = glb.push("accessors", accessor);
            glb.push("meshes", json!({"primitives": [{"attributes": attributes, "indices": indices}]}));
            glb.push("nodes", json!({"mesh": view - 2}));
        }
        let fallback = json!({"byteLength": 100, "extensions": {(name): {"fallback": true}}});
        glb.json["buffers"] = json!([{"byteLength": glb.bin.len()}, fallback]);
        glb.json["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
        let scene = load(&glb);
        for mesh in &scene.meshes {
            assert_eq!(mesh.points, corners);
            // The codec may turn a triangle's corners round, not over.
            let rotate = |mut t: [u32; 3]| {
                let first = t.iter().enumerate().min_by_key(|(_, i)| **i).unwrap().0;
                t.rotate_left(first);
                t
            };
            assert_eq!(mesh.triangles.iter().copied().map(rotate).collect::<Vec<_>>(), [[0, 1, 2], [1, 3, 2]]);
            let normal = points(mesh.normals.as_ref().unwrap())[3];
            assert!((normal[1] - 0.6).abs() < 0.02 && (normal[2] - 0.8).abs() < 0.02, "{normal:?}");
        }
        // Cut short, the data is refused.
        glb.json["bufferViews"][0]["extensions"][name]["byteLength"] = json!(9);
        super::refused(&glb.bytes(), &["buffer view 0", "meshopt"]);
    }
}
