//! What one octave measures.

use super::cells::{Cells, steps};
use super::metric::{Metric, dot};
use super::near::Near;
use crate::texture::procedural::hash::unit;
use crate::texture::procedural::round::{mix, smoothstep};

/// The point that an octave found.
#[derive(Clone, Copy)]
pub struct Found<const N: usize> {
    pub distance: f32,
    pub color: [f32; 3],
    pub position: [f32; N],
}

impl<const N: usize> Found<N> {
    fn new<const PCG: bool, const COLOR: bool>(
        cells: &Cells<N, PCG>,
        distance: f32,
        step: [i32; N],
        point: [f32; N],
    ) -> Self {
        let color = if COLOR { cells.color(step) } else { [0.0; 3] };
        Self { distance, color, position: std::array::from_fn(|axis| point[axis] + cells.corner[axis]) }
    }
}

/// The closest point.
pub fn f1<const N: usize, const PCG: bool, const COLOR: bool>(cells: &Cells<N, PCG>, metric: Metric) -> Found<N> {
    let (step, point) = closest(cells, metric);
    Found::new::<PCG, COLOR>(cells, metric.distance(point, cells.inside), step, point)
}

/// The closest point and its cell.
fn closest<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>, metric: Metric) -> ([i32; N], [f32; N]) {
    let (mut least, mut found, mut point) = (f32::MAX, [0; N], [0.0; N]);
    if N < 3 {
        for step in steps() {
            let at = cells.point(step);
            let rank = metric.rank(at, cells.inside);
            if rank < least {
                (least, found, point) = (rank, step, at);
            }
        }
        return (found, point);
    }
    // Many cells: the own one's point bounds the distance from the start.
    let own = metric.rank(cells.point([0; N]), cells.inside);
    Near::new(cells.inside, cells.randomness, metric).for_each(1, own, |step| {
        let at = cells.point(step);
        let rank = metric.rank(at, cells.inside);
        if rank < least {
            (least, found, point) = (rank, step, at);
        }
        least.min(own)
    });
    (found, point)
}

/// The second closest point.
pub fn f2<const N: usize, const PCG: bool, const COLOR: bool>(cells: &Cells<N, PCG>, metric: Metric) -> Found<N> {
    let mut first = (f32::MAX, [0; N], [0.0; N]);
    let mut second = first;
    for step in steps() {
        let at = cells.point(step);
        let distance = metric.distance(at, cells.inside);
        if distance < first.0 {
            second = first;
            first = (distance, step, at);
        } else if distance < second.0 {
            second = (distance, step, at);
        }
    }
    Found::new::<PCG, COLOR>(cells, second.0, second.1, second.2)
}

/// The closest point, blended with the others where distances are nearly equal.
pub fn smooth_f1<const N: usize, const PCG: bool, const COLOR: bool>(
    cells: &Cells<N, PCG>,
    metric: Metric,
    smoothness: f32,
) -> Found<N> {
    let (mut distance, mut color, mut position) = (0.0, [0.0; 3], [0.0; N]);
    let mut any = false;
    Near::new(cells.inside, cells.randomness, metric).for_each(2, f32::INFINITY, |step| {
        let at = cells.point(step);
        let to_point = metric.distance(at, cells.inside);
        let h = if any { smoothstep(0.5 + 0.5 * (distance - to_point) / smoothness) } else { 1.0 };
        any = true;
        // Nothing changes with a weight of 0, as of all points further than this by the smoothness.
        if h != 0.0 {
            let lower = smoothness * h * (1.0 - h);
            distance = mix(distance, to_point, h) - lower;
            let lower = lower / (1.0 + 3.0 * smoothness);
            if COLOR {
                let other = cells.color(step);
                color = std::array::from_fn(|c| mix(color[c], other[c], h) - lower);
            }
            position = std::array::from_fn(|axis| mix(position[axis], at[axis], h) - lower);
        }
        metric.rank_of(distance + smoothness)
    });
    Found { distance, color, position: std::array::from_fn(|axis| cells.corner[axis] + position[axis]) }
}

/// Cells up to one step away, in four dimensions.
const MOST_CELLS: usize = 81;

/// Distance to the nearest of the planes half way between the closest point and its neighbours.
pub fn distance_to_edge<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    if N == 1 {
        return distance_to_edge_1d(cells);
    }
    // All points as seen from the place, and the closest of them.
    let mut points = [[0.0; N]; MOST_CELLS];
    let (mut least, mut closest) = (f32::MAX, [0.0; N]);
    for (seen, step) in points.iter_mut().zip(steps()) {
        let at = cells.point(step);
        let away: [f32; N] = std::array::from_fn(|axis| at[axis] - cells.inside[axis]);
        let rank = dot(away, away);
        if rank < least {
            (least, closest) = (rank, away);
        }
        *seen = away;
    }
    let mut nearest = f32::MAX;
    for away in &points[..3_usize.pow(N as u32)] {
        let across: [f32; N] = std::array::from_fn(|axis| away[axis] - closest[axis]);
        let length_squared = dot(across, across);
        // The point itself has no edge with itself.
        if length_squared > 0.000_1 {
            let middle: [f32; N] = std::array::from_fn(|axis| (closest[axis] + away[axis]) / 2.0);
            nearest = nearest.min(dot(middle, across) / length_squared.sqrt());
        }
    }
    nearest
}

/// On a line, the middles between the cell's own point and its two neighbours.
fn distance_to_edge_1d<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    let [left, right] = [-1, 1].map(|step| cells.point([step; N])[0]);
    // Not by a step of 0, which would turn -0 into 0: their hashes differ, and Cycles takes -0's.
    let own = unit([cells.corner[0]]) * cells.randomness;
    let to_middle = |other: f32| ((own + other) / 2.0 - cells.inside[0]).abs();
    to_middle(left).min(to_middle(right))
}

/// Half the distance between the closest point and the point closest to that.
pub fn n_sphere_radius<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    let (center, closest) = closest(cells, Metric::EUCLIDEAN);
    let mut least = f32::MAX;
    for step in steps() {
        if step != [0; N] {
            let at = cells.point(std::array::from_fn(|axis| step[axis] + center[axis]));
            least = least.min(Metric::EUCLIDEAN.rank(closest, at));
        }
    }
    least.sqrt() / 2.0
}
