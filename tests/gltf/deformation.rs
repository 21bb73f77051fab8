//! Morph targets and skins.

use penumbra::import::ImportOptions;
use penumbra::math::DVec3;
use serde_json::json;

use super::glb::Glb;
use super::{load, load_with, points};

/// A triangle with one morph target that lifts its points to z = 2 and tips its normals.
fn morphed() -> Glb {
    let mut glb = Glb::triangle();
    let normal = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let lift = glb.floats("VEC3", &[0.0, 0.0, 2.0].repeat(3));
    let tip = glb.floats("VEC3", &[1.0, 0.0, 0.0].repeat(3));
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = json!(normal);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": lift, "NORMAL": tip}]);
    glb
}

#[test]
fn morph_weights_of_the_mesh_of_the_node_and_of_an_animation() {
    let mut glb = morphed();
    assert_eq!(load(&glb).meshes[0].points[0][2], 0.0);
    glb.set("/meshes/0/weights", json!([0.5]));
    glb.push("nodes", json!({"mesh": 0, "weights": [1]}));
    glb.push("nodes", json!({"mesh": 0, "weights": [1]}));
    let scene = load(&glb);
    // Nodes of equal weights share one mesh.
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 3));
    assert_eq!((scene.meshes[0].points[0][2], scene.meshes[1].points[0][2]), (1.0, 2.0));
    let s = 0.5_f32.sqrt();
    let normal = points(scene.meshes[1].normals.as_ref().unwrap())[0];
    assert!((normal[0] - s).abs() < 1e-6 && (normal[2] - s).abs() < 1e-6, "{normal:?}");
    let (times, weights) = (glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("SCALAR", &[0.0, 4.0]));
    let samplers = json!([{"input": times, "output": weights}]);
    let channels = json!([{"sampler": 0, "target": {"node": 1, "path": "weights"}}]);
    glb.push("animations", json!({"samplers": samplers, "channels": channels}));
    let scene = load_with(&glb, &ImportOptions { frame: Some(6.0), ..ImportOptions::default() });
    let mesh = scene.mesh(&scene.instances[1]).unwrap();
    assert_eq!(mesh.points[0][2], 2.0);
}

/// A triangle whose third point follows joint 1, in a far corner of the world.
fn skinned() -> Glb {
    let mut glb = Glb::triangle();
    let joints = glb.accessor(5121, "VEC4", 3, &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0]);
    let weights = glb.accessor(5121, "VEC4", 3, &[255, 0, 0, 0].repeat(3));
    glb.json["accessors"][weights]["normalized"] = json!(true);
    let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut binds: Vec<f32> = Vec::new();
    for y in [0.0, -1.0] {
        binds.extend(identity);
        binds.extend([0.0, y, 0.0, 1.0]);
    }
    let binds = glb.floats("MAT4", &binds);
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    glb.set("/nodes/0/skin", json!(0));
    // The skinned node's own transform means nothing.
    glb.set("/nodes/0/translation", json!([7, 7, 7]));
    glb.push("nodes", json!({"name": "root", "translation": [1e7, 0, 0], "children": [2]}));
    glb.push("nodes", json!({"name": "tip", "translation": [0, 1, 0.25], "scale": [2, 2, 2]}));
    glb.push("skins", json!({"joints": [1, 2], "inverseBindMatrices": binds}));
    glb
}

#[test]
fn skins_move_points_to_their_joints_without_loss_far_from_the_origin() {
    let scene = load(&skinned());
    let (mesh, transform) = (&scene.meshes[0], scene.instances[0].transform);
    let world = |i: usize| transform.transform_point3(DVec3::from_array(mesh.points[i].map(f64::from)));
    assert_eq!(world(0).to_array(), [1e7, 0.0, 0.0]);
    assert_eq!(world(1).to_array(), [1e7 + 1.0, 0.0, 0.0]);
    // Joint 1 scales about its own origin, which the point stands on.
    assert_eq!(world(2).to_array(), [1e7, 1.0, 0.25]);
}

#[test]
fn a_mirrored_skeleton_turns_triangles_round() {
    let mut glb = skinned();
    glb.set("/nodes/1/scale", json!([-1, 1, 1]));
    assert_eq!(load(&glb).meshes[0].triangles, [[0, 2, 1]]);
}
