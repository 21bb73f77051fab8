//! The sRGB transfer function, IEC 61966-2-1.

/// Linear value of an sRGB-encoded one; odd about 0, so that negative values of float images stay.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    srgb_to_linear_f64(f64::from(encoded)) as f32
}

/// The same in double precision.
pub fn srgb_to_linear_f64(encoded: f64) -> f64 {
    let e = encoded.abs();
    let linear = if e <= 0.04045 { e / 12.92 } else { ((e + 0.055) / 1.055).powf(2.4) };
    linear.copysign(encoded)
}
