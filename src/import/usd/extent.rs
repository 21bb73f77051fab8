//! From when to when a stage has samples, where it does not say so itself: what a frame is held against. Curves have
//! rules of their own for what is beyond their ends.

use std::cell::Cell;

use openusd::usd::Attribute;

use super::retime;
use super::stage::Reading;
use crate::error::{Place, Warnings};

/// Times of the first and last sample of all that was read.
pub(super) struct Extent {
    /// The frame that was asked for; `None` where there is nothing to look for.
    frame: Option<f64>,
    met: Cell<Option<[f64; 2]>>,
}

impl Extent {
    /// What is looked for where `frame` was asked for, of a stage that says its range where `is_ranged`.
    pub fn new(frame: Option<f64>, is_ranged: bool) -> Self {
        Self { frame: frame.filter(|_| !is_ranged), met: Cell::new(None) }
    }

    /// What was met, for [`add`](Self::add).
    pub fn met(&self) -> Option<[f64; 2]> {
        self.met.get()
    }

    /// Adds what was met elsewhere.
    pub fn add(&self, times: Option<[f64; 2]>) {
        let Some([first, last]) = times else { return };
        let met = self.met.get().map_or([first, last], |[a, b]| [a.min(first), b.max(last)]);
        self.met.set(Some(met));
    }

    /// True where more samples would change what is said.
    fn is_open(&self) -> bool {
        let Some(frame) = self.frame else { return false };
        self.met.get().is_none_or(|[first, last]| frame < first || frame > last)
    }

    /// Takes note of the samples of an attribute that is read.
    pub fn note(&self, reading: &Reading<'_>, attribute: &Attribute) {
        if self.is_open() {
            let times = retime::samples(reading, std::slice::from_ref(attribute), f64::NEG_INFINITY, f64::INFINITY);
            self.add(times.first().zip(times.last()).map(|(first, last)| [*first, *last]));
        }
    }

    /// Tells of a frame that is outside. A single time is none: whatever the frame, it shows the same.
    pub fn tell(&self, place: &Place, warnings: &mut Warnings) {
        let (Some(frame), Some([first, last])) = (self.frame, self.met.get()) else { return };
        if first < last && (frame < first || frame > last) {
            let what = "the stage names no range, and what it has samples of";
            warnings
                .push(place, format!("frame {frame}: {what} has them from {first} to {last}; the nearest are held"));
        }
    }
}
