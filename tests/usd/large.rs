//! Large stages, which many threads read. How long that takes and how much memory: `benches/usd.py`.

use std::fmt::Write;
use std::path::PathBuf;

use penumbra::import::ImportOptions;

use super::{Loaded, try_load};

const TRIANGLE: &str = "int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    uniform token subdivisionScheme = \"none\"";

/// `count` references to an asset of 20 prims; those that `instanceable` is true for share theirs.
fn references(count: usize, instanceable: impl Fn(usize) -> bool) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let mut asset = String::from("#usda 1.0\n( defaultPrim = \"Asset\" )\ndef Xform \"Asset\" {\n");
    for i in 0..19 {
        let order = "uniform token[] xformOpOrder = [\"xformOp:translate\"]";
        writeln!(
            asset,
            "def Mesh \"M{i}\" {{ double3 xformOp:translate = ({i}, 0, 0)\n {order}\n {TRIANGLE}
                point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, {i})] }}"
        )
        .unwrap();
    }
    asset.push_str("}\n");
    std::fs::write(dir.path().join("asset.usda"), asset).unwrap();
    let mut root = String::from("#usda 1.0\n( metersPerUnit = 0.01 upAxis = \"Y\" )\ndef Xform \"World\" {\n");
    for i in 0..count {
        let shared = instanceable(i);
        writeln!(
            root,
            "def \"A{i}\" ( instanceable = {shared} references = @./asset.usda@ ) {{
                double3 xformOp:translate = (0, {i}, 0)
                uniform token[] xformOpOrder = [\"xformOp:translate\"]
            }}"
        )
        .unwrap();
    }
    root.push_str("}\n");
    let path = dir.path().join("root.usda");
    std::fs::write(&path, root).unwrap();
    (dir, path)
}

/// The order of everything, and which instances share a mesh, are the same for any number of threads.
#[test]
fn many_threads_read_what_one_does() {
    let (_dir, path) = references(700, |i| i % 100 < 2);
    let read = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| try_load(&path, &ImportOptions::default()).unwrap())
    };
    let one = read(1);
    one.said_nothing();
    let scene = |loaded: &Loaded| (loaded.scene.instances.clone(), loaded.scene.meshes.clone());
    assert!(scene(&one) == scene(&read(3)));
    assert_eq!(one.scene.instances.len(), 700 * 19);
    // 14 of 700 are instances, the others have meshes that are equal to theirs.
    assert_eq!(one.scene.meshes.len(), 19);
    let paths: Vec<String> = (0..700).flat_map(|i| (0..19).map(move |m| format!("/World/A{i}/M{m}"))).collect();
    assert_eq!(one.paths(), paths);
    assert_eq!(one.origin("/World/A699/M18"), [0.18, 6.99, 0.0]);
}
