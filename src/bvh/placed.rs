//! Instances as traversal needs them.

use std::sync::Arc;

use super::Instance;
use super::blas::{Blas, Kind};
use super::ray::RaySetup;
use super::round::RoundStart;
use super::simd::Simd;
use super::triangle::Best;
use crate::math::{Affine3A, Bounds, DAffine3, DMat3, MovingTransform, Ray, gamma, traced};

/// Relative growth of an instance's box: more than the rounding of its transform and of a ray's.
const MARGIN: f32 = 1.0 / (1 << 20) as f32;

/// Columns of the linear part, then the translation.
pub(super) type Columns = [[f32; 3]; 4];

/// An instance as traversal needs it.
#[repr(C, align(64))]
pub(super) struct Placed {
    render_to_object: Columns,
    pub blas: *const Blas,
    pub mask: u64,
    /// Index in the caller's list, [`Placed::IDENTITY`] added where the transform does nothing, [`Placed::ODD`] for all
    /// but triangles that stand still and [`Placed::MOVES`] for all that does not.
    id_and_flags: u32,
    /// How the transform changes, in place of `render_to_object`; null where it does not.
    motion: *const MovingTransform,
}

// SAFETY: `blas` and `motion` point into `Arc`s that the tree holds, and are only read.
unsafe impl Send for Placed {}
// SAFETY: as above.
unsafe impl Sync for Placed {}

impl Placed {
    const IDENTITY: u32 = 1 << 31;
    const ODD: u32 = 1 << 30;
    const MOVES: u32 = 1 << 29;

    /// `None` for an instance that is never hit.
    pub fn new(id: usize, instance: &Instance, blases: &[Arc<Blas>]) -> Option<Self> {
        let blas = blases.get(instance.blas as usize)?;
        let render_to_object = inverse(&instance.object_to_render)?;
        let identity = instance.object_to_render == Affine3A::IDENTITY;
        assert!(id < Self::MOVES as usize, "too many instances");
        let flag = |on: bool, flag: u32| if on { flag } else { 0 };
        let moves = instance.motion.is_some() || matches!(blas.kind(), Kind::Moving(_));
        let odd = moves || matches!(blas.kind(), Kind::Rounds(_));
        Some(Self {
            render_to_object,
            blas: Arc::as_ptr(blas),
            mask: instance.mask,
            id_and_flags: id as u32 | flag(identity, Self::IDENTITY) | flag(odd, Self::ODD) | flag(moves, Self::MOVES),
            motion: instance.motion.as_ref().map_or(std::ptr::null(), Arc::as_ptr),
        })
    }

    #[inline(always)]
    pub fn id(&self) -> u32 {
        self.id_and_flags & !(Self::IDENTITY | Self::ODD | Self::MOVES)
    }

    #[inline(always)]
    pub fn is_identity(&self) -> bool {
        self.id_and_flags & Self::IDENTITY != 0
    }

    /// True for round cones and for all that moves: their queries are called.
    #[inline(always)]
    pub fn is_odd(&self) -> bool {
        self.id_and_flags & Self::ODD != 0
    }

    /// True for what moves or whose points do: its queries are [`Placed::closest_moving`] and [`Placed::any_moving`];
    /// those of other odd instances are [`Placed::closest_round`] and [`Placed::any_round`].
    #[inline(always)]
    pub fn moves(&self) -> bool {
        self.id_and_flags & Self::MOVES != 0
    }

    /// The ray in object space.
    #[inline(always)]
    pub fn ray(&self, ray: &RaySetup) -> RaySetup {
        moved(&self.render_to_object, ray)
    }

    /// From render to object space when `ray` sees it; `None` where the transform can't be undone then.
    #[inline(always)]
    fn to_object(&self, ray: &Ray) -> Option<Columns> {
        // SAFETY: null, or what lives as long as the tree.
        match unsafe { self.motion.as_ref() } {
            None => Some(self.render_to_object),
            Some(motion) => inverse(&traced(&motion.at(ray.time))),
        }
    }

    /// From render to object space where it does not move.
    #[inline(always)]
    pub fn still(&self) -> &Columns {
        &self.render_to_object
    }

    /// `best`, or the nearest hit of a ray in render space on round cones, whose space is reached by `to_object`.
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn closest_round<S: Simd>(&self, to_object: &Columns, ray: &Ray, mut best: Best) -> Best {
        // SAFETY: the shape lives as long as the tree; the instruction set by contract.
        unsafe {
            let blas = &*self.blas;
            if let Kind::Rounds(rounds) = blas.kind() {
                blas.closest_round::<S>(rounds, &round_start(to_object, ray), self.id(), &mut best);
            }
        }
        best
    }

    /// True where a ray in render space hits round cones, whose space is reached by `to_object`.
    ///
    /// # Safety
    /// As for [`Placed::closest_round`].
    #[inline(always)]
    pub unsafe fn any_round<S: Simd>(&self, to_object: &Columns, ray: &Ray) -> bool {
        // SAFETY: as above.
        unsafe {
            let blas = &*self.blas;
            match blas.kind() {
                Kind::Rounds(rounds) => blas.any_round::<S>(rounds, &round_start(to_object, ray), ray.t_max),
                _ => false,
            }
        }
    }

