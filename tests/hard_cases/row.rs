//! One case, and what must hold for each.

use std::path::PathBuf;

use penumbra::bvh::Isa;
use penumbra::film::Picture;
use penumbra::math::{DAffine3, DVec3};
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;

use crate::scene::{Builder, mean, settings};

/// How far the scene is moved for the second picture, in metres.
pub const MOVED: DVec3 = DVec3::new(1234.5, -987.6, 2345.7);

/// What is measured in a picture, of a scene that stands at a place in the world.
type Measure = Box<dyn Fn(&Picture, DVec3) -> f64>;

/// A scene, what is measured in its picture and what that has to be.
pub struct Row {
    name: String,
    scene: Builder,
    size: [u32; 2],
    settings: Settings,
    measure: Measure,
    truth: f64,
    tolerance: f64,
    moved: Option<DVec3>,
    open: Option<&'static str>,
}

impl Row {
    /// The mean of the first channel of `layer`, from `spp` samples of each of 4 × 4 pixels: `truth` to a relative
    /// `tolerance`, an absolute one where the truth is 0.
    pub fn new(
        name: impl Into<String>,
        scene: Builder,
        layer: &'static str,
        spp: u32,
        truth: f64,
        tolerance: f64,
    ) -> Self {
        let passes = penumbra::film::PASSES.iter().find(|pass| pass.layer == layer).map_or(layer, |pass| pass.name);
        Self {
            name: name.into(),
            scene,
            size: [4; 2],
            settings: Settings { max_bounces: 0, ..settings(passes, spp) },
            measure: Box::new(move |picture, _| mean(picture, layer, 0)),
            truth,
            tolerance,
            moved: Some(MOVED),
            open: None,
        }
    }

    /// Other settings.
    pub fn with(mut self, change: impl FnOnce(&mut Settings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// Another picture.
    pub fn sized(self, width: u32, height: u32) -> Self {
        Self { size: [width, height], ..self }
    }

    /// Another measure; it is given where in the world the scene stands.
    pub fn by(self, measure: impl Fn(&Picture, DVec3) -> f64 + 'static) -> Self {
        Self { measure: Box::new(measure), ..self }
    }

    /// Moved by another distance, or not at all, where the place is what the row is about.
    pub fn moved(self, moved: Option<DVec3>) -> Self {
        Self { moved, ..self }
    }

    /// A row that does not hold, and why: it stays until it does.
    pub fn open(self, why: &'static str) -> Self {
        Self { open: Some(why), ..self }
    }

    fn picture(&self, scene: &Builder, settings: &Settings, isa: Isa) -> Picture {
        let view = View { camera: None, size: Some(self.size) };
        let prepared = prepare(scene.desc.clone(), &view, settings).unwrap_or_else(|e| panic!("{}: {e}", self.name));
        let traced = prepared.scene.with_isa(isa).expect("an instruction set of this machine");
        penumbra::render::render(&traced, settings, &()).unwrap().film.develop()
    }

    fn value(&self, at: DVec3) -> f64 {
        let scene = moved(&self.scene, at);
        let picture = self.picture(&scene, &self.settings, Isa::best());
        for layer in &picture.layers {
            assert!(layer.data.iter().all(|v| v.is_finite()), "{}: {} has what is no number", self.name, layer.name);
        }
        (self.measure)(&picture, at)
    }

    /// Whatever the threads and the code that finds hits, the bits are the same.
    fn same_bits(&self) {
        let few = Settings { spp: self.settings.spp.min(4), threads: 1, ..self.settings.clone() };
        let expected = self.picture(&self.scene, &few, Isa::Scalar);
        let threads = Settings { threads: 3, ..few };
        for &isa in &Isa::available()[1..] {
            assert!(
                self.picture(&self.scene, &threads, isa) == expected,
                "{}: other bits on {}",
                self.name,
                isa.name()
            );
        }
    }
}

/// The same scene elsewhere.
pub fn moved(scene: &Builder, by: DVec3) -> Builder {
    placed(scene, DAffine3::from_translation(by))
}

/// The same scene, moved as a whole.
pub fn placed(scene: &Builder, by: DAffine3) -> Builder {
    let mut scene = scene.clone();
    let desc = &mut scene.desc;
    let transforms = desc.instances.iter_mut().map(|instance| &mut instance.transform);
    let transforms = transforms.chain(desc.lights.iter_mut().map(|light| &mut light.transform));
    for transform in transforms.chain(desc.cameras.iter_mut().map(|camera| &mut camera.transform)) {
        *transform = by * *transform;
    }
    scene
}

/// What a row came to, for the page.
pub struct Found {
    pub name: String,
    pub truth: f64,
    pub tolerance: f64,
    /// In place, and moved.
    pub values: [Option<f64>; 2],
    pub open: Option<&'static str>,
}

impl Found {
    fn off(&self) -> f64 {
        let scale = if self.truth == 0.0 { 1.0 } else { self.truth.abs() };
        self.values.iter().flatten().map(|value| (value - self.truth).abs() / scale).fold(0.0, f64::max)
    }
}

/// Renders every row and holds it to its answer, then leaves the results of `room` for the page.
pub fn hold(room: &str, rows: Vec<Row>) {
    let found = rows.into_iter().map(|row| {
        row.same_bits();
        let values = [Some(row.value(DVec3::ZERO)), row.moved.map(|by| row.value(by))];
        Found { name: row.name, truth: row.truth, tolerance: row.tolerance, values, open: row.open }
    });
    judge(room, found.collect());
}

/// The same for what was found by other means than a picture.
pub fn judge(room: &str, found: Vec<Found>) {
    let lines = found.iter().map(|row| {
        serde_json::json!({
            "name": row.name, "truth": row.truth, "tolerance": row.tolerance, "values": row.values, "off": row.off(),
            "open": row.open,
        })
    });
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("hard-cases");
    std::fs::create_dir_all(&folder).unwrap();
    let text = serde_json::to_string_pretty(&lines.collect::<Vec<_>>()).unwrap();
    std::fs::write(folder.join(format!("{room}.json")), text).unwrap();

    let mut wrong = Vec::new();
    for row in &found {
        let holds = row.off() <= row.tolerance;
        match row.open {
            None if !holds => {
                wrong.push(format!("{}: {:?} instead of {}, off by {:.2e}", row.name, row.values, row.truth, row.off()))
            }
            Some(why) if holds => wrong.push(format!("{}: holds now, though it is said to be open: {why}", row.name)),
            _ => {}
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    crate::page::lists(room, &found.iter().map(|row| row.name.as_str()).collect::<Vec<_>>());
}
