//! Renders that stop, are killed, and go on: the bits are those of one that never stopped, and what is not theirs to go
//! on from is left as it is.

#[path = "support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use penumbra::desc::{ColorInput, LightKind, MaterialDesc, ScalarInput, SceneDesc};
use penumbra::film::Picture;
use penumbra::math::{DAffine3, DVec3};
use penumbra::output::exr;
use penumbra::render::{Ended, Observer, Rendered, Start, State, render, render_from};
use penumbra::scene::{Scene, View, prepare};
use penumbra::settings::Settings;
use scene::{Builder, settings};

/// A ball and many small ones over glossy ground, lit by a lamp and a dim dome.
fn still() -> SceneDesc {
    let mut builder = Builder::default();
    let white = builder.lambert(0.7);
    let shiny = builder.material(MaterialDesc {
        base_color: ColorInput::constant([0.6, 0.5, 0.4]),
        roughness: ScalarInput::constant(0.3),
        ..MaterialDesc::default()
    });
    builder.ground(20.0, shiny);
    builder.sphere(16, true, white, DAffine3::from_translation(DVec3::Y));
    for i in 0..40 {
        // More objects than a pixel of Cryptomatte keeps inline.
        let (x, z) = (0.25 * f64::from(i % 8) - 1.0, 0.25 * f64::from(i / 8) - 1.0);
        let place = DAffine3::from_translation(DVec3::new(x, 2.2, z)) * DAffine3::from_scale(DVec3::splat(0.08));
        builder.sphere(4, false, white, place);
    }
    let lamp = LightKind::Sphere { radius: 0.7, radiance: [6.0, 5.0, 4.0], facing: false };
    builder.light(lamp, DAffine3::from_translation(DVec3::new(1.5, 3.5, 0.5)));
    builder.dome(0.1);
    builder.look([0.0, 0.3, 0.0], [0.3, -0.7, -0.4], 2.5);
    builder.desc
}

fn prepared(size: [u32; 2], settings: &Settings) -> Scene {
    prepare(still(), &View { camera: None, size: Some(size) }, settings).unwrap().scene
}

/// Four tiles, three of which are cut.
const SMALL: [u32; 2] = [21, 19];

/// Enough pixels for an error to be known.
const LARGE: [u32; 2] = [48, 34];

/// Stops after a number of questions whether to go on, which are asked at every row of a tile, and keeps the states that
/// it asks for at some of them, fewer than there are rows.
struct Stops {
    after: u64,
    asked: AtomicU64,
    states: std::sync::Mutex<Vec<Vec<u8>>>,
}

impl Stops {
    fn after(after: u64) -> Self {
        Self { after, asked: AtomicU64::new(0), states: Default::default() }
    }
}

impl Observer for Stops {
    fn cancelled(&self) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed) >= self.after
    }

    fn wants_state(&self) -> bool {
        self.asked.load(Ordering::Relaxed) % 101 == 100
    }

    fn save(&self, state: &State<'_>) {
        self.states.lock().unwrap().push(bytes(*state));
    }
}

fn bytes(state: State<'_>) -> Vec<u8> {
    let mut bytes = Vec::new();
    state.write(&mut bytes).unwrap();
    bytes
}

