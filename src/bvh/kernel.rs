//! The whole traversal compiled once per instruction set, so that nothing crosses a call boundary
//! in the hot loop.

use super::Hit;
use super::isa::Isa;
use super::placed::{Columns, Placed};
use super::ray::{is_plain, rescaled};
use super::simd;
use super::top::Tree;
use super::triangle::Best;
use crate::math::Ray;

/// The queries for one instruction set.
pub(super) struct Kernel {
    pub isa: Isa,
    closest: unsafe fn(&Tree, &Ray, u64) -> Best,
    any: unsafe fn(&Tree, &Ray, u64) -> bool,
}

/// The queries of an odd instance ([`Placed::is_odd`]) for one instruction set. They are called, and with nothing
/// that has to be made for them, so that code and registers for triangles that stand still are as if there were
/// none; round cones in turn as if nothing moved.
pub(super) struct OddCode {
    pub closest: unsafe fn(&Placed, &Ray, Best) -> Best,
    pub any: unsafe fn(&Placed, &Ray) -> bool,
}

/// Compiles all queries for an instruction set.
macro_rules! kernel {
    ($name:ident, $isa:expr, $simd:ty $(, $features:literal)?) => {{
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn closest_round(placed: &Placed, to_object: &Columns, ray: &Ray, best: Best) -> Best {
            // SAFETY: the features are enabled here.
            unsafe { placed.closest_round::<$simd>(to_object, ray, best) }
        }
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn any_round(placed: &Placed, to_object: &Columns, ray: &Ray) -> bool {
            // SAFETY: the features are enabled here.
            unsafe { placed.any_round::<$simd>(to_object, ray) }
        }
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn closest_moving(placed: &Placed, ray: &Ray, best: Best) -> Best {
            // SAFETY: the features are enabled here.
            unsafe { placed.closest_moving::<$simd>(ray, best, closest_round) }
        }
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn any_moving(placed: &Placed, ray: &Ray) -> bool {
            // SAFETY: the features are enabled here.
            unsafe { placed.any_moving::<$simd>(ray, any_round) }
        }
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn closest_odd(placed: &Placed, ray: &Ray, best: Best) -> Best {
            // SAFETY: the features are enabled here.
            unsafe {
                match placed.moves() {
                    true => closest_moving(placed, ray, best),
                    false => closest_round(placed, placed.still(), ray, best),
                }
            }
        }
        #[inline(never)]
        $(#[target_feature(enable = $features)])?
        unsafe fn any_odd(placed: &Placed, ray: &Ray) -> bool {
            // SAFETY: the features are enabled here.
            unsafe {
                match placed.moves() {
                    true => any_moving(placed, ray),
                    false => any_round(placed, placed.still(), ray),
                }
            }
        }
        static ODD: OddCode = OddCode { closest: closest_odd, any: any_odd };
        $(#[target_feature(enable = $features)])?
        unsafe fn closest_hit(tree: &Tree, ray: &Ray, mask: u64) -> Best {
            // SAFETY: the features are enabled here.
            unsafe { tree.closest::<$simd>(ray, mask, &ODD) }
        }
        $(#[target_feature(enable = $features)])?
        unsafe fn any_hit(tree: &Tree, ray: &Ray, mask: u64) -> bool {
            // SAFETY: the features are enabled here.
            unsafe { tree.any::<$simd>(ray, mask, &ODD) }
        }
        static $name: Kernel = Kernel { isa: $isa, closest: closest_hit, any: any_hit };
        &$name
    }};
}

impl Kernel {
    /// The code for `isa`, which must be available; the scalar one for a foreign architecture's.
    pub fn of(isa: Isa) -> &'static Self {
        debug_assert!(Isa::available().contains(&isa));
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Sse2 => kernel!(SSE2, Isa::Sse2, simd::Sse2),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 => kernel!(AVX2, Isa::Avx2, simd::Avx2, "avx2,bmi1,bmi2,lzcnt,popcnt"),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx512 => kernel!(AVX512, Isa::Avx512, simd::Avx512, "avx512f,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt"),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => kernel!(NEON, Isa::Neon, simd::Neon),
            _ => kernel!(SCALAR, Isa::Scalar, simd::Scalar),
        }
    }

    /// See [`super::Bvh::closest_hit`].
    #[inline]
    pub fn closest(&self, tree: &Tree, ray: &Ray, mask: u64) -> Option<Hit> {
        if !is_plain(ray) {
            let (scaled, power) = rescaled(ray)?;
            return self.closest(tree, &scaled, mask).map(|hit| Hit { t: hit.t * power, ..hit });
        }
        // SAFETY: only available kernels are handed out.
        let Best { t, u, v, instance, primitive } = unsafe { (self.closest)(tree, ray, mask) };
        (primitive != Best::NONE).then_some(Hit { t, u, v, instance, primitive })
    }

    /// See [`super::Bvh::any_hit`].
    #[inline]
    pub fn any(&self, tree: &Tree, ray: &Ray, mask: u64) -> bool {
        if !is_plain(ray) {
            return rescaled(ray).is_some_and(|(scaled, _)| self.any(tree, &scaled, mask));
        }
        // SAFETY: as above.
        unsafe { (self.any)(tree, ray, mask) }
    }
}
