//! How points and instances move by their velocities (UsdGeomPointBased, UsdGeomPointInstancer).

use openusd::gf::Vec3f;
use openusd::usd::{Attribute, Prim, TimeCode};

use super::retime::Retime;
use super::stage::Reading;
use crate::math::DVec3;

/// What an array does from its last sample on.
pub(super) struct Flow {
    /// Time of that sample.
    pub from: TimeCode,
    /// Change per second.
    rates: Vec<Vec3f>,
    /// Change of that per second.
    gains: Option<Vec<Vec3f>>,
    /// Seconds of a time code.
    second: f64,
}

impl Flow {
    /// That of `array`, of which there are `count`, by the velocities `rates` and, where there are any, the
    /// accelerations `gains`. They count where the samples around the frame are at the times of those of the
    /// array, and are as many; that they do not is told.
    pub fn of(
        reading: &Reading<'_>,
        prim: &Prim,
        array: &str,
        rates: &str,
        gains: Option<&str>,
        count: usize,
    ) -> Option<Self> {
        let around = |name: &str| around(reading, &prim.attribute(name), reading.time);
        // Without a frame nothing has passed since the first sample.
        let moves = !reading.time.is_earliest_time();
        let Some(positions) = moves.then(|| around(array)).flatten() else {
            for name in [Some(rates), gains].into_iter().flatten() {
                let values: Vec<Vec3f> = reading.value(prim, name).unwrap_or_default();
                if !values.is_empty() && values.len() != count {
                    tell_of_count(reading, prim, name, values.len(), array, count);
                }
            }
            return None;
        };
        let values = |name: &str| {
            let samples = around(name);
            let from = samples.map_or(reading.time, |[from, ..]| TimeCode::new(from));
            let values: Vec<Vec3f> = reading.value_of(&prim.attribute(name), from)?;
            if values.is_empty() {
                return None;
            }
            let is_close = |(a, b): (&f64, &f64)| (a - b).abs() < f64::EPSILON;
            if !samples.is_some_and(|samples| samples.iter().zip(&positions).all(is_close)) {
                let what = format!("the samples of its {name} are not at the times of those of its {array}");
                reading.warn(prim.path(), format!("{what}; they are left out"));
                return None;
            }
            if values.len() != count {
                tell_of_count(reading, prim, name, values.len(), array, count);
                return None;
            }
            Some(values)
        };
        let rates = values(rates)?;
        let second = 1.0 / reading.stage.time_codes_per_second();
        let gains = gains.and_then(values);
        second.is_finite().then(|| Self { from: TimeCode::new(positions[0]), rates, gains, second })
    }

    /// Seconds from the sample to `time`.
    fn seconds(&self, time: TimeCode) -> f64 {
        (time.value() - self.from.value()) * self.second
    }

    /// By how much element `i` changes up to `time`.
    pub fn change(&self, i: usize, time: TimeCode) -> DVec3 {
        let seconds = self.seconds(time);
        let gained = self.gains.as_ref().map_or(DVec3::ZERO, |gains| 0.5 * seconds * vector(gains[i]));
        seconds * (vector(self.rates[i]) + gained)
    }
}

fn tell_of_count(reading: &Reading<'_>, prim: &Prim, name: &str, have: usize, array: &str, count: usize) {
    reading.warn(prim.path(), format!("has {have} {name} for {count} {array}; they are left out"));
}

/// Times of the sample of `attribute` that counts at `time` and of those around it: a sample at `time` itself
/// counts as that before. `None` where there are none.
fn around(reading: &Reading<'_>, attribute: &Attribute, time: TimeCode) -> Option<[f64; 3]> {
    let retime = Retime::of(reading, attribute);
    let bracket = |time| {
        let asked = retime.map_or(time, |retime| retime.asked(time));
        let (from, after) = attribute.bracketing_time_samples(asked).ok().flatten()?;
        Some(retime.map_or((from, after), |retime| (retime.told(from), retime.told(after))))
    };
    let (from, after) = bracket(time)?;
    if (from - after).abs() >= f64::EPSILON {
        return Some([from, from, after]);
    }
    // OpenUSD's smallest step that survives layers being shifted and stretched.
    const STEP: f64 = f64::EPSILON * 1e6 * 10.0 * 2.0;
    let (before, after) = bracket(TimeCode::new(time.value() + STEP))?;
    Some([from, before, after])
}

/// The time of the sample of `attribute` that counts at `time`; `time` itself where there are no samples.
pub(super) fn last_sample(reading: &Reading<'_>, attribute: &Attribute, time: TimeCode) -> TimeCode {
    around(reading, attribute, time).map_or(time, |[from, ..]| TimeCode::new(from))
}

pub(super) fn vector(v: Vec3f) -> DVec3 {
    DVec3::new(v.x.into(), v.y.into(), v.z.into())
}
