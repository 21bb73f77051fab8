//! The sRGB transfer function's inverse, and tables of both for 8-bit texels.

use std::sync::LazyLock;

pub(super) use crate::math::srgb_to_linear as decode;
use crate::math::srgb_to_linear_f64 as decode_f64;

/// Linear value of each 8-bit code.
pub(super) static DECODE_U8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode_f64(code as f64 / 255.0) as f32));

/// Linear values at equal steps of encoded ones from 0 to 1, and one beyond.
static STEPS: LazyLock<[f32; 1026]> = LazyLock::new(|| std::array::from_fn(|i| decode_f64(i as f64 / 1024.0) as f32));

/// Light of an encoded colour from 0 to 1 whose values lie between codes, within 5e-7 (of which 3.6e-7 are the chords'); alpha stays.
pub(super) fn decode_all([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    let table = &*STEPS;
    let decoded = |value: f32| {
        let place = (value * 1024.0).clamp(0.0, 1024.0);
        let (i, t) = (place as usize, place.fract());
        table[i] + t * (table[i + 1] - table[i])
    };
    [decoded(r), decoded(g), decoded(b), a]
}

/// Inverse of [`decode`].
pub(super) fn encode(linear: f32) -> f32 {
    let l = f64::from(linear.abs());
    let encoded = if l <= 0.04045 / 12.92 { l * 12.92 } else { 1.055 * l.powf(1.0 / 2.4) - 0.055 };
    (encoded as f32).copysign(linear)
}

/// The 8-bit code nearest to the encoded value, as `encode` and rounding would give, without a power.
pub(super) fn encode_u8(linear: f32) -> u8 {
    /// Codes at equal steps of linear value, each a little low, and the linear value where each code begins.
    static TABLE: LazyLock<([u8; STEPS], [f32; 256])> = LazyLock::new(|| {
        let begins: [f32; 256] = std::array::from_fn(|code| decode_f64((code as f64 - 0.5) / 255.0) as f32);
        let code = |step: usize| begins.partition_point(|&begin| begin <= step as f32 / STEPS as f32) - 1;
        (std::array::from_fn(|step| code(step) as u8), begins)
    });
    const STEPS: usize = 4096;
    let (codes, begins) = &*TABLE;
    let mut code = usize::from(codes[((linear * STEPS as f32) as usize).min(STEPS - 1)]);
    while code < 255 && linear >= begins[code + 1] {
        code += 1;
    }
    code as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_round_trip() {
        for code in 0..=255_u8 {
            let encoded = encode(DECODE_U8[usize::from(code)]);
            assert_eq!((encoded * 255.0).round() as u8, code);
        }
        for code in 0..=65535_u16 {
            let encoded = encode(decode(f32::from(code) / 65535.0));
            assert_eq!((encoded * 65535.0).round() as u16, code);
        }
    }

    #[test]
    fn the_table_rounds_as_the_function_does() {
        for i in 0..=200_000 {
            let linear = i as f32 / 200_000.0;
            let exact = encode(linear) * 255.0;
            let code = encode_u8(linear);
            // Ties may fall either way.
            assert!((exact - f32::from(code)).abs() <= 0.5001, "{linear}: {code} for {exact}");
        }
        assert_eq!([-1.0, 2.0, f32::INFINITY, f32::NAN].map(encode_u8), [0, 255, 255, 0]);
    }

    #[test]
    fn between_codes_the_table_is_the_function() {
        for i in 0..=100_000 {
            let value = i as f32 / 100_000.0;
            let [r, g, b, a] = decode_all([value, 0.5 * value, 0.0, value]);
            assert!((r - decode(value)).abs() < 5e-7 && (g - decode(0.5 * value)).abs() < 5e-7, "{value}: {r} {g}");
            assert_eq!((b, a), (0.0, value));
        }
    }

    #[test]
    fn known_values() {
        assert_eq!(DECODE_U8[0], 0.0);
        assert_eq!(DECODE_U8[255], 1.0);
        assert!((DECODE_U8[128] - 0.215_860_5).abs() < 1e-7);
        assert_eq!(decode(-0.5), -decode(0.5));
    }
}
