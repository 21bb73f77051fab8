//! What the error of a render will be: a power of the samples, fitted to what it was.
//!
//! Independent samples have an error of n^-½, low-discrepancy samples of smooth light up to n^-3/2; a picture, which
//! has both, lies between, near the slower one at last.

use std::io::{self, Read, Write};

use crate::film::{Doubt, Figure, REPLICATES};

/// Exponent that pictures have on the way to a fifth of their first error, and its standard deviation.
const EXPONENT: (f64, f64) = (0.62, 0.05);

/// What the exponent changes by on the way, which no fit shows: the light that is smooth is done first.
const DRIFT: f64 = 0.05;

/// So many of the last checks are fitted.
const FITTED: usize = 4;

/// Half widths of a normal distribution's 10 to 90 % and 95 % intervals.
const Z80: f64 = 1.281_552;
const Z95: f64 = 1.959_964;

/// How the error goes on, in units of the display's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlook {
    /// At the last check; `None` while it can't be told.
    pub error: Option<f64>,
    /// At the end that samples or time set; `None` where there is none, or nothing is known.
    pub at_end: Option<f64>,
    /// Where it is to be.
    pub target: Option<f64>,
    /// Seconds from the start of the render to the target: the likely ones, and those that one in ten renders
    /// stays below and nine in ten stay below.
    pub target_at: Option<[f64; 3]>,
}

/// A check: samples per pixel, the picture's mean, and the error then.
#[derive(Clone, Copy, Debug)]
struct Check {
    spp: f64,
    error: Figure,
}

/// The checks of a render.
#[derive(Clone, Debug)]
pub(super) struct Forecast {
    target: Option<f64>,
    /// True where pixels have different numbers of samples.
    uneven: bool,
    /// Those at the steps that every render takes, whatever its target.
    checks: Vec<Check>,
    /// The last of all.
    latest: Option<Check>,
    /// Samples per pixel and seconds of the first mark and the last.
    marks: Option<[(f64, f64); 2]>,
}

/// The first number of samples per pixel after `spp` at which every render looks at its error: powers of two, and half
/// way between.
pub(super) fn step_after(spp: u32) -> u32 {
    let first = super::FIRST_CHECK;
    if spp < first {
        return first;
    }
    let power = 1 << spp.ilog2();
    if spp < power + power / 2 && power > first { power + power / 2 } else { power.saturating_mul(2) }
}

impl Forecast {
    pub(super) fn new(target: Option<f64>, uneven: bool) -> Self {
        Self { target, uneven, checks: Vec::new(), latest: None, marks: None }
    }

    /// Takes in how many samples per pixel there are after so many seconds.
    pub(super) fn mark(&mut self, spp: f64, seconds: f64) {
        self.marks = Some([self.marks.map_or((spp, seconds), |[first, _]| first), (spp, seconds)]);
    }

    /// Takes in what a check gave after so many samples per pixel, at a step or between two. Doubt ends what was known.
    pub(super) fn note(&mut self, display: Result<Figure, Doubt>, spp: f64, is_step: bool) {
        self.latest = display.ok().map(|error| Check { spp, error });
        match self.latest {
            Some(check) if is_step => self.checks.push(check),
            None if is_step => self.checks.clear(),
            _ => {}
        }
    }

    /// True where the target is reached.
    pub(super) fn is_reached(&self) -> bool {
        self.latest.zip(self.target).is_some_and(|(check, target)| check.error.value <= target)
    }

    /// The checks that make a trend: between powers of two point sets are not at their best, where all pixels have as
    /// many samples.
    fn trend(&self) -> impl DoubleEndedIterator<Item = &Check> {
        self.checks.iter().filter(|check| self.uneven || check.spp.log2().fract() == 0.0)
    }

    /// The exponent of the error's fall, and the standard deviation of what it is taken to be.
    fn exponent(&self) -> (f64, f64) {
        let (prior, sd) = EXPONENT;
        let known = self.trend().rev().take(FITTED).filter(|check| check.error.value > 0.0);
        let points: Vec<[f64; 3]> = known
            .map(|Check { spp, error }| {
                // The interval is that of the picture's own error; the estimate by itself is surer.
                let spread = (error.high / error.low).ln() / (2.0 * Z95) / (REPLICATES as f64).sqrt();
                [spp.ln(), error.value.ln(), spread.max(1e-3).powi(-2)]
            })
            .collect();
        let sum = |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(of).sum::<f64>();
        let weight = sum(&|p| p[2]);
        if points.len() < 2 || weight <= 0.0 {
            return (prior, sd);
        }
        let (x, y) = (sum(&|p| p[2] * p[0]) / weight, sum(&|p| p[2] * p[1]) / weight);
        let spread = sum(&|p| p[2] * (p[0] - x).powi(2));
        let slope = -sum(&|p| p[2] * (p[0] - x) * (p[1] - y));
        if spread <= 0.0 {
            return (prior, sd);
        }
        let (fitted, trust) = (slope / spread, (spread.recip() + DRIFT * DRIFT).recip());
        let precision = trust + sd.powi(-2);
        ((fitted * trust + prior * sd.powi(-2)) / precision, precision.recip().sqrt())
    }

