//! A 64-bit digest of bytes, by which it is known whether data are the same.
//!
//! XXH64 (Yann Collet, *xxHash fast digest algorithm*, specification 0.1.1, section "XXH64 algorithm description"),
//! with seed 0. It tells accidents apart, not attacks.

use std::fmt;

const P1: u64 = 0x9E37_79B1_85EB_CA87;
const P2: u64 = 0xC2B2_AE3D_27D4_EB4F;
const P3: u64 = 0x1656_67B1_9E37_79F9;
const P4: u64 = 0x85EB_CA77_C2B2_AE63;
const P5: u64 = 0x27D4_EB2F_1656_67C5;

/// Bytes of a stripe, which four lanes take in together.
const STRIPE: usize = 32;

/// Takes in bytes, piece by piece; how they are cut into pieces makes no difference.
#[derive(Clone, Debug)]
pub struct Digest {
    lanes: [u64; 4],
    /// What has not filled a stripe yet.
    rest: [u8; STRIPE],
    held: usize,
    length: u64,
}

impl Default for Digest {
    fn default() -> Self {
        let lanes = [P1.wrapping_add(P2), P2, 0, 0_u64.wrapping_sub(P1)];
        Self { lanes, rest: [0; STRIPE], held: 0, length: 0 }
    }
}

fn word(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte))
}

fn round(lane: u64, word: u64) -> u64 {
    lane.wrapping_add(word.wrapping_mul(P2)).rotate_left(31).wrapping_mul(P1)
}

fn stripe(lanes: &mut [u64; 4], stripe: &[u8]) {
    for (lane, bytes) in lanes.iter_mut().zip(stripe.chunks_exact(8)) {
        let bytes: [u8; 8] = bytes.try_into().unwrap_or_default();
        *lane = round(*lane, u64::from_le_bytes(bytes));
    }
}

impl Digest {
    /// Takes in `bytes`.
    pub fn write(&mut self, bytes: &[u8]) {
        self.length = self.length.wrapping_add(bytes.len() as u64);
        let mut bytes = bytes;
        if self.held > 0 {
            let taken = bytes.len().min(STRIPE - self.held);
            self.rest[self.held..self.held + taken].copy_from_slice(&bytes[..taken]);
            self.held += taken;
            bytes = &bytes[taken..];
            if self.held < STRIPE {
                return;
            }
            stripe(&mut self.lanes, &self.rest);
        }
        let mut stripes = bytes.chunks_exact(STRIPE);
        stripes.by_ref().for_each(|bytes| stripe(&mut self.lanes, bytes));
        let rest = stripes.remainder();
        self.rest[..rest.len()].copy_from_slice(rest);
        self.held = rest.len();
    }

    /// Takes in a number.
    pub fn write_u64(&mut self, number: u64) {
        self.write(&number.to_le_bytes());
    }

    /// The digest of all that was taken in so far.
    pub fn finish(&self) -> u64 {
        let [a, b, c, d] = self.lanes;
        let mut hash = if self.length < STRIPE as u64 {
            P5
        } else {
            let sum = [(a, 1), (b, 7), (c, 12), (d, 18)];
            let mixed = sum.iter().fold(0_u64, |hash, &(lane, by)| hash.wrapping_add(lane.rotate_left(by)));
            let merge = |hash: u64, &lane: &u64| (hash ^ round(0, lane)).wrapping_mul(P1).wrapping_add(P4);
            self.lanes.iter().fold(mixed, merge)
        };
        hash = hash.wrapping_add(self.length);
        let mut rest = &self.rest[..self.held];
        while let Some((bytes, after)) = rest.split_at_checked(8) {
            hash = (hash ^ round(0, word(bytes))).rotate_left(27).wrapping_mul(P1).wrapping_add(P4);
            rest = after;
        }
        if let Some((bytes, after)) = rest.split_at_checked(4) {
            hash = (hash ^ word(bytes).wrapping_mul(P1)).rotate_left(23).wrapping_mul(P2).wrapping_add(P3);
            rest = after;
        }
        for &byte in rest {
            hash = (hash ^ u64::from(byte).wrapping_mul(P5)).rotate_left(11).wrapping_mul(P1);
        }
        hash = (hash ^ hash >> 33).wrapping_mul(P2);
        hash = (hash ^ hash >> 29).wrapping_mul(P3);
        hash ^ hash >> 32
    }
}

impl fmt::Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.write(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bytes: &[u8]) -> u64 {
        let mut digest = Digest::default();
        digest.write(bytes);
        digest.finish()
    }

    #[test]
    fn digests_are_the_published_ones() {
        assert_eq!(of(b""), 0xef46_db37_51d8_e999);
        assert_eq!(of(b"a"), 0xd24e_c4f1_a98c_6e5b);
        assert_eq!(of(b"abc"), 0x44bc_2cf5_ad77_0999);
        // The bytes of the specification's own self test.
        let mut generator = 2_654_435_761_u64;
        let bytes: Vec<u8> = (0..222)
            .map(|_| {
                let byte = (generator >> 56) as u8;
                generator = generator.wrapping_mul(11_400_714_785_074_694_797);
                byte
            })
            .collect();
        assert_eq!(of(&bytes[..1]), 0xe934_a84a_db05_2768);
        assert_eq!(of(&bytes[..14]), 0x8282_dcc4_994e_35c8);
        assert_eq!(of(&bytes[..222]), 0xb641_ae8c_b691_c174);
    }

    #[test]
    fn pieces_make_no_difference() {
        let bytes: Vec<u8> = (0..300_u32).map(|i| (i * 7 % 251) as u8).collect();
        for size in [1, 3, 8, 31, 32, 33, 100] {
            let mut digest = Digest::default();
            bytes.chunks(size).for_each(|piece| digest.write(piece));
            assert_eq!(digest.finish(), of(&bytes), "{size}");
        }
    }
}
