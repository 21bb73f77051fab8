//! What the error of a render will be: a power of the samples, fitted to what it was.
//!
//! Independent samples have an error of n^-½, low-discrepancy samples of smooth light up to n^-3/2; a picture, which
//! has both, lies between, near the slower one at last.

use crate::film::{Accuracy, Figure, REPLICATES};

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
    checks: Vec<Check>,
    /// Samples per pixel and seconds of the first mark and the last.
    marks: Option<[(f64, f64); 2]>,
}

impl Forecast {
    pub(super) fn new(target: Option<f64>, uneven: bool) -> Self {
        Self { target, uneven, checks: Vec::new(), marks: None }
    }

    /// Takes in how many samples per pixel there are after so many seconds.
    pub(super) fn mark(&mut self, spp: f64, seconds: f64) {
        self.marks = Some([self.marks.map_or((spp, seconds), |[first, _]| first), (spp, seconds)]);
    }

    /// Takes in what a check gave after so many samples per pixel. Doubt ends what was known.
    pub(super) fn note(&mut self, accuracy: &Accuracy, spp: f64) {
        match accuracy.display {
            Ok(error) => self.checks.push(Check { spp, error }),
            Err(_) => self.checks.clear(),
        }
    }

    /// True where the target is reached.
    pub(super) fn is_reached(&self) -> bool {
        self.checks.last().zip(self.target).is_some_and(|(check, target)| check.error.value <= target)
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

    /// The last check of the trend, or the last of all.
    fn base(&self) -> Option<&Check> {
        self.trend().next_back().or(self.checks.last())
    }

    /// Samples per pixel at which the target is reached, by the fit: `z` standard deviations later.
    fn spp_at_target(&self, z: f64) -> Option<f64> {
        let ((base, last), target) = (self.base().zip(self.checks.last())?, self.target?);
        if last.error.value <= target {
            return Some(last.spp);
        }
        let (exponent, sd) = self.exponent();
        let exponent = exponent.max(0.1);
        let fall = (base.error.value / target).max(1.0).ln();
        let of_base = (base.error.high / base.error.low).ln() / (2.0 * Z95) / exponent;
        let spread = of_base.hypot(fall * sd / (exponent * exponent));
        Some((base.spp * (fall / exponent + z * spread).exp()).max(last.spp))
    }

    /// Seconds after which a render has so many samples per pixel: what starts slowly is not carried on.
    fn seconds_at(&self, spp: f64) -> f64 {
        let Some([first, last]) = self.marks else { return 0.0 };
        let since = last.0 - first.0;
        let rate = if since > 0.0 { (last.1 - first.1) / since } else { last.1 / last.0.max(1e-9) };
        last.1 + rate * (spp - last.0)
    }

    /// Samples per pixel, the mean, after which to look again: at powers of two and half way between, or a little
    /// beyond where the target seems to be.
    pub(super) fn next_check(&self, spp: f64) -> u32 {
        let first = super::FIRST_CHECK;
        if spp < f64::from(first) {
            // Half way there is a mark.
            return if spp < f64::from(first / 2) { first / 2 } else { first };
        }
        let up = |spp: f64| (spp / REPLICATES as f64).ceil() as u32 * REPLICATES as u32;
        let power = (spp + 1.0).log2().floor().exp2();
        let between = if power >= 2.0 * f64::from(first) { 1.5 * power } else { 2.0 * power };
        let regular = if spp + 1.0 < between { between } else { 2.0 * power };
        let target = self.spp_at_target(0.0).map_or(u32::MAX, |target| up(target * 1.02));
        up(regular).min(target).max(up(spp + REPLICATES as f64))
    }

    /// What is to be told, for a render that samples end at `end_spp` and time at `end_seconds`.
    pub(super) fn outlook(&self, end_spp: Option<f64>, end_seconds: Option<f64>) -> Outlook {
        let target = self.target;
        let Some(check) = self.checks.last() else {
            return Outlook { error: None, at_end: None, target, target_at: None };
        };
        let base = self.base().unwrap_or(check);
        let exponent = self.exponent().0.max(0.1);
        let rate = self.seconds_at(check.spp + 1.0) - self.seconds_at(check.spp);
        let left = |end: f64| (end - self.seconds_at(check.spp)).max(0.0) / rate.max(1e-12);
        let by_time = end_seconds.map(|end| check.spp + left(end));
        let end = [end_spp, by_time].into_iter().flatten().min_by(f64::total_cmp);
        let at_end = end.map(|end| match end > check.spp {
            true => (base.error.value * (base.spp / end).powf(exponent)).min(check.error.value),
            false => check.error.value,
        });
        let at = |z: f64| self.spp_at_target(z).map_or(0.0, |spp| self.seconds_at(spp));
        let target_at = target.map(|_| [0.0, -Z80, Z80].map(at));
        Outlook { error: Some(check.error.value), at_end, target, target_at }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Doubt;

    fn accuracy(error: f64) -> Accuracy {
        let figure = Ok(Figure { value: error, low: error * 0.97, high: error / 0.97 });
        Accuracy { rmse: figure, rel_mse: figure, display: figure }
    }

    /// Checks of a render whose error falls with this exponent, half a second a sample.
    fn forecast(exponent: f64, target: f64) -> Forecast {
        let mut forecast = Forecast::new(Some(target), false);
        for spp in [16.0_f64, 32.0, 48.0, 64.0] {
            // A second of start, and half a second a sample.
            forecast.mark(spp, 1.0 + 0.5 * spp);
            // Between powers of two the points are not at their best.
            let worse = if spp == 48.0 { 1.1 } else { 1.0 };
            forecast.note(&accuracy(worse * spp.powf(-exponent)), spp);
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
        assert_eq!(forecast(0.5, 1e-3).outlook(None, None).at_end, None);
    }

    #[test]
    fn checks_are_at_powers_of_two_and_between_and_meet_the_target() {
        let open = Forecast::new(None, false);
        assert_eq!(
            [0.0, 8.0, 16.0, 24.0, 32.0, 48.0, 63.9, 96.0].map(|spp| open.next_check(spp)),
            [8, 16, 32, 32, 48, 64, 96, 128]
        );
        let near = forecast(0.6, 75.0_f64.powf(-0.6));
        assert_eq!(near.next_check(64.0), 80);
        assert!(!near.is_reached() && forecast(0.5, 0.13).is_reached());
    }

    #[test]
    fn doubt_reaches_no_target() {
        let mut forecast = forecast(0.5, 1.0);
        assert!(forecast.is_reached());
        forecast.note(&Accuracy { display: Err(Doubt::HeavyTail), ..accuracy(0.1) }, 96.0);
        assert!(!forecast.is_reached());
        assert_eq!(forecast.outlook(Some(128.0), None).error, None);
    }

    #[test]
    fn a_picture_without_error_is_there_at_once() {
        let mut forecast = Forecast::new(Some(0.01), false);
        let zero = Ok(Figure { value: 0.0, low: 0.0, high: 0.0 });
        forecast.mark(16.0, 1.0);
        forecast.note(&Accuracy { rmse: zero, rel_mse: zero, display: zero }, 16.0);
        assert!(forecast.is_reached());
        assert_eq!(forecast.outlook(None, None).target_at, Some([1.0; 3]));
    }
}
