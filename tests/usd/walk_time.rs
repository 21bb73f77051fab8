//! How long large stages take; ignored, since it says nothing on a busy machine.

use std::fmt::Write;
use std::time::Instant;

use penumbra::import::ImportOptions;

use super::try_load;

/// 5 000 references to an asset of 20 prims: 100 000 prims, none of them shared.
fn references(instanceable: bool) -> f64 {
    let (_dir, path) = write(instanceable);
    let start = Instant::now();
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    assert_eq!(loaded.scene.instances.len(), 5000 * 19);
    assert_eq!(loaded.scene.meshes.len(), if instanceable { 19 } else { 5000 * 19 });
    seconds
}

pub fn write(instanceable: bool) -> (tempfile::TempDir, std::path::PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let mut asset = String::from("#usda 1.0\n(\n defaultPrim = \"Asset\"\n)\ndef Xform \"Asset\" {\n");
    for i in 0..19 {
        write!(
            asset,
            "def Mesh \"M{i}\" {{ double3 xformOp:translate = ({i}, 0, 0)\n uniform token[] xformOpOrder = \
             [\"xformOp:translate\"]\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n \
             point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n uniform token subdivisionScheme = \"none\" }}\n"
        )
        .unwrap();
    }
    asset.push_str("}\n");
    std::fs::write(dir.path().join("asset.usda"), asset).unwrap();
    let mut root = String::from("#usda 1.0\n(\n metersPerUnit = 0.01\n upAxis = \"Y\"\n)\ndef Xform \"World\" {\n");
    for i in 0..5000 {
        write!(
            root,
            "def \"A{i}\" (\n instanceable = {instanceable}\n references = @./asset.usda@\n) {{ double3 \
             xformOp:translate = (0, {i}, 0)\n uniform token[] xformOpOrder = [\"xformOp:translate\"] }}\n"
        )
        .unwrap();
    }
    root.push_str("}\n");
    let path = dir.path().join("root.usda");
    std::fs::write(&path, root).unwrap();
    (dir, path)
}

#[test]
#[ignore = "a measurement"]
fn one_hundred_thousand_prims_take_less_than_three_seconds() {
    let seconds = references(false);
    println!("100 000 referenced prims: {seconds:.2} s");
    assert!(seconds < 3.0, "{seconds} s");
}

#[test]
#[ignore = "a measurement"]
fn one_hundred_thousand_instanced_prims_take_less_than_a_second() {
    let seconds = references(true);
    println!("100 000 instanced prims: {seconds:.2} s");
    assert!(seconds < 1.0, "{seconds} s");
}
