//! The cells around a place, without those whose points are too far to matter.
//!
//! Cells come in Cycles' order, since ties and blends depend on it; what is left out could not have
//! changed the result by a bit.

use super::VoronoiMetric;
use super::metric::Metric;

/// Steps to a side, at most.
const MOST: usize = 2;

/// How far each slab of cells is from a place.
pub struct Near {
    /// By axis and step, from -2 to 2: least distance along the axis, in the metric's rank.
    gaps: [[f32; 2 * MOST + 1]; 4],
    max: bool,
}

impl Near {
    /// Around `inside`, from a cell's corner; points stray from their corners by up to `randomness`.
    pub fn new<const N: usize>(inside: [f32; N], randomness: f32, metric: Metric) -> Self {
        /// More than rounding can make a gap too large.
        const ROUNDING: f32 = 1e-6;
        let mut gaps = [[0.0; 2 * MOST + 1]; 4];
        for (gaps, x) in gaps.iter_mut().zip(inside) {
            for (i, gap) in gaps.iter_mut().enumerate() {
                let corner = i as f32 - MOST as f32;
                let away = (corner - x).max(x - corner - randomness) - ROUNDING;
                *gap = match metric.kind {
                    VoronoiMetric::Euclidean => away.max(0.0) * away.max(0.0),
                    VoronoiMetric::Manhattan | VoronoiMetric::Chebychev => away.max(0.0),
                    // Rank does not grow with distance for every exponent: no cell is left out.
                    VoronoiMetric::Minkowski => 0.0,
                };
            }
        }
        Self { gaps, max: metric.kind == VoronoiMetric::Chebychev }
    }

    /// Visits cells up to `reach` steps away, the first axis fastest. Those whose points all rank above
    /// the limit are left out; `visit` returns the limit from there on.
    pub fn for_each<const N: usize>(&self, reach: i32, limit: f32, mut visit: impl FnMut([i32; N]) -> f32) {
        let range = |axis| if axis < N { -reach..=reach } else { 0..=0 };
        let add = |rank: f32, axis: usize, step: i32| {
            let gap = self.gaps[axis][(step + MOST as i32) as usize];
            if self.max { rank.max(gap) } else { rank + gap }
        };
        let mut limit = slack(limit);
        for w in range(3) {
            let rank_w = if N > 3 { add(0.0, 3, w) } else { 0.0 };
            if rank_w > limit {
                continue;
            }
            for z in range(2) {
                let rank_z = if N > 2 { add(rank_w, 2, z) } else { 0.0 };
                if rank_z > limit {
                    continue;
                }
                for y in range(1) {
                    let rank_y = if N > 1 { add(rank_z, 1, y) } else { 0.0 };
                    if rank_y > limit {
                        continue;
                    }
                    for x in range(0) {
                        if add(rank_y, 0, x) <= limit {
                            limit = slack(visit(std::array::from_fn(|axis| [x, y, z, w][axis])));
                        }
                    }
                }
            }
        }
    }
}

/// A limit widened by more than rounding can make a rank too large.
fn slack(limit: f32) -> f32 {
    limit * 1.000_01
}
