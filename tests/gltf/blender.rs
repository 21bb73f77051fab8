//! Files that Blender 5.0 wrote, held against Blender's own numbers.
//!
//! `rig.glb`: a column of three rings between two bones, with a shape key, both animated over 24
//! frames; a lamp of 100 W, a sun of strength 3, a spot of 50 W. `rig.json` holds the world
//! positions of its evaluated points (in glTF's axes) at frames 0, 6, 12 and 24.

use std::f64::consts::PI;

use penumbra::desc::{Attribute, ConeDesc, LightKind, SceneDesc};
use penumbra::import::ImportOptions;
use penumbra::math::{DVec3, Vec3};

use super::read;

fn load(bytes: &[u8], frame: Option<f64>) -> SceneDesc {
    let (scene, warnings) = read(bytes, &ImportOptions { frame, ..ImportOptions::default() });
    assert!(warnings.iter().all(|said| said.contains("exported by Blender alone")), "{warnings:?}");
    scene.unwrap()
}

#[test]
fn bones_and_shape_keys_move_points_to_where_blender_has_them() {
    let reference: std::collections::BTreeMap<String, Vec<[f64; 3]>> =
        serde_json::from_str(include_str!("../data/gltf/rig.json")).unwrap();
    assert_eq!(reference.len(), 4);
    for (frame, expected) in reference {
        let scene = load(include_bytes!("../data/gltf/rig.glb"), Some(frame.parse().unwrap()));
        let instance = scene.instances.iter().find(|i| &*i.name == "Column").unwrap();
        let points = scene.mesh(instance).unwrap().points.iter();
        let points: Vec<DVec3> =
            points.map(|p| instance.transform.transform_point3(DVec3::from_array(p.map(f64::from)))).collect();
        // The exporter splits points at seams; both ways each point has its twin.
        for e in &expected {
            let nearest = points.iter().map(|p| p.distance(DVec3::from_array(*e))).fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-6, "frame {frame}: {e:?} is {nearest} away");
        }
        for p in points {
            let nearest = expected.iter().map(|e| p.distance(DVec3::from_array(*e))).fold(f64::INFINITY, f64::min);
            assert!(nearest < 2e-6, "frame {frame}: {p:?} is {nearest} away");
        }
    }
}

#[test]
fn lamps_come_back_to_their_watts() {
    let scene = load(include_bytes!("../data/gltf/rig.glb"), None);
    let light = |name: &str| scene.lights.iter().find(|light| &*light.name == name).unwrap();
    let kind = |name: &str| light(name).kind;
    let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-6, "{a} {b}");
    let LightKind::Point { intensity, .. } = kind("Lamp") else { panic!() };
    close(intensity[0], 100.0 / (4.0 * PI));
    let LightKind::Distant { irradiance, .. } = kind("Sun") else { panic!() };
    close(irradiance[0], 3.0);
    let LightKind::Point { intensity } = kind("Spot") else { panic!() };
    let Some(ConeDesc::Blend { angle, blend }) = light("Spot").shaping.cone else { panic!() };
    close(intensity[0], 50.0 / (4.0 * PI));
    close(angle, 0.5);
    close(blend, 0.25);
    assert_eq!(scene.cameras.len(), 1);
}

/// MikkTSpace made here against that which Blender wrote for the same mesh.
#[test]
fn tangents_are_blenders() {
    let bytes = include_bytes!("../data/gltf/tangents.glb");
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut document: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    // A normal map whose image is absent would be dropped; anisotropy needs tangents without one.
    document["materials"][0]["extensions"] = serde_json::json!({"KHR_materials_anisotropy": {"anisotropyStrength": 1}});
    let mut glb = super::Glb { json: document.clone(), bin: bytes[28 + length..].to_vec() };
    let theirs = load(&glb.bytes(), None);
    glb.json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TANGENT").unwrap();
    let ours = load(&glb.bytes(), None);
    let Some(Attribute::Point(expected)) = &theirs.meshes[0].tangents else { panic!("Blender wrote tangents") };
    let Some(Attribute::Corner(tangents)) = &ours.meshes[0].tangents else { panic!("none were made") };
    for (corner, &point) in ours.meshes[0].triangles.as_flattened().iter().enumerate() {
        let (a, b) = (tangents[corner], expected[point as usize]);
        assert_eq!(a[3], b[3], "corner {corner}");
        let distance = Vec3::new(a[0], a[1], a[2]).distance(Vec3::new(b[0], b[1], b[2]));
        assert!(distance < 2e-3, "corner {corner}: {a:?} {b:?}");
    }
}

/// The same two meshes through Draco: equal up to its quantization (14 bits of position).
#[test]
fn draco_is_the_plain_file_but_for_its_quantization() {
    let plain = load(include_bytes!("../data/gltf/plain.glb"), None);
    let draco = load(include_bytes!("../data/gltf/draco.glb"), None);
    assert_eq!(draco.meshes.len(), 2);
    for (a, b) in plain.meshes.iter().zip(&draco.meshes) {
        assert_eq!(
            (a.name.clone(), a.triangles.len(), a.points.len()),
            (b.name.clone(), b.triangles.len(), b.points.len())
        );
        let attributes = |mesh: &penumbra::desc::MeshDesc| {
            let normals = super::points(mesh.normals.as_ref().unwrap()).to_vec();
            mesh.points.iter().copied().zip(normals).zip(super::points(&mesh.uvs[0]).to_vec()).collect::<Vec<_>>()
        };
        let ours = attributes(b);
        for ((p, n), uv) in attributes(a) {
            let distance = |((p2, n2), uv2): &(([f32; 3], [f32; 3]), [f32; 2])| {
                let uv_distance = (uv[0] - uv2[0]).abs().max((uv[1] - uv2[1]).abs());
                let n_distance = 0.1 * Vec3::from(n).distance(Vec3::from(*n2));
                Vec3::from(p).distance(Vec3::from(*p2)).max(uv_distance).max(n_distance)
            };
            let nearest = ours.iter().map(distance).fold(f32::INFINITY, f32::min);
            assert!(nearest < 1e-3, "{p:?} {n:?} {uv:?} is {nearest} away");
        }
    }
}
