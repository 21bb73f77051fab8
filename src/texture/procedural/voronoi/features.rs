//! What one octave measures.

use super::cells::{Cells, for_each_step};
use super::metric::{Metric, dot};
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
    let (mut least, mut step, mut point) = (f32::MAX, [0; N], [0.0; N]);
    for_each_step(1, |candidate| {
        let at = cells.point(candidate);
        let rank = metric.rank(at, cells.inside);
        if rank < least {
            (least, step, point) = (rank, candidate, at);
        }
    });
    Found::new::<PCG, COLOR>(cells, metric.distance(point, cells.inside), step, point)
}

/// The second closest point.
pub fn f2<const N: usize, const PCG: bool, const COLOR: bool>(cells: &Cells<N, PCG>, metric: Metric) -> Found<N> {
    let mut first = (f32::MAX, [0; N], [0.0; N]);
    let mut second = first;
    for_each_step(1, |candidate| {
        let at = cells.point(candidate);
        let distance = metric.distance(at, cells.inside);
        if distance < first.0 {
            second = first;
            first = (distance, candidate, at);
        } else if distance < second.0 {
            second = (distance, candidate, at);
        }
    });
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
    for_each_step(2, |step| {
        let at = cells.point(step);
        let to_point = metric.distance(at, cells.inside);
        let h = if any { smoothstep(0.5 + 0.5 * (distance - to_point) / smoothness) } else { 1.0 };
        any = true;
        let lower = smoothness * h * (1.0 - h);
        distance = mix(distance, to_point, h) - lower;
        let lower = lower / (1.0 + 3.0 * smoothness);
        if COLOR {
            let other = cells.color(step);
            color = std::array::from_fn(|c| mix(color[c], other[c], h) - lower);
        }
        position = std::array::from_fn(|axis| mix(position[axis], at[axis], h) - lower);
    });
    Found { distance, color, position: std::array::from_fn(|axis| cells.corner[axis] + position[axis]) }
}

/// Distance to the nearest of the planes half way between the closest point and its neighbours.
pub fn distance_to_edge<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    if N == 1 {
        return distance_to_edge_1d(cells);
    }
    let to_point = |step| -> [f32; N] {
        let at = cells.point(step);
        std::array::from_fn(|axis| at[axis] - cells.inside[axis])
    };
    let (mut least, mut closest) = (f32::MAX, [0.0; N]);
    for_each_step(1, |step| {
        let away = to_point(step);
        let rank = dot(away, away);
        if rank < least {
            (least, closest) = (rank, away);
        }
    });
    let mut nearest = f32::MAX;
    for_each_step(1, |step| {
        let away = to_point(step);
        let across: [f32; N] = std::array::from_fn(|axis| away[axis] - closest[axis]);
        let length_squared = dot(across, across);
        // The point itself has no edge with itself.
        if length_squared > 0.000_1 {
            let middle: [f32; N] = std::array::from_fn(|axis| (closest[axis] + away[axis]) / 2.0);
            nearest = nearest.min(dot(middle, across) / length_squared.sqrt());
        }
    });
    nearest
}

/// On a line, the middles between the cell's own point and its two neighbours.
fn distance_to_edge_1d<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    let [left, own, right] = [-1, 0, 1].map(|step| cells.point([step; N])[0]);
    let to_middle = |other: f32| ((own + other) / 2.0 - cells.inside[0]).abs();
    to_middle(left).min(to_middle(right))
}

/// Half the distance between the closest point and the point closest to that.
pub fn n_sphere_radius<const N: usize, const PCG: bool>(cells: &Cells<N, PCG>) -> f32 {
    let distance_squared = |a: [f32; N], b: [f32; N]| {
        let away: [f32; N] = std::array::from_fn(|axis| a[axis] - b[axis]);
        dot(away, away)
    };
    let (mut least, mut center, mut closest) = (f32::MAX, [0; N], [0.0; N]);
    for_each_step(1, |step| {
        let at = cells.point(step);
        let rank = distance_squared(at, cells.inside);
        if rank < least {
            (least, center, closest) = (rank, step, at);
        }
    });
    let (mut least, mut neighbor) = (f32::MAX, [0.0; N]);
    for_each_step(1, |step| {
        if step != [0; N] {
            let at = cells.point(std::array::from_fn(|axis| step[axis] + center[axis]));
            let rank = distance_squared(closest, at);
            if rank < least {
                (least, neighbor) = (rank, at);
            }
        }
    });
    distance_squared(neighbor, closest).sqrt() / 2.0
}
