//! One render: waves of samples over tiles of the picture, on all threads.
//!
//! A wave gives every pixel the same number of samples, so that a render that is stopped is a whole
//! picture, in which some pixels are a wave ahead. A pixel's samples are summed in order on one thread at a time: the bits do not depend on
//! the number of threads.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::error::{Error, Place, Result};
use crate::film::{Film, SampleId, Tile};
use crate::integrator;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::settings::Settings;

/// Longest wave, in samples per pixel: how much a stop may waste, and how often progress is told.
const LONGEST_WAVE: u32 = 16;

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
}

/// Whoever watches a render. Called from render threads.
pub trait Observer: Sync {
    /// Called now and then.
    fn progress(&self, _progress: &Progress) {}

    /// Called after each wave, when every pixel has the same number of samples.
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
    pool.install(|| {
        if scene.effects.first_hit {
            film.tiles_mut().par_iter_mut().for_each(|tile| job.first_hits(tile));
        }
        let mut taken = 0;
        let mut wave = 1;
        while taken < job.target && !job.stopped() {
            let next = taken.saturating_add(wave).min(job.target);
            film.tiles_mut().par_iter_mut().with_max_len(1).for_each(|tile| job.render_tile(tile, taken..next));
            taken = next;
            observer.wave(&film);
            wave = (wave * 2).min(LONGEST_WAVE);
        }
    });
    job.tell();
    Ok(Rendered { film, elapsed: job.start.elapsed(), interrupted: job.cancelled.load(Ordering::Relaxed) })
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
        }
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

    fn render_tile(&self, tile: &mut Tile, samples: std::ops::Range<u32>) {
        for (x, y) in tile.pixels() {
            if x == tile.rect()[0] {
                self.check();
                if self.stopped() {
                    return;
                }
            }
            for index in samples.clone() {
                let sampler = self.sampler.for_sample(x, y, u64::from(index));
                let (sample, weight) = integrator::sample(self.scene, self.settings, &sampler, x, y);
                tile.add(SampleId { x, y, index }, weight, &sample);
            }
            self.samples.fetch_add(u64::from(samples.end - samples.start), Ordering::Relaxed);
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
        let done = by_samples.max(by_time).min(1.0);
        let remaining = (done > 0.0)
            .then(|| Duration::try_from_secs_f64(elapsed.as_secs_f64() * (1.0 - done) / done).ok())
            .flatten();
        let target_spp = (self.target < Settings::NO_LIMIT).then_some(self.target);
        self.observer.progress(&Progress { spp, target_spp, done, elapsed, remaining });
    }
}
