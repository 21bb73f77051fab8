//! Animation curves as values (OpenUSD's Ts): knots in time, and what is between and beyond them. The openusd
//! crate carries them but does not evaluate them.
//!
//! ```text
//! text, bytes ─► Curve, loops rolled up ─► value at a time
//! ```
//!
//! <https://openusd.org/release/api/ts_page_front.html>

mod binary;
mod evaluate;
mod text;

pub(super) use binary::read as from_bytes;
pub(super) use text::read as from_text;

/// A curve over time codes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spline {
    pub kind: Kind,
    pub before: Beyond,
    pub after: Beyond,
    pub loops: Option<Loops>,
    /// As authored, by time, no two at the same.
    pub knots: Vec<Knot>,
}

/// What a curved segment is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Of tangents with widths and slopes.
    #[default]
    Bezier,
    /// Of slopes.
    Hermite,
}

/// What is before the first knot, or after the last.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Beyond {
    /// No value.
    Blocked,
    #[default]
    Held,
    /// On along the slope of the nearest segment.
    Linear,
    Sloped(f64),
    /// All of it again and again, each time from the value where the last ended.
    Repeat,
    /// All of it again and again.
    Reset,
    /// All of it back and forth.
    Oscillate,
}

/// Knots that are repeated between others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Loops {
    /// From here, where a knot has to be, …
    pub start: f64,
    /// … up to here, without it.
    pub end: f64,
    pub times_before: i32,
    pub times_after: i32,
    /// Added to the value with each repetition.
    pub offset: f64,
}

/// What is between a knot and the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Next {
    /// No value.
    Blocked,
    #[default]
    Held,
    Linear,
    Curved,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Knot {
    pub time: f64,
    pub value: f64,
    /// The value up to the knot, where it is another.
    pub value_before: Option<f64>,
    /// Towards the knot before.
    pub before: Tangent,
    /// Towards the knot after.
    pub after: Tangent,
    pub next: Next,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tangent {
    /// In time codes; without meaning on a Hermite curve.
    pub width: f64,
    /// Change of the value with each time code.
    pub slope: f64,
}

impl Knot {
    fn value_before(&self) -> f64 {
        self.value_before.unwrap_or(self.value)
    }
}

impl Spline {
    /// One of `knots`, in any order, of which the last at a time counts; `None` where a number is not finite.
    fn new(kind: Kind, [before, after]: [Beyond; 2], loops: Option<Loops>, mut knots: Vec<Knot>) -> Option<Self> {
        let is_finite = |knot: &Knot| {
            let numbers = [knot.time, knot.value, knot.value_before(), knot.before.width, knot.after.width];
            numbers.iter().chain(&[knot.before.slope, knot.after.slope]).all(|number| number.is_finite())
        };
        if !knots.iter().all(is_finite) {
            return None;
        }
        knots.reverse();
        knots.sort_by(|a, b| a.time.total_cmp(&b.time));
        knots.dedup_by(|b, a| a.time == b.time);
        let has_start = |loops: &Loops| knots.iter().any(|knot| knot.time == loops.start);
        let loops = loops.filter(|loops| {
            let repeats = loops.times_before > 0 || loops.times_after > 0;
            repeats && loops.start < loops.end && (loops.end - loops.start).is_finite() && has_start(loops)
        });
        Some(Self { kind, before, after, loops, knots })
    }

    /// The curve with values that a number of another precision holds: `round` makes one of a value.
    pub fn rounded(mut self, round: impl Fn(f64) -> f64) -> Self {
        for knot in &mut self.knots {
            for value in [&mut knot.value, &mut knot.before.slope, &mut knot.after.slope] {
                *value = round(*value);
            }
            knot.value_before = knot.value_before.map(&round);
        }
        self
    }

    /// Times of its knots from `open` to `close`, those that loops repeat within it included.
    pub fn times(&self, open: f64, close: f64) -> Vec<f64> {
        let rolled = evaluate::Rolled::of(self);
        let inside = (0..rolled.len()).skip(rolled.at_or_after(open));
        inside.map(|i| rolled.knot(i).time).take_while(|&time| time <= close).take(MOST_TIMES).collect()
    }

    /// True where the value may differ between times.
    pub fn varies(&self) -> bool {
        let moves = |beyond| !matches!(beyond, Beyond::Held);
        self.knots.len() > 1 || moves(self.before) || moves(self.after) || self.loops.is_some()
    }
}

/// More samples than this within one shutter tell nothing more.
const MOST_TIMES: usize = 64;

#[cfg(test)]
mod tests;
