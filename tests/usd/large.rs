//! Large stages: read by many threads, and how long that takes and how much memory. The measurements are
//! ignored, since they say nothing on a busy machine or of a build with debug checks.

use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;

use penumbra::import::ImportOptions;

use super::{Loaded, try_load};

const TRIANGLE: &str = "int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = \"none\"";

/// `count` references to an asset of 20 prims; those that `instanceable` is true for share theirs.
fn references(count: usize, instanceable: impl Fn(usize) -> bool) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let mut asset = String::from("#usda 1.0\n( defaultPrim = \"Asset\" )\ndef Xform \"Asset\" {\n");
    for i in 0..19 {
        let order = "uniform token[] xformOpOrder = [\"xformOp:translate\"]";
        writeln!(asset, "def Mesh \"M{i}\" {{ double3 xformOp:translate = ({i}, 0, 0)\n {order}\n {TRIANGLE} }}")
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
    // 14 of 700 are instances and share 19 meshes.
    assert_eq!(one.scene.meshes.len(), 687 * 19);
    let paths: Vec<String> = (0..700).flat_map(|i| (0..19).map(move |m| format!("/World/A{i}/M{m}"))).collect();
    assert_eq!(one.paths(), paths);
    assert_eq!(one.origin("/World/A699/M18"), [0.18, 6.99, 0.0]);
}

/// Seconds to read 5 000 references, and the processor time of all threads.
fn measured(instanceable: bool) -> (Loaded, f64) {
    let (_dir, path) = references(5000, |_| instanceable);
    let start = Instant::now();
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    let seconds = start.elapsed().as_secs_f64();
    println!("100 000 prims, instances {instanceable}: {seconds:.2} s");
    assert_eq!(loaded.scene.instances.len(), 5000 * 19);
    (loaded, seconds)
}

#[test]
#[ignore = "a measurement"]
fn one_hundred_thousand_prims_take_less_than_three_seconds() {
    let (_, seconds) = measured(false);
    assert!(seconds < 3.0, "{seconds} s");
}

#[test]
#[ignore = "a measurement"]
fn one_hundred_thousand_instanced_prims_take_less_than_a_second() {
    let (loaded, seconds) = measured(true);
    assert_eq!(loaded.scene.meshes.len(), 19);
    assert!(seconds < 1.0, "{seconds} s");
}

/// A million instances of a cube: twelve million triangles.
#[test]
#[ignore = "a measurement"]
fn ten_million_instanced_triangles_take_less_than_a_gibibyte() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("root.usda");
    let count = 1_000_000;
    let mut text = String::from("#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\ndef PointInstancer \"Many\" {\n");
    text.push_str("rel prototypes = </Many/Cube>\nint[] protoIndices = [0");
    text.push_str(&", 0".repeat(count - 1));
    text.push_str("]\npoint3f[] positions = [(0, 0, 0)");
    for i in 1..count {
        write!(text, ", ({i}, 0, 0)").unwrap();
    }
    text.push_str("]\ndef Cube \"Cube\" {}\n}\n");
    std::fs::write(&path, text).unwrap();
    let start = Instant::now();
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse::<f64>().ok());
    let mebibytes = peak.unwrap_or(0.0) / 1024.0;
    println!("{count} instances: {:.2} s, {mebibytes:.0} MiB at most", start.elapsed().as_secs_f64());
    assert_eq!((loaded.scene.instances.len(), loaded.scene.meshes.len()), (count, 1));
    assert!(mebibytes < 1024.0, "{mebibytes} MiB");
}
