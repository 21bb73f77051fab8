//! The vector and mist passes against closed forms, and what the file doors read for the former.

#[path = "support/glb.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod glb;
#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::sync::Arc;

use penumbra::desc::{
    AlphaMode, MaterialDesc, MeshDesc, Motion, ProjectionDesc, RoundsDesc, ScalarInput, SceneDesc, Strand,
};
use penumbra::error::Warnings;
use penumbra::film::{Filter, Picture};
use penumbra::import::{self, ImportOptions, gltf};
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::{MistFalloff, Settings};
use scene::{Builder, picture, settings};
use serde_json::json;

/// Pixels on each side of a picture, which shows −1 to 1: 16 to a metre.
const SIZE: u32 = 32;

fn boxed(passes: &str) -> Settings {
    Settings { filter: Filter::parse("box").unwrap(), ..settings(passes, 4) }
}

/// The pixel right of and below the middle.
fn middle(picture: &Picture, layer: &str) -> Vec<f64> {
    let pixel = picture.layer(layer).unwrap().pixel(SIZE, SIZE / 2, SIZE / 2);
    pixel.iter().map(|&v| f64::from(v)).collect()
}

fn assert_vector(what: &str, desc: &SceneDesc, expected: [f64; 4]) {
    let picture = picture(desc, SIZE, &boxed("vector"));
    let found = middle(&picture, "Vector");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 2e-3, "{what}: {found} instead of {expected}");
    }
    let corner = picture.layer("Vector").unwrap().pixel(SIZE, 0, 0);
    assert_eq!(corner, [0.0; 4], "{what}: the background");
}

fn by(x: f64, y: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, 0.0))
}

/// Keys at the frames before, at and after.
fn frames<T>(before: T, now: T, after: T) -> Vec<Motion<T>> {
    [(-1.0, before), (0.0, now), (1.0, after)].map(|(time, value)| Motion { time, value }).into()
}

/// A square about the origin, before a camera of parallel rays that looks along −z with x to the right.
fn square() -> SceneDesc {
    let mut builder = Builder::default();
    let material = builder.lambert(0.5);
    builder.quad([-0.5, -0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], material);
    builder.look([0.0; 3], [0.0, 0.0, -1.0], 1.0);
    builder.desc.cameras[0].transform = DAffine3::from_translation(DVec3::Z);
    builder.desc
}

fn shifted(points: &[[f32; 3]], x: f32, y: f32) -> Vec<[f32; 3]> {
    points.iter().map(|p| [p[0] + x, p[1] + y, p[2]]).collect()
}

#[test]
fn what_moves_is_told_in_pixels_from_frame_to_frame() {
    // Two pixels to the left of here and one above, then four to the right and three below.
    let expected = [-2.0, 1.0, -4.0, 3.0];
    let mut desc = square();
    desc.instances[0].motion = frames(by(-0.125, 0.0625), by(0.0, 0.0), by(0.25, -0.1875));
    assert_vector("transform", &desc, expected);
    // Keys farther off, as a file may have them.
    let wide = [(-2.0, by(-0.25, 0.125)), (0.0, by(0.0, 0.0)), (2.0, by(0.5, -0.375))];
    desc.instances[0].motion = wide.map(|(time, value)| Motion { time, value }).into();
    assert_vector("wide keys", &desc, expected);

    let mut desc = square();
    let mesh: &mut MeshDesc = Arc::make_mut(&mut desc.meshes[0]);
    mesh.motion =
        frames(shifted(&mesh.points, -0.125, 0.0625), mesh.points.clone(), shifted(&mesh.points, 0.25, -0.1875));
    assert_vector("deformation", &desc, expected);

    // The camera goes the other way.
    let mut desc = square();
    let camera = &mut desc.cameras[0];
    let at = |x: f64, y: f64| by(x, y) * camera.transform;
    camera.motion = frames(at(0.125, -0.0625), at(0.0, 0.0), at(-0.25, 0.1875));
    assert_vector("camera", &desc, expected);
    assert_vector("nothing", &square(), [0.0; 4]);
}

