//! The program end to end: exit codes, messages, files.

#[path = "support/glb.rs"]
#[allow(dead_code)] // The tests of the glTF door use the rest.
mod glb;

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use glb::Glb;
use penumbra::output::exr;
use serde_json::json;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// Names of the files that are there.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

fn penumbra(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_penumbra")).args(args).stdin(Stdio::null()).output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// One triangle and a camera four metres in front of it; after a second the triangle has gone 24
/// metres to the right.
fn triangle() -> Glb {
    let mut glb = Glb::triangle();
    glb.push("materials", json!({"name": "Paint", "pbrMetallicRoughness": {"metallicFactor": 0}}));
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    glb.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}));
    glb.push("nodes", json!({"name": "Cam", "camera": 0, "translation": [0.3, 0.3, 4]}));
    let times = glb.floats("SCALAR", &[0.0, 1.0]);
    let places = glb.floats("VEC3", &[0.0, 0.0, 0.0, 24.0, 0.0, 0.0]);
    let channel = json!({"sampler": 0, "target": {"node": 0, "path": "translation"}});
    glb.push("animations", json!({"channels": [channel], "samplers": [{"input": times, "output": places}]}));
    glb
}

#[test]
fn renders_every_pass_to_parts_named_as_blender_names_them() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let (out, png) = (folder.path("out.exr"), folder.path("out.png"));
    let args = ["render", text(&scene), "-o", text(&out), "--preview", text(&png), "--size", "32x24", "--spp", "2"];
    let output = penumbra(
        &[&args[..], &["--passes", "all,error,error_ao,error_shadow,error_trust", "--progress", "none"]].concat(),
    );
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("before 16 samples"), "{}", stderr(&output));
    assert!(stderr(&output).contains("no light in the scene"), "{}", stderr(&output));
    let picture = exr::read(&out).unwrap();
    assert_eq!((picture.width, picture.height), (32, 24));
    for pass in penumbra::film::PASSES.iter().filter(|pass| pass.prefix().is_none()) {
        let found = picture.layers.iter().any(|layer| layer.name.starts_with(&format!("ViewLayer.{}", pass.layer)));
        assert!(found, "{} is missing", pass.layer);
    }
    let depth = picture.layer("Depth").unwrap();
    assert_eq!(depth.pixel(32, 0, 0), [1e10]);
    assert!((depth.pixel(32, 16, 12)[0] - 4.0).abs() < 1e-4);
    assert_eq!(&std::fs::read(&png).unwrap()[..4], b"\x89PNG");
    assert_eq!(folder.names(), ["out.exr", "out.png", "tri.glb"]);
}

/// The triangle, lit by a lamp of the group "key" and one of "fill.001".
fn two_groups() -> Glb {
    let mut glb = triangle();
    for (name, group, place) in [("Key", "key", [1, 1, 2]), ("Fill", "fill.001", [-1, 0, 3])] {
        let penumbra = json!({"light": {"type": "point", "intensity": 4}, "light_group": group});
        glb.push("nodes", json!({"name": name, "translation": place, "extras": {"penumbra": penumbra}}));
    }
    glb
}

#[test]
fn light_groups_are_passes_that_sum_to_combined() {
    let folder = Folder::new();
    let scene = folder.write("two.glb", two_groups().bytes());
    let out = folder.path("out.exr");
    let render = |passes: &str| {
        let args = ["render", text(&scene), "-o", text(&out), "--size", "32x24", "--spp", "4", "--progress", "none"];
        penumbra(&[&args[..], &["--passes", passes]].concat())
    };
    let output = render("combined,combined_*,shadow_key");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let picture = exr::read(&out).unwrap();
    assert_eq!(picture.layers.len(), 4);
    let layer = |name: &str| picture.layer(name).unwrap();
    let (key, fill, all) = (layer("Combined_key"), layer("Combined_fill_001"), layer("Combined"));
    for (x, y) in (0..24).flat_map(|y| (0..32).map(move |x| (x, y))) {
        for c in 0..3 {
            let value = |layer: &penumbra::film::Layer| layer.pixel(32, x, y)[c];
            assert!((value(key) + value(fill) - value(all)).abs() <= 1e-6 * value(all).abs(), "({x}, {y})");
        }
    }
    let lit = |layer: &penumbra::film::Layer| layer.pixel(32, 16, 12)[0];
    assert!(lit(key) > 0.0 && lit(fill) > 0.0 && lit(key) != lit(fill));
    assert_eq!(lit(layer("Shadow_key")), 1.0);

    let output = render("shadow_kye");
    assert_eq!(output.status.code(), Some(1));
    let message = "there is no light group 'kye'; the scene has: fill.001, key";
    assert!(stderr(&output).contains(message), "{}", stderr(&output));
}

