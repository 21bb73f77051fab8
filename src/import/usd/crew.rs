//! Large stages are read by many threads. A stage is bound to its thread and composes what it is asked for,
//! so each thread opens its own and takes a share of the prims; instances are left to one, so that each
//! prototype is read once.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, mpsc};

use openusd::sdf::Path;

use super::gather::{Found, Gatherer, Haul, Read};
use super::inherit::Clock;
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

/// Everything that is shown while nothing moves.
pub(super) fn gather(reading: &Reading<'_>, aside: fn(&str) -> bool) -> Haul {
    match divide(reading) {
        Some(division) => by_many(reading, division, aside),
        None => by_one(Clock::still(reading), aside),
    }
}

/// Everything that is shown when `clock` says.
pub(super) fn by_one(clock: Clock<'_, '_>, aside: fn(&str) -> bool) -> Haul {
    let mut gatherer = Gatherer::new(clock, aside);
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

/// Where `reading` is to be divided. That depends on the stage alone, so that it is read in the same order
/// by any number of threads.
fn divide(reading: &Reading<'_>) -> Option<Division> {
    let size = reading.place.file.as_ref().and_then(|file| std::fs::metadata(file).ok()).map_or(0, |file| file.len());
    if size > LARGE {
        return None;
    }
    let mut walk = Walk::new(Clock::still(reading));
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
    let shares = Arc::new(division.shares);
    let mut parts: Vec<Option<Part>> = shares.iter().map(|_| None).collect();
    let threads = rayon::current_num_threads().min(shares.len());
    let next = Arc::new(AtomicUsize::new(0));
    let (sender, parcels) = mpsc::channel();
    // With one thread there is no point in opening the stage twice.
    for _ in 0..if threads > 1 { threads } else { 0 } {
        let (hold, held) = mpsc::channel();
        let crew = Crew { shares: shares.clone(), next: next.clone(), sender: sender.clone(), aside, held };
        let (path, options) = (reading.place.file.as_deref().map(PathBuf::from), reading.options.clone());
        // Not scoped: letting go of a stage takes long, and nobody needs to wait for it.
        let worker = std::thread::Builder::new().stack_size(super::STACK);
        if worker.spawn(move || path.map(|path| crew.work(&path, &options))).is_ok() {
            reading.crew.borrow_mut().push(hold);
        }
    }
    drop(sender);
    for parcel in parcels {
        match parcel {
            Parcel::Part(number, part) => parts[number] = Some(part),
            Parcel::Warnings(warnings) => reading.warnings.borrow_mut().extend(warnings),
        }
    }

    let mut gatherer = Gatherer::new(Clock::still(reading), aside);
    let mut haul = Haul::default();
    let mut own = Vec::new();
    // Shapes that are read here are a batch of their own, after those of the shares.
    let last = parts.len();
    gatherer.resolve(division.above, last, &mut own, &mut haul.found);
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

enum Parcel {
    Part(usize, Part),
    Warnings(Warnings),
}

/// What a thread works with.
struct Crew {
    shares: Arc<Vec<Vec<Path>>>,
    next: Arc<AtomicUsize>,
    sender: mpsc::Sender<Parcel>,
    aside: fn(&str) -> bool,
    /// Ends with the stage that the work is for.
    held: mpsc::Receiver<()>,
}

impl Crew {
    fn work(self, path: &std::path::Path, options: &ImportOptions) {
        let Ok(reading) = Reading::open(path, options) else { return };
        let mut gatherer = Gatherer::new(Clock::still(&reading), self.aside);
        loop {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(share) = self.shares.get(number) else { break };
            let part = share_of(&mut gatherer, share, number);
            if self.sender.send(Parcel::Part(number, part)).is_err() {
                return;
            }
        }
        reading.warn_of_composition();
        let _ = self.sender.send(Parcel::Warnings(reading.warnings.take()));
        drop(self.sender);
        let _ = self.held.recv();
    }
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
