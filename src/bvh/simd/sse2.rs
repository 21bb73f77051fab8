//! SSE2, the baseline of x86-64: boxes as two halves.

use std::arch::x86_64::*;

use super::{Lanes, Simd};

/// SSE2.
pub(in crate::bvh) struct Sse2;

impl Simd for Sse2 {
    type F8 = F8;
    type F4 = F4;
}

/// Four lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F4(__m128);

/// Eight lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F8(F4, F4);

// SAFETY: each method asks its caller for SSE2.
unsafe impl Lanes<4> for F4 {
    #[inline(always)]
    unsafe fn splat(v: f32) -> Self {
        unsafe { Self(_mm_set1_ps(v)) }
    }
    #[inline(always)]
    unsafe fn load(v: &[f32; 4]) -> Self {
        unsafe { Self(_mm_loadu_ps(v.as_ptr())) }
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 4]) {
        unsafe { _mm_storeu_ps(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        unsafe { Self(_mm_add_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        unsafe { Self(_mm_sub_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        unsafe { Self(_mm_mul_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        unsafe { Self(_mm_div_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        unsafe { Self(_mm_min_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        unsafe { Self(_mm_max_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn le(self, b: Self) -> u32 {
        unsafe { _mm_movemask_ps(_mm_cmple_ps(self.0, b.0)) as u32 }
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        unsafe { _mm_movemask_ps(_mm_cmpeq_ps(self.0, b.0)) as u32 }
    }
}

// SAFETY: each method asks its caller for SSE2.
unsafe impl Lanes<8> for F8 {
    #[inline(always)]
    unsafe fn splat(v: f32) -> Self {
        unsafe {
            let half = F4::splat(v);
            Self(half, half)
        }
    }
    #[inline(always)]
    unsafe fn load(v: &[f32; 8]) -> Self {
        unsafe {
            let (halves, _) = v.as_chunks::<4>();
            Self(F4::load(&halves[0]), F4::load(&halves[1]))
        }
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        unsafe {
            let (halves, _) = to.as_chunks_mut::<4>();
            self.0.store(&mut halves[0]);
            self.1.store(&mut halves[1])
        }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        unsafe { Self(self.0.add(b.0), self.1.add(b.1)) }
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        unsafe { Self(self.0.sub(b.0), self.1.sub(b.1)) }
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        unsafe { Self(self.0.mul(b.0), self.1.mul(b.1)) }
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        unsafe { Self(self.0.div(b.0), self.1.div(b.1)) }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        unsafe { Self(self.0.min(b.0), self.1.min(b.1)) }
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        unsafe { Self(self.0.max(b.0), self.1.max(b.1)) }
    }
    #[inline(always)]
    unsafe fn le(self, b: Self) -> u32 {
        unsafe { self.0.le(b.0) | self.1.le(b.1) << 4 }
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        unsafe { self.0.eq(b.0) | self.1.eq(b.1) << 4 }
    }
}
