//! Pixels inside a page: half floats, packed.

use std::io::Write;

use base64::Engine;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;

/// Values of a picture of several channels, as base64 of zlib of half floats: all high bytes, then all low bytes, each
/// less the one before it in the same channel, which packs well. Values beyond the range of half floats are clipped.
pub(super) fn halves(values: &[f32], channels: usize) -> String {
    let bits: Vec<u16> = values
        .iter()
        .map(|v| if v.is_nan() { f16::NAN } else { f16::from_f32(v.clamp(-65504.0, 65504.0)) })
        .map(f16::to_bits)
        .collect();
    let mut bytes = Vec::with_capacity(2 * bits.len());
    for shift in [8, 0] {
        let byte = |i: usize| (bits[i] >> shift) as u8;
        bytes.extend(
            (0..bits.len()).map(|i| if i < channels { byte(i) } else { byte(i).wrapping_sub(byte(i - channels)) }),
        );
    }
    packed(&bytes)
}

/// Values from 0 to 1 in steps of 1/255.
pub(super) fn shares(values: &[f32]) -> String {
    packed(&values.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0 + 0.5) as u8).collect::<Vec<_>>())
}

fn packed(bytes: &[u8]) -> String {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Memory takes everything.
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default();
    base64::engine::general_purpose::STANDARD.encode(packed)
}

/// Means of squares of `factor` pixels, which may be cut at the right and at the bottom; and the size of the result.
pub(super) fn reduced(values: &[f32], channels: usize, width: usize, factor: usize) -> (Vec<f32>, usize, usize) {
    let height = values.len() / channels / width.max(1);
    if factor <= 1 {
        return (values.to_vec(), width, height);
    }
    let (small_width, small_height) = (width.div_ceil(factor), height.div_ceil(factor));
    let mut result = Vec::with_capacity(small_width * small_height * channels);
    for y in (0..height).step_by(factor) {
        for x in (0..width).step_by(factor) {
            for c in 0..channels {
                let (mut sum, mut count) = (0.0_f64, 0.0);
                for y in y..height.min(y + factor) {
                    for x in x..width.min(x + factor) {
                        sum += f64::from(values[(y * width + x) * channels + c]);
                        count += 1.0;
                    }
                }
                result.push((sum / count) as f32);
            }
        }
    }
    (result, small_width, small_height)
}

/// A square of `side` pixels around one, less what lies beyond the borders; and where it begins and its size.
pub(super) fn crop(
    values: &[f32],
    channels: usize,
    width: usize,
    at: [usize; 2],
    side: usize,
) -> (Vec<f32>, [usize; 4]) {
    let height = values.len() / channels / width;
    let range = |centre: usize, size: usize| centre.saturating_sub(side / 2)..size.min(centre + side / 2 + 1);
    let (columns, rows) = (range(at[0], width), range(at[1], height));
    let mut result = Vec::new();
    for y in rows.clone() {
        let row = y * width;
        result.extend_from_slice(&values[(row + columns.start) * channels..(row + columns.end) * channels]);
    }
    (result, [columns.start, rows.start, columns.len(), rows.len()])
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    fn unpacked(text: &str) -> Vec<u8> {
        let bytes = base64::engine::general_purpose::STANDARD.decode(text).unwrap();
        let mut result = Vec::new();
        flate2::read::ZlibDecoder::new(&bytes[..]).read_to_end(&mut result).unwrap();
        result
    }

    #[test]
    fn halves_come_back() {
        let values = [1.0, -2.5, 0.0, 1e9, f32::NAN, 0.333_251_95];
        let mut bytes = unpacked(&halves(&values, 2));
        let n = values.len();
        for plane in [0, n] {
            for i in 2..n {
                bytes[plane + i] = bytes[plane + i].wrapping_add(bytes[plane + i - 2]);
            }
        }
        let back: Vec<f32> =
            (0..n).map(|i| f16::from_bits(u16::from_be_bytes([bytes[i], bytes[n + i]])).to_f32()).collect();
        assert_eq!(back[..4], [1.0, -2.5, 0.0, 65504.0]);
        assert!(back[4].is_nan());
        assert_eq!(back[5], 0.333_251_95);
        assert_eq!(unpacked(&shares(&[0.0, 0.5, 2.0])), [0, 128, 255]);
    }

    #[test]
    fn reduction_and_crops_heed_the_borders() {
        let values: Vec<f32> = (0..15).map(|i| i as f32).collect();
        let (small, width, height) = reduced(&values, 1, 5, 2);
        assert_eq!((width, height), (3, 2));
        assert_eq!(small, [3.0, 5.0, 6.5, 10.5, 12.5, 14.0]);
        let (part, place) = crop(&values, 1, 5, [4, 0], 3);
        assert_eq!((part, place), (vec![3.0, 4.0, 8.0, 9.0], [3, 0, 2, 2]));
    }
}
