//! Distances between points in one to four dimensions.

use super::VoronoiMetric;

/// How distance is measured.
#[derive(Clone, Copy)]
pub struct Metric {
    pub kind: VoronoiMetric,
    exponent: f32,
}

impl Metric {
    /// Length of a difference.
    pub const EUCLIDEAN: Self = Self { kind: VoronoiMetric::Euclidean, exponent: 2.0 };

    /// The metric picked; on a line all are alike.
    pub fn new<const N: usize>(kind: VoronoiMetric, exponent: f32) -> Self {
        Self { kind: if N == 1 { VoronoiMetric::Manhattan } else { kind }, exponent }
    }

    /// Distance from `a` to `b`.
    #[inline(always)]
    pub fn distance<const N: usize>(self, a: [f32; N], b: [f32; N]) -> f32 {
        let rank = self.rank(a, b);
        match self.kind {
            VoronoiMetric::Euclidean => rank.sqrt(),
            VoronoiMetric::Manhattan | VoronoiMetric::Chebychev => rank,
            VoronoiMetric::Minkowski => rank.powf(1.0 / self.exponent),
        }
    }

    /// What is smaller for a smaller distance, and cheaper.
    #[inline(always)]
    pub fn rank<const N: usize>(self, a: [f32; N], b: [f32; N]) -> f32 {
        let away: [f32; N] = std::array::from_fn(|axis| (a[axis] - b[axis]).abs());
        match self.kind {
            VoronoiMetric::Euclidean => dot(away, away),
            VoronoiMetric::Manhattan => away.iter().sum(),
            VoronoiMetric::Chebychev => away.iter().fold(0.0, |most, away| away.max(most)),
            VoronoiMetric::Minkowski => away.iter().map(|away| away.powf(self.exponent)).sum(),
        }
    }

    /// The rank of a distance.
    pub fn rank_of(self, distance: f32) -> f32 {
        match self.kind {
            VoronoiMetric::Euclidean => distance * distance.max(0.0),
            VoronoiMetric::Manhattan | VoronoiMetric::Chebychev => distance,
            VoronoiMetric::Minkowski => distance.powf(self.exponent),
        }
    }
}

/// Dot product.
#[inline(always)]
pub fn dot<const N: usize>(a: [f32; N], b: [f32; N]) -> f32 {
    (0..N).map(|axis| a[axis] * b[axis]).sum()
}
