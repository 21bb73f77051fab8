//! Value clips: several sets, templates with frames that are missing, files that are not there.

use super::times::stage_of;
use super::{Loaded, at_frame, try_load};

const MOVED: &str = "double3 xformOp:translate\nuniform token[] xformOpOrder = [\"xformOp:translate\"]";

/// A stage of `prims` beside `files`, at a frame.
fn read(prims: &str, files: &[(&str, &str)], frame: f64) -> Loaded {
    let root = format!("#usda 1.0\n( metersPerUnit = 1 upAxis = \"Y\" )\n{prims}");
    let files: Vec<(&str, String)> =
        files.iter().map(|(name, text)| (*name, format!("#usda 1.0\nover \"M\" {{\n{text}\n}}\n"))).collect();
    let mut all = vec![("root.usda", root.as_str())];
    all.extend(files.iter().map(|(name, text)| (*name, text.as_str())));
    let (_dir, path) = stage_of(&all);
    try_load(&path, &at_frame(frame)).unwrap()
}

/// A triangle whose clip sets are `sets`.
fn clipped(name: &str, sets: &str, body: &str) -> String {
    format!(
        r#"def Mesh "{name}" ( clips = {{ {sets} }} ) {{
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uniform token subdivisionScheme = "none"
    {body}
}}
"#
    )
}

fn explicit(name: &str, clips: &str, manifest: &str, active: &str) -> String {
    format!(
        r#"dictionary {name} = {{
    asset[] assetPaths = [{clips}]
    asset manifestAssetPath = @./{manifest}@
    string primPath = "/M"
    double2[] active = [{active}]
    double2[] times = [(0, 0), (10, 10)]
}}
"#
    )
}

/// What only clips have is reached though more than one set has it; the first set by name is the strongest.
#[test]
fn sets_that_have_the_same_attributes_are_read() {
    let sets = explicit("a", "@./a.usda@", "manifest.usda", "(0, 0)")
        + &explicit("b", "@./b.usda@", "manifest.usda", "(0, 0)");
    let files = [
        ("manifest.usda", "token visibility"),
        ("a.usda", "token visibility.timeSamples = { 0: \"inherited\", 5: \"invisible\" }"),
        ("b.usda", "token visibility.timeSamples = { 0: \"invisible\", 5: \"inherited\" }"),
    ];
    for (frame, shown) in [(2.0, 1), (7.0, 0)] {
        let loaded = read(&(clipped("T", &sets, "") + "def Sphere \"Other\" {}\n"), &files, frame);
        loaded.said_nothing();
        assert_eq!(loaded.all("/T").len(), shown, "at {frame}");
    }
}

fn template(more: &str) -> String {
    let sets = format!(
        r#"dictionary default = {{
    string templateAssetPath = "./t.##.usda"
    double templateStartTime = 1
    double templateEndTime = 3
    double templateStride = 1
    string primPath = "/M"
    {more}
}}
"#
    );
    clipped("T", &sets, MOVED)
}

/// usd-core 26.11's values at 1.5, 2, 2.5 and 3.5.
const PLACES: [(&str, [f64; 4]); 4] = [
    ("", [1.5, 2.0, 2.5, 3.0]),
    ("bool interpolateMissingClipValues = 1", [1.5, 2.0, 2.5, 3.0]),
    ("double templateActiveOffset = 0.5", [1.0, 1.0, 1.0, 3.0]),
    ("double templateActiveOffset = -1", [2.0, 3.0, 3.0, 3.0]),
];

#[test]
fn frames_that_a_template_does_not_find_are_no_clips() {
    let files = [
        ("t.01.usda", "double3 xformOp:translate.timeSamples = { 1: (1, 1, 0) }"),
        ("t.03.usda", "double3 xformOp:translate.timeSamples = { 3: (3, 3, 0) }"),
    ];
    for (more, values) in PLACES {
        for (frame, value) in [1.5, 2.0, 2.5, 3.5].into_iter().zip(values) {
            let loaded = read(&template(more), &files, frame);
            assert_eq!(loaded.origin("/T"), [value, value, 0.0], "{more} at {frame}");
            // The last one is beyond all samples, unless clips are moved.
            let held = "frame 3.5: the stage names no range, and what it has samples of has them from 1 to 3";
            assert!(loaded.said.iter().all(|said| said.contains(held)), "{:?}", loaded.said);
            assert_eq!(
                loaded.said.len(),
                usize::from(frame == 3.5 && !more.contains("Offset")),
                "{more}: {:?}",
                loaded.said
            );
        }
    }
    let none = read(&template(""), &[], 2.0);
    assert_eq!(none.origin("/T"), [0.0; 3]);
    assert_eq!(none.said_of("/T"), none.said_of("no file of its value clips ./t.##.usda is found; they are left out"));
}

/// Shapes are those of usd-core 26.11 at frame 2.
#[test]
fn clips_that_are_not_there_are_told_once() {
    let files = [
        ("manifest.usda", "double3 xformOp:translate"),
        ("a.usda", "double3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 4: (4, 0, 0) }"),
    ];
    let prims = [
        (
            "Gone",
            explicit("default", "@./a.usda@, @./no.usda@, @./nor.usda@", "manifest.usda", "(0, 0), (5, 1), (7, 2)"),
        ),
        ("Bare", explicit("default", "@./a.usda@", "none.usda", "(0, 0)")),
        ("Beyond", explicit("default", "@./a.usda@", "manifest.usda", "(0, 0), (5, 3)")),
    ];
    let text: String = prims.iter().map(|(name, sets)| clipped(name, sets, MOVED)).collect();
    let loaded = read(&text, &files, 2.0);
    let told = [
        "/Gone: 2 of its 3 value clips are not found, @./no.usda@ the first; they give no values",
        "/Bare: the manifest @./none.usda@ of its value clips is not found; they are left out",
        "/Beyond: active of its clip set \"default\" asks for clip 3 at 5, and there are 1; the set is left out",
    ];
    told.iter().for_each(|what| _ = loaded.said_of(what));
    assert_eq!(loaded.said.len(), told.len(), "{:#?}", loaded.said);
    assert_eq!(["/Gone", "/Bare", "/Beyond"].map(|path| loaded.origin(path)[0]), [2.0, 0.0, 0.0]);
}
