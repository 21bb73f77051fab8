//! The USD door, through `import::scene`. Where a number is said to be OpenUSD's, `usd-core` 26.11 gave it
//! for the same file of `stages/`.

mod bad;
mod bindings;
mod clips;
mod composition;
mod corpus;
mod draw_modes;
mod instance_colors;
mod instance_primvars;
mod instances;
mod large;
mod layers;
mod mutation;
mod opacity;
mod open_pbr;
mod pictures;
mod primvars;
mod reliefs;
#[path = "../support/rng.rs"]
mod rng;
#[path = "../support/scene.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod scene;
mod shape_lights;
mod shown;
mod skel;
mod times;

use std::path::{Path, PathBuf};

use penumbra::desc::{InstanceDesc, SceneDesc};
use penumbra::error::{Result, Warnings};
use penumbra::import::{self, ImportOptions};
use penumbra::math::DVec3;

/// A file of `stages/`.
fn stage(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/usd/stages").join(name)
}

/// What became of a stage, and what was said.
struct Loaded {
    scene: SceneDesc,
    said: Vec<String>,
}

fn try_load(path: &Path, options: &ImportOptions) -> Result<Loaded> {
    let mut warnings = Warnings::new();
    let scene = import::scene(path, options, &mut warnings)?;
    penumbra::desc::check(&scene).expect("the door keeps the rules of SceneDesc");
    Ok(Loaded { scene, said: warnings.iter().map(ToString::to_string).collect() })
}

fn load(name: &str, options: &ImportOptions) -> Loaded {
    try_load(&stage(name), options).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A stage of one layer that is this text.
fn load_text(text: &str) -> Loaded {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("stage.usda");
    std::fs::write(&path, text).unwrap();
    try_load(&path, &ImportOptions::default()).unwrap()
}

fn at_frame(frame: f64) -> ImportOptions {
    ImportOptions { frame: Some(frame), ..ImportOptions::default() }
}

impl Loaded {
    /// The instances at a path of the stage.
    fn all(&self, path: &str) -> Vec<&InstanceDesc> {
        self.scene.instances.iter().filter(|i| i.place.node.as_deref() == Some(path)).collect()
    }

    /// The only instance at a path of the stage.
    fn one(&self, path: &str) -> &InstanceDesc {
        let all = self.all(path);
        assert_eq!(all.len(), 1, "instances at {path}; there are {:?}", self.paths());
        all[0]
    }

    /// Where the only instance at a path stands.
    fn origin(&self, path: &str) -> [f64; 3] {
        let origin = self.one(path).transform.translation;
        // Nothing here is finer than a thousandth.
        (origin * 1e6).round().to_array().map(|x| x / 1e6)
    }

    fn paths(&self) -> Vec<&str> {
        self.scene.instances.iter().filter_map(|i| i.place.node.as_deref()).collect()
    }

    /// Name of the material of an instance's first slot.
    fn material(&self, path: &str) -> &str {
        let index = self.one(path).materials[0].expect("a material");
        let name = &self.scene.materials[index as usize].name;
        name.rsplit('/').next().unwrap_or(name)
    }

    /// The only thing that was said of `what`.
    fn said_of(&self, what: &str) -> &str {
        let of: Vec<&String> = self.said.iter().filter(|said| said.contains(what)).collect();
        assert_eq!(of.len(), 1, "warnings with '{what}' in {:#?}", self.said);
        of[0]
    }

    #[track_caller]
    fn said_nothing(&self) {
        assert!(self.said.is_empty(), "{:#?}", self.said);
    }
}

#[track_caller]
fn near(a: DVec3, b: [f64; 3]) {
    assert!((a - DVec3::from(b)).length() <= 1e-6, "{a} is not {b:?}");
}
