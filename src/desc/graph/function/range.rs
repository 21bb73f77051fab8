//! Ranges, color ramps and tables.

use super::Value;
use super::math::divide;

/// How a range is gone through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Range {
    /// Evenly.
    Linear,
    /// In so many steps.
    Stepped,
    /// `3 t² − 2 t³`, and no further than the ends.
    Smooth,
    /// `6 t⁵ − 15 t⁴ + 10 t³` (Ken Perlin: *Improving Noise*, 2002), and no further than the ends.
    Smoother,
}

impl Range {
    pub(super) fn eval(
        self,
        value: Value,
        from: [Value; 2],
        to: [Value; 2],
        steps: Value,
        clamp: bool,
        vector: bool,
    ) -> Value {
        std::array::from_fn(|i| {
            let (low, high) = (to[0][i], to[1][i]);
            let width = from[1][i] - from[0][i];
            if width == 0.0 && !vector {
                return 0.0;
            }
            let t = divide(value[i] - from[0][i], width);
            let share = match self {
                Self::Linear => t,
                Self::Stepped if steps[i] > 0.0 => (t * (steps[i] + 1.0)).floor() / steps[i],
                Self::Stepped => 0.0,
                Self::Smooth => {
                    let t = t.clamp(0.0, 1.0);
                    t * t * (3.0 - 2.0 * t)
                }
                Self::Smoother => {
                    let t = t.clamp(0.0, 1.0);
                    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
                }
            };
            let result = low + share * (high - low);
            if clamp { result.clamp(low.min(high), low.max(high)) } else { result }
        })
    }
}

/// How colors between two stops are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RampKind {
    /// The stop before.
    Constant,
    /// Evenly.
    Linear,
    /// `3 t² − 2 t³`.
    Ease,
    /// Cardinal spline of tension 0.71, through the stops.
    Cardinal,
    /// B-spline, near the stops.
    BSpline,
}

/// Colors along a line, exactly as Blender's color ramps in RGB have them.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// Positions, growing, and the colors there.
    pub stops: Vec<(f64, Value)>,
    /// What lies between.
    pub kind: RampKind,
}

impl Ramp {
    /// The color at `x`.
    pub(super) fn at(&self, x: f64) -> Value {
        let stops = &self.stops;
        let (Some(&first), Some(&last)) = (stops.first(), stops.last()) else { return [0.0; 4] };
        let is_spline = matches!(self.kind, RampKind::Cardinal | RampKind::BSpline);
        if stops.len() == 1 {
            return first.1;
        }
        let next = stops.partition_point(|stop| stop.0 <= x);
        // Splines begin and end at the ends of the line.
        let (before, after) = match next {
            0 => ((0.0, first.1), first),
            next if next == stops.len() => (last, (1.0, last.1)),
            next => (stops[next - 1], stops[next]),
        };
        if !is_spline && (next == 0 || next == stops.len() || self.kind == RampKind::Constant) {
            return before.1;
        }
        // From the later stop to the earlier one.
        let back = divide(x - after.0, before.0 - after.0);
        if !is_spline {
            let t = if self.kind == RampKind::Ease { back * back * (3.0 - 2.0 * back) } else { back };
            return std::array::from_fn(|i| (1.0 - t) * after.1[i] + t * before.1[i]);
        }
        let further = if next + 1 >= stops.len() { after.1 } else { stops[next + 1].1 };
        let earlier = if next < 2 { before.1 } else { stops[next - 2].1 };
        let weights = self.weights(back.clamp(0.0, 1.0));
        let knots = [further, after.1, before.1, earlier];
        std::array::from_fn(|i| (0..4).map(|k| weights[k] * knots[k][i]).sum::<f64>().clamp(0.0, 1.0))
    }

