//! The whole traversal compiled once per instruction set, so that nothing crosses a call boundary
//! in the hot loop.

use super::Hit;
use super::isa::Isa;
use super::ray::normalized;
use super::simd::{self, Simd};
use super::top::Tree;
use super::triangle::Best;
use crate::math::Ray;

/// The queries for one instruction set.
pub(super) struct Kernel {
    pub isa: Isa,
    closest: unsafe fn(&Tree, &Ray, u32) -> Option<Hit>,
    any: unsafe fn(&Tree, &Ray, u32) -> bool,
}

/// # Safety
/// The instruction set is available.
#[inline(always)]
unsafe fn closest<S: Simd>(tree: &Tree, ray: &Ray, mask: u32) -> Option<Hit> {
    let (ray, power) = normalized(ray)?;
    // SAFETY: by contract.
    let best = unsafe { tree.closest::<S>(&ray, mask) };
    let Best { t, u, v, instance, triangle } = best;
    (triangle != Best::NONE).then_some(Hit { t: t * power, u, v, instance, triangle })
}

/// # Safety
/// The instruction set is available.
#[inline(always)]
unsafe fn any<S: Simd>(tree: &Tree, ray: &Ray, mask: u32) -> bool {
    // SAFETY: by contract.
    normalized(ray).is_some_and(|(ray, _)| unsafe { tree.any::<S>(&ray, mask) })
}

/// Compiles both queries for an instruction set.
macro_rules! kernel {
    ($name:ident, $isa:expr, $simd:ty $(, $features:literal)?) => {{
        $(#[target_feature(enable = $features)])?
        unsafe fn closest_hit(tree: &Tree, ray: &Ray, mask: u32) -> Option<Hit> {
            // SAFETY: the features are enabled here.
            unsafe { closest::<$simd>(tree, ray, mask) }
        }
        $(#[target_feature(enable = $features)])?
        unsafe fn any_hit(tree: &Tree, ray: &Ray, mask: u32) -> bool {
            // SAFETY: the features are enabled here.
            unsafe { any::<$simd>(tree, ray, mask) }
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
    #[inline(always)]
    pub fn closest(&self, tree: &Tree, ray: &Ray, mask: u32) -> Option<Hit> {
        // SAFETY: only available kernels are handed out.
        unsafe { (self.closest)(tree, ray, mask) }
    }

    /// See [`super::Bvh::any_hit`].
    #[inline(always)]
    pub fn any(&self, tree: &Tree, ray: &Ray, mask: u32) -> bool {
        // SAFETY: as above.
        unsafe { (self.any)(tree, ray, mask) }
    }
}
