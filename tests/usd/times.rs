//! Time codes, interpolation and the shutter.

use std::path::PathBuf;

use penumbra::import::{ImportOptions, Interpolation};
use penumbra::math::DVec3;

use super::{Loaded, at_frame, load, near, try_load};

/// A stage of several files, the first of which is its root layer.
pub(super) fn stage_of(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(dir.path().join(name), text).unwrap();
    }
    let root = dir.path().join(files[0].0);
    (dir, root)
}

fn read(text: &str, frame: f64) -> Loaded {
    let head = "#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" timeCodesPerSecond = 1 )\n";
    let (_dir, path) = stage_of(&[("stage.usda", &format!("{head}{text}"))]);
    try_load(&path, &at_frame(frame)).unwrap()
}

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
    late.said_of("frame 40 is outside of the stage's time codes 1 to 20; what has samples there shows them");
}

/// A stage that says no range has that of what it has samples of: here a mesh in a layer that is shifted by 100 and
/// slowed to half, and in an instance.
#[test]
fn a_frame_beyond_all_samples_is_held_and_told() {
    let head = "#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n";
    let mesh = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]";
    let part = format!(
        "#usda 1.0\n( defaultPrim = \"Part\" )\ndef Xform \"Part\" {{ def Mesh \"T\" {{ {mesh}
            double3 xformOp:translate.timeSamples = {{ 0: (0, 0, 0), 10: (5, 0, 0) }}
            uniform token[] xformOpOrder = [\"xformOp:translate\"] }} }}"
    );
    let place = |more: &str| {
        format!("{head}def \"A\" ( {more} prepend references = @part.usda@ (offset = 100; scale = 2) ) {{ }}")
    };
    for more in ["", "instanceable = true"] {
        let (_dir, path) = stage_of(&[("stage.usda", &place(more)), ("part.usda", &part)]);
        let at = |frame: f64| try_load(&path, &at_frame(frame)).unwrap();
        for (frame, x) in [(99.0, 0.0), (100.0, 0.0), (110.0, 2.5), (120.0, 5.0), (120.5, 5.0)] {
            let loaded = at(frame);
            assert_eq!(loaded.origin("/A/T"), [x, 0.0, 0.0], "frame {frame}");
            let said = format!(
                "frame {frame}: the stage names no range, and what it has samples of has them from 100 to 120; the nearest are held"
            );
            let outside = !(100.0..=120.0).contains(&frame);
            assert_eq!(loaded.said.iter().any(|told| told.contains(&said)), outside, "{:?}", loaded.said);
            assert_eq!(loaded.said.len(), usize::from(outside), "{:?}", loaded.said);
        }
        assert!(try_load(&path, &ImportOptions::default()).unwrap().said.is_empty());
    }
    // What has one sample, or none, shows the same at any frame.
    for values in ["token visibility.timeSamples = { 3: \"inherited\" }", ""] {
        let (_dir, path) = stage_of(&[("stage.usda", &format!("{head}def Mesh \"M\" {{ {mesh}\n{values} }}"))]);
        assert!(try_load(&path, &at_frame(40.0)).unwrap().said.is_empty());
    }
}

/// The same of a stage that many threads read.
#[test]
fn samples_are_met_by_all_threads() {
    let mut text = String::from("#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n");
    for i in 0..700 {
        let end = 10 + i;
        text += &format!(
            "def Sphere \"S{i}\" {{ double radius.timeSamples = {{ {}: 1, {end}: 2 }} }}\n",
            if i == 350 { -5 } else { 1 }
        );
    }
    let (_dir, path) = stage_of(&[("stage.usda", &text)]);
    let loaded = try_load(&path, &at_frame(1000.0)).unwrap();
    loaded.said_of("has them from -5 to 709");
    assert_eq!(loaded.said.len(), 1, "{:?}", loaded.said);
    assert!(try_load(&path, &at_frame(709.0)).unwrap().said.is_empty());
}

