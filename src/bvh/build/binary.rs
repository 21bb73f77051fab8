//! A binary tree by binned SAH, top down.
//!
//! Ingo Wald: *On fast Construction of SAH-based Bounding Volume Hierarchies*, IEEE Symposium on
//! Interactive Ray Tracing 2007.
//!
//! The subtree of `n` primitives takes the `2 n - 1` places from that of its root on, so that
//! threads build disjoint slices of one array. Sums over primitives are counts, minima and maxima,
//! which do not depend on the order.

use rayon::prelude::*;

use super::{Box3, LeafRule, Primitive};
use crate::bvh::node::MAX_DEPTH;
use crate::math::Vec3A;

const BINS: usize = 16;
/// Below this many primitives a subtree is not worth a task.
const TASK: usize = 2048;
/// From this many on a single node is binned by all threads.
const PARALLEL_BINNING: usize = 1 << 16;

/// A node of the binary tree.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct Binary {
    pub bounds: Box3,
    /// First primitive below.
    pub first: u32,
    /// Number of primitives below.
    pub count: u32,
    /// Distance to the second child in the array, 0 for a leaf. The first child follows at once.
    pub second: u32,
}

impl Binary {
    const UNUSED: Self = Self { bounds: Box3::EMPTY, first: 0, count: 0, second: 0 };
}

/// The binary tree over `primitives`, which are reordered. Empty for none.
pub(super) fn build(primitives: &mut [Primitive], rule: LeafRule) -> Vec<Binary> {
    let mut nodes = vec![Binary::UNUSED; (2 * primitives.len()).saturating_sub(1)];
    if !primitives.is_empty() {
        let extent = Extent::of(primitives);
        subdivide(&mut nodes, primitives, 0, 0, extent, rule);
    }
    nodes
}

/// Boxes of a set of primitives and of their centers (doubled).
#[derive(Clone, Copy)]
struct Extent {
    bounds: Box3,
    centers: Box3,
}

impl Extent {
    const EMPTY: Self = Self { bounds: Box3::EMPTY, centers: Box3::EMPTY };

    fn with(self, p: &Primitive) -> Self {
        let c = p.center2();
        Self { bounds: self.bounds.union(p.bounds()), centers: self.centers.union(Box3 { min: c, max: c }) }
    }

    fn union(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(other.bounds), centers: self.centers.union(other.centers) }
    }

    fn of(primitives: &[Primitive]) -> Self {
        reduce(primitives, Self::EMPTY, |extent, p| extent.with(p), Self::union)
    }
}

/// A fold over all primitives, by several threads where there are many. `join` must be exact.
fn reduce<T: Copy + Send + Sync>(
    primitives: &[Primitive],
    start: T,
    step: impl Fn(T, &Primitive) -> T + Sync,
    join: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    if primitives.len() < PARALLEL_BINNING {
        return primitives.iter().fold(start, step);
    }
    primitives.par_chunks(PARALLEL_BINNING / 4).map(|chunk| chunk.iter().fold(start, &step)).reduce(|| start, join)
}

/// Builds the subtree of `primitives`, the first of which is number `first`, into `nodes`.
fn subdivide(
    nodes: &mut [Binary],
    primitives: &mut [Primitive],
    first: usize,
    depth: usize,
    extent: Extent,
    rule: LeafRule,
) {
    let count = primitives.len();
    let (node, below) = nodes.split_first_mut().expect("2 n - 1 places for n primitives");
    *node = Binary { bounds: extent.bounds, first: first as u32, count: count as u32, second: 0 };
    if count == 1 {
        return;
    }
    // Halving reaches single primitives within the rest of the depth.
    let levels_of_halving = count.next_power_of_two().trailing_zeros() as usize;
    let split = if depth + levels_of_halving + 1 < MAX_DEPTH { Split::find(primitives, &extent, rule) } else { None };
    let middle = match split {
        Some(split) => split.partition(primitives),
        None => count / 2,
    };
    let (left, right) = primitives.split_at_mut(middle);
    let (left_nodes, right_nodes) = below.split_at_mut(2 * middle - 1);
    node.second = 2 * middle as u32;
    let (left_extent, right_extent) = (Extent::of(left), Extent::of(right));
    let mut go_left = |nodes: &mut [Binary]| subdivide(nodes, left, first, depth + 1, left_extent, rule);
    let mut go_right = |nodes: &mut [Binary]| subdivide(nodes, right, first + middle, depth + 1, right_extent, rule);
    if count >= TASK {
        rayon::join(|| go_left(left_nodes), || go_right(right_nodes));
    } else {
        go_left(left_nodes);
        go_right(right_nodes);
    }
}

