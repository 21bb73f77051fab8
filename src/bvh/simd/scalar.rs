//! The scalar twin: runs everywhere, under Miri too, and is what the others are tested against.

use super::{Lanes, Simd};

/// No vector instructions.
pub(in crate::bvh) struct Scalar;

impl Simd for Scalar {
    type F8 = Array<8>;
    type F4 = Array<4>;
}

/// Lanes in an array.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct Array<const N: usize>([f32; N]);

impl<const N: usize> Array<N> {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], b.0[i])))
    }

    #[inline(always)]
    fn mask(self, b: Self, f: impl Fn(f32, f32) -> bool) -> u32 {
        (0..N).fold(0, |mask, i| mask | u32::from(f(self.0[i], b.0[i])) << i)
    }
}

// SAFETY: needs no instruction set.
unsafe impl<const N: usize> Lanes<N> for Array<N> {
    #[inline(always)]
    unsafe fn splat(v: f32) -> Self {
        Self([v; N])
    }
    #[inline(always)]
    unsafe fn load(v: &[f32; N]) -> Self {
        Self(*v)
    }
    #[inline(always)]
    unsafe fn store(self, to: &mut [f32; N]) {
        *to = self.0;
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        self.zip(b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        self.zip(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    unsafe fn le(self, b: Self) -> u32 {
        self.mask(b, |a, b| a <= b)
    }
    #[inline(always)]
    unsafe fn eq(self, b: Self) -> u32 {
        self.mask(b, |a, b| a == b)
    }
}
