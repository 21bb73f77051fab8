//! `penumbra.render`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyList, PyString, PyTuple};

use super::job::{Watch, run};
use super::picture::Picture;
use super::scene::Scene;
use penumbra::desc::SceneDesc;
use penumbra::error::{Place, Result, Warnings};
use penumbra::film::Quantity;
use penumbra::import::{self, ImportOptions};
use penumbra::job;
use penumbra::job::resume::{self, Saver};
use penumbra::plan::Plan;
use penumbra::render::{Start, render_from};
use penumbra::scene::{Cache, prepare_with};
use penumbra::settings::{SETTINGS, Settings};

/// Where a scene comes from.
enum Source<'py> {
    File(PathBuf),
    Memory(&'py Scene),
}

/// Renders a scene: a path of a USD or glTF file, or a Scene.
///
/// Settings are keyword arguments with the names of the command line (spp, time, passes, …); passes may
/// be a list. `observer(progress)` is called on this thread at least 20 times a second with a dict of
/// done, spp, target_spp, elapsed, remaining, error, error_at_end, error_target and to_target (or None where
/// nothing is new), and stops the render by a true answer: the picture is as it is then, and KeyboardInterrupt is raised
/// where there is none yet; `on_picture(picture)` gets the picture so far every `picture_interval` seconds.
///
/// `state` names a file: the render goes on from what it holds, where it is there, as if it had never stopped, and
/// leaves all that it takes to go on in it; with `checkpoint` that is saved every so many seconds, too. With `plan` the
/// picture's `plan` says which effects were simulated, and why.
#[pyfunction]
#[pyo3(signature = (scene, *, camera=None, size=None, frame=None, subdivision=2, variants=Vec::new(),
    observer=None, on_picture=None, picture_interval=1.0, state=None,
    checkpoint=None, plan=false, **settings))]
pub fn render(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    camera: Option<String>,
    size: Option<[u32; 2]>,
    frame: Option<f64>,
    subdivision: u32,
    variants: Vec<String>,
    observer: Option<Py<PyAny>>,
    on_picture: Option<Py<PyAny>>,
    picture_interval: f64,
    state: Option<PathBuf>,
    checkpoint: Option<f64>,
    plan: bool,
    settings: Option<&Bound<'_, PyDict>>,
) -> PyResult<Picture> {
    let (settings, passes_given) = settings_of(settings)?;
    let source = match scene.cast::<Scene>() {
        Ok(scene) => Source::Memory(scene.get()),
        Err(_) => Source::File(scene.extract::<PathBuf>().map_err(|_| {
            let kind = scene.get_type().name().map_or_else(|_| "this".into(), |name| name.to_string());
            PyTypeError::new_err(format!("a scene is a path or a penumbra.Scene, not {kind}"))
        })?),
    };
    let picture_interval = Duration::try_from_secs_f64(picture_interval)
        .map_err(|_| PyValueError::new_err("picture_interval must be a number of seconds, not negative"))?;
    let is_interval = |seconds: f64| (seconds >= 1.0).then(|| Duration::try_from_secs_f64(seconds).ok()).flatten();
    let every = checkpoint.map(|seconds| {
        let what = "checkpoint must be a number of seconds, 1 or more";
        is_interval(seconds).ok_or_else(|| PyValueError::new_err(what))
    });
    let every = every.transpose()?;
    let watch = Watch { observer, on_picture, picture_interval };
    let vectors = settings.passes.needs(Quantity::Vector);
    let options = ImportOptions { frame, subdivision, variants, vectors, ..ImportOptions::default() };
    let half = settings.half;
    run(py, &watch, |mailbox| {
        let (name, (desc, mut warnings)) = match &source {
            Source::File(path) => (path.display().to_string(), load(path, &options)?),
            Source::Memory(scene) => ("Blender".to_owned(), scene.read(mailbox.stop())?),
        };
        let view = job::view(camera, size, &desc, &mut warnings);
        let settings = if passes_given { settings } else { job::with_own_passes(&settings, &desc, &mut warnings) };
        let identity = state.as_ref().map(|_| job::identity(&desc, &view, &settings)).unwrap_or_default();
        let found = match &state {
            Some(path) => resume::open(path, &identity)?,
            None => None,
        };
        let authored = plan.then(|| desc.clone());
        let prepared = prepare_with(desc, &view, &settings, &mut Cache::default().stopped_by(mailbox.stop()))?;
        let plan = authored.map(|desc| Plan::of(&desc, &prepared, &settings)).unwrap_or_default();
        warnings.extend(prepared.warnings.clone());
        let start = match found {
            Some(file) => resume::read(file, &prepared.scene, &settings)?,
            None => Start::new(&prepared.scene, &settings)?,
        };
        let rendered = match &state {
            None => render_from(start, &prepared.scene, &settings, mailbox)?,
            Some(path) => {
                let saver = Saver::new(mailbox, path.clone(), identity.clone(), every);
                let rendered = render_from(start, &prepared.scene, &settings, &saver)?;
                let failure = saver.failure().or_else(|| resume::save(path, &identity, &rendered).err());
                if let Some(error) = failure {
                    warnings.push(&Place::default(), format!("the state could not be saved: {error}"));
                }
                rendered
            }
        };
        for what in job::shortfalls(&rendered, &settings) {
            warnings.push(&Place::default(), what);
        }
        let metadata = job::metadata(name, frame, &prepared, &rendered, &settings, identity, &warnings);
        Ok(Picture { picture: rendered.film.develop(), metadata, half, plan, interrupted: rendered.interrupted })
    })
}

fn load(path: &Path, options: &ImportOptions) -> Result<(SceneDesc, Warnings)> {
    let mut warnings = Warnings::new();
    Ok((import::scene(path, options, &mut warnings)?, warnings))
}

/// The settings that were given by name, and whether passes were among them.
pub(super) fn settings_of(given: Option<&Bound<'_, PyDict>>) -> PyResult<(Settings, bool)> {
    let mut settings = Settings::default();
    let (mut passes, mut spp) = (false, false);
    for (name, value) in given.into_iter().flatten() {
        let name: String = name.extract()?;
        let Some(def) = SETTINGS.iter().find(|def| def.name == name) else {
            let names: Vec<&str> = SETTINGS.iter().map(|def| def.name).collect();
            return Err(PyTypeError::new_err(format!("no setting \"{name}\"; there are {}", names.join(", "))));
        };
        if value.is_none() {
            continue;
        }
        let text = text_of(&value)?;
        def.set(&mut settings, &text).map_err(|what| PyValueError::new_err(format!("{name}={text}: {what}")))?;
        passes |= name == "passes";
        spp |= name == "spp";
    }
    if !spp {
        settings.without_spp();
    }
    Ok((settings, passes))
}

/// A value as it would be typed.
fn text_of(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(if flag.is_true() { "on" } else { "off" }.to_owned());
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let parts: Vec<String> = value.extract()?;
        return Ok(parts.join(","));
    }
    if value.is_instance_of::<PyString>() { value.extract() } else { Ok(value.str()?.to_string()) }
}