    /// Weights of four knots, `t` from the second to the third.
    fn weights(&self, t: f64) -> [f64; 4] {
        let (t2, t3) = (t * t, t * t * t);
        if self.kind == RampKind::BSpline {
            return [
                (1.0 - t) * (1.0 - t) * (1.0 - t) / 6.0,
                0.5 * t3 - t2 + 2.0 / 3.0,
                -0.5 * t3 + 0.5 * t2 + 0.5 * t + 1.0 / 6.0,
                t3 / 6.0,
            ];
        }
        let k = 0.71;
        [
            -k * t3 + 2.0 * k * t2 - k * t,
            (2.0 - k) * t3 + (k - 3.0) * t2 + 1.0,
            (k - 2.0) * t3 + (3.0 - 2.0 * k) * t2 + k * t,
            k * t3 - k * t2,
        ]
    }
}

/// A table of values, evenly spaced.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Where the first row is.
    pub min: f64,
    /// Where the last row is.
    pub max: f64,
    /// The rows.
    pub rows: Vec<Value>,
    /// What is done between them and beyond.
    pub curves: Curves,
}

/// What a table does between its rows and beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Curves {
    /// The row before; the last one beyond the end.
    Stepped,
    /// Blended evenly; the first and last one beyond the ends.
    Clamped,
    /// Blended evenly, and the slope at the ends goes on.
    Extrapolated,
}

impl Table {
    /// The row at `x`.
    pub(super) fn row(&self, x: f64) -> Value {
        let (row, next, t) = self.find(x);
        std::array::from_fn(|i| row[i] + t * (next[i] - row[i]))
    }

    /// Red, green and blue, each looked up in its own column.
    pub(super) fn columns(&self, a: Value) -> Value {
        let at = |i: usize| {
            let (row, next, t) = self.find(a[i]);
            row[i] + t * (next[i] - row[i])
        };
        [at(0), at(1), at(2), a[3]]
    }

    /// Two rows and where between, or beyond, them `x` is.
    fn find(&self, x: f64) -> (Value, Value, f64) {
        let Some(last) = self.rows.len().checked_sub(1) else { return ([0.0; 4], [0.0; 4], 0.0) };
        let share = divide(x - self.min, self.max - self.min);
        let at = share.clamp(0.0, 1.0) * last as f64;
        let beyond = if self.curves == Curves::Extrapolated { share * last as f64 - at } else { 0.0 };
        let i = (at as usize).min(last.saturating_sub(1));
        let t = match self.curves {
            Curves::Stepped => f64::from(u8::from(at as usize > i)),
            _ => at - i as f64 + beyond,
        };
        (self.rows[i], self.rows[(i + 1).min(last)], t)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::Function;
    use super::*;

    #[test]
    fn ranges_have_their_closed_forms() {
        let at = |range: Range, clamp: bool, x: f64, from: [f64; 2], to: [f64; 2]| {
            let args = [x, from[0], from[1], to[0], to[1], 4.0].map(|x| [x; 4]);
            Function::MapRange { range, clamp, vector: false }.eval(&args)[0]
        };
        assert_eq!(at(Range::Linear, false, 3.0, [0.0, 2.0], [10.0, 20.0]), 25.0);
        assert_eq!(at(Range::Linear, true, 3.0, [0.0, 2.0], [10.0, 20.0]), 20.0);
        assert_eq!(at(Range::Linear, true, 3.0, [0.0, 2.0], [20.0, 10.0]), 10.0);
        assert_eq!(at(Range::Linear, false, 3.0, [2.0, 2.0], [10.0, 20.0]), 0.0);
        assert_eq!(at(Range::Stepped, false, 0.5, [0.0, 1.0], [0.0, 1.0]), 0.5);
        assert_eq!(at(Range::Stepped, false, 0.39, [0.0, 1.0], [0.0, 1.0]), 0.25);
        assert_eq!(at(Range::Smooth, false, 0.25, [0.0, 1.0], [0.0, 1.0]), 0.15625);
        assert_eq!(at(Range::Smooth, false, 0.25, [1.0, 0.0], [0.0, 1.0]), 0.84375);
        assert_eq!(at(Range::Smoother, false, 0.5, [0.0, 1.0], [0.0, 2.0]), 1.0);
        assert_eq!(at(Range::Smoother, false, 9.0, [0.0, 1.0], [0.0, 2.0]), 2.0);
        let vector = Function::MapRange { range: Range::Linear, clamp: false, vector: true };
        let empty = [[3.0; 4], [2.0; 4], [2.0; 4], [10.0; 4], [20.0; 4]];
        assert_eq!(vector.eval(&empty), [10.0; 4]);
    }

    fn ramp(kind: RampKind) -> Function {
        let color = |x: f64| [x, 1.0 - x, 0.5, 1.0];
        Function::Ramp(Arc::new(Ramp { stops: vec![(0.2, color(0.0)), (0.6, color(1.0)), (0.8, color(0.5))], kind }))
    }

    /// Red of `ColorRamp.evaluate` of bpy 5.0.1 at 0, 0.1, … 1 for these stops, to six digits.
    #[test]
    fn ramps_are_those_of_blender() {
        for (kind, expected) in [
            (RampKind::Constant, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.5, 0.5, 0.5]),
            (RampKind::Linear, [0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 0.75, 0.5, 0.5, 0.5]),
            (RampKind::Ease, [0.0, 0.0, 0.0, 0.15625, 0.5, 0.84375, 1.0, 0.75, 0.5, 0.5, 0.5]),
            (RampKind::Cardinal, [0.0, 0.0, 0.0, 0.239453, 0.544375, 0.827109, 1.0, 0.83875, 0.5, 0.455625, 0.5]),
            (
                RampKind::BSpline,
                [0.0, 0.020833, 0.166667, 0.316406, 0.489583, 0.647135, 0.75, 0.729167, 0.583333, 0.510417, 0.5],
            ),
        ] {
            for (i, expected) in expected.iter().enumerate() {
                let got = ramp(kind).eval(&[[i as f64 / 10.0; 4]])[0];
                assert!((got - expected).abs() < 1e-6, "{kind:?} at {i}: {got}");
            }
        }
    }

