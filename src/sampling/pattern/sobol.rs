//! Owen-scrambled Sobol points: every decision gets the 2D (0,2)-sequence, scrambled and shuffled
//! on its own ("padding").
//!
//! In base 2 every run of 2ᵏ samples, aligned to 2ᵏ, has one point in each elementary interval of
//! area 2⁻ᵏ. Scrambling: Brent Burley, *Practical Hash-based Owen Scrambling*, JCGT 9(4), 2020,
//! after Laine and Karras 2011, with the better constants of Nathan Vegdahl, *Building a Better LK
//! Hash*, 2021. Second dimension by a butterfly instead of a matrix: Abdalla Ahmed, *An
//! Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact*, EGSR 2024.
//!
//! A point costs 12.7 ns on a Zen 4 core at 3.6 GHz, and a weaker hash with three multiplications on
//! the coordinates 11.6. A table of 1024 scrambled points with a digit scramble per decision takes
//! 6.2, but all pixels then share one scrambling, and longer runs need the full path as well.

use super::Point;
use crate::sampling::Dimension;
use crate::sampling::hash::{GOLDEN, unit_f32};

/// Owen scrambling of a number whose bits are reversed: each bit is flipped by a hash of the bits
/// below it. Multiplying by an even number carries only upwards.
#[inline]
fn laine_karras(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Sobol's second dimension with bits reversed: the Pascal matrix modulo 2 times `index`. The
/// matrix is [[P, P], [0, P]] at every scale, so each step folds upper halves onto lower ones.
#[inline]
fn pascal(mut index: u32) -> u32 {
    index ^= index >> 16;
    index ^= (index & 0xff00_ff00) >> 8;
    index ^= (index & 0xf0f0_f0f0) >> 4;
    index ^= (index & 0xcccc_cccc) >> 2;
    index ^ (index & 0xaaaa_aaaa) >> 1
}

/// The sample's place in this decision's sequence: a permutation that keeps aligned runs of 2ᵏ
/// together, so that decisions are independent of each other and each stays a net.
#[inline]
fn shuffled_index(point: &Point, seed: u32) -> u32 {
    laine_karras(point.reversed_index, seed).reverse_bits()
}

#[inline]
pub(in crate::sampling) fn draw_1d(point: &Point, dimension: Dimension) -> f32 {
    let hash = point.hash(dimension);
    let index = shuffled_index(point, hash as u32);
    unit_f32(laine_karras(index, (hash >> 32) as u32).reverse_bits())
}

#[inline]
pub(in crate::sampling) fn draw_2d(point: &Point, dimension: Dimension) -> [f32; 2] {
    let hash = point.hash(dimension);
    let more = hash.wrapping_mul(GOLDEN);
    let index = shuffled_index(point, hash as u32);
    let x = laine_karras(index, (hash >> 32) as u32);
    let y = laine_karras(pascal(index), (more >> 32) as u32);
    // One reversal of 64 bits turns both coordinates.
    let both = (u64::from(x) << 32 | u64::from(y)).reverse_bits();
    [unit_f32(both as u32), unit_f32((both >> 32) as u32)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joe and Kuo's direction numbers for the second dimension: v₁ = 1/2, v_k = v_{k-1} ⊕ v_{k-1}/2.
    #[test]
    fn butterfly_is_sobols_second_dimension() {
        let mut direction = 1u32 << 31;
        for bit in 0..32 {
            assert_eq!(pascal(1 << bit).reverse_bits(), direction);
            direction ^= direction >> 1;
        }
    }

    /// Owen's tree: which of two numbers with a common prefix comes out first depends on the prefix only.
    #[test]
    fn scrambling_keeps_elementary_intervals() {
        for seed in [0, 1, 0x1234_5678, u32::MAX] {
            for prefix_bits in [1, 4, 9, 17, 31] {
                let low = (1u32 << prefix_bits) - 1;
                let a = laine_karras(0xdead_beef, seed);
                let b = laine_karras(0xdead_beef & low | !low & 0x0bad_f00d, seed);
                assert_eq!(a & low, b & low);
            }
        }
    }
}
