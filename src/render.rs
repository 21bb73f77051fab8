//! One render: waves of samples over tiles of the picture, on all threads.
//!
//! A wave gives every pixel the same number of samples, or as many as a plan has for it, so that a render that is
//! stopped is a whole picture, in which some pixels are a wave ahead. A pixel's samples are summed in order on one
//! thread at a time: the bits do not depend on the number of threads. Where errors are asked for, waves make up stages,
//! and at the end of each the error is looked at.

mod costs;
mod forecast;
mod job;
mod plan;
mod start;

pub use costs::{Cost, Costs};
pub use forecast::Outlook;
pub use start::{Start, State};

use std::sync::atomic::Ordering;
use std::time::Duration;

use crate::error::{Error, Place, Result};
use crate::film::{Accuracy, Film, LEAST_PER_REPLICATE, REPLICATES};
use crate::scene::Scene;
use crate::settings::Settings;
use job::Job;
use start::Course;

/// Longest wave, in samples per pixel: how much a stop may waste, and how often progress is told.
const LONGEST_WAVE: u32 = 16;

/// Samples per pixel at which an error is known first.
const FIRST_CHECK: u32 = REPLICATES as u32 * LEAST_PER_REPLICATE;

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples per pixel taken so far, the picture's mean.
    pub spp: f64,
    /// Samples per pixel at which it ends; `None` where only time ends it.
    pub target_spp: Option<u32>,
    /// Share of the work that is done, 0 to 1.
    pub done: f64,
    /// Time of rendering so far, that before it was stopped and went on included.
    pub elapsed: Duration,
    /// Estimated time to the end; `None` while nothing is known.
    pub remaining: Option<Duration>,
    /// What is known of the error, where it is asked for.
    pub outlook: Option<Outlook>,
}

impl Progress {
    /// Seconds from now to the target of the error: the likely ones, and the 10 to 90 % band.
    pub fn to_target(&self) -> Option<[f64; 3]> {
        let at = self.outlook?.target_at?;
        Some(at.map(|at| (at - self.elapsed.as_secs_f64()).max(0.0)))
    }
}

/// Whoever watches a render. Called from render threads.
pub trait Observer: Sync {
    /// Called now and then.
    fn progress(&self, _progress: &Progress) {}

    /// Called after each wave, when every pixel has its samples of it.
    fn wave(&self, _film: &Film) {}

    /// True stops the render soon; what was computed is kept.
    fn cancelled(&self) -> bool {
        false
    }

    /// True makes the render pause soon to have its state [saved](Observer::save).
    fn wants_state(&self) -> bool {
        false
    }

    /// Called where [`Observer::wants_state`] asked for it, while no other thread renders.
    fn save(&self, _state: &State<'_>) {}
}

/// Watches nothing.
impl Observer for () {}

/// What ended a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// Its number of samples.
    Samples,
    /// Its error, which is small enough.
    Error,
    /// Its time.
    Time,
    /// The observer.
    Cancelled,
}

/// What a render gave.
#[derive(Debug)]
pub struct Rendered {
    /// The picture so far.
    pub film: Film,
    /// Time from the first ray to the last, that before it was stopped and went on included.
    pub elapsed: Duration,
    /// Time of it, since the last start, that went into looking at errors.
    pub looked: Duration,
    /// What ended it.
    pub ended: Ended,
    /// True where the observer stopped it.
    pub interrupted: bool,
    /// True where there was nothing left to do.
    pub was_done: bool,
    /// The picture's errors, where they are asked for.
    pub accuracy: Option<Accuracy>,
    course: Course,
}

impl Rendered {
    /// What it takes to go on.
    pub fn state(&self) -> State<'_> {
        State { film: &self.film, course: &self.course }
    }
}

/// Renders `scene` until one of the stop rules of `settings` holds, or the observer cancels.
///
/// # Errors
/// Threads that can't be started, memory that is not there.
pub fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Result<Rendered> {
    render_from(Start::new(scene, settings)?, scene, settings, observer)
}

/// The same from what another render of `scene` has left: the bits are those of one that was never stopped.
///
/// # Errors
/// Threads that can't be started.
pub fn render_from(start: Start, scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Result<Rendered> {
    let pool = threads(settings)?;
    let Start { mut film, mut course } = start;
    let job = Job::new(scene, settings, observer, &film, course.elapsed);
    let accuracy = pool.install(|| {
        job.render(&mut film, &mut course);
        film.accuracy()
    });
    job.tell();
    course.elapsed = job.elapsed();
    let interrupted = job.cancelled.load(Ordering::Relaxed);
    let ended = match () {
        () if interrupted => Ended::Cancelled,
        () if job.out_of_time.load(Ordering::Relaxed) => Ended::Time,
        () if course.forecast.is_reached() => Ended::Error,
        () => Ended::Samples,
    };
    let (elapsed, looked, was_done) = (course.elapsed, job.looked(), job.was_done());
    Ok(Rendered { film, elapsed, looked, ended, interrupted, was_done, accuracy, course })
}

/// Measures what the samples of `scene` spend their time on, in some seconds; the scene is as before afterwards.
///
/// # Errors
/// Threads that can't be started.
pub fn costs(scene: &mut Scene, settings: &Settings) -> Result<Costs> {
    Ok(threads(settings)?.install(|| costs::costs(scene, settings)))
}

fn threads(settings: &Settings) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build().map_err(|error| Error::Unsupported {
        place: Place::default(),
        what: format!("can't start {} render threads: {error}", settings.threads),
    })
}