fn gone_on(state: &[u8], scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Rendered {
    let mut rest = state;
    let start = Start::read(scene, settings, &mut rest).unwrap().unwrap();
    assert!(rest.is_empty());
    render_from(start, scene, settings, observer).unwrap()
}

/// Cases of settings that take every kind of sum: spp, error, adaptive.
fn cases() -> Vec<Settings> {
    let all = "all,error,error_ao,error_shadow,error_trust,sample_count";
    vec![
        settings("combined", 40),
        settings("all", 9),
        settings(all, 40),
        Settings { error: Some(0.02), ..settings("combined,sample_count", 4096) },
        Settings { adaptive: true, ..settings("combined,sample_count", 70) },
        Settings { adaptive: true, error: Some(0.02), ..settings("combined,shadow,sample_count", 4096) },
    ]
}

fn same(one: &Picture, other: &Picture, what: &str) {
    for (a, b) in one.layers.iter().zip(&other.layers) {
        let bits = |layer: &penumbra::film::Layer| layer.data.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(bits(a) == bits(b), "{what}: {} differs", a.name);
    }
    assert_eq!(one.layers.len(), other.layers.len());
}

/// Stopped anywhere, in the middle of a wave of samples too, again and again.
#[test]
fn what_stops_anywhere_goes_on_to_the_same_bits() {
    for (i, settings) in cases().into_iter().enumerate() {
        let scene = prepared(SMALL, &settings);
        let whole = render(&scene, &settings, &()).unwrap();
        let (mut times, mut state) = (0, bytes(Start::new(&scene, &settings).unwrap().state()));
        loop {
            let stops = Stops::after(40 + 37 * (times % 5));
            let rendered = gone_on(&state, &scene, &settings, &stops);
            // A state that was saved on the way leads to the same end.
            if let Some(saved) = stops.states.lock().unwrap().last().filter(|_| times % 3 == 0) {
                let other = gone_on(saved, &scene, &settings, &());
                same(&other.film.develop(), &whole.film.develop(), &format!("case {i}, saved on the way"));
            }
            state = bytes(rendered.state());
            times += 1;
            if !rendered.interrupted {
                same(&rendered.film.develop(), &whole.film.develop(), &format!("case {i}"));
                assert_eq!((rendered.ended, rendered.accuracy), (whole.ended, whole.accuracy));
                break;
            }
        }
        assert!(times > 2, "case {i} stopped {times} times");
        let again = gone_on(&state, &scene, &settings, &());
        assert!(again.was_done, "case {i}");
    }
}

/// More samples, whatever the numbers.
#[test]
fn more_samples_give_the_bits_of_one_render() {
    for base in [
        settings("combined", 1),
        settings("combined,error", 1),
        Settings { adaptive: true, ..settings("combined,sample_count", 1) },
    ] {
        let scene = prepared(SMALL, &base);
        let spp = |spp| Settings { spp, ..base.clone() };
        let whole = render(&scene, &spp(100), &()).unwrap();
        let mut state = bytes(Start::new(&scene, &base).unwrap().state());
        for some in [3, 16, 37, 64, 65, 99, 100] {
            let rendered = gone_on(&state, &scene, &spp(some), &());
            assert_eq!(rendered.ended, Ended::Samples);
            state = bytes(rendered.state());
            // What has more than is asked for stays.
            assert!(gone_on(&state, &scene, &spp(2), &()).was_done);
        }
        same(&gone_on(&state, &scene, &spp(100), &()).film.develop(), &whole.film.develop(), "100");
    }
}

/// A smaller error, from any larger one.
#[test]
fn a_tighter_target_gives_the_bits_of_one_render() {
    let targets = [0.012, 0.0085, 0.007, 0.006, 0.0052, 0.0046, 0.0041];
    for adaptive in [false, true] {
        let base =
            Settings { adaptive, error: Some(1.0), max_bounces: 1, ..settings("combined,sample_count", 1 << 12) };
        let scene = prepared(LARGE, &base);
        let to = |target| Settings { error: Some(target), ..base.clone() };
        let whole = targets.map(|target| render(&scene, &to(target), &()).unwrap());
        println!("{:?} spp", whole.each_ref().map(|whole| whole.film.samples() / (48 * 34)));
        let mut longer = 0;
        for (i, from) in whole.iter().enumerate() {
            for (to_end, &target) in whole.iter().zip(&targets).skip(i) {
                let rendered = gone_on(&bytes(from.state()), &scene, &to(target), &());
                same(&rendered.film.develop(), &to_end.film.develop(), &format!("{} to {target}", targets[i]));
                assert_eq!(rendered.ended, Ended::Error);
                longer += u32::from(!rendered.was_done);
            }
            // A larger target is met already.
            if i > 0 {
                assert!(gone_on(&bytes(from.state()), &scene, &to(targets[0]), &()).was_done, "{}", targets[i]);
            }
        }
        println!("{longer} went on");
        assert!(longer >= 10, "{longer} went on");
    }
}

/// Time counts from the first start.
#[test]
fn time_that_is_spent_is_spent() {
    let base = Settings { time: Some(0.2), ..settings("combined,depth", Settings::NO_LIMIT) };
    let scene = prepared(SMALL, &base);
    let rendered = render(&scene, &base, &()).unwrap();
    assert_eq!(rendered.ended, Ended::Time);
    let again = gone_on(&bytes(rendered.state()), &scene, &base, &());
    assert!(again.was_done && again.ended == Ended::Time && again.elapsed >= rendered.elapsed);
    // What is found anew without samples is there.
    same(&again.film.develop(), &rendered.film.develop(), "depth");
    let more = gone_on(&bytes(rendered.state()), &scene, &Settings { time: Some(0.4), ..base }, &());
    assert!(more.film.samples() > rendered.film.samples() && more.elapsed >= Duration::from_millis(400));
}

#[test]
fn states_that_are_cut_off_are_told() {
    let settings = settings("combined,crypto_object,error", 16);
    let scene = prepared(SMALL, &settings);
    let state = bytes(render(&scene, &settings, &()).unwrap().state());
    for length in (0..state.len()).step_by(state.len() / 50) {
        assert!(Start::read(&scene, &settings, &mut &state[..length]).unwrap().is_err(), "{length}");
    }
}

// The program.

const STAGE: &str = r#"#usda 1.0
(
    upAxis = "Y"
)
def Camera "Camera" {
    float focalLength = 30
    double3 xformOp:translate = (0, 1, 6)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Sphere "Ball" {
    double radius = 1
    double3 xformOp:translate = (0, 1, 0)
    double3 xformOp:translate.timeSamples = { 1: (0, 1, 0), 9: (0, 1.5, 0) }
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def SphereLight "Lamp" {
    float inputs:intensity = 60
    float inputs:radius = 0.5
    double3 xformOp:translate = (2, 4, 2)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"#;

struct Folder(tempfile::TempDir);

impl Folder {
    fn with_stage() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("scene.usda"), STAGE).unwrap();
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The program with a scene and a picture of this folder.
    fn command(&self, out: &str, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
        command.current_dir(self.0.path()).args(["render", "scene.usda", "-o", out]);
        for (name, value) in [("--size", "48x32"), ("--progress", "none")] {
            if !args.contains(&name) {
                command.args([name, value]);
            }
        }
        command.args(args).stdin(Stdio::null()).stderr(Stdio::piped());
        command
    }

    fn run(&self, out: &str, args: &[&str]) -> Output {
        self.command(out, args).output().unwrap()
    }

    /// What it says where it can do what it is asked for.
    fn done(&self, out: &str, args: &[&str]) -> String {
        let output = self.run(out, args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
        said(&output)
    }

    /// What it says where it can't; no file changes.
    fn refused(&self, out: &str, args: &[&str]) -> String {
        let before = self.files();
        let output = self.run(out, args);
        assert_eq!(output.status.code(), Some(1), "{args:?}: {}", said(&output));
        assert!(self.files() == before, "{args:?} changed a file");
        said(&output)
    }

    /// Every file and its bytes.
    fn files(&self) -> Vec<(String, Vec<u8>)> {
        let entries = std::fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap());
        let read = |entry: std::fs::DirEntry| {
            (entry.file_name().to_string_lossy().into_owned(), std::fs::read(entry.path()).unwrap_or_default())
        };
        let mut files: Vec<_> = entries.map(read).collect();
        files.sort();
        files
    }

    fn picture(&self, out: &str) -> Picture {
        exr::read(&self.path(out)).unwrap()
    }

    fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_picture_goes_on_to_more_samples_and_to_a_smaller_error() {
    let folder = Folder::with_stage();
    let passes = ["--passes", "combined,shadow,ao,depth,crypto_object,error"];
    let with = |args: &[&'static str]| [&passes[..], args].concat();
    let told = folder.done("a.exr", &with(&["--spp", "20", "--resume"]));
    assert!(told.contains("no picture to go on with: it begins anew"), "{told}");
    let told = folder.done("a.exr", &with(&["--spp", "50", "--resume"]));
    assert!(told.contains("50 spp (20 of them before)"), "{told}");
    folder.done("whole.exr", &with(&["--spp", "50"]));
    same(&folder.picture("a.exr"), &folder.picture("whole.exr"), "samples");
    assert!(folder.has("a.exr.state") && !folder.has("whole.exr.state"));

    folder.done("a.exr", &with(&["--error", "0.0025", "--resume"]));
    let told = folder.done("whole.exr", &with(&["--error", "0.0025"]));
    assert!(!told.contains(" 50 spp"), "no smaller error: {told}");
    same(&folder.picture("a.exr"), &folder.picture("whole.exr"), "error");
}

/// What is done is known by the picture alone, and is not touched.
#[test]
fn finished_frames_are_passed_over() {
    let folder = Folder::with_stage();
    let frames = ["--frames", "1-3", "--resume", "--spp", "8"];
    folder.done("f.####.exr", &frames);
    for frame in 1..4 {
        std::fs::remove_file(folder.path(&format!("f.000{frame}.exr.state"))).unwrap();
    }
    std::fs::remove_file(folder.path("f.0002.exr")).unwrap();
    let before = folder.files();
    let told = folder.done("f.####.exr", &frames);
    assert_eq!(told.matches("it has 8 spp and is done").count(), 2, "{told}");
    let after = folder.files();
    assert!(before.iter().all(|file| after.contains(file)));
    assert!(folder.has("f.0002.exr") && folder.has("f.0002.exr.state") && !folder.has("f.0001.exr.state"));
    // More is asked for: those without a state begin anew, and the bits are the same.
    let told = folder.done("f.####.exr", &["--frames", "1-2", "--resume", "--spp", "12"]);
    assert!(told.contains("f.0001.exr: the picture has no state beside it: it begins anew"), "{told}");
    assert!(told.contains("12 spp (8 of them before)"), "{told}");
    folder.done("w.####.exr", &["--frames", "1-2", "--spp", "12"]);
    for frame in 1..3 {
        same(&folder.picture(&format!("f.000{frame}.exr")), &folder.picture(&format!("w.000{frame}.exr")), "frame");
    }
}

#[test]
fn what_is_of_another_scene_or_of_other_settings_is_refused() {
    let folder = Folder::with_stage();
    folder.done("a.exr", &["--spp", "4", "--resume"]);
    let others: [(&[&str], &str); 8] = [
        (&["--seed", "3"], "seed was 0 and is 3"),
        (&["--sampler", "independent"], "sampler was sobol and is independent"),
        (&["--size", "40x32"], "size was 48x32 and is 40x32"),
        (&["--filter", "box"], "filter was"),
        (&["--passes", "combined,ao"], "passes was combined and is combined,ao"),
        (&["--integrator", "direct"], "integrator was path and is direct"),
        (&["--max-bounces", "2"], "max-bounces was 12 and is 2"),
        (&["--error", "0.01"], "sequences of samples was one and is eight, for the error"),
    ];
    for (args, what) in others {
        let told = folder.refused("a.exr", &[&["--resume", "--spp", "8"], args].concat());
        assert!(told.contains(what) && told.contains("a.exr.state") && told.contains("nothing was written"), "{told}");
    }
    // Neither a state nor a picture of another scene is gone on from.
    std::fs::write(folder.path("scene.usda"), STAGE.replace("radius = 1\n", "radius = 1.01\n")).unwrap();
    let told = folder.refused("a.exr", &["--spp", "8", "--resume"]);
    assert!(told.contains("the scene is another one, or has changed since"), "{told}");
    std::fs::remove_file(folder.path("a.exr.state")).unwrap();
    let told = folder.refused("a.exr", &["--spp", "8", "--resume"]);
    assert!(told.contains("a.exr: can't go on from this: the scene is another one"), "{told}");
    // Without --resume it is replaced, as ever.
    folder.done("a.exr", &["--spp", "2"]);
}

#[test]
fn settings_that_change_no_sample_and_another_folder_are_no_obstacle() {
    let folder = Folder::with_stage();
    folder.done("a.exr", &["--spp", "4", "--resume"]);
    std::fs::create_dir(folder.path("sub")).unwrap();
    std::fs::rename(folder.path("scene.usda"), folder.path("sub/moved.usda")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    command.current_dir(folder.path("sub")).args(["render", "moved.usda", "-o", "../a.exr", "--size", "48x32"]);
    let args = ["--progress", "none", "--spp", "6", "--resume", "--threads", "1", "--effects", "all", "--half", "on"];
    let output = command.args(args).output().unwrap();
    assert!(said(&output).contains("6 spp (4 of them before)"), "{}", said(&output));
}

#[test]
fn damaged_states_and_strange_pictures_are_refused() {
    let folder = Folder::with_stage();
    folder.done("a.exr", &["--spp", "4", "--resume"]);
    let state = folder.path("a.exr.state");
    let whole = std::fs::read(&state).unwrap();
    for length in [0, 10, 40, 400, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&state, &whole[..length]).unwrap();
        let told = folder.refused("a.exr", &["--spp", "8", "--resume"]);
        assert!(told.contains("a.exr.state: can't go on from this state: it is cut off"), "{length}: {told}");
    }
    let mut flipped = whole.clone();
    let middle = flipped.len() * 2 / 3;
    flipped[middle] ^= 1;
    std::fs::write(&state, &flipped).unwrap();
    let told = folder.refused("a.exr", &["--spp", "8", "--resume"]);
    assert!(told.contains("it is damaged"), "{told}");
    // What is asked for is there: no state is needed.
    folder.done("a.exr", &["--spp", "4", "--resume"]);
    std::fs::remove_file(&state).unwrap();
    std::fs::write(folder.path("a.exr"), "not an EXR").unwrap();
    let told = folder.refused("a.exr", &["--spp", "8", "--resume"]);
    assert!(told.contains("a.exr: not a sound EXR file"), "{told}");
}

/// A picture that is made anew takes the state of the old one with it.
#[test]
fn a_state_that_is_not_the_pictures_does_not_stay() {
    let folder = Folder::with_stage();
    folder.done("a.exr", &["--spp", "4", "--resume"]);
    folder.done("a.exr", &["--spp", "2", "--seed", "5"]);
    assert!(!folder.has("a.exr.state"));
    folder.done("a.exr", &["--spp", "2", "--seed", "5", "--checkpoint", "1"]);
    assert!(!folder.has("a.exr.state"));
}

/// Waits until `path` is there, and the process still runs.
fn wait_for(path: &Path, child: &mut Child) {
    while !path.exists() {
        assert!(child.try_wait().unwrap().is_none(), "ended before {}", path.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_picture_goes_on() {
    let folder = Folder::with_stage();
    let args = ["--passes", "combined,error", "--progress", "json"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    command.current_dir(folder.0.path()).args(["render", "scene.usda", "-o", "a.exr", "--size", "48x32"]);
    let mut child = command.args(args).args(["--spp", "10000000"]).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = std::io::BufRead::lines(std::io::BufReader::new(child.stderr.take().unwrap()));
    lines.find(|line| line.as_ref().unwrap().starts_with('{')).unwrap().unwrap();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let rest: Vec<String> = lines.map(|line| line.unwrap()).collect();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(rest.iter().any(|line| line.contains("--resume goes on from there")), "{rest:?}");
    let spp: f64 = exr::attributes(&folder.path("a.exr")).unwrap()["penumbra/samples"].parse().unwrap();
    let more = (spp.ceil() as u32 + 24).to_string();
    let with = |more: &[&'static str]| [&["--passes", "combined,error"], more].concat();
    let told = folder.done("a.exr", &[&with(&["--resume"])[..], &["--spp", &more]].concat());
    assert!(told.contains(" of them before)"), "{told}");
    folder.done("whole.exr", &[&with(&[])[..], &["--spp", &more]].concat());
    same(&folder.picture("a.exr"), &folder.picture("whole.exr"), "interrupted");
}

/// Killed at any moment, while its state is written too, again and again.
#[cfg(unix)]
#[test]
fn a_killed_render_goes_on_from_its_checkpoint() {
    let folder = Folder::with_stage();
    // Some seconds of work on one thread, which leaves the other tests room.
    let args = ["--passes", "combined,shadow,ao,crypto_object,error", "--threads", "1", "--spp", "1200"];
    let with = |more: &[&'static str]| [&args[..], more].concat();
    let changed = || std::fs::metadata(folder.path("a.exr.state")).and_then(|data| data.modified()).ok();
    let mut kills = 0;
    for round in 0_u64.. {
        let before = changed();
        let mut child = folder.command("a.exr", &with(&["--resume", "--checkpoint", "1"])).spawn().unwrap();
        let mut is_running = || child.try_wait().unwrap().is_none();
        // Now at some time in the first two seconds, in which a checkpoint may be written, now shortly after one.
        if round % 2 == 0 {
            std::thread::sleep(Duration::from_millis(200 * (round / 2 % 9) + 13 * round));
        } else {
            while changed() == before && is_running() {
                std::thread::sleep(Duration::from_millis(1));
            }
            std::thread::sleep(Duration::from_millis(3 * round));
        }
        if !is_running() {
            assert!(child.wait().unwrap().success());
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
        // It may have come to its end between the look and the kill: what it has written is held to the whole below.
        if folder.has("a.exr") {
            break;
        }
        assert!(round < 300, "it does not get on");
    }
    folder.done("whole.exr", &with(&[]));
    println!("{kills} kills");
    same(&folder.picture("a.exr"), &folder.picture("whole.exr"), "killed");
    assert!(kills > 0);
}

/// A killed writer leaves a whole state, old or new.
#[cfg(unix)]
#[test]
fn a_state_is_whole_whenever_its_writer_is_killed() {
    let folder = Folder::with_stage();
    let mut child = folder.command("a.exr", &["--resume", "--checkpoint", "1", "--spp", "10000000"]).spawn().unwrap();
    wait_for(&folder.path("a.exr.state"), &mut child);
    child.kill().unwrap();
    child.wait().unwrap();
    let mut state = penumbra::output::state::open(&folder.path("a.exr.state")).unwrap();
    let mut body = Vec::new();
    // To the end, the digest of the body among it.
    std::io::Read::read_to_end(&mut state, &mut body).unwrap();
    assert!(body.len() > 48 * 32 * 36);
    let told = folder.done("a.exr", &["--resume", "--spp", "1"]);
    assert!(told.contains(" of them before)"), "{told}");
}

/// Where the time goes is told to people, to machines and in the file; what samples spend it on where that is asked for.
#[test]
fn where_the_time_goes_is_told() {
    let folder = Folder::with_stage();
    let args = ["--spp", "16", "--passes", "combined,ao,shadow,error", "--progress", "json", "--max-bounces", "2"];
    let line = |told: &str| -> serde_json::Value {
        let line = told.lines().rfind(|line| line.starts_with('{')).unwrap();
        serde_json::from_str(line).unwrap()
    };
    let told = line(&folder.done("a.exr", &args));
    assert!(told["ended_by"] == "samples" && told["spp"] == 16.0 && told.get("costs").is_none(), "{told}");
    let attributes = exr::attributes(&folder.path("a.exr")).unwrap();
    for name in ["import", "materials", "geometry", "lights", "samples", "errors"] {
        assert!(told["time_s"][name].as_f64().unwrap() >= 0.0, "{told}");
        assert!(attributes.contains_key(&format!("penumbra/time/{name}")));
    }
    let said = folder.done("b.exr", &[&args[..], &["--costs"]].concat());
    let told = line(&said);
    let share = |name: &str| told["costs"][name][0].as_f64().unwrap();
    let bounces = share("first hit and its light") + share("bounce 1") + share("bounce 2");
    assert!((bounces - 1.0).abs() < 1e-9 && share("first hit and its light") > 0.1, "{told}");
    assert!(share("pass ao").is_finite() && share("pass shadow").is_finite());
    // Neither there nor asked for.
    assert!(told["costs"].get("effect motion blur").is_none() && told["costs"].get("pass cryptomatte").is_none());
    assert!(said.contains("a sample takes a thread") && said.contains("  pass ao: "), "{said}");
    assert!(exr::attributes(&folder.path("b.exr")).unwrap().contains_key("penumbra/cost/bounce 1"));
    // What measures changes nothing.
    same(&folder.picture("a.exr"), &folder.picture("b.exr"), "costs");
}
