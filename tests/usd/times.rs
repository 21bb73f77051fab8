//! Time codes, interpolation and the shutter.

use penumbra::import::ImportOptions;
use penumbra::math::DVec3;

use super::{at_frame, load, near};

#[test]
fn samples_are_interpolated_or_held() {
    let at = |frame| load("times.usda", &at_frame(frame));
    // OpenUSD's at time code 6.
    let loaded = at(6.0);
    assert_eq!(loaded.origin("/Linear/T"), [5.0, 0.0, 0.0]);
    let turned = loaded.one("/Turned/T").transform;
    near(turned.transform_vector3(DVec3::X), [0.0, 1.0, 0.0]);
    // A token can't be interpolated.
    assert!(loaded.all("/Held/T").is_empty());
    assert!(!at(4.5).all("/Held/T").is_empty());
    assert!(at(8.5).all("/Held/T").is_empty());
    assert!(!at(9.0).all("/Held/T").is_empty());
}

#[test]
fn a_value_is_held_up_to_a_block() {
    // OpenUSD's.
    assert_eq!(load("times.usda", &at_frame(3.0)).origin("/Blocked/T"), [3.0, 0.0, 0.0]);
    assert_eq!(load("times.usda", &at_frame(6.0)).origin("/Blocked/T"), [0.0, 0.0, 0.0]);
}

#[test]
fn the_stage_starts_where_it_says() {
    let loaded = load("times.usda", &ImportOptions::default());
    assert_eq!(loaded.origin("/Linear/T"), [0.0, 0.0, 0.0]);
    let late = load("times.usda", &at_frame(40.0));
    assert_eq!(late.origin("/Linear/T"), [10.0, 0.0, 0.0]);
    late.said_of("frame 40 is outside of the stage's time codes 1 to 20; the nearest are held");
}

#[test]
fn what_moves_while_a_shutter_is_open_is_kept() {
    let loaded = load("times.usda", &at_frame(6.0));
    let motion: Vec<(f64, [f64; 3])> =
        loaded.one("/Linear/T").motion.iter().map(|m| (m.time, m.value.translation.to_array())).collect();
    assert_eq!(motion, [(-0.25, [4.75, 0.0, 0.0]), (0.25, [5.25, 0.0, 0.0])]);
    assert!(loaded.one("/Blocked/T").motion.is_empty() || loaded.one("/Blocked/T").motion.len() == 2);
    loaded.said_of("motion blur is not rendered yet");
}

#[test]
fn what_deforms_while_a_shutter_is_open_is_kept() {
    let loaded = load("deforms.usda", &at_frame(4.0));
    let mesh = loaded.scene.mesh(loaded.one("/Sheet")).unwrap();
    assert_eq!(mesh.points[1], [1.0, 0.0, 4.0]);
    let motion: Vec<(f64, [f32; 3])> = mesh.motion.iter().map(|m| (m.time, m.value[1])).collect();
    assert_eq!(motion, [(-0.5, [1.0, 0.0, 3.5]), (0.5, [1.0, 0.0, 4.5])]);
    loaded.said_of("motion blur is not rendered yet");
}

/// Which operations a transform has is the same at all times, as OpenUSD has it.
#[test]
fn the_order_of_operations_is_read_without_a_time() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("stage.usda");
    let text = r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Cube "A" {
    double3 xformOp:translate = (1, 2, 3)
    double3 xformOp:translate:b = (10, 2, 3)
    token[] xformOpOrder = ["xformOp:translate"]
    token[] xformOpOrder.timeSamples = { 1: ["xformOp:translate:b"], 5: [] }
}
"#;
    std::fs::write(&path, text).unwrap();
    for options in [ImportOptions::default(), at_frame(1.0), at_frame(5.0)] {
        assert_eq!(super::try_load(&path, &options).unwrap().origin("/A"), [1.0, 2.0, 3.0]);
    }
}
