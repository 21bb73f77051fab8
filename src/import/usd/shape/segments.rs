//! Pieces of curves: every basis as Bezier pieces.

use std::ops::Range;

use openusd_schemas::geom::Interpolation;

use super::primvar::Channel;
use super::ribbon::Joint;
use crate::math::Vec3;

/// How points make a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Basis {
    Linear,
    Bezier,
    Bspline,
    CatmullRom,
}

/// What happens at the ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrap {
    Open,
    Closed,
    /// Open, and the curve reaches its first and last point.
    Pinned,
}

/// One curve of a prim.
pub(super) struct Curve {
    /// Its points among those of the prim.
    pub points: Range<usize>,
    /// Its values at the ends of pieces among the prim's varying ones.
    pub joints: Range<usize>,
    basis: Basis,
    wrap: Wrap,
}

/// A cubic Bezier piece.
pub(super) struct Piece<const N: usize>([[f32; N]; 4]);

impl Curve {
    pub fn new(points: Range<usize>, first_joint: usize, basis: Basis, wrap: Wrap) -> Self {
        let mut curve = Self { points, joints: first_joint..first_joint, basis, wrap };
        let joints = match (wrap, curve.segments()) {
            // As UsdGeomBasisCurves counts, too few points have one value as well.
            (Wrap::Closed, segments) => segments,
            (_, segments) => segments + 1,
        };
        curve.joints.end += joints;
        curve
    }

    pub fn is_closed(&self) -> bool {
        self.wrap == Wrap::Closed
    }

    /// How many pieces it has (UsdGeomBasisCurves::ComputeSegmentCounts).
    pub fn segments(&self) -> usize {
        let n = self.points.len();
        match (self.basis, self.wrap) {
            (Basis::Linear, Wrap::Closed) => {
                if n > 2 {
                    n
                } else {
                    0
                }
            }
            (Basis::Linear, _) => n.saturating_sub(1),
            (Basis::Bezier, Wrap::Closed) => n / 3,
            (Basis::Bezier, _) => n.saturating_sub(1) / 3,
            (_, Wrap::Closed) => {
                if n > 2 {
                    n
                } else {
                    0
                }
            }
            (_, Wrap::Open) => n.saturating_sub(3),
            (_, Wrap::Pinned) => n.saturating_sub(1),
        }
    }