/// Where to cut: primitives whose center lies in a bin of `axis` below `bin` go left.
struct Split {
    mapping: Mapping,
    axis: usize,
    bin: usize,
}

/// From centers to bins.
#[derive(Clone, Copy)]
struct Mapping {
    origin: Vec3A,
    scale: Vec3A,
}

impl Mapping {
    fn new(centers: &Box3) -> Self {
        let extent = centers.max - centers.min;
        // An axis without extent gets scale 0: all of it is bin 0.
        let scale = Vec3A::splat(BINS as f32 * 0.999_999) / extent;
        Self { origin: centers.min, scale: Vec3A::select(scale.is_finite_mask(), scale, Vec3A::ZERO) }
    }

    fn bins(&self, p: &Primitive) -> [usize; 3] {
        let b = ((p.center2() - self.origin) * self.scale).to_array();
        b.map(|v| (v as usize).min(BINS - 1))
    }
}

#[derive(Clone, Copy)]
struct Bins {
    bounds: [[Box3; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

impl Bins {
    const EMPTY: Self = Self { bounds: [[Box3::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    fn of(primitives: &[Primitive], mapping: &Mapping) -> Self {
        if primitives.len() < PARALLEL_BINNING {
            let mut bins = Self::EMPTY;
            bins.fill(primitives, mapping);
            return bins;
        }
        primitives
            .par_chunks(PARALLEL_BINNING / 4)
            .map(|chunk| {
                let mut bins = Self::EMPTY;
                bins.fill(chunk, mapping);
                bins
            })
            .reduce(|| Self::EMPTY, |a, b| a.union(&b))
    }

    fn fill(&mut self, primitives: &[Primitive], mapping: &Mapping) {
        for p in primitives {
            let bounds = p.bounds();
            for (axis, bin) in mapping.bins(p).into_iter().enumerate() {
                self.counts[axis][bin] += 1;
                self.bounds[axis][bin] = self.bounds[axis][bin].union(bounds);
            }
        }
    }

    fn union(mut self, other: &Self) -> Self {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.counts[axis][bin] += other.counts[axis][bin];
                self.bounds[axis][bin] = self.bounds[axis][bin].union(other.bounds[axis][bin]);
            }
        }
        self
    }

    /// The cheapest cut of an axis: cost, bin; `None` where all centers share a bin.
    fn cheapest(&self, axis: usize, rule: LeafRule) -> Option<(f32, usize)> {
        let (bounds, counts) = (&self.bounds[axis], &self.counts[axis]);
        let mut below = [(0.0, 0); BINS];
        let (mut b, mut n) = (Box3::EMPTY, 0);
        for bin in 0..BINS {
            below[bin] = (b.half_area() * rule.blocks(n), n);
            b = b.union(bounds[bin]);
            n += counts[bin] as usize;
        }
        let (mut b, mut n) = (Box3::EMPTY, 0);
        let mut best = None;
        for bin in (1..BINS).rev() {
            b = b.union(bounds[bin]);
            n += counts[bin] as usize;
            let cost = below[bin].0 + b.half_area() * rule.blocks(n);
            if n > 0 && below[bin].1 > 0 && best.is_none_or(|(c, _)| cost < c) {
                best = Some((cost, bin));
            }
        }
        best
    }
}

impl Split {
    /// The cheapest split; `None` where the centers cannot be told apart.
    fn find(primitives: &[Primitive], extent: &Extent, rule: LeafRule) -> Option<Self> {
        let mapping = Mapping::new(&extent.centers);
        let bins = Bins::of(primitives, &mapping);
        (0..3)
            .filter_map(|axis| bins.cheapest(axis, rule).map(|(cost, bin)| (cost, axis, bin)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, axis, bin)| Self { mapping, axis, bin })
    }

    /// Moves the left ones to the front and returns their number.
    fn partition(&self, primitives: &mut [Primitive]) -> usize {
        let goes_left = |p: &Primitive| self.mapping.bins(p)[self.axis] < self.bin;
        let (mut left, mut right) = (0, primitives.len());
        loop {
            while left < right && goes_left(&primitives[left]) {
                left += 1;
            }
            while left < right && !goes_left(&primitives[right - 1]) {
                right -= 1;
            }
            if left == right {
                return left;
            }
            primitives.swap(left, right - 1);
        }
    }
}
