//! Points at other times of the shutter.

use openusd::sdf::Value;
use openusd::usd::{Prim, TimeCode};

use super::super::skel::Deformer;
use super::super::stage::Reading;
use super::values::triples;
use crate::desc::Motion;

/// The points of `prim`, of which there are `count`, at the ends of `shutter` and at the samples between
/// them; the interval is in frames after the one that is read. Velocities come before samples, as in
/// UsdGeomPointBased::ComputePointsAtTime. Empty for points that stand still, and where their number
/// changes. What `deformer` deforms has no velocities: those are of the points as modelled.
pub(super) fn read(
    reading: &Reading<'_>,
    prim: &Prim,
    shutter: [f64; 2],
    count: usize,
    deformer: Option<&Deformer<'_>>,
) -> Vec<Motion<Vec<[f32; 3]>>> {
    let attribute = prim.attribute("points");
    let now = reading.time.value();
    let read = |time: f64| {
        let time = TimeCode::new(time);
        let value = attribute.get_at::<Value>(time).ok().flatten();
        let points = value.and_then(triples).filter(|points| points.len() == count)?;
        Some(match deformer {
            Some(deformer) => deformer.points(points, time),
            None => points,
        })
    };
    if deformer.is_none()
        && let Some(velocities) = reading.value::<Value>(prim, "velocities").and_then(triples)
        && velocities.len() == count
        && let Some(points) = read(now)
    {
        let seconds = 1.0 / reading.stage.time_codes_per_second();
        let at = |frame: f64| {
            let dt = (frame * seconds) as f32;
            let moved = points.iter().zip(&velocities).map(|(p, v)| std::array::from_fn(|i| p[i] + dt * v[i]));
            Motion { time: frame, value: moved.collect() }
        };
        return shutter.map(at).into();
    }
    let [open, close] = shutter.map(|frame| now + frame);
    let deforms = deformer.and_then(|deformer| deformer.samples(open, close));
    if deforms.is_none() && !attribute.value_might_be_time_varying().unwrap_or(false) {
        return Vec::new();
    }
    let mut times = attribute.time_samples_in_interval(open..=close).unwrap_or_default();
    times.extend(deforms.into_iter().flatten());
    times.extend([open, close]);
    times.sort_by(f64::total_cmp);
    times.dedup();
    let motion: Option<Vec<_>> =
        times.iter().map(|&time| read(time).map(|value| Motion { time: time - now, value })).collect();
    motion.unwrap_or_else(|| {
        reading.warn(attribute.path(), "the number of points changes within the shutter; they stand still");
        Vec::new()
    })
}
