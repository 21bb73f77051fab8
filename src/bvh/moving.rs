//! Shapes whose points move: a tree for each stretch of time between two keys.
//!
//! Boxes and points are known at both ends of a stretch and go from one to the other on straight lines; a box
//! that holds its points at both ends does so all the way.
//!
//! Leonhard Grünschloß, Martin Stich, Sehera Nawaz, Alexander Keller: *MSBVH: An Efficient Acceleration Data
//! Structure for Ray Traced Motion Blur*, High Performance Graphics 2011, and Embree's kernels.

use std::ops::ControlFlow;

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::blas::{RULE, blocks, fill_block, moving_bounds};
use super::buffer::Buffer;
use super::build::{self, Primitive, Wide};
use super::node::{BLOCK, Block, Link, Node, WIDTH};
use super::ray::RaySetup;
use super::round::{self, Beyond, RoundBlock, RoundRay, RoundStart};
use super::simd::{Lanes, Simd};
use super::triangle::{self, Best};
use super::walk::{Links, WideNode, walk};
use crate::math::{Ball, Bounds, Times, Vec3};

/// A shape at all times.
pub(super) struct Moving {
    times: Times,
    stretches: Box<[Stretch]>,
    pub bounds: Bounds,
    pub len: usize,
}

/// The time between two keys.
struct Stretch {
    nodes: Buffer<MovingNode>,
    root: Link,
    leaves: Leaves,
}

enum Leaves {
    Triangles(Buffer<Moved<Block>>),
    Rounds {
        blocks: Buffer<Moved<RoundBlock>>,
        /// By segment; empty where every ball stands alone.
        beyond: Buffer<[Beyond; 2]>,
    },
}

/// Eight boxes at the beginning of a stretch, and what their planes change by until its end.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
struct MovingNode {
    planes: [[f32; WIDTH]; 6],
    moved: [[f32; WIDTH]; 6],
    children: [Link; WIDTH],
}

const MOVED: usize = size_of::<[[f32; WIDTH]; 6]>();

impl WideNode for MovingNode {
    #[inline(always)]
    fn children(&self) -> &[Link; WIDTH] {
        &self.children
    }

    #[inline(always)]
    unsafe fn plane<F: Lanes<WIDTH>>(&self, at: usize, share: f32) -> F {
        // SAFETY: both arrays lie one after the other; the rest by contract.
        unsafe {
            let planes = (&raw const *self).cast::<u8>();
            let row = |at: usize| F::load(&*planes.add(at).cast());
            row(at).add(row(MOVED + at).mul(F::splat(share)))
        }
    }
}

/// Numbers side by side that move on straight lines.
trait Lerp: Copy + Zeroable + Send + Sync {
    fn rows(&self) -> &[[f32; BLOCK]];
    fn rows_mut(&mut self) -> &mut [[f32; BLOCK]];
}

impl Lerp for Block {
    fn rows(&self) -> &[[f32; BLOCK]] {
        self.vertices.as_flattened()
    }
    fn rows_mut(&mut self) -> &mut [[f32; BLOCK]] {
        self.vertices.as_flattened_mut()
    }
}

impl Lerp for RoundBlock {
    fn rows(&self) -> &[[f32; BLOCK]] {
        self.balls.as_flattened()
    }
    fn rows_mut(&mut self) -> &mut [[f32; BLOCK]] {
        self.balls.as_flattened_mut()
    }
}

/// A block at the beginning of a stretch, and what its numbers change by until its end.
#[derive(Clone, Copy)]
struct Moved<B> {
    from: B,
    by: B,
}

// SAFETY: two values that may be zero.
unsafe impl<B: Zeroable> Zeroable for Moved<B> {}

impl<B: Lerp> Moved<B> {
    fn new(from: B, to: B) -> Self {
        let mut by = to;
        let rows = by.rows_mut().as_flattened_mut().iter_mut();
        rows.zip(from.rows().as_flattened()).for_each(|(to, from)| *to -= from);
        Self { from, by }
    }