    /// Piece `segment` of values of points.
    pub fn piece<const N: usize>(&self, segment: usize, value: impl Fn(usize) -> [f32; N]) -> Piece<N> {
        let n = self.points.len() as isize;
        let plain = |i: isize| value(self.points.start + i.rem_euclid(n) as usize);
        // The points beyond the ends of a pinned curve continue its first and last step.
        let at = |i: isize| match self.wrap {
            Wrap::Pinned if i < 0 => mix(plain(0), plain(1), -1.0),
            Wrap::Pinned if i >= n => mix(plain(n - 1), plain(n - 2), -1.0),
            _ => plain(i),
        };
        let s = segment as isize;
        // The four points of an overlapping basis.
        let first = if self.wrap == Wrap::Open { s } else { s - 1 };
        let four = || [at(first), at(first + 1), at(first + 2), at(first + 3)];
        Piece(match self.basis {
            Basis::Linear => {
                let (a, b) = (at(s), at(s + 1));
                [a, mix(a, b, 1.0 / 3.0), mix(a, b, 2.0 / 3.0), b]
            }
            Basis::Bezier => [at(3 * s), at(3 * s + 1), at(3 * s + 2), at(3 * s + 3)],
            Basis::Bspline => {
                let [a, b, c, d] = four();
                let sum = |w: [f32; 4]| std::array::from_fn(|i| w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i]);
                let (s, t) = (1.0 / 6.0, 1.0 / 3.0);
                [
                    sum([s, 4.0 * s, s, 0.0]),
                    sum([0.0, 2.0 * t, t, 0.0]),
                    sum([0.0, t, 2.0 * t, 0.0]),
                    sum([0.0, s, 4.0 * s, s]),
                ]
            }
            Basis::CatmullRom => {
                let [a, b, c, d] = four();
                let off =
                    |p: [f32; N], from: [f32; N], to: [f32; N]| std::array::from_fn(|i| p[i] + (to[i] - from[i]) / 6.0);
                [b, off(b, a, c), off(c, d, b), c]
            }
        })
    }

    /// The value of `channel` on this curve, the prim's curve `index`, at a place along it.
    pub fn value<const N: usize>(&self, channel: &Channel<N>, index: usize, (segment, t): (u32, f32)) -> [f32; N] {
        match channel.interpolation {
            Interpolation::Constant => channel.at(0),
            Interpolation::Uniform => channel.at(index),
            Interpolation::Vertex => self.piece(segment as usize, |i| channel.at(i)).at(t),
            Interpolation::Varying | Interpolation::FaceVarying => {
                let count = self.joints.len();
                let at = |i: usize| channel.at(self.joints.start + i % count);
                mix(at(segment as usize), at(segment as usize + 1), t)
            }
        }
    }

    /// Where straight pieces meet, the mean of their directions; where points coincide, that of neighbours.
    pub fn soften(&self, joints: &mut [Joint]) {
        let n = joints.len();
        let centers: Vec<Vec3> = joints.iter().map(|joint| joint.center).collect();
        for (i, joint) in joints.iter_mut().enumerate() {
            if self.basis != Basis::Linear && joint.tangent.length_squared() > 0.0 {
                continue;
            }
            let (a, b) = match self.is_closed() {
                true => ((i + n - 1) % n, (i + 1) % n),
                false => (i.saturating_sub(1), (i + 1).min(n - 1)),
            };
            let step = |a: usize, b: usize| (centers[b] - centers[a]).normalize_or_zero();
            let tangent = step(a, i) + step(i, b);
            joint.tangent = if tangent.length_squared() > 1e-12 { tangent } else { step(a, i) };
        }
    }
}

/// `a` at 0, `b` at 1.
fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

impl<const N: usize> Piece<N> {
    /// The largest second difference of its points: how far it is from straight and even.
    pub fn bend(&self) -> f32 {
        let [a, b, c, d] = &self.0;
        let length = |p: &[f32; N], q: &[f32; N], r: &[f32; N]| {
            (0..N).map(|i| (p[i] - 2.0 * q[i] + r[i]).powi(2)).sum::<f32>().sqrt()
        };
        length(a, b, c).max(length(b, c, d))
    }

    pub fn at(&self, t: f32) -> [f32; N] {
        let [a, b, c, d] = self.0;
        let s = 1.0 - t;
        let w = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        std::array::from_fn(|i| w[0] * a[i] + w[1] * b[i] + w[2] * c[i] + w[3] * d[i])
    }
}

impl Piece<3> {
    /// The derivative, or, where handles have no length, the direction that it comes from.
    pub fn tangent(&self, t: f32) -> [f32; 3] {
        let [a, b, c, d] = self.0.map(Vec3::from);
        let s = 1.0 - t;
        let derivative = (b - a) * (s * s) + (c - b) * (2.0 * s * t) + (d - c) * (t * t);
        let size = (b - a).length_squared().max((c - b).length_squared()).max((d - c).length_squared());
        if derivative.length_squared() > 1e-12 * size { derivative } else { d - a }.into()
    }

    /// Chords that keep within `tolerance` of the curve, by its second derivative, or by `bend` of what else
    /// runs along it; straight pieces have one.
    pub fn steps(&self, bend: f32, tolerance: f32) -> u32 {
        let [a, b, c, d] = self.0.map(Vec3::from);
        let bend = self.bend().max(bend);
        let scale = (b - a).length() + (c - b).length() + (d - c).length();
        // Thin curves that fill the picture show their chords as well.
        let tolerance = tolerance.min(1e-2 * scale).max(1e-5 * scale);
        if bend > 1e-6 * scale { (0.75 * bend / tolerance).sqrt().ceil().clamp(1.0, 64.0) as u32 } else { 1 }
    }
}
