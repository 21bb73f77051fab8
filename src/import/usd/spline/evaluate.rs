//! The value of a curve at a time.

use super::{Beyond, Kind, Knot, Loops, Next, Spline};

/// From which side a value is looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Before,
    After,
}

impl Spline {
    /// The value at `time`; `None` where there is none.
    pub fn at(&self, time: f64) -> Option<f64> {
        if self.knots.is_empty() || !time.is_finite() {
            return None;
        }
        let rolled = Rolled::of(self);
        let (time, side, offset) = self.turned(&rolled, time);
        let value = self.within(&rolled, time, side)? + offset;
        value.is_finite().then_some(value)
    }

    /// The curve as OpenUSD has it once read from a binary layer: tangents that lead back in time are shortened then,
    /// and where the margins ask for it once more at evaluation, which moves upright places in the sixth digit.
    pub(super) fn settled(mut self) -> Self {
        if self.kind == Kind::Bezier {
            for i in 1..self.knots.len() {
                let [before, after] = [self.knots[i - 1], self.knots[i]];
                if before.next == Next::Curved {
                    let widths = forward([before.after.width, after.before.width], after.time - before.time);
                    (self.knots[i - 1].after.width, self.knots[i].before.width) = (widths[0], widths[1]);
                }
            }
        }
        self
    }

    /// Where the whole curve is repeated: the time within it, the side, and what is added to the value.
    fn turned(&self, rolled: &Rolled<'_>, time: f64) -> (f64, Side, f64) {
        let as_is = (time, Side::After, 0.0);
        let (first, last) = (rolled.knot(0), rolled.knot(rolled.len() - 1));
        let span = last.time - first.time;
        let (beyond, turns) = if time < first.time {
            (self.before, ((first.time - time) / span).ceil())
        } else if time >= last.time {
            (self.after, -(((time - last.time) / span).floor() + 1.0))
        } else {
            return as_is;
        };
        if span <= 0.0 || !matches!(beyond, Beyond::Repeat | Beyond::Reset | Beyond::Oscillate) {
            return as_is;
        }
        let inside = (time + turns * span).clamp(first.time, last.time);
        match beyond {
            // Of what is seen from the side on which it goes on.
            Beyond::Repeat if turns > 0.0 => {
                (inside, Side::After, -turns * (last.value_before() - first.value_before()))
            }
            Beyond::Repeat => (inside, Side::After, -turns * (last.value - first.value)),
            Beyond::Oscillate if turns.rem_euclid(2.0) == 1.0 => (first.time + (last.time - inside), Side::Before, 0.0),
            _ => (inside, Side::After, 0.0),
        }
    }

    /// The value at `time` with no regard to repetitions of the whole curve.
    fn within(&self, rolled: &Rolled<'_>, time: f64, side: Side) -> Option<f64> {
        let count = rolled.len();
        let next = rolled.at_or_after(time);
        let before = next.checked_sub(1).map(|i| rolled.knot(i));
        let after = (next < count).then(|| rolled.knot(next));
        match (before, after) {
            (before, Some(knot)) if knot.time == time => match side {
                Side::Before => match before.map(|before| (before.next, before.value)) {
                    Some((Next::Blocked, _)) => None,
                    Some((Next::Held, held)) => Some(held),
                    None if self.before == Beyond::Blocked => None,
                    _ => Some(knot.value_before()),
                },
                Side::After if next + 1 == count => (self.after != Beyond::Blocked).then_some(knot.value),
                Side::After => (knot.next != Next::Blocked).then_some(knot.value),
            },
            (None, Some(first)) => {
                let inner = (count > 1).then(|| rolled.knot(1));
                let slope = slope_beyond(self.before, &first, first.next, first.after.slope, inner)?;
                Some(first.value_before() - slope * (first.time - time))
            }
            (Some(last), None) => {
                let inner = (count > 1).then(|| rolled.knot(count - 2));
                let next = inner.map_or(Next::Held, |inner| inner.next);
                let slope = slope_beyond(self.after, &last, next, last.before.slope, inner)?;
                Some(last.value + slope * (time - last.time))
            }
            (Some(before), Some(after)) => match before.next {
                Next::Blocked => None,
                Next::Held => Some(before.value),
                Next::Linear => Some(before.value + straight(&before, &after) * (time - before.time)),
                Next::Curved if self.kind == Kind::Hermite => Some(hermite(&before, &after, time)),
                Next::Curved => Some(bezier(&before, &after, time)),
            },
            (None, None) => None,
        }
    }
}