    /// The block when `share` of the stretch has passed. Shading moves points by the same products and sums, so
    /// that neighbours and what is seen of them share every corner.
    ///
    /// # Safety
    /// As for [`Lanes`].
    #[inline(always)]
    unsafe fn at<F: Lanes<BLOCK>>(&self, share: f32) -> B {
        let mut block = self.from;
        for (lanes, by) in block.rows_mut().iter_mut().zip(self.by.rows()) {
            // SAFETY: by contract.
            unsafe { F::load(lanes).add(F::load(by).mul(F::splat(share))).store(lanes) };
        }
        block
    }
}

/// A tree over boxes that move, and what its leaves hold.
struct Topology {
    nodes: Buffer<MovingNode>,
    root: Link,
    bounds: Bounds,
    primitives: Vec<Primitive>,
    items: Vec<(u32, u32)>,
}

impl Topology {
    /// Over those of `count` things that have boxes at both ends. Where they part is decided by the middle.
    fn over(count: usize, boxes: impl Fn(usize) -> Option<[Bounds; 2]> + Sync) -> Self {
        let middle = |[a, b]: [Bounds; 2]| Bounds { min: 0.5 * (a.min + b.min), max: 0.5 * (a.max + b.max) };
        let mut primitives: Vec<Primitive> =
            (0..count).into_par_iter().filter_map(|i| Some(Primitive::new(middle(boxes(i)?), i as u32))).collect();
        let Wide { nodes: still, root, items, .. } = build::build(&mut primitives, RULE);
        let both = |i: u32| boxes(i as usize).expect("those without were left out");
        let mut whole = vec![[Bounds::EMPTY; 2]; still.len()];
        let mut nodes = Buffer::zeroed(still.len());
        let of = |link: Link, whole: &[[Bounds; 2]]| {
            if !link.is_leaf() {
                return whole[link.index()];
            }
            let (first, count) = link.items();
            let items = items[first..first + count].iter().flat_map(|&(first, count)| first..first + count);
            items.map(|i| both(primitives[i as usize].index)).fold([Bounds::EMPTY; 2], union)
        };
        // Children come after their parents.
        for i in (0..still.len()).rev() {
            let mut ends = [Node::EMPTY; 2];
            for (slot, &link) in still[i].children.iter().enumerate().filter(|(_, link)| **link != Link::EMPTY) {
                let child = of(link, &whole);
                whole[i] = union(whole[i], child);
                ends.iter_mut().zip(child).for_each(|(end, bounds)| end.set(slot, bounds, link));
            }
            nodes[i] = MovingNode::new(ends);
        }
        let [from, to] = of(root, &whole);
        Self { nodes, root, bounds: from.union(to), primitives, items }
    }

    fn blocks<B: Lerp>(&self, fill: impl Fn(&[Primitive], usize) -> B + Sync) -> Buffer<Moved<B>> {
        blocks(&self.items, &self.primitives, |range| Moved::new(fill(range, 0), fill(range, 1)))
    }
}

fn union(a: [Bounds; 2], b: [Bounds; 2]) -> [Bounds; 2] {
    [a[0].union(b[0]), a[1].union(b[1])]
}

impl MovingNode {
    fn new([from, to]: [Node; 2]) -> Self {
        let mut moved = to.planes;
        for (to, from) in moved.as_flattened_mut().iter_mut().zip(from.planes.as_flattened()) {
            // Unused slots are infinite.
            *to = if *to == *from { 0.0 } else { *to - from };
        }
        Self { planes: from.planes, moved, children: from.children }
    }
}

impl Moving {
    /// Triangles that index points, of which each key has a list.
    pub fn triangles(times: Times, keys: &[Vec<Vec3>], triangles: &[[u32; 3]]) -> Self {
        let corners = |key: usize, i: usize| triangles[i].map(|p| keys[key][p as usize]);
        Self::of(times, triangles.len(), |stretch| {
            let ends = |i: usize| [corners(stretch, i), corners(stretch + 1, i)];
            let topology = Topology::over(triangles.len(), |i| moving_bounds(ends(i)));
            let blocks = topology.blocks(|range, end| {
                fill_block(range.iter().map(|p| (p.index, corners(stretch + end, p.index as usize))))
            });
            (topology, Leaves::Triangles(blocks))
        })
    }