#[test]
fn what_comes_nearer_is_seen_in_perspective() {
    let mut desc = square();
    desc.cameras[0].transform = DAffine3::from_translation(DVec3::new(-0.5, 0.0, 2.0));
    desc.cameras[0].projection = ProjectionDesc::Perspective { fov_y: 2.0 * 0.5_f64.atan(), aspect: Some(1.0) };
    desc.instances[0].motion = frames(
        DAffine3::from_translation(DVec3::new(0.0, 0.0, -2.0)),
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(0.0, 0.0, 1.0)),
    );
    let picture = picture(&desc, SIZE, &Settings { spp: 1024, ..boxed("vector") });
    let found = picture.layer("Vector").unwrap().pixel(SIZE, 24, 16);
    // The pixel's middle is 8.5 right of that of the picture and 0.5 below, at a distance of 2: half as much a frame
    // before, at 4, and twice as much after, at 1.
    for (found, expected) in found.iter().zip([-4.25, 0.25, -8.5, 0.5]) {
        assert!((found - expected).abs() < 0.02, "{found} instead of {expected}");
    }
}

#[test]
fn strands_go_where_their_axis_goes() {
    let mut builder = Builder::default();
    let material = builder.lambert(0.5);
    let points = vec![[-0.5, 0.0, 0.0], [0.5, 0.0, 0.0]];
    builder.rounds(
        RoundsDesc {
            motion: frames(shifted(&points, 0.0, -0.125), points.clone(), shifted(&points, 0.25, 0.0)),
            points,
            radii: vec![0.25; 2],
            strands: vec![Strand { end: 2, closed: false }],
            ..RoundsDesc::default()
        },
        material,
    );
    builder.look([0.0; 3], [0.0, 0.0, -1.0], 1.0);
    builder.desc.cameras[0].transform = DAffine3::from_translation(DVec3::Z);
    assert_vector("strand", &builder.desc, [0.0, -2.0, -4.0, 0.0]);
}

#[test]
fn a_blurred_picture_has_no_vectors_and_says_so() {
    let mut desc = square();
    desc.instances[0].motion = frames(by(-0.125, 0.0), by(0.0, 0.0), by(0.125, 0.0));
    desc.cameras[0].shutter = [-0.25, 0.25];
    let told = |settings: &Settings| {
        let view = View { camera: None, size: Some([SIZE; 2]) };
        let prepared = prepare(desc.clone(), &view, settings).unwrap();
        prepared.warnings.iter().filter(|warning| warning.what.contains("vector pass")).count()
    };
    assert_eq!(told(&boxed("vector")), 1);
    assert_eq!(middle(&picture(&desc, SIZE, &boxed("vector")), "Vector"), [0.0; 4]);
    let sharp = Settings { motion_blur: false, ..boxed("vector") };
    assert_eq!(told(&sharp), 0);
    assert_eq!(middle(&picture(&desc, SIZE, &sharp), "Vector"), [-2.0, 0.0, -2.0, 0.0]);
    // Nothing that moves, nothing to tell.
    desc.instances[0].motion.clear();
    let view = View { camera: None, size: Some([SIZE; 2]) };
    assert!(!prepare(desc, &view, &boxed("vector")).unwrap().warnings.iter().any(|w| w.what.contains("vector")));
}

#[test]
fn mist_is_that_of_what_is_there() {
    let mut desc = square();
    let thin =
        MaterialDesc { alpha: ScalarInput::constant(0.25), alpha_mode: AlphaMode::Blend, ..desc.materials[0].clone() };
    let mist = |desc: &SceneDesc, falloff| {
        let settings = Settings { spp: 4096, mist_start: 0.5, mist_depth: 2.0, mist_falloff: falloff, ..boxed("mist") };
        let picture = picture(desc, SIZE, &settings);
        assert_eq!(picture.layer("Mist").unwrap().pixel(SIZE, 0, 0), [1.0]);
        middle(&picture, "Mist")[0]
    };
    for (falloff, expected) in
        [(MistFalloff::Linear, 0.25), (MistFalloff::Quadratic, 0.0625), (MistFalloff::InverseQuadratic, 0.5)]
    {
        assert!((mist(&desc, falloff) - expected).abs() < 1e-6, "{falloff:?}");
    }
    // A pane of a quarter before nothing, which is all mist.
    desc.materials[0] = thin;
    assert!((mist(&desc, MistFalloff::Linear) - (0.25 * 0.25 + 0.75)).abs() < 1e-6);
    // The same before a wall one metre behind, which is passed to by three paths in four.
    let mut builder = Builder { desc };
    let wall = builder.lambert(0.5);
    builder.quad([-0.5, -0.5, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], wall);
    let expected = 0.25 * 0.25 + 0.75 * 0.75;
    assert!((mist(&builder.desc, MistFalloff::Linear) - expected).abs() < 0.02);
}

