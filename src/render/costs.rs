//! What a sample's time is spent on: by bounce, by pass, by effect.
//!
//! Nothing in a render counts or times: it would cost those who don't ask. Who does has a few of the picture's pixels
//! sampled again and again after the render, with all of it and with one thing left out in turn, back to back; what it
//! costs is the difference. Left out, an effect's light is missing from those samples, which are thrown away.

use std::hint::black_box;
use std::time::Instant;

use rayon::prelude::*;

use crate::integrator;
use crate::sampling::Sampler;
use crate::scene::{Effects, Scene};
use crate::settings::{Integrator, Settings};

/// Pairs of timings for each thing.
const ROUNDS: usize = 9;

/// Seconds that one timing is to take: long beside what starting threads takes.
const LONG: f64 = 0.012;

/// Most and fewest samples of one timing.
const MOST: usize = 1 << 16;
const FEWEST: usize = 64;

/// Bounces that are told one by one.
const BOUNCES: u32 = 4;

/// What of a sample's time goes into one thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The thing, as "bounce 1", "pass ao", "effect motion blur".
    pub name: String,
    /// Share of the time of a sample; below 0 where it could not be told from nothing.
    pub share: f64,
    /// Standard error of that.
    pub error: f64,
}

/// Where the time of samples goes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Costs {
    /// Seconds that a thread spends on one sample, the mean over the picture.
    pub sample: f64,
    /// By thing; those of bounces add up to the whole, those of passes and effects overlap with them and each other.
    pub list: Vec<Cost>,
}

/// Whether something is there.
type Is = fn(&Effects) -> bool;

/// Turns something of a scene off.
type Off = fn(&mut Effects);

/// Passes and effects that can be left out alone, with whether they are there.
const THINGS: &[(&str, Is, Off)] = &[
    ("pass ao", |e| e.ao, |e| e.ao = false),
    ("pass shadow", |e| e.shadow, |e| (e.shadow, e.irradiance) = (false, false)),
    ("pass shadow of groups", |e| e.group_shadows, |e| e.group_shadows = false),
    ("pass colors", |e| e.color, |e| e.color = false),
    ("pass normal, uv, vector", |e| e.geometry, |e| e.geometry = false),
    ("pass denoising", |e| e.denoising, |e| e.denoising = false),
    ("pass mist", |e| e.mist, |e| e.mist = false),
    ("pass aovs", |e| e.aovs, |e| e.aovs = false),
    ("pass cryptomatte", |e| e.cryptomatte, |e| e.cryptomatte = false),
    ("effect motion blur", |e| e.motion_blur, |e| e.motion_blur = false),
    ("effect cut-outs", |e| e.cutouts, |e| e.cutouts = false),
    ("effect absorption", |e| e.absorption, |e| e.absorption = false),
    ("effect shadow catchers", |e| e.catchers, |e| e.catchers = false),
    ("effect own shadows", |e| e.own_shadows, |e| e.own_shadows = false),
    ("effect occlusion maps", |e| e.occlusion_maps, |e| e.occlusion_maps = false),
];

/// Measures it for `scene`, which is as before afterwards. Takes some seconds.
pub fn costs(scene: &mut Scene, settings: &Settings) -> Costs {
    let probe = Probe::new(scene, settings);
    let mut list = Vec::new();
    let effects = scene.effects;
    let bounces = match settings.integrator {
        Integrator::Path if effects.indirect => settings.max_bounces,
        _ => 0,
    };
    let mut before = 1.0;
    let mut deepest = Vec::new();
    // From the deepest on, so that each has what is above it as its whole.
    for bounce in (0..bounces.min(BOUNCES)).rev() {
        let fewer = Settings { max_bounces: bounce, ..settings.clone() };
        let (share, error) = probe.left_out(scene, settings, scene, &fewer);
        let deeper = if bounce + 1 == BOUNCES && bounces > BOUNCES { " and deeper" } else { "" };
        deepest.push(Cost { name: format!("bounce {}{deeper}", bounce + 1), share: share - (1.0 - before), error });
        before = 1.0 - share;
    }
    list.push(Cost { name: "first hit and its light".to_owned(), share: before, error: 0.0 });
    list.extend(deepest.into_iter().rev());
    for (name, is_there, off) in THINGS {
        if is_there(&effects) {
            let (share, error) = probe.without(scene, settings, *off);
            list.push(Cost { name: (*name).to_owned(), share, error });
        }
    }
    Costs { sample: probe.sample, list }
}