    /// Round cones between balls, of which each key has a list; see [`super::Blas::rounds`].
    pub fn rounds(times: Times, keys: &[Vec<Ball>], segments: Option<&[[u32; 4]]>) -> Self {
        let ends = |key: usize, i: usize| match segments {
            Some(segments) => [1, 2].map(|k| keys[key][segments[i][k] as usize]),
            None => [keys[key][i]; 2],
        };
        let count = segments.map_or(keys[0].len(), <[_]>::len);
        Self::of(times, count, |stretch| {
            let boxes =
                |i: usize| Some(widened([round::bounds(ends(stretch, i))?, round::bounds(ends(stretch + 1, i))?]));
            let topology = Topology::over(count, boxes);
            let blocks = topology.blocks(|range, end| {
                RoundBlock::of(range.iter().map(|p| (p.index, ends(stretch + end, p.index as usize))))
            });
            let mut beyond = Buffer::zeroed(segments.map_or(0, <[_]>::len));
            for (beyond, &segment) in beyond.iter_mut().zip(segments.unwrap_or_default()) {
                let [from, to] = [0, 1].map(|end| round::beyond(&keys[stretch + end], segment));
                let by = std::array::from_fn(|k| std::array::from_fn(|c| to[k][c] - from[k][c]));
                *beyond = [from, by];
            }
            (topology, Leaves::Rounds { blocks, beyond })
        })
    }

    fn of(times: Times, count: usize, stretch: impl Fn(usize) -> (Topology, Leaves) + Sync + Send) -> Self {
        let made: Vec<_> = (0..times.stretches()).into_par_iter().map(stretch).collect();
        let bounds = made.iter().fold(Bounds::EMPTY, |bounds, (topology, _)| bounds.union(topology.bounds));
        let stretches = made.into_iter().map(|(Topology { nodes, root, .. }, leaves)| Stretch { nodes, root, leaves });
        Self { times, stretches: stretches.collect(), bounds, len: count }
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let leaves = |leaves: &Leaves| match leaves {
            Leaves::Triangles(blocks) => blocks.bytes(),
            Leaves::Rounds { blocks, beyond } => blocks.bytes() + beyond.bytes(),
        };
        let of = |stretch: &Stretch| size_of::<Stretch>() + stretch.nodes.bytes() + leaves(&stretch.leaves);
        size_of::<Self>() + self.stretches.iter().map(of).sum::<usize>()
    }

    /// Calls `visit` with each number of the trees, for a hash of them.
    pub fn each_number(&self, mut visit: impl FnMut(u32)) {
        for stretch in &self.stretches {
            visit(stretch.root.0);
            for node in stretch.nodes.iter() {
                node.planes.iter().chain(&node.moved).flatten().for_each(|v| visit(v.to_bits()));
                node.children.iter().for_each(|link| visit(link.0));
            }
            match &stretch.leaves {
                Leaves::Triangles(blocks) => blocks.iter().for_each(|b| each_of(b, &b.from.triangles, &mut visit)),
                Leaves::Rounds { blocks, beyond } => {
                    blocks.iter().for_each(|b| each_of(b, &b.from.segments, &mut visit));
                    beyond.iter().flatten().flatten().flatten().for_each(|v| visit(v.to_bits()));
                }
            }
        }
    }

