//! Integer hashing for seeds and for the independent pattern.

/// Mixes all 64 bits: the finalizer "Mix13" of David Stafford (2011), as in SplitMix64 (Steele,
/// Lea and Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014). A bijection.
#[inline]
pub(super) const fn mix64(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Odd multiplier 2⁶⁴/φ, which spreads small integers over the word.
pub(super) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The upper 24 bits as a float in [0, 1), exact: no rounding can give 1.
#[inline]
pub(super) fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The conversion reads 24 bits, so 2²⁴ inputs are all there are.
    #[test]
    fn unit_interval_exhaustively() {
        let mut previous = -1.0;
        for high in 0..1u32 << 24 {
            let u = unit_f32(high << 8 | 0xff);
            assert!(u > previous && u < 1.0 && u == unit_f32(high << 8));
            previous = u;
        }
        assert_eq!(unit_f32(0), 0.0);
    }
}