    /// `best`, or the nearest hit of a ray in render space on the instance, which moves or whose points do;
    /// `closest_round` is the compiled [`Placed::closest_round`].
    ///
    /// # Safety
    /// The instruction set is available.
    #[inline(always)]
    pub unsafe fn closest_moving<S: Simd>(
        &self,
        ray: &Ray,
        mut best: Best,
        closest_round: unsafe fn(&Self, &Columns, &Ray, Best) -> Best,
    ) -> Best {
        let Some(to_object) = self.to_object(ray) else { return best };
        // SAFETY: the shape lives as long as the tree; the instruction set by contract.
        unsafe {
            let blas = &*self.blas;
            match blas.kind() {
                Kind::Triangles => blas.closest::<S, true>(&setup(&to_object, ray), self.id(), &mut best),
                Kind::Rounds(_) => return closest_round(self, &to_object, ray, best),
                Kind::Moving(moving) => {
                    moving.closest::<S>(&round_start(&to_object, ray), ray.time, self.id(), &mut best);
                }
            }
        }
        best
    }

    /// True where a ray in render space hits the instance, which moves or whose points do; `any_round` is the compiled
    /// [`Placed::any_round`].
    ///
    /// # Safety
    /// As for [`Placed::closest_moving`].
    #[inline(always)]
    pub unsafe fn any_moving<S: Simd>(&self, ray: &Ray, any_round: unsafe fn(&Self, &Columns, &Ray) -> bool) -> bool {
        let Some(to_object) = self.to_object(ray) else { return false };
        // SAFETY: as above.
        unsafe {
            let blas = &*self.blas;
            match blas.kind() {
                Kind::Triangles => blas.any::<S, true>(&setup(&to_object, ray), ray.t_max),
                Kind::Rounds(_) => any_round(self, &to_object, ray),
                Kind::Moving(moving) => moving.any::<S>(&round_start(&to_object, ray), ray.time, ray.t_max),
            }
        }
    }
}

/// The ray in object space; its direction keeps the length that the transform gives it, so that `t` stays the
/// same.
#[inline(always)]
fn moved([x, y, z, t]: &Columns, ray: &RaySetup) -> RaySetup {
    let linear = |v: &[f32; 3], i: usize| x[i] * v[0] + y[i] * v[1] + z[i] * v[2];
    let o = [linear(&ray.o, 0) + t[0], linear(&ray.o, 1) + t[1], linear(&ray.o, 2) + t[2]];
    RaySetup::new(o, [linear(&ray.d, 0), linear(&ray.d, 1), linear(&ray.d, 2)])
}

fn setup(to_object: &Columns, ray: &Ray) -> RaySetup {
    moved(to_object, &RaySetup::new(ray.o.to_array(), ray.d.to_array()))
}

/// `ray` in object space, for round cones: also how far from a surface it may be found there though it
/// starts on it, by the rounding of its own origin and of its way here.
fn round_start(to_object: &Columns, ray: &Ray) -> RoundStart {
    let RaySetup { o, d, .. } = setup(to_object, ray);
    let [x, y, z, t] = to_object;
    let axis = |i: usize| (x[i] * ray.o.x).abs() + (y[i] * ray.o.y).abs() + (z[i] * ray.o.z).abs() + t[i].abs();
    RoundStart { o, d, o_err: gamma(8) * axis(0).max(axis(1)).max(axis(2)) }
}

/// The inverse, computed in `f64`; `None` where there is none within the range of `f32`.
fn inverse(object_to_render: &Affine3A) -> Option<Columns> {
    let m = object_to_render;
    let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, m.matrix3.z_axis].map(|c| c.as_dvec3());
    let matrix = DMat3::from_cols(x, y, z);
    let inverse = DAffine3 { matrix3: matrix, translation: m.translation.as_dvec3() }.inverse();
    let columns = [inverse.matrix3.x_axis, inverse.matrix3.y_axis, inverse.matrix3.z_axis, inverse.translation];
    let columns = columns.map(|c| c.as_vec3().to_array());
    (matrix.determinant() != 0.0 && columns.iter().flatten().all(|v| v.is_finite())).then_some(columns)
}

/// The box of an instance in render space, over all times; `None` where it holds nothing or is not finite.
pub(super) fn bounds(instance: &Instance, outline: &[Bounds]) -> Option<Bounds> {
    let bounds = match &instance.motion {
        Some(motion) => motion.bounds(outline),
        None => {
            let corners = outline.iter().flat_map(|b| b.corners());
            Bounds::of_points(corners.map(|p| instance.object_to_render.transform_point3(p)))
        }
    };
    let margin = MARGIN * bounds.min.abs().max(bounds.max.abs()).max_element();
    let bounds = Bounds { min: bounds.min - margin, max: bounds.max + margin };
    (bounds.min.is_finite() && bounds.max.is_finite() && !bounds.is_empty()).then_some(bounds)
}
