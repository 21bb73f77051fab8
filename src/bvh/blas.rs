//! The lower level: the triangles of one mesh, or the round cones of one set of strands and balls, in
//! object space.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::ControlFlow;

use rayon::prelude::*;

use super::buffer::Buffer;
use super::build::{self, LeafRule, Primitive};
use super::moving::{Moving, widened};
use super::node::{BLOCK, Block, Link, Node};
use super::ray::RaySetup;
use super::round::{self, Beyond, RoundBlock, RoundRay, RoundStart};
use super::simd::Simd;
use super::triangle::{self, Best};
use super::walk::{Links, walk};
use crate::math::{Ball, Bounds, DVec3, Times, Vec3};

/// Coordinates beyond this, 2^60, count as not finite: squares of their differences must not
/// overflow in the triangle test.
pub(super) const LARGEST: f32 = (1_u64 << 60) as f32;

/// Bounds of a triangle grow by this much of its largest extent, for the rounding of the triangle
/// test, which may find a hit that lies this far beside the triangle.
const MARGIN: f32 = 4.0 * f32::EPSILON;

/// Up to eight triangles or round cones in a leaf.
pub(super) const RULE: LeafRule = LeafRule { block: BLOCK, max: 2 * BLOCK, cost: 1.0 };

/// The triangles or round cones of one shape in object space, ready to be instanced in a [`super::Bvh`].
pub struct Blas {
    /// Empty for what moves.
    nodes: Buffer<Node>,
    /// Empty for all but triangles that stand still.
    blocks: Buffer<Block>,
    kind: Kind,
    root: Link,
    bounds: Bounds,
    len: usize,
}

/// What there is, beside triangles that stand still.
pub(super) enum Kind {
    Triangles,
    Rounds(Rounds),
    Moving(Box<Moving>),
}

/// Round cones, and what continues them.
pub(super) struct Rounds {
    blocks: Buffer<RoundBlock>,
    /// By segment; empty where every ball stands alone.
    beyond: Buffer<Beyond>,
}

