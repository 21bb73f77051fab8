//! Small functions of one number.

/// The largest `f32` below 1.
pub const ONE_MINUS_EPSILON: f32 = 1.0 - f32::EPSILON / 2.0;

/// `x²`.
pub fn sqr(x: f32) -> f32 {
    x * x
}

/// Square root that takes a slightly negative argument, left by rounding, as 0.
pub fn safe_sqrt(x: f32) -> f32 {
    x.max(0.0).sqrt()
}

/// Arc cosine of an argument that rounding may have left just outside -1 to 1.
pub fn safe_acos(x: f32) -> f32 {
    x.clamp(-1.0, 1.0).acos()
}

/// Bound of the relative error of `n` floating-point operations, `nε / (1 - nε)`.
///
/// Nicholas Higham: *Accuracy and Stability of Numerical Algorithms*, 2002, Lemma 3.1.
pub const fn gamma(n: u32) -> f32 {
    let e = n as f32 * (f32::EPSILON * 0.5);
    e / (1.0 - e)
}
