//! Rounding to cells, in plain arithmetic: the baseline instruction set has no rounding instruction,
//! and a library call would cost more than the rest of a cell's lookup.

use crate::math::Vec3;

/// From here on a float has no fraction.
const WHOLE: f32 = 8_388_608.0;

/// The largest whole number not above `x`; it keeps the sign of 0.
pub fn floor(x: f32) -> f32 {
    let whole = x as i32 as f32;
    let down = whole - f32::from(u8::from(whole > x));
    if x.abs() < WHOLE { down.copysign(x) } else { x }
}

/// The whole part of `x`, towards 0.
pub fn trunc(x: f32) -> f32 {
    if x.abs() < WHOLE { x as i32 as f32 } else { x }
}

/// A whole number as an integer; what does not fit becomes the least one, as the instruction has it.
pub fn to_int(x: f32) -> i32 {
    if x.abs() < 2_147_483_648.0 { x as i32 } else { i32::MIN }
}

/// The cell that `x` lies in.
pub fn cell(x: f32) -> i32 {
    to_int(floor(x))
}

/// `a b + c`, rounded once (but for a rare tie): where a position is scaled up afterwards, the last bit
/// shows, and Cycles' compiled code fuses the two.
pub fn fused(a: f32, b: f32, c: f32) -> f32 {
    (f64::from(a) * f64::from(b) + f64::from(c)) as f32
}

/// A scaled position moved a little, so that whole coordinates are off the edges of cells: rounding
/// would make noise of them.
pub fn off_edges(p: Vec3, scale: f32) -> Vec3 {
    Vec3::from(p.to_array().map(|x| fused(x, scale, 0.000_001))) * 0.999_999
}

/// `a` at `t` = 0, `b` at 1.
pub fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

/// Hermite step from 0 to 1 over the unit interval.
pub fn smoothstep(t: f32) -> f32 {
    let t = saturate(t);
    t * t * (3.0 - 2.0 * t)
}

/// `x` held in 0 to 1; 0 for what is no number.
pub fn saturate(x: f32) -> f32 {
    within(x, 0.0, 1.0)
}

/// `x` held in `low` to `high`; `low` for what is no number, which `clamp` would let pass.
#[allow(clippy::manual_clamp, reason = "what is no number must not pass")]
pub fn within(x: f32, low: f32, high: f32) -> f32 {
    x.max(low).min(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_as_the_library() {
        for x in [0.0, 0.5, -0.5, 1.0, -1.0, -1.5, 2.999_999_8, 8_388_607.5, -8_388_607.5, 1e9, -1e30, 3e38] {
            assert_eq!(floor(x), x.floor(), "{x}");
            assert_eq!(trunc(x), x.trunc(), "{x}");
        }
        assert!(floor(f32::NAN).is_nan());
        assert!(floor(-0.0).is_sign_negative() && floor(0.5).is_sign_positive());
        assert_eq!(floor(f32::NEG_INFINITY), f32::NEG_INFINITY);
        assert_eq!([cell(-0.25), cell(7.0), cell(1e10), cell(f32::NAN)], [-1, 7, i32::MIN, i32::MIN]);
    }
}