impl Blas {
    /// Builds the tree over `triangles`, which index `points`; all indices must be in range.
    ///
    /// Triangles without area and those with a coordinate that is not finite or beyond 2^60 are
    /// left out: they are never hit. The tree is the same for any number of threads.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn build(points: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let mut primitives: Vec<Primitive> = triangles
            .par_iter()
            .enumerate()
            .filter_map(|(index, t)| Some(Primitive::new(triangle_bounds(corners(points, *t))?, index as u32)))
            .collect();
        let wide = build::build(&mut primitives, RULE);
        let blocks = blocks(&wide.items, &primitives, |range| {
            fill_block(range.iter().map(|p| (p.index, corners(points, triangles[p.index as usize]))))
        });
        let (kind, len) = (Kind::Triangles, primitives.len());
        Self { nodes: wide.nodes, blocks, kind, root: wide.root, bounds: wide.bounds, len }
    }

    /// Builds the tree over the round cones between `balls`: those of `segments`, which name a ball
    /// before, both ends, and a ball after (an end itself where the strand ends there); `None` for
    /// balls that stand alone. All indices must be in range.
    ///
    /// Those without size, and those with a coordinate or radius that is not finite or beyond 2^60,
    /// are left out: they are never hit.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn rounds(balls: &[Ball], segments: Option<&[[u32; 4]]>) -> Self {
        let ends = |index: usize| match segments {
            Some(segments) => [1, 2].map(|k| balls[segments[index][k] as usize]),
            None => [balls[index]; 2],
        };
        let count = segments.map_or(balls.len(), <[_]>::len);
        let mut primitives: Vec<Primitive> = (0..count)
            .into_par_iter()
            .filter_map(|index| Some(Primitive::new(round::bounds(ends(index))?, index as u32)))
            .collect();
        let wide = build::build(&mut primitives, RULE);
        let blocks = blocks(&wide.items, &primitives, |range| {
            RoundBlock::of(range.iter().map(|p| (p.index, ends(p.index as usize))))
        });
        let mut beyond = Buffer::zeroed(segments.map_or(0, <[_]>::len));
        beyond
            .par_iter_mut()
            .zip(segments.unwrap_or_default())
            .with_min_len(1024)
            .for_each(|(beyond, &segment): (&mut Beyond, _)| *beyond = round::beyond(balls, segment));
        let (kind, len) = (Kind::Rounds(Rounds { blocks, beyond }), primitives.len());
        let blocks = Buffer::zeroed(0);
        Self { nodes: wide.nodes, blocks, kind, root: wide.root, bounds: wide.bounds, len }
    }

    /// The same as [`Blas::build`] of points that move: `keys` are all points at each of `times`, and between two
    /// keys each goes straight on. A triangle is left out between keys at one of which it has a coordinate that
    /// is not finite or beyond 2^60.
    ///
    /// # Panics
    /// If an index is out of range, or if there are not as many lists of points as times.
    pub fn moving(times: Times, keys: &[Vec<Vec3>], triangles: &[[u32; 3]]) -> Self {
        Self::of_moving(Moving::triangles(times, keys, triangles))
    }

    /// The same as [`Blas::rounds`] of balls that move: see [`Blas::moving`].
    ///
    /// # Panics
    /// As for [`Blas::moving`].
    pub fn moving_rounds(times: Times, keys: &[Vec<Ball>], segments: Option<&[[u32; 4]]>) -> Self {
        Self::of_moving(Moving::rounds(times, keys, segments))
    }

    fn of_moving(moving: Moving) -> Self {
        let (nodes, blocks) = (Buffer::zeroed(0), Buffer::zeroed(0));
        let (bounds, len) = (moving.bounds, moving.len);
        Self { nodes, blocks, kind: Kind::Moving(moving.into()), root: Link::EMPTY, bounds, len }
    }

    /// The box of all that can be hit, in object space; empty if there is nothing.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let others = match &self.kind {
            Kind::Triangles => 0,
            Kind::Rounds(rounds) => rounds.blocks.bytes() + rounds.beyond.bytes(),
            Kind::Moving(moving) => moving.bytes(),
        };
        size_of::<Self>() + self.nodes.bytes() + self.blocks.bytes() + others
    }

    /// Number of triangles or round cones that can be hit.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True where nothing can be hit.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// A hash of the whole tree, for tests that two builds are the same.
    pub fn digest(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.root.0.hash(&mut hasher);
        for node in self.nodes.iter() {
            node.planes.as_flattened().iter().for_each(|v| v.to_bits().hash(&mut hasher));
            node.children.iter().for_each(|link| link.0.hash(&mut hasher));
        }
        let mut hash = |values: &[f32], indices: &[u32]| {
            values.iter().for_each(|v| v.to_bits().hash(&mut hasher));
            indices.hash(&mut hasher);
        };
        self.blocks.iter().for_each(|b| hash(b.vertices.as_flattened().as_flattened(), &b.triangles));
        match &self.kind {
            Kind::Triangles => {}
            Kind::Rounds(rounds) => {
                rounds.blocks.iter().for_each(|b| hash(b.balls.as_flattened().as_flattened(), &b.segments));
                rounds.beyond.iter().for_each(|b| hash(b.as_flattened(), &[]));
            }
            Kind::Moving(moving) => moving.each_number(|v| v.hash(&mut hasher)),
        }
        hasher.finish()
    }

    /// Boxes that together hold everything, tighter than the one of [`Blas::bounds`].
    pub(super) fn outline(&self) -> Vec<Bounds> {
        let children = |node: &Node| {
            let node = *node;
            (0..node.children.len()).map(move |i| (node.bounds(i), node.children[i])).filter(|(b, _)| !b.is_empty())
        };
        if self.root.is_leaf() {
            return vec![self.bounds];
        }
        let mut boxes = Vec::new();
        for (bounds, link) in children(&self.nodes[self.root.index()]) {
            if link.is_leaf() {
                boxes.push(bounds);
            } else {
                boxes.extend(children(&self.nodes[link.index()]).map(|(bounds, _)| bounds));
            }
        }
        boxes
    }

    /// What there is to be hit, which decides on the queries to make.
    #[inline(always)]
    pub(super) fn kind(&self) -> &Kind {
        &self.kind
    }

    #[inline(always)]
    fn links(&self) -> Links<Block> {
        Links::still(self.nodes.as_ptr(), self.blocks.as_ptr())
    }

    /// Updates `best` with the nearest hit of a ray in object space on a triangle. `ODD` tells callers apart: each
    /// has a copy of its own, all in one piece, which costs 10 % fewer instructions than a leaf that is called.
    ///
    /// # Safety
    /// The instruction set is available, and the tree is one over triangles.
    #[inline(always)]
    pub(super) unsafe fn closest<S: Simd, const ODD: bool>(&self, ray: &RaySetup, instance: u32, best: &mut Best) {
        let tree = self.links();
        let leaf = |best: &mut Best, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: links are made by the builder together with the blocks.
                unsafe { triangle::closest::<S::F4>(&*tree.items.add(i), ray, instance, best) };
            }
            ControlFlow::Continue(())
        };
        // SAFETY: the builder's links and depth; the instruction set by contract.
        unsafe { walk::<S, _, _, _>(&tree, self.root, ray, best, |best| best.t, leaf) };
    }

    /// True where a ray in object space hits a triangle at `0 <= t < t_max`.
    ///
    /// # Safety
    /// As for [`Blas::closest`].
    #[inline(always)]
    pub(super) unsafe fn any<S: Simd, const ODD: bool>(&self, ray: &RaySetup, t_max: f32) -> bool {
        let tree = self.links();
        let mut found = false;
        let leaf = |found: &mut bool, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: as above.
                if unsafe { triangle::any::<S::F4>(&*tree.items.add(i), ray, t_max) } {
                    *found = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: as above.
        unsafe { walk::<S, _, _, _>(&tree, self.root, ray, &mut found, |_| t_max, leaf) };
        found
    }

    /// Updates `best` with the nearest hit of a ray in object space on a round cone.
    ///
    /// # Safety
    /// The instruction set is available, and `rounds` are those of the tree.
    #[inline(always)]
    pub(super) unsafe fn closest_round<S: Simd>(
        &self,
        rounds: &Rounds,
        ray: &RoundStart,
        instance: u32,
        best: &mut Best,
    ) {
        let tree = Links::still(self.nodes.as_ptr(), rounds.blocks.as_ptr());
        let beyond = |segment: u32| rounds.beyond.get(segment as usize).copied().unwrap_or([round::NONE; 2]);
        let (setup, ray) = (RaySetup::new(ray.o, ray.d), RoundRay::new(ray));
        let leaf = |best: &mut Best, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: as above.
                unsafe { round::closest::<S::F4>(&*tree.items.add(i), beyond, &ray, instance, best) };
            }
            ControlFlow::Continue(())
        };
        // SAFETY: as above.
        unsafe { walk::<S, _, _, _>(&tree, self.root, &setup, best, |best| best.t, leaf) };
    }

    /// True where a ray in object space hits a round cone at `0 <= t < t_max`.
    ///
    /// # Safety
    /// As for [`Blas::closest_round`].
    #[inline(always)]
    pub(super) unsafe fn any_round<S: Simd>(&self, rounds: &Rounds, ray: &RoundStart, t_max: f32) -> bool {
        let tree = Links::still(self.nodes.as_ptr(), rounds.blocks.as_ptr());
        let beyond = |segment: u32| rounds.beyond.get(segment as usize).copied().unwrap_or([round::NONE; 2]);
        let (setup, ray) = (RaySetup::new(ray.o, ray.d), RoundRay::new(ray));
        let mut found = false;
        let leaf = |found: &mut bool, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: as above.
                if unsafe { round::any::<S::F4>(&*tree.items.add(i), beyond, &ray, t_max) } {
                    *found = true;
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: as above.
        unsafe { walk::<S, _, _, _>(&tree, self.root, &setup, &mut found, |_| t_max, leaf) };
        found
    }
}

