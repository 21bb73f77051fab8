//! The upper level: instances of shapes, and the queries.

use std::ops::ControlFlow;
use std::sync::Arc;

use super::blas::Blas;
use super::buffer::Buffer;
use super::build::{self, LeafRule, Primitive};
use super::isa::Isa;
use super::kernel::{Kernel, RoundCode};
use super::node::{Link, Node};
use super::ray::RaySetup;
use super::round::RoundStart;
use super::simd::Simd;
use super::triangle::Best;
use super::walk::{Links, walk};
use super::{Hit, Instance};
use crate::math::{Affine3A, Bounds, DAffine3, DMat3, Ray, gamma};

/// Relative growth of an instance's box: more than the rounding of its transform and of a ray's.
const MARGIN: f32 = 1.0 / (1 << 20) as f32;

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
}

/// An instance as traversal needs it.
#[repr(C, align(64))]
pub(super) struct Placed {
    /// Columns of the linear part, then the translation.
    render_to_object: [[f32; 3]; 4],
    blas: *const Blas,
    mask: u64,
    /// Index in the caller's list, [`Placed::IDENTITY`] added where the transform does nothing and
    /// [`Placed::ROUND`] for a shape of round cones.
    id_and_flags: u32,
}

// SAFETY: `blas` points into an `Arc` that the tree holds, and is only read.
unsafe impl Send for Placed {}
// SAFETY: as above.
unsafe impl Sync for Placed {}

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
        size_of::<Self>() + tree.nodes.bytes() + tree.placed.len() * size_of::<Placed>() + meshes
    }
}

impl Placed {
    const IDENTITY: u32 = 1 << 31;
    const ROUND: u32 = 1 << 30;

    fn new(id: usize, instance: &Instance, blases: &[Arc<Blas>]) -> Option<Self> {
        let blas = blases.get(instance.blas as usize)?;
        let render_to_object = inverse(&instance.object_to_render)?;
        let identity = instance.object_to_render == Affine3A::IDENTITY;
        assert!(id < Self::ROUND as usize, "too many instances");
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        Some(Self {
            render_to_object,
            blas: Arc::as_ptr(blas),
            mask: instance.mask,
            id_and_flags: id as u32 | flag(identity, Self::IDENTITY) | flag(blas.is_round(), Self::ROUND),
        })
    }

    #[inline(always)]
    fn id(&self) -> u32 {
        self.id_and_flags & !(Self::IDENTITY | Self::ROUND)
    }

    #[inline(always)]
    fn is_identity(&self) -> bool {
        self.id_and_flags & Self::IDENTITY != 0
    }

    #[inline(always)]
    fn is_round(&self) -> bool {
        self.id_and_flags & Self::ROUND != 0
    }

    /// The ray in object space; its direction keeps the length that the transform gives it, so that
    /// `t` stays the same.
    #[inline(always)]
    fn ray(&self, ray: &RaySetup) -> RaySetup {
        let [x, y, z, t] = &self.render_to_object;
        let linear = |v: &[f32; 3], i: usize| x[i] * v[0] + y[i] * v[1] + z[i] * v[2];
        let o = [linear(&ray.o, 0) + t[0], linear(&ray.o, 1) + t[1], linear(&ray.o, 2) + t[2]];
        RaySetup::new(o, [linear(&ray.d, 0), linear(&ray.d, 1), linear(&ray.d, 2)])
    }

    /// `ray` in object space, for round cones: also how far from a surface it may be found there though it
    /// starts on it, by the rounding of its own origin and of its way here.
    fn round_start(&self, ray: &Ray) -> RoundStart {
        let RaySetup { o, d, .. } = self.ray(&RaySetup::new(ray.o.to_array(), ray.d.to_array()));
        let [x, y, z, t] = &self.render_to_object;
        let axis = |i: usize| (x[i] * ray.o.x).abs() + (y[i] * ray.o.y).abs() + (z[i] * ray.o.z).abs() + t[i].abs();
        RoundStart { o, d, o_err: gamma(8) * axis(0).max(axis(1)).max(axis(2)) }
    }

