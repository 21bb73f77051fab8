//! The work of one render, and what its threads share.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::start::{Course, State};
use super::{FIRST_CHECK, LONGEST_WAVE, Observer, Outlook, Progress};
use super::{forecast, plan::Plan};
use crate::film::{Film, SampleId, Tile};
use crate::integrator;
use crate::sampling::Sampler;
use crate::scene::Scene;
use crate::settings::Settings;

/// What all tiles of a render share.
pub(super) struct Job<'a> {
    scene: &'a Scene,
    settings: &'a Settings,
    observer: &'a dyn Observer,
    sampler: Sampler,
    start: Instant,
    /// Time that it had taken before.
    before: Duration,
    deadline: Option<Instant>,
    target: u32,
    pixels: u64,
    /// Samples that there were at the start, and now.
    first: u64,
    samples: AtomicU64,
    pub(super) cancelled: AtomicBool,
    pub(super) out_of_time: AtomicBool,
    /// The state is to be saved.
    paused: AtomicBool,
    /// Nanoseconds spent on looking at errors.
    looked: AtomicU64,
    /// Milliseconds from the start when progress was last told.
    told: AtomicU64,
    /// What is known of the error.
    outlook: Mutex<Option<Outlook>>,
}

/// Samples that pixels are to have.
enum Goals<'a> {
    Alike(u32),
    Planned(&'a Plan),
}

impl<'a> Goals<'a> {
    /// Of the plan, where there is one, as it was [aimed](Plan::aim); else `end`.
    fn of(course: &'a Course, end: u32) -> Self {
        course.plan.as_ref().map_or(Self::Alike(end), Self::Planned)
    }

    /// That of a pixel, by its tile and its place in it.
    fn at(&self, tile: usize, pixel: usize) -> u32 {
        match self {
            Self::Alike(goal) => *goal,
            Self::Planned(plan) => plan.goal(tile, pixel),
        }
    }

    /// True where some pixel lacks samples.
    fn are_open(&self, film: &Film) -> bool {
        self.any(film, |given, goal| given < goal)
    }

    /// True where some pixel has more.
    fn are_passed(&self, film: &Film) -> bool {
        self.any(film, |given, goal| given > goal)
    }

    fn any(&self, film: &Film, test: impl Fn(u32, u32) -> bool + Sync) -> bool {
        let of_tile =
            |(i, tile): (usize, &Tile)| (0..tile.pixels().count()).any(|p| test(tile.given(p), self.at(i, p)));
        film.tiles().par_iter().enumerate().any(of_tile)
    }
}

impl<'a> Job<'a> {
    /// A render that goes on from `film`, to which it came in the time `before`.
    pub(super) fn new(
        scene: &'a Scene,
        settings: &'a Settings,
        observer: &'a dyn Observer,
        film: &Film,
        before: Duration,
    ) -> Self {
        let start = Instant::now();
        let (_, _, first) = film.given();
        let left = |t: f64| Duration::try_from_secs_f64(t).ok().map(|t| t.saturating_sub(before));
        Self {
            scene,
            settings,
            observer,
            sampler: Sampler::new(settings.sampler, settings.seed),
            start,
            before,
            deadline: settings.time.and_then(left).map(|left| start + left),
            target: settings.spp,
            pixels: u64::from(scene.size[0]) * u64::from(scene.size[1]),
            first,
            samples: AtomicU64::new(first),
            cancelled: AtomicBool::new(false),
            out_of_time: AtomicBool::new(false),
            paused: AtomicBool::new(false),
            looked: AtomicU64::new(0),
            told: AtomicU64::new(0),
            outlook: Mutex::new(None),
        }
    }

    /// Renders until a stop rule holds.
    pub(super) fn render(&self, film: &mut Film, course: &mut Course) {
        if self.scene.effects.first_hit {
            film.tiles_mut().par_iter_mut().for_each(|tile| self.first_hits(tile));
        }
        match self.scene.passes.has_error() {
            true => self.render_in_stages(film, course),
            false => self.render_to(film, course, self.target),
        }
    }

    /// Time of rendering so far.
    pub(super) fn elapsed(&self) -> Duration {
        self.before + self.start.elapsed()
    }

    /// Time that went into looking at errors.
    pub(super) fn looked(&self) -> Duration {
        Duration::from_nanos(self.looked.load(Ordering::Relaxed))
    }

    /// True where no sample was taken.
    pub(super) fn was_done(&self) -> bool {
        self.samples.load(Ordering::Relaxed) == self.first
    }

    /// Gives every pixel `end` samples, or as many as the plan has for `end` in the mean. What is there is gone on from.
    fn render_to(&self, film: &mut Film, course: &mut Course, end: u32) {
        if let Some(plan) = &mut course.plan {
            plan.aim(end);
        }
        let mut least = film.given().0;
        while Goals::of(course, end).are_open(film) && !self.stopped() {
            let wave = match course.plan {
                Some(_) => LONGEST_WAVE,
                // Powers of two, as point sets like them.
                None => least.clamp(1, LONGEST_WAVE),
            };
            self.render_wave(film, &Goals::of(course, end), least.saturating_add(wave), wave);
            if self.paused.swap(false, Ordering::Relaxed) && !self.stopped() {
                course.elapsed = self.elapsed();
                self.observer.save(&State { film, course });
                continue;
            }
            least = film.given().0;
            self.observer.wave(film);
        }
    }

