//! The few vector operations that traversal needs, one implementation per instruction set.
//!
//! All are plain IEEE operations in the same order and without fused multiply-adds, so that every
//! instruction set gives the same bits: the scalar twin is the reference, and the edge functions
//! of a triangle and its neighbor stay exact opposites (see `triangle.rs`).

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod scalar;
#[cfg(target_arch = "x86_64")]
mod sse2;

#[cfg(target_arch = "aarch64")]
pub(super) use neon::Neon;
pub(super) use scalar::Scalar;
#[cfg(target_arch = "x86_64")]
pub(super) use {avx2::Avx2, avx512::Avx512, sse2::Sse2};

/// An instruction set: its vectors of 8 lanes for boxes and of 4 for triangles.
pub(super) trait Simd {
    /// Eight lanes.
    type F8: Lanes<8>;
    /// Four lanes.
    type F4: Lanes<4>;
}

/// Begins to load all cache lines of `*at` where the machine has such an instruction; a hint that
/// may name any address.
#[inline(always)]
pub(super) fn prefetch<T>(at: *const T) {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    for line in 0..size_of::<T>().div_ceil(64) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: prefetches access no memory.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(at.cast::<i8>().wrapping_add(64 * line)) };
    }
    #[cfg(not(all(target_arch = "x86_64", not(miri))))]
    let _ = at;
}

/// `N` numbers side by side.
///
/// # Safety
/// Every method may be called only where the instruction set is available, and must be inlined
/// into a function that enables it.
pub(super) unsafe trait Lanes<const N: usize>: Copy {
    /// `v` in every lane.
    unsafe fn splat(v: f32) -> Self;
    /// Lanes from memory.
    unsafe fn load(v: &[f32; N]) -> Self;
    /// Lanes to memory.
    unsafe fn store(self, to: &mut [f32; N]);
    /// Sum.
    unsafe fn add(self, b: Self) -> Self;
    /// Difference.
    unsafe fn sub(self, b: Self) -> Self;
    /// Product.
    unsafe fn mul(self, b: Self) -> Self;
    /// Quotient.
    unsafe fn div(self, b: Self) -> Self;
    /// `self < b ? self : b`; so `b` where either is NaN.
    unsafe fn min(self, b: Self) -> Self;
    /// `self > b ? self : b`; so `b` where either is NaN.
    unsafe fn max(self, b: Self) -> Self;
    /// Bit `i` is set where `self <= b` in lane `i`; never for NaN.
    unsafe fn le(self, b: Self) -> u32;
    /// Bit `i` is set where `self == b` in lane `i`; never for NaN.
    unsafe fn eq(self, b: Self) -> u32;
}
