//! Large stages are read by many threads. A stage is bound to its thread and composes what it is asked for,
//! so each thread opens its own and takes a share of the prims; instances are left to one, so that each
//! prototype is read once.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};

use openusd::sdf::Path;

use super::gather::{Found, Gatherer, Haul, Read};
use super::guard;
use super::inherit::Clock;
use super::pulse::Pulse;
use super::stage::Reading;
use super::walk::{Shown, Walk};
use crate::error::Warnings;
use crate::import::ImportOptions;

/// A stage is divided where so many prims stand side by side.
const WIDE: usize = 512;
/// How deep such a place is looked for.
const DEEP: usize = 8;
/// How many of them a thread takes at a time.
const SHARE: usize = 64;
/// Opening a larger root layer once more would take too long and too much memory.
const LARGE: u64 = 64 << 20;

/// Everything that is shown: while nothing moves, or with what moves within the reading's shutter, for which all
/// is walked through once more before, to know when something has a sample.
pub(super) fn gather(reading: &Reading<'_>, aside: fn(&str) -> bool) -> Haul {
    match divide(&mut Walk::new(Clock::still(reading))) {
        Some(division) => by_many(reading, division, aside),
        None => by_one(reading, aside),
    }
}

fn by_one(reading: &Reading<'_>, aside: fn(&str) -> bool) -> Haul {
    let times = reading.shutter.get().map(|shutter| {
        let mut walk = Walk::new(Clock::noting(reading));
        walk.stage();
        walk.clock.samples(shutter)
    });
    let mut gatherer = Gatherer::new(Clock::at(reading, times.unwrap_or_default()), aside);
    let shown = gatherer.walk.stage();
    let mut haul = Haul { shapes: vec![Vec::new()], ..Haul::default() };
    gatherer.resolve(shown, 0, &mut haul.shapes[0], &mut haul.found);
    haul.times = gatherer.walk.clock.times;
    haul
}

/// A stage in two: what was met on the way, and many prims with all that is below them.
struct Division {
    above: Vec<Shown>,
    shares: Vec<Vec<Path>>,
}

/// Where the stage of `walk` is to be divided. That depends on the stage alone, so that it is read in the same
/// order by any number of threads.
fn divide(walk: &mut Walk<'_, '_>) -> Option<Division> {
    let reading = walk.reading;
    let size = reading.place.file.as_ref().and_then(|file| std::fs::metadata(file).ok()).map_or(0, |file| file.len());
    if size > LARGE {
        return None;
    }
    let root = reading.stage.prim(Path::abs_root()).ok()?;
    let mut level: Vec<_> =
        root.children().ok()?.into_iter().map(|prim| (prim, std::rc::Rc::new(walk.root()))).collect();
    let mut above = Vec::new();
    for _ in 0..DEEP {
        if level.len() >= WIDE {
            let paths: Vec<Path> = level.iter().map(|(prim, _)| prim.path().clone()).collect();
            return Some(Division { above, shares: paths.chunks(SHARE).map(<[Path]>::to_vec).collect() });
        }
        let mut below = Vec::new();
        for (prim, context) in level {
            if let Some(context) = walk.enter(&prim, &context, false, &mut above) {
                let context = std::rc::Rc::new(context);
                below.extend(prim.children().ok()?.into_iter().map(|child| (child, context.clone())));
            }
        }
        level = below;
    }
    None
}

/// What a thread found in a share.
struct Part {
    found: Vec<Found>,
    shapes: Vec<Read>,
    /// Instances, and how many prims were found before each.
    later: Vec<(usize, Path)>,
}

fn by_many(reading: &Reading<'_>, division: Division, aside: fn(&str) -> bool) -> Haul {
    let Division { mut above, shares } = division;
    let shares = Arc::new(shares);
    let mut parts: Vec<Option<Part>> = shares.iter().map(|_| None).collect();
    let threads = rayon::current_num_threads().min(shares.len());
    // With one thread there is no point in opening the stage twice.
    let threads = if threads > 1 { threads } else { 0 };
    let shutter = reading.shutter.get();
    let next = Arc::new([const { AtomicUsize::new(0) }; 2]);
    let (sender, parcels) = mpsc::channel();
    let (noter, notes) = mpsc::channel();
    let mut start = Vec::new();
    for _ in 0..threads {
        let (hold, held) = mpsc::channel();
        let (starter, started) = mpsc::channel();
        let (shares, next, sender, noter) = (shares.clone(), next.clone(), sender.clone(), noter.clone());
        let crew =
            Crew { shares, next, sender, aside, shutter: shutter.map(|shutter| (shutter, noter)), started, held };
        let (path, options) = (reading.place.file.as_deref().map(PathBuf::from), reading.options.clone());
        // What breaks down here is left to this thread. Not scoped: letting go of a stage takes long, and nobody needs to wait for it.
        let worker = std::thread::Builder::new().stack_size(super::STACK);
        let pulse = Pulse::own();
        let work = move || {
            pulse.adopt();
            path.map(|path| guard::guarded(|| crew.work(&path, &options)))
        };
        if worker.spawn(work).is_ok() {
            reading.crew.borrow_mut().push(hold);
            start.push(starter);
        }
    }
    drop((sender, noter));
    let mut clock = Clock::still(reading);
    if let Some(shutter) = shutter {
        let times = moments(reading, shutter, &shares, &notes);
        start.iter().for_each(|start| _ = start.send(times.clone()));
        clock = Clock::at(reading, times);
        // What is above the shares stands where it does at each of the times.
        let mut walk = Walk::new(Clock::at(reading, clock.times.clone()));
        above = divide(&mut walk).map_or(above, |division| division.above);
    }
    for parcel in parcels {
        match parcel {
            Parcel::Part(number, part) => parts[number] = Some(part),
            Parcel::Told(warnings, times) => {
                reading.warnings.borrow_mut().extend(warnings);
                reading.extent.add(times);
            }
        }
    }

    let times = clock.times.clone();
    let mut gatherer = Gatherer::new(clock, aside);
    let mut haul = Haul { times, ..Haul::default() };
    let mut own = Vec::new();
    // Shapes that are read here are a batch of their own, after those of the shares.
    let last = parts.len();
    gatherer.resolve(above, last, &mut own, &mut haul.found);
    for (number, (part, share)) in parts.into_iter().zip(shares.iter()).enumerate() {
        let part = part.unwrap_or_else(|| share_of(&mut gatherer, share, number));
        haul.shapes.push(part.shapes);
        let mut later = part.later.into_iter().peekable();
        for (i, found) in part.found.into_iter().map(Some).chain([None]).enumerate() {
            while let Some((_, path)) = later.next_if(|(before, _)| *before == i) {
                let mut shown = Vec::new();
                gatherer.walk.from(&path, &mut shown);
                gatherer.resolve(shown, last, &mut own, &mut haul.found);
            }
            haul.found.extend(found);
        }
    }
    haul.shapes.push(own);
    haul
}

