//! Points at other times of the shutter.

use openusd::sdf::Value;
use openusd::usd::{Attribute, Prim, TimeCode};

use super::super::flow::Flow;
use super::super::retime;
use super::super::skel::Deformer;
use super::super::stage::Reading;
use super::values::triples;
use crate::desc::Motion;
use crate::math::DVec3;

/// Where the points of `prim` are at the frame, which their attribute `points` has at it: moved on by velocities
/// from the last sample, as UsdGeomPointBased::ComputePointsAtTime does. `None` where there are no velocities.
pub(super) fn flowing(reading: &Reading<'_>, prim: &Prim, count: usize) -> Option<Flowing> {
    let flow = Flow::of(reading, prim, "points", "velocities", Some("accelerations"), count)?;
    let points = reading.value_of::<Value>(&prim.attribute("points"), flow.from).and_then(triples)?;
    (points.len() == count).then_some(Flowing { points, flow })
}

/// Points that velocities move.
pub(super) struct Flowing {
    points: Vec<[f32; 3]>,
    flow: Flow,
}

impl Flowing {
    pub fn at(&self, time: TimeCode) -> Vec<[f32; 3]> {
        let moved = |(i, point): (usize, &[f32; 3])| DVec3::from(point.map(f64::from)) + self.flow.change(i, time);
        self.points.iter().enumerate().map(moved).map(|point| point.as_vec3().into()).collect()
    }
}

/// The points of `prim`, of which there are `count`, at the ends of `shutter` and at the samples between
/// them; the interval is in frames after the one that is read. Velocities come before samples. Empty for
/// points that stand still, and where their number changes. What `deformer` deforms has no velocities: those are
/// of the points as modelled. Where the attribute `beside` changes there are keys at its samples, too, though the
/// points stand still.
pub(super) fn read(
    reading: &Reading<'_>,
    prim: &Prim,
    shutter: [f64; 2],
    count: usize,
    deformer: Option<&Deformer<'_>>,
    beside: Option<&Attribute>,
) -> Vec<Motion<Vec<[f32; 3]>>> {
    let attribute = prim.attribute("points");
    let beside = beside.filter(|attribute| varies(attribute));
    let now = reading.time.value();
    let [open, close] = shutter.map(|frame| now + frame);
    let deforms = deformer.and_then(|deformer| deformer.samples(open, close));
    if deformer.is_none()
        && let Some(flowing) = flowing(reading, prim, count)
    {
        let mut times = retime::samples(reading, beside.map_or(&[], std::slice::from_ref), open, close);
        times.extend([open, close]);
        let key = |time: f64| Motion { time: time - now, value: flowing.at(TimeCode::new(time)) };
        return in_order(times).into_iter().map(key).collect();
    }
    if deforms.is_none() && beside.is_none() && !varies(&attribute) {
        return Vec::new();
    }
    let read = |time: f64| {
        let time = TimeCode::new(time);
        let points = reading.value_of::<Value>(&attribute, time).and_then(triples);
        let points = points.filter(|points| points.len() == count)?;
        Some(match deformer {
            Some(deformer) => deformer.points(points, time),
            None => points,
        })
    };
    let sampled: Vec<Attribute> = std::iter::once(&attribute).chain(beside).cloned().collect();
    let mut times = retime::samples(reading, &sampled, open, close);
    times.extend(deforms.into_iter().flatten());
    times.extend([open, close]);
    let times = in_order(times);
    let motion: Option<Vec<_>> =
        times.iter().map(|&time| read(time).map(|value| Motion { time: time - now, value })).collect();
    motion.unwrap_or_else(|| {
        reading.warn(attribute.path(), "the number of points changes while they move; they stand still");
        Vec::new()
    })
}

/// True for what may have another value at another time.
pub(super) fn varies(attribute: &Attribute) -> bool {
    attribute.value_might_be_time_varying().unwrap_or(false)
}

/// Times as they follow each other, each once.
fn in_order(mut times: Vec<f64>) -> Vec<f64> {
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