#[test]
fn what_moves_while_a_shutter_is_open_is_kept() {
    let loaded = load("times.usda", &at_frame(6.0));
    let motion: Vec<(f64, [f64; 3])> =
        loaded.one("/Linear/T").motion.iter().map(|m| (m.time, m.value.translation.to_array())).collect();
    assert_eq!(motion, [(-0.25, [4.75, 0.0, 0.0]), (0.25, [5.25, 0.0, 0.0])]);
    assert!(loaded.one("/Blocked/T").motion.is_empty() || loaded.one("/Blocked/T").motion.len() == 2);
}

#[test]
fn what_deforms_while_a_shutter_is_open_is_kept() {
    let loaded = load("deforms.usda", &at_frame(4.0));
    for path in ["/Sheet", "/Solid"] {
        let mesh = loaded.scene.mesh(loaded.one(path)).unwrap();
        // The solid's corners are its faces'.
        let at = mesh.points.iter().position(|&p| p == [1.0, 0.0, 4.0]).unwrap();
        let motion: Vec<(f64, [f32; 3])> = mesh.motion.iter().map(|m| (m.time, m.value[at])).collect();
        assert_eq!(motion, [(-0.5, [1.0, 0.0, 3.5]), (0.5, [1.0, 0.0, 4.5])], "{path}");
    }
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

/// usd-core 26.11's values of these curves.
#[test]
fn curves_give_their_values() {
    let text = r#"
def Xform "A" {
    double xformOp:translateX.spline = { hermite, post: linear,
        0: 0; post curve (1),
        10: .5; pre (-1),
    }
    float xformOp:rotateZ.spline = { bezier,
        1: 0; post curve (2, 10),
        5: 90; pre (1, 0); post held; { string note = "hi" },
        8: 20,
    }
    uniform token[] xformOpOrder = ["xformOp:translateX", "xformOp:rotateZ"]
    def Cube "T" { double size.spline = { post: sloped(0.5), 1: 3; post linear, 5: 4 & 7; post held, 8: 2 } }
}
"#;
    for (frame, x, degrees, size) in
        [(0.0, 0.0, 0.0, 3.0), (3.0, 2.208, 40.800_918_579, 3.5), (6.0, 2.724, 90.0, 7.0), (12.0, -1.5, 20.0, 4.0)]
    {
        let loaded = read(text, frame);
        let cube = loaded.one("/A/T");
        near(cube.transform.translation, [x, 0.0, 0.0]);
        let turned = cube.transform.transform_vector3(DVec3::X);
        assert!((turned.y.atan2(turned.x).to_degrees() - degrees).abs() < 1e-4, "{frame}: {turned}");
        assert_eq!(loaded.scene.mesh(cube).unwrap().points[0][0], (0.5 * size) as f32);
        loaded.said_nothing();
    }
}

#[test]
fn what_follows_a_curve_moves_while_a_shutter_is_open() {
    let text = r#"
def Camera "C" { double shutter:open = -1
 double shutter:close = 1 }
def Cube "T" {
    double xformOp:translateX.spline = { 0: 0; post linear, 4: 4; post linear, 8: 0 }
    uniform token[] xformOpOrder = ["xformOp:translateX"]
}
"#;
    let loaded = read(text, 4.0);
    let motion = &loaded.one("/T").motion;
    let at = |time: f64| motion.iter().find(|m| m.time == time).unwrap().value.translation.x;
    assert_eq!([at(-1.0), at(0.0), at(1.0)], [3.0, 4.0, 3.0]);
    assert!(motion.len() > 4 && motion.windows(2).all(|pair| pair[0].time < pair[1].time));
}

/// Widths, of points that stand still and of such that fly, of strands and of ribbons.
#[test]
fn widths_change_while_a_shutter_is_open() {
    let text = r#"
def Camera "C" { double shutter:open = -1
 double shutter:close = 1 }
def Points "Grows" {
    point3f[] points = [(0, 0, 0), (9, 0, 0)]
    float[] widths.timeSamples = { 0: [0, 8], 5: [5, 8], 8: [2, 8] }
}
def Points "Flies" {
    point3f[] points.timeSamples = { 4: [(0, 0, 0)] }
    vector3f[] velocities.timeSamples = { 4: [(24, 0, 0)] }
    float[] widths.timeSamples = { 0: [1], 8: [9] }
}
def BasisCurves "Strand" {
    uniform token type = "linear"
    int[] curveVertexCounts = [2]
    point3f[] points = [(0, 0, 0), (9, 0, 0)]
    float[] primvars:widths ( interpolation = "vertex" )
    float[] primvars:widths.timeSamples = { 0: [2, 1], 8: [10, 1] }
}
def BasisCurves "Ribbon" {
    uniform token type = "linear"
    int[] curveVertexCounts = [2]
    point3f[] points.timeSamples = { 0: [(0, 0, 0), (9, 0, 0)], 8: [(0, 8, 0), (9, 8, 0)] }
    normal3f[] normals = [(0, 0, 1), (0, 0, 1)]
    float[] widths.timeSamples = { 0: [2, 2], 8: [10, 10] }
}
def Points "Counts" {
    point3f[] points = [(0, 0, 0), (9, 0, 0)]
    float[] widths.timeSamples = { 0: [1, 1], 4: [1, 1], 5: [1, 1, 1] }
}
"#;
    let loaded = read(text, 4.0);
    let rounds = |path| loaded.scene.rounds(loaded.one(path)).unwrap();
    let times = |path| rounds(path).motion.iter().map(|m| m.time).collect::<Vec<_>>();
    // The sample within the shutter is at its end.
    assert_eq!((rounds("/Grows").radii.clone(), times("/Grows")), (vec![2.0, 4.0], vec![-1.0, 1.0]));
    assert_eq!(rounds("/Grows").radii_motion, [[1.5, 4.0], [2.5, 4.0]]);
    assert_eq!(rounds("/Flies").radii_motion, [[2.0], [3.0]]);
    assert_eq!(rounds("/Flies").motion[1].value, [[24.0, 0.0, 0.0]]);
    assert_eq!(rounds("/Strand").radii_motion, [[2.5, 0.5], [3.5, 0.5]]);
    let ribbon = loaded.scene.mesh(loaded.one("/Ribbon")).unwrap();
    let across = |points: &[[f32; 3]]| [points[0][1], points[1][1]];
    assert_eq!(across(&ribbon.points), [1.0, 7.0]);
    let motion: Vec<_> = ribbon.motion.iter().map(|m| (m.time, across(&m.value))).collect();
    assert_eq!(motion, [(-1.0, [0.5, 5.5]), (1.0, [1.5, 8.5])]);
    assert!(rounds("/Counts").radii_motion.is_empty());
    loaded.said_of("/Counts.widths: the number of widths changes within the shutter; those of the frame are used");
}

/// `--interpolation held`, OpenUSD's `SetInterpolationType(Usd.InterpolationTypeHeld)`.
#[test]
fn samples_are_held_where_that_is_asked_for() {
    let options = ImportOptions { interpolation: Interpolation::Held, ..at_frame(6.0) };
    assert_eq!(load("times.usda", &options).origin("/Linear/T"), [0.0, 0.0, 0.0]);
}

/// `ComputeInstanceTransformsAtTimes` of usd-core 26.11 at time code 4.
#[test]
fn velocities_count_where_their_samples_are_those_of_the_positions() {
    let place = |rates: &str| {
        let text = format!(
            r#"
def PointInstancer "I" {{
    int[] protoIndices = [0]
    point3f[] positions.timeSamples = {{ 0: [(0, 0, 0)], 10: [(10, 0, 0)] }}
    vector3f[] velocities{rates}
    rel prototypes = </I/P>
    def Cube "P" {{}}
}}
"#
        );
        let loaded = read(&text, 4.0);
        let told =
            loaded.said.iter().any(|said| said.contains("/I: the samples of its velocities are not at the times"));
        (loaded.origin("/I/P"), told)
    };
    assert_eq!(place(".timeSamples = { 0: [(0, 1, 0)], 10: [(0, 2, 0)] }"), ([0.0, 4.0, 0.0], false));
    for rates in ["{ 0: [(0, 1, 0)], 9: [(0, 2, 0)] }", "{ 0: [(0, 1, 0)] }", "{ 1: [(0, 1, 0)], 10: [(0, 2, 0)] }"] {
        assert_eq!(place(&format!(".timeSamples = {rates}")), ([4.0, 0.0, 0.0], true), "{rates}");
    }
    assert_eq!(place(" = [(0, 1, 0)]"), ([4.0, 0.0, 0.0], true));
}

/// What a schema knows is reached though only the clips have it; the manifest is made where there is none.
#[test]
fn clips_reach_what_the_stage_does_not_declare() {
    for manifest in ["", "asset manifestAssetPath = @./manifest.usda@"] {
        let root = format!(
            r#"#usda 1.0
( metersPerUnit = 1 upAxis = "Y" )
def Xform "A" (
    clips = {{
        dictionary default = {{
            asset[] assetPaths = [@./clip.usda@]
            string primPath = "/Clip"
            double2[] active = [(0, 0)]
            {manifest}
        }}
    }}
)
{{
    def Mesh "T" {{
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2]
        uniform token subdivisionScheme = "none"
    }}
}}
"#
        );
        let clip = r#"#usda 1.0
def "Clip" { def "T" {
    point3f[] points.timeSamples = { 0: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 4: [(0, 0, 0), (3, 0, 0), (0, 1, 0)] }
} }
"#;
        let declared = "#usda 1.0\ndef \"Clip\" { def \"T\" { point3f[] points\n } }\n";
        let (_dir, path) = stage_of(&[("root.usda", &root), ("clip.usda", clip), ("manifest.usda", declared)]);
        let loaded = try_load(&path, &at_frame(2.0)).unwrap();
        loaded.said_nothing();
        assert_eq!(loaded.scene.mesh(loaded.one("/A/T")).unwrap().points[1], [2.0, 0.0, 0.0]);
    }
}

