//! One render: waves of samples over tiles of the picture, on all threads.
//!
//! A wave gives every pixel the same number of samples, or as many as a plan has for it, so that a render that is
//! stopped is a whole picture, in which some pixels are a wave ahead. A pixel's samples are summed in order on one
//! thread at a time: the bits do not depend on the number of threads. Where errors are asked for, waves make up stages,
//! and at the end of each the error is looked at.

mod forecast;
mod plan;

pub use forecast::Outlook;

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::error::{Error, Place, Result};
use crate::film::{Accuracy, Film, LEAST_PER_REPLICATE, REPLICATES, SampleId, Tile};
use crate::integrator;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::settings::Settings;
use forecast::Forecast;
use plan::Plan;

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
    /// Since the first ray.
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
}

/// Watches nothing.
impl Observer for () {}

/// What a render gave.
#[derive(Debug)]
pub struct Rendered {
    /// The picture so far.
    pub film: Film,
    /// Time from the first ray to the last.
    pub elapsed: Duration,
    /// True where the observer stopped it.
    pub interrupted: bool,
    /// The picture's errors, where they are asked for.
    pub accuracy: Option<Accuracy>,
}

/// Renders `scene` until one of the stop rules of `settings` holds, or the observer cancels.
///
/// # Errors
/// Threads that can't be started.
pub fn render(scene: &Scene, settings: &Settings, observer: &dyn Observer) -> Result<Rendered> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build().map_err(|error| {
        Error::Unsupported {
            place: Place::default(),
            what: format!("can't start {} render threads: {error}", settings.threads),
        }
    })?;
    let [width, height] = scene.size;
    // Asked for beforehand, since what runs out in the middle aborts the process.
    let bytes = Film::bytes_needed(width, height, &scene.passes);
    let there = usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if !there {
        return Err(Error::Unsupported {
            place: Place::default(),
            what: format!("a picture of {width}x{height} pixels needs {} MiB, which are not there", bytes >> 20),
        });
    }
    let mut film = Film::new(width, height, scene.passes.clone());
    let job = Job::new(scene, settings, observer);
    let accuracy = pool.install(|| {
        if scene.effects.first_hit {
            film.tiles_mut().par_iter_mut().for_each(|tile| job.first_hits(tile));
        }
        match scene.passes.has_error() {
            true => job.render_in_stages(&mut film),
            false => job.render_alike(&mut film, 0, job.target),
        }
        film.accuracy()
    });
    job.tell();
    let interrupted = job.cancelled.load(Ordering::Relaxed);
    Ok(Rendered { film, elapsed: job.start.elapsed(), interrupted, accuracy })
}

/// What all tiles of a render share.
struct Job<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    observer: &'a dyn Observer,
    sampler: Sampler,
    start: Instant,
    deadline: Option<Instant>,
    target: u32,
    pixels: u64,
    samples: AtomicU64,
    cancelled: AtomicBool,
    out_of_time: AtomicBool,
    /// Milliseconds from the start when progress was last told.
    told: AtomicU64,
    /// What is known of the error.
    outlook: Mutex<Option<Outlook>>,
}

impl<'a> Job<'a> {
    fn new(scene: &'a Scene, settings: &'a Settings, observer: &'a dyn Observer) -> Self {
        let start = Instant::now();
        Self {
            scene,
            settings,
            observer,
            sampler: Sampler::new(settings.sampler, settings.seed),
            start,
            deadline: settings.time.and_then(|t| Duration::try_from_secs_f64(t).ok()).map(|t| start + t),
            target: settings.spp,
            pixels: u64::from(scene.size[0]) * u64::from(scene.size[1]),
            samples: AtomicU64::new(0),
            cancelled: AtomicBool::new(false),
            out_of_time: AtomicBool::new(false),
            told: AtomicU64::new(0),
            outlook: Mutex::new(None),
        }
    }

    /// Samples per pixel from `taken` to `end`, in every pixel as many.
    fn render_alike(&self, film: &mut Film, taken: u32, end: u32) {
        let mut taken = taken;
        while taken < end && !self.stopped() {
            // Powers of two, as point sets like them.
            let next = taken.saturating_add(taken.clamp(1, LONGEST_WAVE)).min(end);
            self.render_wave(film, |_, _| taken..next);
            taken = next;
            self.observer.wave(film);
        }
    }

    /// The same up to the goals of `plan`, which may differ.
    fn render_planned(&self, film: &mut Film, plan: &mut Plan) {
        let mut reached = false;
        while !reached && !self.stopped() {
            self.render_wave(film, |tile, pixel| plan.samples(tile, pixel, LONGEST_WAVE));
            reached = plan.advance(LONGEST_WAVE);
            self.observer.wave(film);
        }
    }