    /// Looks at the error on the way, ends where it is small enough, and where settings say so gives noisy pixels more
    /// samples.
    ///
    /// What is rendered next follows from the steps that every render takes, never from where another one ended: one
    /// that goes on to a tighter target takes the way of one that had it from the start.
    fn render_in_stages(&self, film: &mut Film, course: &mut Course) {
        if self.first > 0 {
            course.forecast.mark(self.first as f64 / self.pixels as f64, self.before.as_secs_f64());
            self.tell_outlook(course);
        }
        let mut after = course.step;
        while !self.stopped() && !course.forecast.is_reached() && after < self.target {
            // Half way to the first look there is a mark, for the pace.
            let next = if after == 0 { FIRST_CHECK / 2 } else { course.forecast.next_check(course.step, after) };
            after = next.min(self.target);
            self.render_to(film, course, after);
            if self.stopped() {
                return;
            }
            let is_step = after == forecast::step_after(course.step);
            // What is beyond was looked at by the render that went there.
            if !Goals::of(course, after).are_passed(film) {
                self.look(film, course, after, is_step);
            }
            if is_step {
                course.step = after;
            }
            self.tell_outlook(course);
        }
    }

    /// Looks at the error of `film` as it is after `end` samples per pixel.
    fn look(&self, film: &Film, course: &mut Course, end: u32, is_step: bool) {
        let spp = self.samples.load(Ordering::Relaxed) as f64 / self.pixels as f64;
        course.forecast.mark(spp, self.elapsed().as_secs_f64());
        if end < FIRST_CHECK {
            return;
        }
        let start = Instant::now();
        let errors = film.errors();
        if let Some(errors) = &errors {
            course.forecast.note(errors.display(), spp, is_step);
        }
        if let (true, Some(plan)) = (is_step, &mut course.plan) {
            plan.learn(film, errors.as_ref());
        }
        self.looked.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    fn tell_outlook(&self, course: &Course) {
        *self.outlook() = Some(course.forecast.outlook(self.target_spp().map(f64::from), self.settings.time));
    }

    fn outlook(&self) -> MutexGuard<'_, Option<Outlook>> {
        self.outlook.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Samples per pixel at which the render ends, where they end it.
    fn target_spp(&self) -> Option<u32> {
        (self.target < Settings::NO_LIMIT).then_some(self.target)
    }

    /// Gives each pixel what it lacks of its goal, up to `most` samples and `longest` more than it has.
    fn render_wave(&self, film: &mut Film, goals: &Goals<'_>, most: u32, longest: u32) {
        let tiles = film.tiles_mut().par_iter_mut().with_max_len(1).enumerate();
        let planned = matches!(goals, Goals::Planned(_));
        tiles.for_each(|(i, tile)| {
            self.render_tile(tile, |pixel, given| {
                goals.at(i, pixel).min(if planned { given.saturating_add(longest) } else { most })
            });
        });
    }

    fn stopped(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed) || self.out_of_time.load(Ordering::Relaxed)
    }

    /// Asks the clock and the observer.
    fn check(&self) {
        if self.observer.cancelled() {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        if self.observer.wants_state() {
            self.paused.store(true, Ordering::Relaxed);
        }
        // The first sample of every pixel is worth more than the deadline.
        let whole = self.samples.load(Ordering::Relaxed) >= self.pixels;
        if whole && self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.out_of_time.store(true, Ordering::Relaxed);
        }
    }

    fn first_hits(&self, tile: &mut Tile) {
        for (x, y) in tile.pixels() {
            // A picture that goes on has samples already, and is whole but for this.
            if self.first == 0 && x == tile.rect()[0] {
                self.check();
            }
            if self.first == 0 && self.stopped() {
                return;
            }
            tile.set_first_hit(x, y, integrator::first_hit(self.scene, x, y));
        }
    }

    /// `goal` gives the samples that a pixel is to have, by its place in the tile and those that it has.
    fn render_tile(&self, tile: &mut Tile, goal: impl Fn(usize, u32) -> u32) {
        for (pixel, (x, y)) in tile.pixels().enumerate() {
            if x == tile.rect()[0] {
                self.check();
                if self.stopped() || self.paused.load(Ordering::Relaxed) {
                    return;
                }
            }
            let given = tile.given(pixel);
            let goal = goal(pixel, given).max(given);
            for index in given..goal {
                let sampler = self.sampler.for_sample(x, y, self.scene.passes.sequence_place(index));
                let (sample, weight) = integrator::sample(self.scene, self.settings, &sampler, x, y);
                tile.add(SampleId { x, y, index }, weight, &sample);
            }
            self.samples.fetch_add(u64::from(goal - given), Ordering::Relaxed);
        }
        let now = self.start.elapsed().as_millis() as u64;
        let told = self.told.load(Ordering::Relaxed);
        let due = now >= told + 100;
        if due && self.told.compare_exchange(told, now, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
            self.tell();
        }
    }

    /// Tells the observer how far the render is.
    pub(super) fn tell(&self) {
        let elapsed = self.elapsed();
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