    /// The last check of the trend, or the last step.
    fn base(&self) -> Option<&Check> {
        self.trend().next_back().or(self.checks.last())
    }

    /// Samples per pixel at which the target is reached, by the fit to the steps: `z` standard deviations later.
    fn spp_at_target(&self, z: f64) -> Option<f64> {
        let (base, target) = self.base().zip(self.target)?;
        let (exponent, sd) = self.exponent();
        let exponent = exponent.max(0.1);
        let fall = (base.error.value / target).max(1.0).ln();
        let of_base = (base.error.high / base.error.low).ln() / (2.0 * Z95) / exponent;
        let spread = of_base.hypot(fall * sd / (exponent * exponent));
        Some(base.spp * (fall / exponent + z * spread).exp())
    }

    /// Seconds after which a render has so many samples per pixel: what starts slowly is not carried on.
    fn seconds_at(&self, spp: f64) -> f64 {
        let Some([first, last]) = self.marks else { return 0.0 };
        let since = last.0 - first.0;
        let rate = if since > 0.0 { (last.1 - first.1) / since } else { last.1 / last.0.max(1e-9) };
        last.1 + rate * (spp - last.0)
    }

    /// Samples per pixel, the mean, after which to look again on the way from one step to the next, `after` being that
    /// step or the last look: a little behind where the target seems to be, or the next step.
    ///
    /// It follows from steps and target alone, and looks for a smaller target are among those for a larger one: a
    /// render that goes on to a smaller target ends where one that had it from the start does.
    pub(super) fn next_check(&self, step: u32, after: u32) -> u32 {
        let next = step_after(step);
        let Some(target) = self.spp_at_target(0.0) else { return next };
        let grid = (step / 64).next_power_of_two().max(REPLICATES as u32);
        let look = (target * 1.02).max(f64::from(after) + 1.0) / f64::from(grid);
        (look.ceil() * f64::from(grid)).min(f64::from(next)) as u32
    }

    /// What is to be told, for a render that samples end at `end_spp` and time at `end_seconds`.
    pub(super) fn outlook(&self, end_spp: Option<f64>, end_seconds: Option<f64>) -> Outlook {
        let target = self.target;
        let Some(check) = self.latest else {
            return Outlook { error: None, at_end: None, target, target_at: None };
        };
        let base = self.base().unwrap_or(&check);
        let exponent = self.exponent().0.max(0.1);
        let rate = self.seconds_at(check.spp + 1.0) - self.seconds_at(check.spp);
        let left = |end: f64| (end - self.seconds_at(check.spp)).max(0.0) / rate.max(1e-12);
        let by_time = end_seconds.map(|end| check.spp + left(end));
        let end = [end_spp, by_time].into_iter().flatten().min_by(f64::total_cmp);
        let at_limit = end.map(|end| match end > check.spp {
            true => (base.error.value * (base.spp / end).powf(exponent)).min(check.error.value),
            false => check.error.value,
        });
        // What ends at its target goes no further.
        let by_target = target.map(|target| target.min(check.error.value));
        let at_end = match (at_limit, by_target) {
            (Some(at_limit), Some(by_target)) => Some(at_limit.max(by_target)),
            (at_limit, by_target) => at_limit.or(by_target),
        };
        let at = |z: f64| match self.is_reached() {
            true => self.seconds_at(check.spp),
            false => self.spp_at_target(z).map_or(0.0, |spp| self.seconds_at(spp.max(check.spp))),
        };
        let target_at = target.map(|_| [0.0, -Z80, Z80].map(at));
        Outlook { error: Some(check.error.value), at_end, target, target_at }
    }