/// The blocks of the leaf items `items`, each filled from its primitives.
pub(super) fn blocks<B: bytemuck::Zeroable + Copy + Send + Sync>(
    items: &[(u32, u32)],
    primitives: &[Primitive],
    fill: impl Fn(&[Primitive]) -> B + Sync,
) -> Buffer<B> {
    let mut blocks = Buffer::zeroed(items.len());
    blocks.par_iter_mut().zip(items).with_min_len(1024).for_each(|(block, &(first, count))| {
        *block = fill(&primitives[first as usize..][..count as usize]);
    });
    blocks
}

fn corners(points: &[Vec3], triangle: [u32; 3]) -> [Vec3; 3] {
    triangle.map(|i| points[i as usize])
}

/// The box of a triangle, with a margin; `None` for one that can't be hit.
fn triangle_bounds(corners: [Vec3; 3]) -> Option<Bounds> {
    (is_in_range(corners) && has_area(corners)).then(|| grown(corners))
}

/// The boxes of a triangle at both ends of a stretch of time, in which it may have area where it has none at the
/// ends.
pub(super) fn moving_bounds(ends: [[Vec3; 3]; 2]) -> Option<[Bounds; 2]> {
    ends.into_iter().all(is_in_range).then(|| widened(ends.map(grown)))
}

fn is_in_range(corners: [Vec3; 3]) -> bool {
    corners.iter().all(|p| p.abs().cmple(Vec3::splat(LARGEST)).all())
}

fn grown(corners: [Vec3; 3]) -> Bounds {
    let bounds = Bounds::of_points(corners);
    let margin = bounds.extent().max_element() * MARGIN;
    Bounds { min: bounds.min - margin, max: bounds.max + margin }
}

fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    let (a, b, c): (DVec3, DVec3, DVec3) = (a.into(), b.into(), c.into());
    (b - a).cross(c - a) != DVec3::ZERO
}

pub(super) fn fill_block(triangles: impl Iterator<Item = (u32, [Vec3; 3])>) -> Block {
    let mut block = Block::EMPTY;
    for (lane, (index, corners)) in triangles.enumerate() {
        for (vertex, p) in block.vertices.iter_mut().zip(corners) {
            for (axis, lanes) in vertex.iter_mut().enumerate() {
                lanes[lane] = p[axis];
            }
        }
        block.triangles[lane] = index;
    }
    block
}