    /// Looks at the error between stages, ends where it is small enough, and where settings say so gives noisy pixels
    /// more samples.
    fn render_in_stages(&self, film: &mut Film) {
        let mut forecast = Forecast::new(self.settings.error, self.settings.adaptive);
        let mut plan = self.settings.adaptive.then(|| Plan::new(film));
        let mut errors = None;
        let (mut taken, mut spp) = (0, 0.0);
        while spp < f64::from(self.target) && !self.stopped() && !forecast.is_reached() {
            let end = forecast.next_check(spp).min(self.target);
            if let Some(plan) = &mut plan {
                plan.aim(film, errors.as_ref(), end);
                if plan.spp() == spp {
                    // What is left of the samples is less than a round for one pixel.
                    break;
                }
                self.render_planned(film, plan);
                spp = plan.spp();
            } else {
                self.render_alike(film, taken, end);
                (taken, spp) = (end, f64::from(end));
            }
            if self.stopped() {
                break;
            }
            forecast.mark(spp, self.start.elapsed().as_secs_f64());
            if spp < f64::from(FIRST_CHECK) {
                continue;
            }
            errors = film.errors();
            if let Some(errors) = &errors {
                forecast.note(&errors.accuracy(), spp);
            }
            *self.outlook() = Some(forecast.outlook(self.target_spp().map(f64::from), self.settings.time));
        }
    }

    fn outlook(&self) -> MutexGuard<'_, Option<Outlook>> {
        self.outlook.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Samples per pixel at which the render ends, where they end it.
    fn target_spp(&self) -> Option<u32> {
        (self.target < Settings::NO_LIMIT).then_some(self.target)
    }

    /// `samples` gives those of a pixel by its tile and its place in it.
    fn render_wave(&self, film: &mut Film, samples: impl Fn(usize, usize) -> Range<u32> + Sync) {
        let tiles = film.tiles_mut().par_iter_mut().with_max_len(1).enumerate();
        tiles.for_each(|(i, tile)| self.render_tile(tile, |pixel| samples(i, pixel)));
    }

    fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.out_of_time.load(Ordering::Relaxed)
    }

    /// Asks the clock and the observer.
    fn check(&self) {
        if self.observer.cancelled() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        // The first sample of every pixel is worth more than the deadline.
        let whole = self.samples.load(Ordering::Relaxed) >= self.pixels;
        if whole && self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.out_of_time.store(true, Ordering::Relaxed);
        }
    }

    fn first_hits(&self, tile: &mut Tile) {
        self.check();
        for (x, y) in tile.pixels().filter(|_| !self.stopped()) {
            tile.set_first_hit(x, y, integrator::first_hit(self.scene, x, y));
        }
    }

    fn render_tile(&self, tile: &mut Tile, samples: impl Fn(usize) -> Range<u32>) {
        for (pixel, (x, y)) in tile.pixels().enumerate() {
            if x == tile.rect()[0] {
                self.check();
                if self.stopped() {
                    return;
                }
            }
            let samples = samples(pixel);
            let count = u64::from(samples.end - samples.start);
            for index in samples {
                let sampler = self.sampler.for_sample(x, y, self.scene.passes.sequence_place(index));
                let (sample, weight) = integrator::sample(self.scene, self.settings, &sampler, x, y);
                tile.add(SampleId { x, y, index }, weight, &sample);
            }
            self.samples.fetch_add(count, Ordering::Relaxed);
        }
        let now = self.start.elapsed().as_millis() as u64;
        let told = self.told.load(Ordering::Relaxed);
        let due = now >= told + 100;
        if due && self.told.compare_exchange(told, now, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
            self.tell();
        }
    }

    fn tell(&self) {
        let elapsed = self.start.elapsed();
        let spp = self.samples.load(Ordering::Relaxed) as f64 / self.pixels as f64;
        let by_samples = spp / f64::from(self.target);
        let by_time = self.settings.time.map_or(0.0, |t| elapsed.as_secs_f64() / t.max(1e-9));
        let outlook = *self.outlook();
        let by_error = outlook.and_then(|outlook| outlook.target_at).map_or(0.0, |[at, ..]| elapsed.as_secs_f64() / at);
        let done = by_samples.max(by_time).max(by_error).min(1.0);
        let remaining = (done > 0.0)
            .then(|| Duration::try_from_secs_f64(elapsed.as_secs_f64() * (1.0 - done) / done).ok())
            .flatten();
        self.observer.progress(&Progress { spp, target_spp: self.target_spp(), done, elapsed, remaining, outlook });
    }
}