    /// `best`, or the nearest hit of a ray in render space on the round cones of the instance.
    ///
    /// # Safety
    /// [`Placed::is_round`], and the instruction set is available.
    #[inline(always)]
    pub unsafe fn closest_round<S: Simd>(&self, ray: &Ray, mut best: Best) -> Best {
        // SAFETY: the shape lives as long as the tree; the instruction set by contract.
        unsafe { (*self.blas).closest_round::<S>(&self.round_start(ray), self.id(), &mut best) };
        best
    }

    /// True where a ray in render space hits a round cone of the instance.
    ///
    /// # Safety
    /// As for [`Placed::closest_round`].
    #[inline(always)]
    pub unsafe fn any_round<S: Simd>(&self, ray: &Ray) -> bool {
        // SAFETY: as above.
        unsafe { (*self.blas).any_round::<S>(&self.round_start(ray), ray.t_max) }
    }
}

/// The inverse, computed in `f64`; `None` where there is none within the range of `f32`.
fn inverse(object_to_render: &Affine3A) -> Option<[[f32; 3]; 4]> {
    let m = object_to_render;
    let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(|c| c.as_dvec3());
    let matrix = DMat3::from_cols(x, y, z);
    let inverse = DAffine3 { matrix3: matrix, translation: m.translation.as_dvec3() }.inverse();
    let columns = [inverse.matrix3.x_axis, inverse.matrix3.y_axis, inverse.matrix3.z_axis, inverse.translation];
    let columns = columns.map(|c| c.as_vec3().to_array());
    (matrix.determinant() != 0.0 && columns.iter().flatten().all(|v| v.is_finite())).then_some(columns)
}

/// The box of an instance in render space; `None` where it holds nothing or is not finite.
fn instance_bounds(instance: &Instance, outline: &[Bounds]) -> Option<Bounds> {
    let corners = outline.iter().flat_map(|b| b.corners());
    let bounds = Bounds::of_points(corners.map(|p| instance.object_to_render.transform_point3(p)));
    let margin = MARGIN * bounds.min.abs().max(bounds.max.abs()).max_element();
    let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
    (bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty()).then_some(bounds)
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
            let Some(bounds) = instance_bounds(instance, outline) else { continue };
            primitives.push(Primitive::new(bounds, unordered.len() as u32));
            unordered.push(Some(placed));
        }
        let wide = build::build(&mut primitives, Self::RULE);
        let take = |p: &Primitive| unordered[p.index as usize].take().expect("each instance has one place");
        let placed = primitives.iter().map(take).collect();
        debug_assert!(wide.items.iter().enumerate().all(|(i, &(first, count))| first as usize == i && count == 1));
        Self { nodes: wide.nodes, root: wide.root, bounds: wide.bounds, placed, blases }
    }

    #[inline(always)]
    fn links(&self) -> Links<Placed> {
        Links { nodes: self.nodes.as_ptr(), items: self.placed.as_ptr() }
    }

    /// The nearest hit of a ray in render space.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn closest<S: Simd>(&self, ray: &Ray, mask: u64, round: &RoundCode) -> Best {
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
                if placed.is_round() {
                    // SAFETY: as below.
                    *best = unsafe { (round.closest)(placed, ray, *best) };
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
                    (*placed.blas).closest::<S>(local, placed.id(), best);
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: the builder's links and depth; the instruction set by contract.
        unsafe { walk::<S, _, _>(&self.links(), self.root, &setup, &mut best, |best| best.t, leaf) };
        best
    }

    /// True where a ray in render space hits anything.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn any<S: Simd>(&self, ray: &Ray, mask: u64, round: &RoundCode) -> bool {
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
                if placed.is_round() {
                    // SAFETY: as above.
                    if unsafe { (round.any)(placed, ray) } {
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
                    (*placed.blas).any::<S>(local, t_max)
                };
                if *found {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(())
        };
        // SAFETY: as above.
        unsafe { walk::<S, _, _>(&self.links(), self.root, &setup, &mut found, |_| t_max, leaf) };
        found
    }
}
