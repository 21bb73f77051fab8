//! What a scene calls for, in words: which effects are simulated and which not, because of what, and what each adds.
//!
//! [`Effects`](crate::scene::Effects) and the preparation of the scene decide; here the same authored data are asked for
//! reasons, so that whoever reads a plan can tell whether something that was meant to be seen got lost. One file for each
//! subject; a new effect is a line in one of them.

mod inputs;
mod lights;
mod lobes;
mod passes;
mod picture;
mod row;
mod surfaces;

use std::sync::Arc;

use crate::desc::{CameraDesc, MaterialDesc, SceneDesc};
use crate::render::Costs;
use crate::scene::{Effects, Prepared, Scene};
use crate::settings::{EffectsMode, Settings};

pub use row::Row;

/// Everything that a plan goes by.
struct Facts<'a> {
    desc: &'a SceneDesc,
    camera: Option<&'a CameraDesc>,
    scene: &'a Scene,
    settings: &'a Settings,
    /// The materials of what rays may meet or be lit by, each once.
    materials: Vec<&'a MaterialDesc>,
}

/// The effects of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// All of them, by subject.
    pub rows: Vec<Row>,
    /// Seconds that a thread spends on a sample, where that was measured.
    pub sample: Option<f64>,
}

impl Plan {
    /// The plan of `desc` as `prepared` was made of it under `settings`.
    pub fn of(desc: &SceneDesc, prepared: &Prepared, settings: &Settings) -> Self {
        let used = Effects::materials_met(desc);
        let facts = Facts {
            desc,
            camera: desc.cameras.iter().find(|camera| camera.name == prepared.camera),
            scene: &prepared.scene,
            settings,
            materials: desc.materials.iter().zip(used).filter_map(|(m, used)| used.then_some(m)).collect(),
        };
        let subjects = [picture::rows, lights::rows, surfaces::rows, inputs::rows, passes::rows];
        Self { rows: subjects.iter().flat_map(|rows| rows(&facts)).collect(), sample: None }
    }

    /// Adds what samples were found to spend on each effect.
    pub fn measured(&mut self, costs: &Costs) {
        self.sample = Some(costs.sample);
        for row in &mut self.rows {
            let of_row = costs.list.iter().find(|cost| Some(cost.name.as_str()) == row.probe);
            row.cost = of_row.map(|cost| [cost.share, cost.error]);
        }
    }
}

impl Facts<'_> {
    /// True where everything is simulated, called for or not.
    fn forced(&self) -> bool {
        self.settings.effects == EffectsMode::All
    }

    /// A row for what a flag of the render says, with the reasons that were found for it.
    fn flagged(
        &self,
        subject: &'static str,
        effect: &'static str,
        on: bool,
        reasons: String,
        otherwise: impl Into<String>,
    ) -> Row {
        Row::new(subject, effect, if on { reasons } else { String::new() }, otherwise).is(on, self.forced())
    }

    /// Names of the materials that `test` holds for.
    fn materials(&self, test: impl Fn(&MaterialDesc) -> bool) -> Vec<Arc<str>> {
        self.materials.iter().filter(|m| test(m)).map(|m| m.name.clone()).collect()
    }
}