/// When something in the stage has a sample while the shutter is open, by what each thread notes of its shares.
fn moments(reading: &Reading<'_>, shutter: [f64; 2], shares: &[Vec<Path>], notes: &mpsc::Receiver<Note>) -> Vec<f64> {
    let mut walk = Walk::new(Clock::noting(reading));
    divide(&mut walk);
    let mut missing: Vec<usize> = (0..shares.len()).collect();
    let mut times = Vec::new();
    for note in notes {
        missing.retain(|share| *share != note.share);
        times.extend(note.times);
        note.later.iter().for_each(|path| walk.from(path, &mut Vec::new()));
    }
    for path in missing.iter().flat_map(|share| &shares[*share]) {
        walk.from(path, &mut Vec::new());
    }
    times.extend(walk.clock.samples(shutter));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

enum Parcel {
    Part(usize, Part),
    /// What was told, and from when to when there are samples.
    Told(Warnings, Option<[f64; 2]>),
}

/// When something in a share has a sample, and its instances.
struct Note {
    share: usize,
    times: Vec<f64>,
    later: Vec<Path>,
}

/// What a thread works with.
struct Crew {
    shares: Arc<Vec<Vec<Path>>>,
    /// The share that is noted, and that is read next.
    next: Arc<[AtomicUsize; 2]>,
    sender: mpsc::Sender<Parcel>,
    aside: fn(&str) -> bool,
    /// Where a shutter is open: from when to when, and who is told what has samples in it.
    shutter: Option<([f64; 2], mpsc::Sender<Note>)>,
    /// Gives the times of all samples, once every share was noted.
    started: mpsc::Receiver<Vec<f64>>,
    /// Ends with the stage that the work is for.
    held: mpsc::Receiver<()>,
}

impl Crew {
    fn work(mut self, path: &std::path::Path, options: &ImportOptions) {
        let Ok(reading) = Reading::open(path, options) else { return };
        let mut clock = Clock::still(&reading);
        if let Some((shutter, noter)) = self.shutter.take() {
            reading.shutter.set(Some(shutter));
            while let Some((number, share)) = self.take(0) {
                if noter.send(note(&reading, shutter, share, number)).is_err() {
                    return;
                }
            }
            drop(noter);
            let Ok(times) = self.started.recv() else { return };
            clock = Clock::at(&reading, times);
        }
        let mut gatherer = Gatherer::new(clock, self.aside);
        while let Some((number, share)) = self.take(1) {
            let part = share_of(&mut gatherer, share, number);
            if self.sender.send(Parcel::Part(number, part)).is_err() {
                return;
            }
        }
        reading.warn_of_composition();
        let _ = self.sender.send(Parcel::Told(reading.warnings.take(), reading.extent.met()));
        drop(self.sender);
        let _ = self.held.recv();
    }

    /// The next share, with its number.
    fn take(&self, turn: usize) -> Option<(usize, &Vec<Path>)> {
        let number = self.next[turn].fetch_add(1, Ordering::Relaxed);
        Some((number, self.shares.get(number)?))
    }
}

fn note(reading: &Reading<'_>, shutter: [f64; 2], share: &[Path], number: usize) -> Note {
    let mut walk = Walk::new(Clock::noting(reading));
    walk.later = Some(Vec::new());
    share.iter().for_each(|path| walk.from(path, &mut Vec::new()));
    let later = walk.later.take().unwrap_or_default();
    Note { share: number, times: walk.clock.samples(shutter), later: later.into_iter().map(|(_, path)| path).collect() }
}

/// What is at and below the prims of `share`, instances aside.
fn share_of(gatherer: &mut Gatherer<'_, '_>, share: &[Path], number: usize) -> Part {
    let mut part = Part { found: Vec::new(), shapes: Vec::new(), later: Vec::new() };
    for path in share {
        let mut shown = Vec::new();
        let own = gatherer.walk.later.replace(Vec::new());
        gatherer.walk.from(path, &mut shown);
        let later = std::mem::replace(&mut gatherer.walk.later, own).unwrap_or_default();
        // Up to each instance, so that the order stays that of the stage.
        let mut shown = shown.into_iter();
        let mut taken = 0;
        for (before, path) in later {
            let until = shown.by_ref().take(before - taken).collect();
            taken = before;
            gatherer.resolve(until, number, &mut part.shapes, &mut part.found);
            part.later.push((part.found.len(), path));
        }
        gatherer.resolve(shown.collect(), number, &mut part.shapes, &mut part.found);
    }
    part
}
