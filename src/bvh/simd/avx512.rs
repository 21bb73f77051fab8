//! AVX-512 VL: 256-bit vectors as with AVX2, compares into mask registers, twice the registers.
//!
//! 512-bit operations are split in two by some processors and a node has eight children anyway.

use std::arch::x86_64::*;

use super::{Lanes, Simd};

/// AVX-512 VL.
pub(in crate::bvh) struct Avx512;

impl Simd for Avx512 {
    type F8 = F8;
    // Masks of four lanes come faster from vector registers than from mask registers, whose upper
    // bits would have to be cleared.
    type F4 = super::avx2::F4;
}

/// Eight lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F8(__m256);

// SAFETY: each method asks its caller for AVX-512 VL.
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
        unsafe { u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        unsafe { u32::from(_mm256_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, b.0)) }
    }
}
