//! Arcs that go through several layers, where the openusd crate needs help. What is right, `usd-core` 26.11 says of
//! the same stages in tests/python/test_usd_layers.py.

use std::path::PathBuf;

use penumbra::import::ImportOptions;

use super::{at_frame, try_load};

const MESH: &str = "def Mesh \"T\" { int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0, 1, 2]\n uniform token subdivisionScheme = \"none\"\n point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n }\n";
const MOVES: &str = "double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 100: (100, 0, 0) }\n uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";

/// Layers in a folder of their own; the first is the root.
fn layers(layers: &[(&str, String)]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let head = "#usda 1.0\n( defaultPrim = \"A\"\n metersPerUnit = 1\n upAxis = \"Y\" )\n";
    for (name, text) in layers {
        std::fs::write(dir.path().join(name), format!("{head}{text}")).unwrap();
    }
    let root = dir.path().join(layers[0].0);
    (dir, root)
}

/// Each of two classes has a prim that refers to an heir of the other.
#[test]
fn a_cycle_through_implied_classes_is_left_out_and_told() {
    let leaf = format!(
        "class \"_c\" {{ }}\nclass \"_d\" {{ {MESH} }}\ndef Xform \"A\" (inherits = </_d>) {{ }}\ndef Xform \"D\" (inherits = </_c>) {{ {MESH} }}"
    );
    let middle = "def Xform \"A\" (inherits = </_c>) { }\nclass \"_c\" { def Xform \"B\" (references = @leaf.usda@) { }\n }\nclass \"_d\" { def Xform \"C\" (references = @leaf.usda@</D>) { }\n }";
    let root = format!("def \"R\" (references = @middle.usda@) {{ {MESH} }}\ndef Xform \"S\" {{ {MESH} }}");
    let (_dir, path) = layers(&[("root.usda", root), ("middle.usda", middle.into()), ("leaf.usda", leaf)]);
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    let mut paths = loaded.paths();
    paths.sort_unstable();
    assert_eq!(paths, ["/R/B/C/T", "/R/B/T", "/R/T", "/S/T"]);
    assert!(loaded.said_of("is composed of itself by way of").contains("leaf.usda, /"), "{:?}", loaded.said);
}

/// The class is in the root layer, whose time is that of the stage; what moves in the referenced layer is not.
#[test]
fn implied_classes_are_in_the_time_of_their_own_layer() {
    for arc in ["inherits", "specializes"] {
        let (_dir, path) = layers(&[
            (
                "root.usda",
                format!(
                    "class \"_c\" {{ {MOVES} }}\ndef \"R\" (references = @leaf.usda@ (offset = 10; scale = 2)) {{ }}"
                ),
            ),
            (
                "leaf.usda",
                format!(
                    "class \"_c\" {{ }}\ndef Xform \"A\" ({arc} = </_c>) {{ {MESH} def Xform \"B\" {{ {MOVES} {MESH} }} }}"
                ),
            ),
        ]);
        let loaded = try_load(&path, &at_frame(50.0)).unwrap();
        assert_eq!(loaded.origin("/R/T"), [50.0, 0.0, 0.0], "{arc}");
        assert_eq!(loaded.origin("/R/B/T"), [70.0, 0.0, 0.0], "{arc}");
        loaded.said_nothing();
    }
}

#[test]
fn properties_with_other_letters_are_read() {
    let text = MESH.replacen("point3f", "texCoord2f[] primvars:größe = [(0, 0), (1, 0), (0, 1)]\n point3f", 1);
    let text = format!("def Xform \"Öl\" {{ {text}\n custom double3 breite:日本 = (1, 2, 3) ( doc = \"ä\" )\n }}");
    let (_dir, path) = layers(&[("root.usda", text)]);
    let loaded = try_load(&path, &ImportOptions::default()).unwrap();
    assert_eq!(loaded.paths(), ["/Öl/T"]);
    loaded.said_nothing();
}
