//! Going on with a picture that another run has begun: what must agree, what is saved when, what is done already.

use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use crate::desc::SceneDesc;
use crate::error::{Error, Place, Result};
use crate::film::Film;
use crate::output::state::{self, Head, StateFile};
use crate::output::{Metadata, exr};
use crate::render::{Ended, Observer, Progress, Rendered, Start, State};
use crate::scene::{Scene, View};
use crate::settings::{SETTINGS, Settings};

/// Settings that change no sample: when to stop, how fast, how to write.
const FREE: [&str; 6] = ["spp", "error", "time", "threads", "half", "effects"];

/// What a picture of `desc` is made of, as far as it changes a sample: two renders of which this is the same give the
/// same bits wherever they have as many samples.
pub fn identity(desc: &SceneDesc, view: &View, settings: &Settings) -> Head {
    let size = view.size.map_or_else(|| "by itself".to_owned(), |[width, height]| format!("{width}x{height}"));
    let sequences = if has_error(settings) { "eight, for the error" } else { "one" };
    let own = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("scene", format!("{:016x}", desc.digest())),
        ("camera", view.camera.clone().unwrap_or_else(|| "by itself".to_owned())),
        ("size", size),
        ("sequences of samples", sequences.to_owned()),
    ];
    let own = own.map(|(name, value)| (name.to_owned(), value));
    let of_settings = SETTINGS.iter().filter(|def| !FREE.contains(&def.name));
    own.into_iter().chain(of_settings.map(|def| (def.name.to_owned(), def.get(settings)))).collect()
}

fn has_error(settings: &Settings) -> bool {
    settings.needs_error() || settings.passes.has_error()
}

/// In what `theirs` is not `ours`, as phrases; `None` where it is the same.
fn difference(theirs: &Head, ours: &Head) -> Option<String> {
    let of = |head: &Head, name: &str| head.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone());
    let names = ours.iter().chain(theirs.iter().filter(|(name, _)| of(ours, name).is_none())).map(|(name, _)| name);
    let differs = |name: &String| {
        let (was, is) = (of(theirs, name), of(ours, name));
        let quoted = |value: Option<String>| match value {
            Some(value) if !value.is_empty() => value,
            _ => "not set".to_owned(),
        };
        (was != is).then(|| match name.as_str() {
            "scene" => "the scene is another one, or has changed since".to_owned(),
            "version" => format!("Penumbra was {}, this is {}", quoted(was), quoted(is)),
            _ => format!("{} was {} and is {}", name.replace('_', "-"), quoted(was), quoted(is)),
        })
    };
    let all: Vec<String> = names.filter_map(differs).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// What there is to go on from.
pub enum Found {
    /// The picture is there, and is all that is asked for; a phrase that says so.
    Done(String),
    /// Its state.
    State(Box<StateFile>),
    /// No state; a phrase that says why.
    Nothing(String),
}

/// Looks for what the picture `out` can go on from. `others` are further files that the same render writes.
///
/// # Errors
/// A picture or state that is not of this scene, version and settings, or can't be read: it is left as it is.
pub fn find(out: &Path, others: &[&Path], identity: &Head, settings: &Settings) -> Result<Found> {
    let done = |path: &Path| {
        let attributes = exr::attributes(path).ok()?;
        (of(&attributes, identity) == Some(None)).then(|| finished(&attributes, settings)).flatten()
    };
    let is_exr = |path: &Path| path.extension().is_some_and(|end| end.eq_ignore_ascii_case("exr"));
    if let Some(what) = done(out)
        && others.iter().all(|path| if is_exr(path) { done(path).is_some() } else { path.exists() })
    {
        return Ok(Found::Done(what));
    }
    if let Some(file) = open(&state::path_of(out), identity)? {
        return Ok(Found::State(Box::new(file)));
    }
    if !out.exists() {
        return Ok(Found::Nothing("there is no picture to go on with".to_owned()));
    }
    match of(&exr::attributes(out)?, identity) {
        Some(None) => Ok(Found::Nothing("the picture has no state beside it".to_owned())),
        Some(Some(what)) => Err(refusal(out, &what)),
        None => Err(refusal(out, "it does not say what it was made of")),
    }
}

/// In what a picture with these attributes is [another](difference) than one of `identity`; `None` where it does not
/// say.
fn of(attributes: &BTreeMap<String, String>, identity: &Head) -> Option<Option<String>> {
    let known: Head = serde_json::from_str(attributes.get(Metadata::IDENTITY)?).ok()?;
    Some(difference(&known, identity))
}