/// Wide stages are read by many threads; what moves is the same, instances and what is above included.
#[test]
fn many_threads_agree_on_when_something_moves() {
    let mover = |name: &str, extra: &str, samples: &str| {
        format!(
            "def {name} ({extra}) {{\n double3 xformOp:translate.timeSamples = {{ {samples} }}\n uniform token[] xformOpOrder = [\"xformOp:translate\"]\n"
        )
    };
    let mut text = String::from("def Camera \"C\" { double shutter:open = -1\n double shutter:close = 1 }\n");
    text += "class \"K\" { def Cube \"P\" { } }\n";
    text += &mover("Xform \"W\"", "", "0: (0, 0, 0), 10: (10, 0, 0)");
    for i in 0..600 {
        text += &mover(&format!("Cube \"M{i}\""), "", &format!("0: (0, {i}, 0), 10: (0, {}, 0)", i + 10));
        text += "}\n";
    }
    text += &mover("Xform \"N\"", "instanceable = true inherits = </K>", "4.5: (0, 0, 1), 6.5: (0, 0, 3)");
    text += "}\n}\n";
    let loaded = read(&text, 5.0);
    // The instance's own sample lies between the ends of the shutter.
    for (path, at_open, at_sample) in
        [("/W/M7", [4.0, 11.0, 0.0], [4.5, 11.5, 0.0]), ("/W/M599", [4.0, 603.0, 0.0], [4.5, 603.5, 0.0])]
    {
        let motion = &loaded.one(path).motion;
        assert_eq!(motion.iter().map(|m| m.time).collect::<Vec<_>>(), [-1.0, -0.5, 1.0]);
        near(motion[0].value.translation, at_open);
        near(motion[1].value.translation, at_sample);
    }
    let motion = &loaded.one("/W/N/P").motion;
    near(motion[0].value.translation, [4.0, 0.0, 1.0]);
    near(motion[2].value.translation, [6.0, 0.0, 2.5]);
    assert_eq!(loaded.scene.instances.len(), 601);
}