const STAGE: &str = r#"#usda 1.0
( upAxis = "Y"
  metersPerUnit = 1
  RENDER )
def Camera "C" {
  token projection = "orthographic"
  float horizontalAperture = 20
  float verticalAperture = 20
  double3 xformOp:translate = (0, 0, 5)
  uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Mesh "Square" {
  int[] faceVertexCounts = [4]
  int[] faceVertexIndices = [0, 1, 2, 3]
  point3f[] points.timeSamples = {
    2: [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)],
    4: [(-0.5, 0.0, 0), (0.5, 0.0, 0), (0.5, 1.0, 0), (-0.5, 1.0, 0)] }
  double3 xformOp:translate.timeSamples = { 0: (-0.25, 0, 0), 2: (0, 0, 0), 4: (1, 0, 0) }
  uniform token[] xformOpOrder = ["xformOp:translate"]
}
def RenderSettings "R" { rel products = </P> }
def RenderProduct "P" { rel orderedVars = </V> }
def RenderVar "V" { uniform string sourceName = "motionvector" }
"#;

#[test]
fn usd_is_read_at_the_frames_before_and_after() {
    let expected = [-2.0, 0.0, -8.0, -4.0];
    let read = |render: &str, vectors: bool| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("moving.usda");
        std::fs::write(&path, STAGE.replace("RENDER", render)).unwrap();
        let options = ImportOptions { frame: Some(2.0), vectors, ..ImportOptions::default() };
        let mut warnings = Warnings::new();
        import::scene(&path, &options, &mut warnings).unwrap()
    };
    assert_vector("asked for", &read("", true), expected);
    let own = r#"renderSettingsPrimPath = "/R""#;
    let desc = read(own, false);
    assert_eq!(desc.render.passes, ["vector".into()]);
    assert_vector("asked for by the stage", &desc, expected);
    let desc = read("", false);
    assert!(desc.instances[0].motion.is_empty() && desc.meshes[0].motion.is_empty());
}

#[test]
fn gltf_is_read_at_the_frames_before_and_after() {
    let mut glb = glb::Glb::new();
    let position = glb.floats("VEC3", &[-0.5, -0.5, 0.0, 0.5, -0.5, 0.0, 0.0, 0.9, 0.0]);
    let lift = glb.floats("VEC3", &[0.0, 0.25, 0.0].repeat(3));
    let primitive = json!({"attributes": {"POSITION": position}, "targets": [{"POSITION": lift}]});
    glb.push("meshes", json!({"primitives": [primitive]}));
    glb.push("nodes", json!({"name": "N", "mesh": 0}));
    let view = json!({"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 9}});
    glb.push("cameras", view);
    glb.push("nodes", json!({"name": "C", "camera": 0, "translation": [0, 0, 2]}));
    // The same mesh twice, alike at the frame alone.
    glb.push("nodes", json!({"name": "Still", "mesh": 0, "translation": [0, 0, -1]}));
    let times = glb.floats("SCALAR", &[0.0, 1.0 / 24.0, 2.0 / 24.0]);
    let ways = glb.floats("VEC3", &[-0.125, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0]);
    let weights = glb.floats("SCALAR", &[1.0, 0.0, 1.0]);
    let samplers = json!([{"input": times, "output": ways}, {"input": times, "output": weights}]);
    let channels = json!([
        {"sampler": 0, "target": {"node": 0, "path": "translation"}},
        {"sampler": 1, "target": {"node": 0, "path": "weights"}},
    ]);
    glb.push("animations", json!({"samplers": samplers, "channels": channels}));
    let read = |vectors: bool| {
        let options = ImportOptions { frame: Some(1.0), vectors, ..ImportOptions::default() };
        let place = penumbra::error::Place::file("test.glb");
        gltf::from_bytes(&glb.bytes(), None, &place, &options, &mut Warnings::new()).unwrap()
    };
    let desc = read(true);
    assert_vector("glTF", &desc, [-2.0, 4.0, -4.0, -4.0]);
    let still = desc.mesh(&desc.instances[1]).unwrap();
    assert!(still.motion.is_empty() && desc.instances[1].motion.is_empty());
    let desc = read(false);
    assert!(desc.instances.iter().all(|instance| instance.motion.is_empty()));
    assert!(desc.meshes.iter().all(|mesh| mesh.motion.is_empty()));
}
