//! Distances between points in one to four dimensions.

use super::VoronoiMetric;

/// How distance is measured.
#[derive(Clone, Copy)]
pub struct Metric {
    pub kind: VoronoiMetric,
    pub exponent: f32,
}

impl Metric {
    /// Distance from `a` to `b`.
    pub fn distance<const N: usize>(self, a: [f32; N], b: [f32; N]) -> f32 {
        let rank = self.rank(a, b);
        match self.kind {
            _ if N == 1 => rank,
            VoronoiMetric::Euclidean => rank.sqrt(),
            VoronoiMetric::Manhattan | VoronoiMetric::Chebychev => rank,
            VoronoiMetric::Minkowski => rank.powf(1.0 / self.exponent),
        }
    }

    /// What is smaller for a smaller distance, and cheaper.
    pub fn rank<const N: usize>(self, a: [f32; N], b: [f32; N]) -> f32 {
        let away: [f32; N] = std::array::from_fn(|axis| (a[axis] - b[axis]).abs());
        match self.kind {
            _ if N == 1 => away[0],
            VoronoiMetric::Euclidean => dot(away, away),
            VoronoiMetric::Manhattan => away.iter().sum(),
            VoronoiMetric::Chebychev => away.iter().fold(0.0, |most, away| away.max(most)),
            VoronoiMetric::Minkowski => away.iter().map(|away| away.powf(self.exponent)).sum(),
        }
    }
}

/// Dot product.
pub fn dot<const N: usize>(a: [f32; N], b: [f32; N]) -> f32 {
    (0..N).map(|axis| a[axis] * b[axis]).sum()
}