/// The slope beyond the knot at the `end` of a curve, whose nearest segment is of kind `next`, leads to
/// `inner` and has the slope `curved` at the end. `None` where there is no value.
fn slope_beyond(beyond: Beyond, end: &Knot, next: Next, curved: f64, inner: Option<Knot>) -> Option<f64> {
    match (beyond, inner) {
        (Beyond::Blocked, _) => None,
        (Beyond::Sloped(slope), _) => Some(slope),
        (Beyond::Linear, Some(inner)) if end.value_before.is_none() => Some(match next {
            Next::Blocked | Next::Held => 0.0,
            Next::Linear if inner.time > end.time => straight(end, &inner),
            Next::Linear => straight(&inner, end),
            Next::Curved => curved,
        }),
        _ => Some(0.0),
    }
}

fn straight(before: &Knot, after: &Knot) -> f64 {
    (after.value_before() - before.value) / (after.time - before.time)
}

fn hermite(before: &Knot, after: &Knot, time: f64) -> f64 {
    let span = after.time - before.time;
    let u = (time - before.time) / span;
    let rise = after.value_before() - before.value;
    let (m0, m1) = (before.after.slope * span, after.before.slope * span);
    ((m0 + m1 - 2.0 * rise) * u + (3.0 * rise - 2.0 * m0 - m1)) * u * u + m0 * u + before.value
}

fn bezier(before: &Knot, after: &Knot, time: f64) -> f64 {
    let [w0, w1] = forward([before.after.width, after.before.width], after.time - before.time);
    let times = power([before.time - time, before.time + w0 - time, after.time - w1 - time, after.time - time]);
    let u = root(times).clamp(0.0, 1.0);
    let (v0, v1) = (before.value, after.value_before());
    let [a, b, c, d] = power([v0, v0 + w0 * before.after.slope, v1 - w1 * after.before.slope, v1]);
    ((a * u + b) * u + c) * u + d
}

/// A Bézier polynomial's coefficients, the highest first.
fn power([p0, p1, p2, p3]: [f64; 4]) -> [f64; 4] {
    [-p0 + 3.0 * p1 - 3.0 * p2 + p3, 3.0 * p0 - 6.0 * p1 + 3.0 * p2, -3.0 * p0 + 3.0 * p1, p0]
}

/// Where a polynomial that only grows from 0 to 1 is 0 there, by Cardano's formulas, as in OpenUSD: where a curve
/// is upright, digits are lost, and these are to be the same.
fn root([a, b, c, d]: [f64; 4]) -> f64 {
    const FLAT: f64 = 1e-10;
    let nearest = |roots: &[f64]| roots.iter().copied().min_by(|x, y| (x - 0.5).abs().total_cmp(&(y - 0.5).abs()));
    if a.abs() < FLAT && b.abs() < FLAT {
        return if c.abs() < FLAT { 0.0 } else { -d / c };
    }
    if a.abs() < FLAT {
        let part = (c * c - 4.0 * b * d).sqrt();
        return nearest(&[(-c - part) / (2.0 * b), (-c + part) / (2.0 * b)]).unwrap_or(0.0);
    }
    let (b, c, d) = (b / a, c / a, d / a);
    let p3 = (3.0 * c - b * b) / 3.0 / 3.0;
    let p33 = p3 * p3 * p3;
    let q = (2.0 * b * b * b - 9.0 * b * c + 27.0 * d) / 27.0;
    let q2 = q / 2.0;
    let b3 = b / 3.0;
    let discriminant = q2 * q2 + p33;
    if discriminant < 0.0 {
        let r = (-p33).sqrt();
        let angle = (-q / (2.0 * r)).clamp(-1.0, 1.0).acos();
        let scale = 2.0 * r.cbrt();
        let roots = [0.0, 2.0, 4.0].map(|turn| scale * ((angle + turn * std::f64::consts::PI) / 3.0).cos() - b3);
        return nearest(&roots).unwrap_or(0.0);
    }
    if discriminant == 0.0 {
        let u = -q2.cbrt();
        return nearest(&[2.0 * u - b3, -u - b3]).unwrap_or(0.0);
    }
    let part = discriminant.sqrt();
    (part - q2).cbrt() - (part + q2).cbrt() - b3
}