    #[test]
    fn a_ramp_of_one_stop_or_none() {
        let one = Ramp { stops: vec![(0.5, [0.1, 0.2, 0.3, 0.4])], kind: RampKind::BSpline };
        assert_eq!(one.at(0.9), [0.1, 0.2, 0.3, 0.4]);
        assert_eq!(Ramp { stops: Vec::new(), kind: RampKind::Linear }.at(0.5), [0.0; 4]);
        // Two stops at one place.
        let twice = Ramp { stops: vec![(0.5, [0.0; 4]), (0.5, [1.0; 4])], kind: RampKind::Linear };
        assert_eq!((twice.at(0.4), twice.at(0.5)), ([0.0; 4], [1.0; 4]));
    }

    #[test]
    fn tables_blend_step_and_go_on() {
        let rows: Vec<Value> = [0.0, 1.0, 4.0].map(|x| [x, 2.0 * x, 0.0, 1.0]).to_vec();
        let at = |curves: Curves, x: f64| Table { min: -1.0, max: 1.0, rows: rows.clone(), curves }.row(x)[0];
        assert_eq!((at(Curves::Clamped, -0.5), at(Curves::Clamped, 0.5), at(Curves::Clamped, 9.0)), (0.5, 2.5, 4.0));
        assert_eq!((at(Curves::Stepped, -0.1), at(Curves::Stepped, 0.9), at(Curves::Stepped, 1.0)), (0.0, 1.0, 4.0));
        assert_eq!((at(Curves::Extrapolated, 2.0), at(Curves::Extrapolated, -2.0)), (7.0, -1.0));
        let table = Table { min: -1.0, max: 1.0, rows: rows.clone(), curves: Curves::Clamped };
        assert_eq!(Function::Curves(Arc::new(table)).eval(&[[1.0, 0.0, 7.0, 0.5]]), [4.0, 2.0, 0.0, 0.5]);
        let empty = Table { min: 0.0, max: 0.0, rows: Vec::new(), curves: Curves::Clamped };
        assert_eq!(empty.row(0.5), [0.0; 4]);
    }
}