/// Opens the state `path`; `None` where there is none.
///
/// # Errors
/// One that is not of this scene, version and settings, or is damaged: it is left as it is.
pub fn open(path: &Path, identity: &Head) -> Result<Option<StateFile>> {
    if !path.exists() {
        return Ok(None);
    }
    let file = state::open(path)?;
    match difference(&file.head, identity) {
        None => Ok(Some(file)),
        Some(what) => Err(refusal(path, &what)),
    }
}

fn refusal(path: &Path, what: &str) -> Error {
    let advice = "nothing was written; render without --resume to begin anew";
    Error::invalid(&Place::file(path), format!("can't go on from this: {what}. {advice}"))
}

/// The stop rule of `settings` that a picture with these attributes meets.
fn finished(attributes: &BTreeMap<String, String>, settings: &Settings) -> Option<String> {
    let number = |name: &str| attributes.get(name)?.split(' ').next()?.parse::<f64>().ok();
    let setting = |name: &str| number(&format!("penumbra/settings/{name}"));
    let ended_by = attributes.get(Metadata::ENDED_BY)?;
    // One that is to be written otherwise is not as it should be.
    if attributes.get("penumbra/settings/half").map(String::as_str) != Some(if settings.half { "on" } else { "off" }) {
        return None;
    }
    let spp = number("penumbra/samples")?;
    let (by_samples, by_error, by_time) = (name(Ended::Samples), name(Ended::Error), name(Ended::Time));
    let enough = spp >= f64::from(settings.spp)
        || (ended_by == by_samples && setting("spp").is_some_and(|was| was >= f64::from(settings.spp)));
    let clean =
        settings.error.is_some_and(|target| ended_by == by_error && setting("error").is_some_and(|was| was <= target));
    let long = settings.time.is_some_and(|time| {
        number("penumbra/seconds").is_some_and(|was| was >= time)
            || (ended_by == by_time && setting("time").is_some_and(|was| was >= time))
    });
    (enough || clean || long).then(|| format!("it has {spp:.0} spp and is done, by its {ended_by}"))
}

/// What ended a render, for the file.
pub fn name(ended: Ended) -> &'static str {
    match ended {
        Ended::Samples => "samples",
        Ended::Error => "error",
        Ended::Time => "time",
        Ended::Cancelled => "interruption",
    }
}

/// Reads the state `file` for `scene`.
///
/// # Errors
/// A state that is cut off or damaged, a picture too large for memory.
pub fn read(mut file: StateFile, scene: &Scene, settings: &Settings) -> Result<Start> {
    let start = Start::read(scene, settings, &mut file)?.map_err(|error| file.damaged(error))?;
    file.finish()?;
    Ok(start)
}

/// Saves what `rendered` takes to go on, at `path`.
///
/// # Errors
/// [`Error::Io`] that names the file where it can't be written.
pub fn save(path: &Path, identity: &Head, rendered: &Rendered) -> Result<()> {
    state::write(path, identity, |out| rendered.state().write(out))
}

/// Watches a render as another observer does, and saves its state now and then.
pub struct Saver<'a> {
    inner: &'a dyn Observer,
    path: PathBuf,
    identity: Head,
    every: Option<Duration>,
    /// When it was saved last, and the first error of it.
    last: Mutex<(Instant, Option<Error>)>,
}

impl<'a> Saver<'a> {
    /// Saves to `path` every so often; never where that is `None`.
    pub fn new(inner: &'a dyn Observer, path: PathBuf, identity: Head, every: Option<Duration>) -> Self {
        Self { inner, path, identity, every, last: Mutex::new((Instant::now(), None)) }
    }

    fn last(&self) -> MutexGuard<'_, (Instant, Option<Error>)> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Why it could not be saved, where it once could not.
    pub fn failure(self) -> Option<Error> {
        self.last.into_inner().unwrap_or_else(PoisonError::into_inner).1
    }
}

impl Observer for Saver<'_> {
    fn progress(&self, progress: &Progress) {
        self.inner.progress(progress);
    }

    fn wave(&self, film: &Film) {
        self.inner.wave(film);
    }

    fn cancelled(&self) -> bool {
        self.inner.cancelled()
    }

    fn wants_state(&self) -> bool {
        self.every.is_some_and(|every| self.last().0.elapsed() >= every)
    }

    fn save(&self, state: &State<'_>) {
        let written = state::write(&self.path, &self.identity, |out| state.write(out));
        let mut last = self.last();
        // From the end: a disk that is slower than the interval does not stop the render.
        last.0 = Instant::now();
        if let (Err(error), None) = (written, &last.1) {
            last.1 = Some(error);
        }
    }
}

/// Removes the state of a picture that another one has replaced.
///
/// # Errors
/// Those of the system; none where there is no such file.
pub fn discard(path: &Path) -> io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}