#[test]
fn info_says_all_of_a_light_that_is_not_the_default() {
    let docs = include_str!("../docs/gltf.md");
    let example = docs.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let folder = Folder::new();
    let scene = folder.write("example.gltf", example);
    let output = penumbra(&["info", text(&scene)]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let page = String::from_utf8(output.stdout).unwrap();
    for line in [
        r#"rectangle light "Key": (53.0516, 42.4413, 31.8310) W/(m2 sr), 1.2 x 0.6 m, spread 114.5916 degrees, group "key", lights all but "Backdrop""#,
        r#"sphere light "Rim": (405.2847, 405.2847, 405.2847) W/(m2 sr), radius 0.05 m, cone 34.3775 degrees, blend 0.3, decay linear, group "fill", seen by camera"#,
        r#"point light "Panel": (9.0000, 9.0000, 9.0000) W/sr, group "fill", casts no shadow"#,
        r#"dome light "Sky": (0.2000, 0.2000, 0.2000) W/(m2 sr), group "sky""#,
        "light groups: fill, key, sky",
    ] {
        assert!(page.lines().any(|l| l.trim() == line), "{line}\nis not in\n{page}");
    }
    let output = penumbra(&["info", text(&scene), "--json"]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["light_groups"], json!(["fill", "key", "sky"]));
    let key = &info["lights"][0];
    assert_eq!((&key["size_m"], &key["receivers"]), (&json!([1.2, 0.6]), &json!({"exclude": ["Backdrop"]})));
    assert_eq!(info["lights"][1]["visibility"], json!({"camera": true}));
}

#[test]
fn the_same_command_gives_the_same_pixels_on_any_number_of_threads() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let render = |name: &str, threads: &str, seed: &str| {
        let out = folder.path(name);
        let args = ["render", text(&scene), "-o", text(&out), "--size", "33x17", "--spp", "5", "--threads", threads];
        assert!(penumbra(&[&args[..], &["--seed", seed]].concat()).status.success());
        exr::read(&out).unwrap()
    };
    let one = render("a.exr", "1", "7");
    assert_eq!(one, render("b.exr", "4", "7"));
    assert_ne!(one, render("c.exr", "4", "8"));
}

#[test]
fn frames_are_numbered_and_move() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("f.exr");
    let args = ["render", text(&scene), "-o", text(&out), "--frames", "0-24x24", "--size", "16x16", "--spp", "1"];
    assert!(penumbra(&args).status.success());
    let depth = |name: &str| exr::read(&folder.path(name)).unwrap().layers[0].data.clone();
    // After a second the triangle has gone 24 m to the right.
    assert_ne!(depth("f.0000.exr"), depth("f.0024.exr"));
    assert!(depth("f.0024.exr").iter().all(|v| *v == 0.0));
}