/// Some of the pixels.
struct Probe {
    pixels: Vec<(u32, u32)>,
    sampler: Sampler,
    /// Seconds of one sample on one thread.
    sample: f64,
}

impl Probe {
    fn new(scene: &Scene, settings: &Settings) -> Self {
        let [width, height] = scene.size;
        let all = u64::from(width) * u64::from(height);
        // Steps of the golden ratio go over the picture evenly, however many there are.
        let pixel = |i: u64| {
            let at = ((u128::from(i.wrapping_mul(0x9E37_79B9_7F4A_7C15)) * u128::from(all)) >> 64) as u64;
            ((at % u64::from(width)) as u32, (at / u64::from(width)) as u32)
        };
        let pixels = |count: usize| (0..count as u64).map(pixel).collect();
        let sampler = Sampler::new(settings.sampler, settings.seed);
        let mut probe = Self { pixels: pixels(FEWEST), sampler, sample: 0.0 };
        // The first run warms caches, the second finds the pace.
        let _ = probe.seconds(scene, settings);
        let pace = probe.seconds(scene, settings) / FEWEST as f64;
        probe.pixels = pixels(((LONG / pace.max(1e-9)) as usize).clamp(FEWEST, MOST));
        let count = probe.pixels.len() as f64;
        let threads = rayon::current_num_threads() as f64;
        let times: Vec<f64> = (0..ROUNDS).map(|_| probe.seconds(scene, settings)).collect();
        probe.sample = median(times) * threads / count;
        probe
    }

    /// Seconds that one sample of each pixel takes on all threads.
    fn seconds(&self, scene: &Scene, settings: &Settings) -> f64 {
        let start = Instant::now();
        self.pixels.par_iter().enumerate().for_each(|(i, &(x, y))| {
            let sampler = self.sampler.for_sample(x, y, scene.passes.sequence_place(i as u32 % 64));
            black_box(integrator::sample(scene, settings, &sampler, x, y));
        });
        start.elapsed().as_secs_f64()
    }

    /// Share of the time that a sample takes in `scene` under `settings` which it lacks in `less` under `fewer`, and its
    /// standard error.
    fn left_out(&self, scene: &Scene, settings: &Settings, less: &Scene, fewer: &Settings) -> (f64, f64) {
        self.shares(|| self.seconds(scene, settings), || self.seconds(less, fewer))
    }

    fn without(&self, scene: &mut Scene, settings: &Settings, off: Off) -> (f64, f64) {
        let effects = scene.effects;
        let mut less = effects;
        off(&mut less);
        let cell = std::cell::RefCell::new(scene);
        let timed = |effects: Effects| {
            let mut scene = cell.borrow_mut();
            scene.effects = effects;
            self.seconds(&scene, settings)
        };
        let shares = self.shares(|| timed(effects), || timed(less));
        cell.borrow_mut().effects = effects;
        shares
    }

    fn shares(&self, all: impl Fn() -> f64, less: impl Fn() -> f64) -> (f64, f64) {
        let share = |round: usize| {
            // Which comes first alternates: a machine that gets slower is no cost.
            let (all, less) = if round.is_multiple_of(2) {
                let all = all();
                (all, less())
            } else {
                let less = less();
                (all(), less)
            };
            1.0 - less / all.max(1e-9)
        };
        let shares: Vec<f64> = (0..ROUNDS).map(share).collect();
        let middle = median(shares.clone());
        let spread = median(shares.iter().map(|share| (share - middle).abs()).collect());
        // A normal distribution's standard deviation is 1.4826 of the median deviation; the median's error is 1.2533 of
        // the mean's.
        (middle, 1.4826 * 1.2533 * spread / (ROUNDS as f64).sqrt())
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
