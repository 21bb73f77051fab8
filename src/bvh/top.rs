//! The upper level: instances of shapes, and the queries.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::blas::Blas;
use super::buffer::Buffer;
use super::build::{self, LeafRule, Primitive};
use super::isa::Isa;
use super::kernel::{Kernel, OddCode};
use super::node::{Link, Node};
use super::placed::{self, Placed};
use super::ray::RaySetup;
use super::simd::Simd;
use super::triangle::Best;
use super::walk::{Links, walk};
use super::{Hit, Instance};
use crate::math::{Bounds, MovingTransform, Ray};

/// Instances of meshes, ready to be hit by rays.
pub struct Bvh {
    tree: Tree,
    kernel: &'static Kernel,
}

/// All but the choice of code.
pub(super) struct Tree {
    nodes: Buffer<Node>,
    root: Link,
    bounds: Bounds,
    /// In the order of the leaves.
    placed: Vec<Placed>,
    blases: Vec<Arc<Blas>>,
    /// What `placed` points to beside the shapes.
    motions: Vec<Arc<MovingTransform>>,
}

impl Bvh {
    /// Builds the level over `instances` of `blases`.
    ///
    /// An instance whose transform is singular or not finite is never hit, nor is one whose `blas`
    /// is out of range.
    pub fn build(blases: Vec<Arc<Blas>>, instances: Vec<Instance>) -> Self {
        Self { tree: Tree::build(blases, &instances), kernel: Kernel::of(Isa::best()) }
    }

    /// The same structure traversed by the code for `isa`; `None` where this machine can't run it.
    pub fn with_isa(self, isa: Isa) -> Option<Self> {
        Isa::available().contains(&isa).then(|| Self { kernel: Kernel::of(isa), ..self })
    }

    /// The instruction set in use.
    pub fn isa(&self) -> Isa {
        self.kernel.isa
    }

    /// The nearest hit at `0 <= t < ray.t_max` on an instance with `instance.mask & mask != 0`.
    ///
    /// Surfaces are hit from both sides. Of hits at equal `t`, the lowest instance, then primitive,
    /// wins. A ray that is not finite hits nothing.
    #[inline]
    pub fn closest_hit(&self, ray: &Ray, mask: u64) -> Option<Hit> {
        self.kernel.closest(&self.tree, ray, mask)
    }

    /// True where [`Bvh::closest_hit`] would find something.
    #[inline]
    pub fn any_hit(&self, ray: &Ray, mask: u64) -> bool {
        self.kernel.any(&self.tree, ray, mask)
    }

    /// The box of everything, in render space; empty for an empty scene.
    pub fn bounds(&self) -> Bounds {
        self.tree.bounds
    }

    /// Memory held, in bytes, with that of the meshes.
    pub fn bytes(&self) -> usize {
        let tree = &self.tree;
        let meshes: usize = tree.blases.iter().map(|b| b.bytes()).sum();
        let motions: usize = tree.motions.iter().map(|motion| motion.bytes()).sum();
        size_of::<Self>() + tree.nodes.bytes() + tree.placed.len() * size_of::<Placed>() + motions + meshes
    }
}

impl Tree {
    const RULE: LeafRule = LeafRule { block: 1, max: 1, cost: 1.0 };

    fn build(blases: Vec<Arc<Blas>>, instances: &[Instance]) -> Self {
        let outlines: Vec<Vec<Bounds>> = blases.iter().map(|b| b.outline()).collect();
        let mut primitives = Vec::with_capacity(instances.len());
        let mut unordered = Vec::with_capacity(instances.len());
        for (id, instance) in instances.iter().enumerate() {
            let Some(placed) = Placed::new(id, instance, &blases) else { continue };
            let outline = &outlines[instance.blas as usize];
            let Some(bounds) = placed::bounds(instance, outline) else { continue };
            primitives.push(Primitive::new(bounds, unordered.len() as u32));
            unordered.push(Some(placed));
        }
        let wide = build::build(&mut primitives, Self::RULE);
        let take = |p: &Primitive| unordered[p.index as usize].take().expect("each instance has one place");
        let placed = primitives.iter().map(take).collect();
        debug_assert!(wide.items.iter().enumerate().all(|(i, &(first, count))| first as usize == i && count == 1));
        let motions = instances.iter().filter_map(|instance| instance.motion.clone()).collect();
        Self { nodes: wide.nodes, root: wide.root, bounds: wide.bounds, placed, blases, motions }
    }

    #[inline(always)]
    fn links(&self) -> Links<Placed> {
        Links::still(self.nodes.as_ptr(), self.placed.as_ptr())
    }

    /// The nearest hit of a ray in render space.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn closest<S: Simd>(&self, ray: &Ray, mask: u64, odd: &OddCode) -> Best {
        let setup = RaySetup::new(ray.o.to_array(), ray.d.to_array());
        let mut best = Best::none(ray.t_max);
        let leaf = |best: &mut Best, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: one placed instance for each leaf item.
                let placed = unsafe { self.placed.get_unchecked(i) };
                if placed.mask & mask == 0 {
                    continue;
                }
                if placed.is_odd() {
                    // SAFETY: as below.
                    *best = unsafe { (odd.closest)(placed, ray, *best) };
                    continue;
                }
                // SAFETY: the mesh lives as long as the tree; the instruction set by contract.
                unsafe {
                    let moved;
                    let local = if placed.is_identity() {
                        &setup
                    } else {
                        moved = placed.ray(&setup);
                        &moved
                    };
                    (*placed.blas).closest::<S, false>(local, placed.id(), best);
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: the builder's links and depth; the instruction set by contract.
        unsafe { walk::<S, _, _, _>(&self.links(), self.root, &setup, &mut best, |best| best.t, leaf) };
        best
    }

    /// True where a ray in render space hits anything.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn any<S: Simd>(&self, ray: &Ray, mask: u64, odd: &OddCode) -> bool {
        let setup = RaySetup::new(ray.o.to_array(), ray.d.to_array());
        let t_max = ray.t_max;
        let mut found = false;
        let leaf = |found: &mut bool, link: Link| {
            let (first, count) = link.items();
            for i in first..first + count {
                // SAFETY: as above.
                let placed = unsafe { self.placed.get_unchecked(i) };
                if placed.mask & mask == 0 {
                    continue;
                }
                if placed.is_odd() {
                    // SAFETY: as above.
                    if unsafe { (odd.any)(placed, ray) } {
                        *found = true;
                        return ControlFlow::Break(());
                    }
                    continue;
                }
                // SAFETY: as above.
                *found = unsafe {
                    let moved;
                    let local = if placed.is_identity() {
                        &setup
                    } else {
                        moved = placed.ray(&setup);
                        &moved
                    };
                    (*placed.blas).any::<S, false>(local, t_max)
                };
                if *found {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: as above.
        unsafe { walk::<S, _, _, _>(&self.links(), self.root, &setup, &mut found, |_| t_max, leaf) };
        found
    }
}