#[test]
fn a_time_limit_is_kept() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("t.exr");
    let start = Instant::now();
    let output = penumbra(&["render", text(&scene), "-o", text(&out), "--size", "64x64", "--time", "1"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!((Duration::from_secs(1)..Duration::from_secs(8)).contains(&start.elapsed()), "{:?}", start.elapsed());
}

/// An attribute of the header, as text.
fn attribute(path: &Path, name: &str) -> String {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let header = ::exr::meta::MetaData::read_from_buffered(file, true).unwrap().headers[0].clone();
    let found = header.own_attributes.other.iter().find(|(key, _)| key.as_slice() == name.as_bytes());
    let Some((_, ::exr::meta::attribute::AttributeValue::Text(text))) = found else { panic!("no {name}") };
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

/// The light of the two lamps, which are points, is the same in every sample but for the pixels at the edges.
#[test]
fn an_error_ends_a_render_and_is_told() {
    let folder = Folder::new();
    let scene = folder.write("two.glb", two_groups().bytes());
    let out = folder.path("e.exr");
    let render = |args: &[&str]| {
        let start = ["render", text(&scene), "-o", text(&out), "--size", "64x64", "--progress", "json"];
        penumbra(&[&start[..], args].concat())
    };
    let output = render(&["--error", "0.02", "--passes", "combined,error,error_trust,sample_count"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let numbers: Vec<f64> =
        attribute(&out, "penumbra/error/display").split(' ').map(|text| text.parse().unwrap()).collect();
    assert!(numbers[1] < numbers[0] && numbers[0] < numbers[2] && numbers[0] <= 0.02, "{numbers:?}");
    let said = stderr(&output);
    assert!(said.lines().last().unwrap().contains(&format!("error {:.3e}", numbers[0])), "{said}");
    let progress: Vec<serde_json::Value> =
        said.lines().filter(|line| line.starts_with('{')).map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(progress.last().unwrap()["error_target"], 0.02);
    let taken = exr::read(&out).unwrap().layer("Debug Sample Count").unwrap().data[0];
    assert!((16.0..4096.0).contains(&taken), "{taken}");
    // Fewer samples than it takes: told, with the error that there is.
    let output = render(&["--error", "1e-5", "--spp", "24"]);
    assert!(output.status.success());
    assert!(stderr(&output).contains("an error of 0.00001 was not reached with 24 samples"), "{}", stderr(&output));
    let strict = render(&["--error", "1e-5", "--spp", "24", "--strict"]);
    assert_eq!(strict.status.code(), Some(1), "{}", stderr(&strict));
}

#[test]
fn bad_input_gets_one_clear_error_that_names_the_file() {
    let folder = Folder::new();
    let good = folder.write("good.glb", triangle().bytes());
    let out = folder.path("out.exr");
    let whole = triangle().bytes();
    let truncated = folder.write("cut.glb", &whole[..whole.len() / 2]);
    let changed = |name: &str, change: &dyn Fn(&mut serde_json::Value)| {
        let mut glb = triangle();
        change(&mut glb.json);
        folder.write(name, glb.bytes())
    };
    let loops = changed("loop.glb", &|json| json["nodes"][0]["children"] = json!([0]));
    let range = changed("range.glb", &|json| json["bufferViews"][0]["byteLength"] = json!(999_999));
    let needs = changed("needs.glb", &|json| json["extensionsRequired"] = json!(["EXT_of_the_future"]));
    let no_json = folder.write("x.gltf", "{ not json");
    let no_scene = folder.write("x.abc", "?");
    let no_usd = folder.write("x.usda", "#usda 1.0\ndef Mesh {");
    let no_sky = folder.write("bad.hdr", "#?RADIANCE\nrubbish");
    let cases: [(&[&str], &str); 11] = [
        (&["/no/such/scene.glb"], "/no/such/scene.glb"),
        (&[text(&truncated)], "cut.glb"),
        (&[text(&range)], "range.glb"),
        (&[text(&needs)], "EXT_of_the_future"),
        (&[text(&no_json)], "x.gltf"),
        (&[text(&no_scene)], "x.abc"),
        (&[text(&no_usd)], "x.usda"),
        (&[text(&good), "--camera", "Nobody"], "Cam"),
        (&[text(&good), "--environment", "/no/sky.hdr"], "/no/sky.hdr"),
        (&[text(&good), "--environment", text(&no_sky)], "bad.hdr"),
        (&[text(&good), "--variant", "Gold"], "Gold"),
    ];
    for (args, named) in cases {
        let output = penumbra(&[&["render"], args, &["-o", text(&out), "--size", "8x8", "--spp", "1"]].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{args:?}: {message}");
        assert!(message.starts_with("error: ") && message.contains(named), "{args:?}: {message}");
        assert!(!message.contains("panicked") && !out.exists(), "{args:?}: {message}");
    }
    // A loop among nodes is cut or refused, and told of either way.
    let output = penumbra(&["render", text(&loops), "-o", text(&out), "--size", "8x8", "--spp", "1"]);
    assert!(stderr(&output).contains("loop.glb") && !stderr(&output).contains("panicked"), "{}", stderr(&output));
}

#[test]
fn an_output_that_cannot_be_written_is_found_before_the_render() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let taken = folder.path("folder.exr");
    std::fs::create_dir(&taken).unwrap();
    for out in ["/no/such/folder/out.exr", text(&taken)] {
        let start = Instant::now();
        let output = penumbra(&["render", text(&scene), "-o", out, "--spp", "100000"]);
        assert_eq!(output.status.code(), Some(1));
        assert!(stderr(&output).contains(out) && stderr(&output).contains("can't write"), "{}", stderr(&output));
        assert!(start.elapsed() < Duration::from_secs(10));
    }
}

#[test]
fn pictures_never_overwrite_what_they_are_made_of() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let sky = folder.write("sky.exr", b"a sky");
    let (out, hashes) = (folder.path("out.exr"), folder.path("out.####.exr"));
    let cases: [&[&str]; 5] = [
        &["-o", text(&scene)],
        &["-o", text(&out), "--preview", text(&scene)],
        &["-o", text(&out), "--preview", text(&out)],
        &["-o", text(&sky), "--environment", text(&sky)],
        &["-o", text(&hashes)],
    ];
    for args in cases {
        let output = penumbra(&[&["render", text(&scene), "--size", "4x4", "--spp", "1"], args].concat());
        assert_eq!(output.status.code(), Some(1), "{args:?}: {}", stderr(&output));
    }
    assert_eq!(std::fs::read(&scene).unwrap(), triangle().bytes());
    assert_eq!(std::fs::read(&sky).unwrap(), b"a sky");
    assert_eq!(folder.names(), ["sky.exr", "tri.glb"]);
}

#[test]
fn mistakes_on_the_command_line_are_exit_code_two() {
    let cases: [&[&str]; 9] = [
        &[],
        &["render"],
        &["render", "x.glb"],
        &["render", "x.glb", "-o", "o.exr", "--size", "0x540"],
        &["render", "x.glb", "-o", "o.exr", "--spp", "0"],
        &["render", "x.glb", "-o", "o.exr", "--passes", "beauty"],
        &["render", "x.glb", "-o", "o.exr", "--filter", "box:wide"],
        &["render", "x.glb", "-o", "o.exr", "--integrator", "magic"],
        &["paint", "x.glb"],
    ];
    for args in cases {
        let output = penumbra(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
    }
    assert!(stderr(&penumbra(cases[5])).contains("combined"), "lists the passes that there are");
}

#[test]
fn strict_takes_warnings_for_errors() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("out.exr");
    let output = penumbra(&["render", text(&scene), "-o", text(&out), "--strict"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--strict") && !out.exists());
}

#[test]
fn info_says_what_was_read() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let plain = penumbra(&["info", text(&scene)]);
    let plain = String::from_utf8_lossy(&plain.stdout).into_owned();
    assert!(plain.contains("Paint") && plain.contains("Cam"), "{plain}");
    let json = penumbra(&["info", text(&scene), "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert_eq!((&json["triangles"], &json["instances"]), (&1.into(), &1.into()));
    assert_eq!(json["cameras"][0]["fov_y_deg"].as_f64().unwrap().round(), 46.0);
}

/// Of a scene that never comes there is nothing to save.
#[cfg(unix)]
#[test]
fn an_interrupt_while_the_scene_is_read_ends_at_once() {
    let folder = Folder::new();
    let scene = folder.path("pipe.gltf");
    assert!(Command::new("mkfifo").arg(&scene).status().unwrap().success());
    let out = folder.path("out.exr");
    let args = ["render", text(&scene), "-o", text(&out)];
    let mut child = Command::new(env!("CARGO_BIN_EXE_penumbra")).args(args).stderr(Stdio::piped()).spawn().unwrap();
    // Opens once the program has the other end; it waits for bytes then.
    let writer = std::fs::OpenOptions::new().write(true).open(&scene).unwrap();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    drop(writer);
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
    assert!(said.contains("nothing to save") && !out.exists(), "{said}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_saves_what_is_there() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("out.exr");
    let args =
        ["render", text(&scene), "-o", text(&out), "--size", "200x200", "--spp", "1000000", "--progress", "json"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_penumbra")).args(args).stderr(Stdio::piped()).spawn().unwrap();
    // The first line of progress tells that samples are being taken.
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().unwrap()));
    let progress = lines.find(|line| line.as_ref().unwrap().starts_with('{')).unwrap().unwrap();
    let progress: serde_json::Value = serde_json::from_str(&progress).unwrap();
    assert_eq!(progress["target_spp"], 1_000_000);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let rest: Vec<String> = lines.map(|line| line.unwrap()).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(rest.iter().any(|line| line.contains("interrupted") && line.contains("out.exr")), "{rest:?}");
    let picture = exr::read(&out).unwrap();
    assert!(picture.layer("Combined").unwrap().data.iter().any(|v| *v > 0.0));
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_does_not_end_the_render() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("out.exr");
    let shell = |line: String| Command::new("sh").args(["-c", &line]).output().unwrap();
    let program = env!("CARGO_BIN_EXE_penumbra");
    let args = format!("-o {} --size 64x64 --spp 64 --progress json", text(&out));
    shell(format!("{program} render {} {args} 2>&1 >/dev/null | head -n 0", text(&scene)));
    let start = Instant::now();
    while !out.exists() && start.elapsed() < Duration::from_secs(30) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(exr::read(&out).unwrap().layer("Combined").is_some());
    let closed = shell(format!("{program} info {} 2>&1 >&-", text(&scene)));
    assert!(!String::from_utf8_lossy(&closed.stdout).contains("panicked"));
}

#[test]
fn numbers_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let scene = folder.write("tri.glb", triangle().bytes());
    let out = folder.path("out.exr");
    let render = |args: &[&str]| penumbra(&[&["render", text(&scene), "-o", text(&out)], args].concat());
    for args in
        [["--frame", "nan"], ["--frame", "inf"], ["--time", "nan"], ["--frames", "9-1"], ["--ao-distance", "-1"]]
    {
        assert_eq!(render(&args).status.code(), Some(2), "{args:?}");
    }
    for flag in ["--error", "--time"] {
        for value in ["0", "-0.5", "nan", "inf", "much"] {
            let output = render(&[flag, value]);
            let said = stderr(&output);
            let line = format!("error: invalid value '{value}' for '{flag} <");
            assert!(output.status.code() == Some(2) && said.starts_with(&line), "{said}");
        }
    }
    let huge = render(&["--size", "65536x65535", "--passes", "all"]);
    assert_eq!(huge.status.code(), Some(1), "{}", stderr(&huge));
    assert!(stderr(&huge).contains("65536x65535") && !out.exists(), "{}", stderr(&huge));
    assert!(render(&["--frames", "-2--1", "--size", "4x4", "--spp", "1"]).status.success());
    assert_eq!(folder.names(), ["out.-001.exr", "out.-002.exr", "tri.glb"]);
}

/// One render, a file for each product with the passes of its own.
#[test]
fn a_stage_has_a_picture_for_each_of_its_products() {
    let folder = Folder::new();
    let stage = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/usd/stages/products.usda");
    let run = |args: &[&str]| {
        let program = Command::new(env!("CARGO_BIN_EXE_penumbra")).current_dir(folder.path("")).args(args).output();
        program.unwrap()
    };
    let layers = |name: &str| -> Vec<String> {
        let picture = exr::read(&folder.path(name)).unwrap();
        picture.layers.iter().map(|layer| layer.name.rsplit('.').next().unwrap().to_owned()).collect()
    };
    let output = run(&["render", stage, "--spp", "1", "--strict"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert_eq!((layers("a.exr"), layers("b.exr")), (vec!["Combined".into(), "Depth".into()], vec!["Normal".into()]));
    assert!(stderr(&output).contains("a.exr, b.exr: 8x4"), "{}", stderr(&output));
    // Whoever names the file gets one, with all passes.
    let output = run(&["render", stage, "--spp", "1", "--strict", "-o", "one.exr"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(
        stderr(&output).contains("note: ") && stderr(&output).contains("asks for 2 pictures"),
        "{}",
        stderr(&output)
    );
    assert_eq!(layers("one.exr"), ["Combined", "Depth", "Normal"]);
}

/// A product that can't be written is told by its prim, and costs none of the others unless a warning is an error.
#[test]
fn a_product_that_is_no_exr_file_is_left_out() {
    let folder = Folder::new();
    let text = include_str!("usd/stages/products.usda");
    let run = |name: &str, text: &str, args: &[&str]| {
        std::fs::write(folder.path(name), text).unwrap();
        let mut program = Command::new(env!("CARGO_BIN_EXE_penumbra"));
        program.current_dir(folder.path("")).args(["render", name, "--spp", "1"]).args(args).output().unwrap()
    };
    let first = text.replace("a.exr", "a.png");
    let output = run("first.usda", &first, &[]);
    let told =
        "warning: first.usda, /Render/Beauty: names the picture a.png, but a render writes .exr files: it is left out";
    assert!(output.status.success() && stderr(&output).contains(told), "{}", stderr(&output));
    assert_eq!(folder.names(), ["b.exr", "first.usda"]);
    let layers: Vec<_> = exr::read(&folder.path("b.exr")).unwrap().layers.into_iter().map(|l| l.name).collect();
    assert!(layers.len() == 1 && layers[0].ends_with("Normal"), "{layers:?}");
    let output = run("first.usda", &first, &["--strict"]);
    assert!(!output.status.success() && stderr(&output).contains("--strict: 1 warnings"), "{}", stderr(&output));
    // Whoever names the file has it.
    assert!(run("first.usda", &first, &["--strict", "-o", "c.exr"]).status.success());
    let output = run("none.usda", &first.replace("b.exr", "b.tif"), &[]);
    let told = "none.usda, /Render/Beauty: its picture a.png: a render writes .exr files, the name must end so";
    assert!(!output.status.success() && stderr(&output).contains(told), "{}", stderr(&output));
    let output = run("nowhere.usda", &text.replace("b.exr", "no/such/b.exr"), &[]);
    let told = "nowhere.usda, /Render/Data: its picture no/such/b.exr: can't write";
    assert!(!output.status.success() && stderr(&output).contains(told), "{}", stderr(&output));
}

/// Where the command line is silent, a USD stage says where its picture goes and how large it is.
#[test]
fn a_stage_names_its_own_picture() {
    let folder = Folder::new();
    let stage = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/usd/stages/deforms.usda");
    let run = |args: &[&str]| {
        let program = Command::new(env!("CARGO_BIN_EXE_penumbra")).current_dir(folder.path("")).args(args).output();
        program.unwrap()
    };
    let output = run(&["render", stage, "--spp", "1"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let picture = exr::read(&folder.path("own_name.exr")).unwrap();
    assert_eq!((picture.width, picture.height), (8, 4));
    let scene = folder.write("tri.glb", triangle().bytes());
    assert_eq!(run(&["render", text(&scene)]).status.code(), Some(2));
}

/// What overflows reaches no pass, is counted, and can be looked at again.
#[test]
fn a_sample_that_is_no_number_is_told_and_can_be_replayed() {
    let mut glb = triangle();
    glb.json["cameras"][0]["perspective"]["yfov"] = json!(1e-7);
    let penumbra = json!({"light": {"type": "point", "intensity": 1e30}});
    glb.push("nodes", json!({"name": "Key", "translation": [0.3, 0.3, 1e-6], "extras": {"penumbra": penumbra}}));
    let folder = Folder::new();
    let scene = folder.write("bright.glb", glb.bytes());
    let out = folder.path("out.exr");
    let args = ["render", text(&scene), "--size", "1x1", "--spp", "4", "--progress", "none"];
    let output = self::penumbra(&[&args[..], &["--filter", "box", "-o", text(&out)]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(exr::read(&out).unwrap().layers[0].data.iter().all(|v| v.is_finite()));
    let told = stderr(&output);
    let id = told.split_once("samples were not finite and left out; the first: --debug-sample ").expect(&told).1;
    let id = id.split_whitespace().next().unwrap();
    let output = self::penumbra(&[&args[..], &["--filter", "box", "--debug-sample", id]].concat());
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(told.contains("inf") || told.contains("NaN"), "{told}");
}
