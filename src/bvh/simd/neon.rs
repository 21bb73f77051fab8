//! NEON, the baseline of AArch64: boxes as two halves.

use std::arch::aarch64::*;

use super::{Lanes, Simd};

/// NEON.
pub(in crate::bvh) struct Neon;

impl Simd for Neon {
    type F8 = F8;
    type F4 = F4;
}

/// Four lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F4(float32x4_t);

/// Eight lanes.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct F8(F4, F4);

/// One bit per lane of a comparison.
#[inline(always)]
unsafe fn mask(lanes: uint32x4_t) -> u32 {
    const BITS: [u32; 4] = [1, 2, 4, 8];
    unsafe { vaddvq_u32(vandq_u32(lanes, vld1q_u32(BITS.as_ptr()))) }
}

// SAFETY: each method asks its caller for NEON.
unsafe impl Lanes<4> for F4 {
    #[inline(always)]
    unsafe fn splat(v: f32) -> Self {
        unsafe { Self(vdupq_n_f32(v)) }
    }
    #[inline(always)]
    unsafe fn load(v: &[f32; 4]) -> Self {
        unsafe { Self(vld1q_f32(v.as_ptr())) }
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; 4]) {
        unsafe { vst1q_f32(to.as_mut_ptr(), self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        unsafe { Self(vaddq_f32(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        unsafe { Self(vsubq_f32(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        unsafe { Self(vmulq_f32(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        unsafe { Self(vdivq_f32(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        unsafe { Self(vbslq_f32(vcltq_f32(self.0, b.0), self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        unsafe { Self(vbslq_f32(vcgtq_f32(self.0, b.0), self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn le(self, b: Self) -> u32 {
        unsafe { mask(vcleq_f32(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        unsafe { mask(vceqq_f32(self.0, b.0)) }
    }
}

// SAFETY: each method asks its caller for NEON.
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