    /// Updates `best` with the nearest hit of a ray in object space at `time`.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn closest<S: Simd>(&self, ray: &RoundStart, time: f32, instance: u32, best: &mut Best) {
        let (stretch, share) = self.times.at(time);
        let Stretch { nodes, root, leaves } = &self.stretches[stretch];
        let setup = RaySetup::new(ray.o, ray.d);
        // SAFETY: the builder's links and depth; the instruction set by contract.
        unsafe {
            match leaves {
                Leaves::Triangles(blocks) => {
                    let leaf = |best: &mut Best, link: Link| {
                        for block in items(blocks, link) {
                            triangle::closest::<S::F4>(&block.at::<S::F4>(share), &setup, instance, best);
                        }
                        ControlFlow::Continue(())
                    };
                    let tree = Links { nodes: nodes.as_ptr(), items: blocks.as_ptr(), share };
                    walk::<S, _, _, _>(&tree, *root, &setup, best, |best| best.t, leaf);
                }
                Leaves::Rounds { blocks, beyond } => {
                    let (ray, beyond) = (RoundRay::new(ray), |segment| beyond_at(beyond, segment, share));
                    let leaf = |best: &mut Best, link: Link| {
                        for block in items(blocks, link) {
                            round::closest::<S::F4>(&block.at::<S::F4>(share), beyond, &ray, instance, best);
                        }
                        ControlFlow::Continue(())
                    };
                    let tree = Links { nodes: nodes.as_ptr(), items: blocks.as_ptr(), share };
                    walk::<S, _, _, _>(&tree, *root, &setup, best, |best| best.t, leaf);
                }
            }
        }
    }

    /// True where a ray in object space hits something at `time` and `0 <= t < t_max`.
    ///
    /// # Safety
    /// As for [`Moving::closest`].
    #[inline(always)]
    pub unsafe fn any<S: Simd>(&self, ray: &RoundStart, time: f32, t_max: f32) -> bool {
        let (stretch, share) = self.times.at(time);
        let Stretch { nodes, root, leaves } = &self.stretches[stretch];
        let setup = RaySetup::new(ray.o, ray.d);
        let mut found = false;
        let until = |found: bool| if found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        // SAFETY: as above.
        unsafe {
            match leaves {
                Leaves::Triangles(blocks) => {
                    let leaf = |found: &mut bool, link: Link| {
                        *found = items(blocks, link)
                            .iter()
                            .any(|block| triangle::any::<S::F4>(&block.at::<S::F4>(share), &setup, t_max));
                        until(*found)
                    };
                    let tree = Links { nodes: nodes.as_ptr(), items: blocks.as_ptr(), share };
                    walk::<S, _, _, _>(&tree, *root, &setup, &mut found, |_| t_max, leaf);
                }
                Leaves::Rounds { blocks, beyond } => {
                    let (ray, beyond) = (RoundRay::new(ray), |segment| beyond_at(beyond, segment, share));
                    let leaf = |found: &mut bool, link: Link| {
                        *found = items(blocks, link)
                            .iter()
                            .any(|block| round::any::<S::F4>(&block.at::<S::F4>(share), beyond, &ray, t_max));
                        until(*found)
                    };
                    let tree = Links { nodes: nodes.as_ptr(), items: blocks.as_ptr(), share };
                    walk::<S, _, _, _>(&tree, *root, &setup, &mut found, |_| t_max, leaf);
                }
            }
        }
        found
    }
}

fn each_of<B: Lerp>(block: &Moved<B>, indices: &[u32; BLOCK], visit: &mut impl FnMut(u32)) {
    block.from.rows().iter().chain(block.by.rows()).flatten().for_each(|v| visit(v.to_bits()));
    indices.iter().for_each(|&i| visit(i));
}

fn items<B: Zeroable + Copy>(blocks: &Buffer<B>, link: Link) -> &[B] {
    let (first, count) = link.items();
    &blocks[first..first + count]
}

fn beyond_at(beyond: &[[Beyond; 2]], segment: u32, share: f32) -> Beyond {
    let Some([from, by]) = beyond.get(segment as usize) else { return [round::NONE; 2] };
    std::array::from_fn(|k| std::array::from_fn(|c| from[k][c] + by[k][c] * share))
}

/// Boxes at both ends, grown by what rounding may move a point on its way between them.
pub(super) fn widened(ends: [Bounds; 2]) -> [Bounds; 2] {
    let largest = ends.iter().fold(Vec3::ZERO, |most, b| most.max(b.min.abs()).max(b.max.abs()));
    let margin = largest * (4.0 * f32::EPSILON);
    ends.map(|b| Bounds { min: b.min - margin, max: b.max + margin })
}