    /// Writes what the steps gave.
    pub(super) fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(&(self.checks.len() as u64).to_le_bytes())?;
        let numbers =
            self.checks.iter().flat_map(|&Check { spp, error: Figure { value, low, high } }| [spp, value, low, high]);
        numbers.map(f64::to_le_bytes).try_for_each(|bytes| out.write_all(&bytes))
    }

    /// Takes it in again.
    pub(super) fn load(&mut self, from: &mut dyn Read) -> io::Result<()> {
        let mut number = || {
            let mut bytes = [0; 8];
            from.read_exact(&mut bytes).map(|()| bytes)
        };
        // There are two steps to each power of two.
        let count = u64::from_le_bytes(number()?).min(64);
        self.checks.clear();
        for _ in 0..count {
            let [spp, value, low, high] = [number()?, number()?, number()?, number()?].map(f64::from_le_bytes);
            self.checks.push(Check { spp, error: Figure { value, low, high } });
        }
        self.latest = self.checks.last().copied();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(error: f64) -> Result<Figure, Doubt> {
        Ok(Figure { value: error, low: error * 0.97, high: error / 0.97 })
    }

    /// Checks of a render whose error falls with this exponent, half a second a sample.
    fn forecast(exponent: f64, target: f64) -> Forecast {
        let mut forecast = Forecast::new(Some(target), false);
        for spp in [16.0_f64, 32.0, 48.0, 64.0] {
            // A second of start, and half a second a sample.
            forecast.mark(spp, 1.0 + 0.5 * spp);
            // Between powers of two the points are not at their best.
            let worse = if spp == 48.0 { 1.1 } else { 1.0 };
            forecast.note(figure(worse * spp.powf(-exponent)), spp, true);
        }
        forecast
    }

    #[test]
    fn powers_are_continued() {
        for exponent in [0.57, 0.62, 0.68] {
            let at = 640.0;
            let forecast = forecast(exponent, f64::powf(at, -exponent));
            let outlook = forecast.outlook(Some(256.0), Some(1e9));
            let [likely, low, high] = outlook.target_at.expect("known");
            let seconds = 1.0 + 0.5 * at;
            assert!((likely / seconds - 1.0).abs() < 0.15, "{exponent}: {likely}");
            assert!(low < seconds && seconds < high, "{exponent}: {low} to {high}");
            let end = outlook.at_end.expect("known");
            assert!((end / 256.0_f64.powf(-exponent) - 1.0).abs() < 0.05, "{exponent}: {end}");
        }
    }

    #[test]
    fn time_ends_what_samples_do_not() {
        let by_time = forecast(0.6, 1e-3).outlook(None, Some(129.0)).at_end.expect("known");
        assert!((by_time * 256.0_f64.powf(0.6) - 1.0).abs() < 0.05, "{by_time}");
        let open = Forecast { target: None, ..forecast(0.5, 1e-3) };
        assert_eq!(open.outlook(None, None).at_end, None);
    }

    /// A render that its target ends has that error then, however many samples it might take.
    #[test]
    fn a_target_ends_what_samples_and_time_would_not() {
        let target = 640.0_f64.powf(-0.6);
        let end = |spp: Option<f64>, seconds| forecast(0.6, target).outlook(spp, seconds).at_end.expect("known");
        assert_eq!([end(Some(1e6), None), end(None, Some(1e6)), end(None, None)], [target; 3]);
        assert!(end(Some(100.0), None) > 1.5 * target);
    }

    #[test]
    fn steps_are_powers_of_two_and_half_way_between() {
        let steps = std::iter::successors(Some(0), |&step| Some(step_after(step)));
        assert_eq!(steps.take(8).collect::<Vec<_>>(), [0, 16, 32, 48, 64, 96, 128, 192]);
        assert_eq!(step_after(3 << 30), u32::MAX);
    }

    #[test]
    fn looks_between_steps_meet_the_target_and_are_among_those_for_a_larger_one() {
        let looks = |target: f64| -> Vec<u32> {
            let forecast = forecast(0.6, target.powf(-0.6));
            let mut after = 64;
            std::iter::from_fn(|| {
                after = forecast.next_check(64, after);
                Some(after)
            })
            .take_while(|&after| after < 96)
            .collect()
        };
        assert_eq!(looks(75.0), [80, 88]);
        assert!(looks(200.0).is_empty());
        let all = looks(64.5);
        for target in 65..96 {
            let some = looks(f64::from(target));
            assert!(all.ends_with(&some), "{target}: {some:?}");
        }
        assert!(!forecast(0.6, 75.0_f64.powf(-0.6)).is_reached() && forecast(0.5, 0.13).is_reached());
    }

    #[test]
    fn what_steps_gave_comes_back() {
        let (forecast, mut bytes) = (forecast(0.6, 0.01), Vec::new());
        forecast.save(&mut bytes).expect("written");
        let mut other = Forecast::new(Some(0.01), false);
        other.load(&mut &*bytes).expect("read");
        other.marks = forecast.marks;
        assert_eq!(other.outlook(Some(999.0), None), forecast.outlook(Some(999.0), None));
        assert!(other.load(&mut &bytes[..40]).is_err());
    }

    #[test]
    fn doubt_reaches_no_target() {
        let mut forecast = forecast(0.5, 1.0);
        assert!(forecast.is_reached());
        forecast.note(Err(Doubt::HeavyTail), 96.0, true);
        assert!(!forecast.is_reached());
        assert_eq!(forecast.outlook(Some(128.0), None).error, None);
    }

    #[test]
    fn a_picture_without_error_is_there_at_once() {
        let mut forecast = Forecast::new(Some(0.01), false);
        let zero = Ok(Figure { value: 0.0, low: 0.0, high: 0.0 });
        forecast.mark(16.0, 1.0);
        forecast.note(zero, 16.0, true);
        assert!(forecast.is_reached());
        assert_eq!(forecast.outlook(None, None).target_at, Some([1.0; 3]));
    }
}
