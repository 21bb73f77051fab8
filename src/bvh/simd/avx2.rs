//! AVX2: eight boxes at once.

use std::arch::x86_64::*;

use super::{Lanes, Simd};

/// AVX2.
pub(in crate::bvh) struct Avx2;

impl Simd for Avx2 {
    type F8 = F8;
    type F4 = F4;
}

/// Four lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F4(__m128);

/// Eight lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F8(__m256);

// SAFETY: each method asks its caller for AVX2.
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

// SAFETY: each method asks its caller for AVX2.
unsafe impl Lanes<8> for F8 {
    #[inline(always)]
    unsafe fn splat(v: f32) -> Self {
        unsafe { Self(_mm256_set1_ps(v)) }
    }
    #[inline(always)]
    unsafe fn load(v: &[f32; 8]) -> Self {
        unsafe { Self(_mm256_loadu_ps(v.as_ptr())) }
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 8]) {
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        unsafe { Self(_mm256_add_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        unsafe { Self(_mm256_sub_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        unsafe { Self(_mm256_mul_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        unsafe { Self(_mm256_div_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        unsafe { Self(_mm256_min_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        unsafe { Self(_mm256_max_ps(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn le(self, b: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, b.0)) as u32 }
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        unsafe { _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, b.0)) as u32 }
    }
}