/// Widths of tangents of a segment `span` long that do not lead back in time: those that do are made shorter in
/// the same proportion until the curve is upright at one place (TsAntiRegressionKeepRatio, with the margins that
/// OpenUSD leaves).
fn forward(widths: [f64; 2], span: f64) -> [f64; 2] {
    const READ: f64 = 1e-6;
    const WRITE: f64 = 1e-5;
    let [start, end] = widths.map(|width| width / span);
    // Curves that are upright somewhere lie on an ellipse of the two widths.
    let (a, b) = (start + READ, end + READ);
    let leads_back = a * a + b * b - 2.0 * (a + b) + a * b + 1.0 > 0.0;
    if (start <= 1.0 && end <= 1.0) || !leads_back {
        return widths;
    }
    if start < READ {
        return [widths[0], (1.0 - WRITE) * span];
    }
    if end < READ {
        return [(1.0 - WRITE) * span, widths[1]];
    }
    let ratio = start / end;
    let shorter = (ratio.sqrt() + ratio + 1.0) / (ratio * ratio + ratio + 1.0);
    [(ratio * shorter - WRITE) * span, (shorter - WRITE) * span]
}

/// The knots of a curve, with those that its loops repeat, which are never stored: there may be billions.
pub(super) struct Rolled<'a> {
    knots: &'a [Knot],
    loops: Option<Loops>,
    /// Knots before what is repeated, in it, and the first after all repetitions.
    head: usize,
    body: [usize; 2],
    tail: usize,
    /// How often the body stands there.
    turns: usize,
}

impl<'a> Rolled<'a> {
    pub fn of(spline: &'a Spline) -> Self {
        let knots = &spline.knots[..];
        let Some(loops) = spline.loops else {
            return Self { knots, loops: None, head: knots.len(), body: [0; 2], tail: knots.len(), turns: 0 };
        };
        let span = loops.end - loops.start;
        let [before, after] = [loops.times_before, loops.times_after].map(|times| times.max(0));
        let from = loops.start - f64::from(before) * span;
        let until = loops.end + f64::from(after) * span;
        let at = |time: f64| knots.partition_point(|knot| knot.time < time);
        Self {
            knots,
            loops: Some(Loops { times_before: before, times_after: after, ..loops }),
            head: at(from),
            body: [at(loops.start), at(loops.end)],
            tail: knots.partition_point(|knot| knot.time <= until),
            turns: before as usize + 1 + after as usize,
        }
    }

    fn looped(&self) -> usize {
        // The first knot of the body once more, at the end of it all.
        self.turns * (self.body[1] - self.body[0]) + usize::from(self.loops.is_some())
    }

    pub fn len(&self) -> usize {
        self.head + self.looped() + (self.knots.len() - self.tail)
    }

    pub fn knot(&self, i: usize) -> Knot {
        let Some(i) = i.checked_sub(self.head) else { return self.knots[i] };
        let Some(loops) = self.loops.filter(|_| i < self.looped()) else {
            return self.knots[self.tail + i - self.looped()];
        };
        let [first, end] = self.body;
        let (turn, inner) = (i / (end - first), i % (end - first));
        let turn = turn as f64 - f64::from(loops.times_before);
        let knot = self.knots[first + inner];
        let lift = turn * loops.offset;
        Knot {
            time: knot.time + turn * (loops.end - loops.start),
            value: knot.value + lift,
            value_before: knot.value_before.map(|value| value + lift),
            ..knot
        }
    }

    /// Index of the first knot that is not before `time`.
    pub fn at_or_after(&self, time: f64) -> usize {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low + (high - low) / 2;
            if self.knot(middle).time < time { low = middle + 1 } else { high = middle }
        }
        low
    }
}
