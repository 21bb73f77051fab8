//! Arithmetic with numbers, place by place.

use super::Value;

/// A function of up to three numbers. What would be NaN or infinite is 0: `x / 0`, the logarithm of what
/// is not above 0, a root of a negative power, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Math {
    /// `a + b`.
    Add,
    /// `a − b`.
    Subtract,
    /// `a b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// `a b + c`.
    MultiplyAdd,
    /// `a^b`; 0 for a negative base under a broken exponent.
    Power,
    /// `sign(a) |a|^b`.
    SignedPower,
    /// Logarithm of a to the base b.
    Logarithm,
    /// Natural logarithm.
    Ln,
    /// Square root; of what is negative 0.
    Sqrt,
    /// One by the square root; of what is not above 0, 0.
    InverseSqrt,
    /// `|a|`.
    Absolute,
    /// `e^a`.
    Exponent,
    /// The smaller.
    Minimum,
    /// The larger.
    Maximum,
    /// 1 where `a < b`.
    LessThan,
    /// 1 where `a > b`.
    GreaterThan,
    /// −1, 0 or 1.
    Sign,
    /// 1 where a and b differ by c or less.
    Compare,
    /// The smaller, smoothed over the distance c.
    SmoothMinimum,
    /// The larger, smoothed over the distance c.
    SmoothMaximum,
    /// `⌊a + ½⌋`.
    Round,
    /// Rounded, halves away from 0.
    RoundAway,
    /// Rounded down.
    Floor,
    /// Rounded up.
    Ceil,
    /// Rounded towards 0.
    Truncate,
    /// `a − ⌊a⌋`.
    Fraction,
    /// Remainder of `a / b` with the sign of a.
    Modulo,
    /// Remainder of `a / b` with the sign of b.
    FlooredModulo,
    /// a moved by whole ranges to between c and b: value, max, min.
    Wrap,
    /// a rounded down to a multiple of b.
    Snap,
    /// a folded to between 0 and b.
    PingPong,
    /// Of radians.
    Sine,
    /// Of radians.
    Cosine,
    /// Of radians.
    Tangent,
    /// In radians; a is taken to be within −1 to 1.
    Arcsine,
    /// In radians; a is taken to be within −1 to 1.
    Arccosine,
    /// In radians.
    Arctangent,
    /// Angle of the point (b, a); 0 for the origin.
    Arctangent2,
    /// Hyperbolic.
    Sinh,
    /// Hyperbolic.
    Cosh,
    /// Hyperbolic.
    Tanh,
    /// Degrees to radians.
    Radians,
    /// Radians to degrees.
    Degrees,
    /// a, low, high: within them; low counts where they are the wrong way round, as in MaterialX it does
    /// not: high does.
    Clamp,
    /// The same, with low and high put in order.
    ClampRange,
    /// a, low, high: 0 below, 1 above, smooth between.
    Smoothstep,
}

impl Math {
    /// The value for a, b, c, place by place.
    pub(super) fn eval(self, a: Value, b: Value, c: Value) -> Value {
        self.lanes(a, b, c)
    }

    /// The same for numbers.
    pub fn number(self, a: f64, b: f64, c: f64) -> f64 {
        let [result] = self.lanes([a], [b], [c]);
        if result.is_finite() { result + 0.0 } else { 0.0 }
    }

    #[inline(always)]
    fn lanes<const N: usize>(self, a: [f64; N], b: [f64; N], c: [f64; N]) -> [f64; N] {
        let one = |f: fn(f64) -> f64| a.map(f);
        let two = |f: fn(f64, f64) -> f64| -> [f64; N] { std::array::from_fn(|i| f(a[i], b[i])) };
        let three = |f: fn(f64, f64, f64) -> f64| -> [f64; N] { std::array::from_fn(|i| f(a[i], b[i], c[i])) };
        match self {
            Self::Add => two(|a, b| a + b),
            Self::Subtract => two(|a, b| a - b),
            Self::Multiply => two(|a, b| a * b),
            Self::Divide => two(divide),
            Self::MultiplyAdd => three(|a, b, c| a * b + c),
            Self::Power => two(|a, b| if a < 0.0 && b != b.trunc() { 0.0 } else { a.powf(b) }),
            Self::SignedPower => two(|a, b| sign(a) * a.abs().powf(b)),
            Self::Logarithm => two(|a, b| if a > 0.0 && b > 0.0 { divide(a.ln(), b.ln()) } else { 0.0 }),
            Self::Ln => one(|a| if a > 0.0 { a.ln() } else { 0.0 }),
            Self::Sqrt => one(|a| a.max(0.0).sqrt()),
            Self::InverseSqrt => one(|a| if a > 0.0 { a.sqrt().recip() } else { 0.0 }),
            Self::Absolute => one(f64::abs),
            Self::Exponent => one(f64::exp),
            Self::Minimum => two(f64::min),
            Self::Maximum => two(f64::max),
            Self::LessThan => two(|a, b| f64::from(u8::from(a < b))),
            Self::GreaterThan => two(|a, b| f64::from(u8::from(a > b))),
            Self::Sign => one(sign),
            Self::Compare => three(|a, b, c| f64::from(u8::from((a - b).abs() <= c.max(f64::from(f32::EPSILON))))),
            Self::SmoothMinimum => three(smooth_min),
            Self::SmoothMaximum => three(|a, b, c| -smooth_min(-a, -b, c)),
            Self::Round => one(|a| (a + 0.5).floor()),
            Self::RoundAway => one(f64::round),
            Self::Floor => one(f64::floor),
            Self::Ceil => one(f64::ceil),
            Self::Truncate => one(f64::trunc),
            Self::Fraction => one(|a| a - a.floor()),
            Self::Modulo => two(|a, b| if b == 0.0 { 0.0 } else { a % b }),
            Self::FlooredModulo => two(|a, b| if b == 0.0 { 0.0 } else { a - (a / b).floor() * b }),
            Self::Wrap => three(|a, max, min| {
                let range = max - min;
                if range == 0.0 { min } else { a - range * ((a - min) / range).floor() }
            }),
            Self::Snap => two(|a, b| divide(a, b).floor() * b),
            Self::PingPong => two(|a, b| {
                let t = divide(a - b, 2.0 * b);
                if b == 0.0 { 0.0 } else { ((t - t.floor()) * 2.0 * b - b).abs() }
            }),
            Self::Sine => one(f64::sin),
            Self::Cosine => one(f64::cos),
            Self::Tangent => one(f64::tan),
            Self::Arcsine => one(|a| a.clamp(-1.0, 1.0).asin()),
            Self::Arccosine => one(|a| a.clamp(-1.0, 1.0).acos()),
            Self::Arctangent => one(f64::atan),
            Self::Arctangent2 => two(|a, b| if a == 0.0 && b == 0.0 { 0.0 } else { a.atan2(b) }),
            Self::Sinh => one(f64::sinh),
            Self::Cosh => one(f64::cosh),
            Self::Tanh => one(f64::tanh),
            Self::Radians => one(f64::to_radians),
            Self::Degrees => one(f64::to_degrees),
            Self::Clamp => three(|a, low, high| a.max(low).min(high)),
            Self::ClampRange => three(|a, b, c| a.clamp(b.min(c), b.max(c))),
            Self::Smoothstep => three(|a, low, high| {
                let t = if high > low { ((a - low) / (high - low)).clamp(0.0, 1.0) } else { f64::from(a >= high) };
                t * t * (3.0 - 2.0 * t)
            }),
        }
    }
}

/// `a / b`, 0 where b is.
pub(super) fn divide(a: f64, b: f64) -> f64 {
    if b == 0.0 { 0.0 } else { a / b }
}

fn sign(a: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a.signum() }
}

/// Inigo Quilez: *Smooth minimum*, the cubic one, <https://iquilezles.org/articles/smin/>.
fn smooth_min(a: f64, b: f64, k: f64) -> f64 {
    let h = divide((k - (a - b).abs()).max(0.0), k);
    a.min(b) - h * h * h * k / 6.0
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{LN_2, PI};

    use super::*;

    /// Each function at points where its value is known.
    #[test]
    fn functions_have_their_closed_forms() {
        for (math, args, expected) in [
            (Math::Add, [2.5, -1.0, 0.0], 1.5),
            (Math::Subtract, [2.5, -1.0, 0.0], 3.5),
            (Math::Multiply, [2.5, -2.0, 0.0], -5.0),
            (Math::Divide, [1.0, 8.0, 0.0], 0.125),
            (Math::Divide, [1.0, 0.0, 0.0], 0.0),
            (Math::MultiplyAdd, [2.0, 3.0, 4.0], 10.0),
            (Math::Power, [2.0, 10.0, 0.0], 1024.0),
            (Math::Power, [-2.0, 3.0, 0.0], -8.0),
            (Math::Power, [-2.0, 0.5, 0.0], 0.0),
            (Math::Power, [0.0, 0.0, 0.0], 1.0),
            (Math::SignedPower, [-4.0, 0.5, 0.0], -2.0),
            (Math::Logarithm, [8.0, 2.0, 0.0], 3.0),
            (Math::Logarithm, [8.0, 1.0, 0.0], 0.0),
            (Math::Logarithm, [0.0, 2.0, 0.0], 0.0),
            (Math::Ln, [2.0, 0.0, 0.0], LN_2),
            (Math::Ln, [-2.0, 0.0, 0.0], 0.0),
            (Math::Sqrt, [6.25, 0.0, 0.0], 2.5),
            (Math::Sqrt, [-1.0, 0.0, 0.0], 0.0),
            (Math::InverseSqrt, [4.0, 0.0, 0.0], 0.5),
            (Math::InverseSqrt, [0.0, 0.0, 0.0], 0.0),
            (Math::Absolute, [-3.0, 0.0, 0.0], 3.0),
            (Math::Exponent, [LN_2, 0.0, 0.0], 2.0),
            (Math::Minimum, [1.0, 2.0, 0.0], 1.0),
            (Math::Maximum, [1.0, 2.0, 0.0], 2.0),
            (Math::LessThan, [1.0, 2.0, 0.0], 1.0),
            (Math::LessThan, [2.0, 2.0, 0.0], 0.0),
            (Math::GreaterThan, [3.0, 2.0, 0.0], 1.0),
            (Math::Sign, [-0.0, 0.0, 0.0], 0.0),
            (Math::Sign, [-7.0, 0.0, 0.0], -1.0),
            (Math::Compare, [1.0, 1.4, 0.5], 1.0),
            (Math::Compare, [1.0, 1.6, 0.5], 0.0),
            (Math::Compare, [1.0, 1.0, -1.0], 1.0),
            // At a = b the smooth minimum is lower by k / 6.
            (Math::SmoothMinimum, [1.0, 1.0, 0.6], 0.9),
            (Math::SmoothMaximum, [1.0, 1.0, 0.6], 1.1),
            (Math::SmoothMinimum, [1.0, 3.0, 0.5], 1.0),
            (Math::SmoothMinimum, [1.0, 3.0, 0.0], 1.0),
            (Math::Round, [2.5, 0.0, 0.0], 3.0),
            (Math::Round, [-2.5, 0.0, 0.0], -2.0),
            (Math::RoundAway, [-2.5, 0.0, 0.0], -3.0),
            (Math::Floor, [-1.5, 0.0, 0.0], -2.0),
            (Math::Ceil, [-1.5, 0.0, 0.0], -1.0),
            (Math::Truncate, [-1.5, 0.0, 0.0], -1.0),
            (Math::Fraction, [-1.25, 0.0, 0.0], 0.75),
            (Math::Modulo, [-5.5, 2.0, 0.0], -1.5),
            (Math::FlooredModulo, [-5.5, 2.0, 0.0], 0.5),
            (Math::FlooredModulo, [5.5, 0.0, 0.0], 0.0),
            (Math::Wrap, [5.5, 3.0, 1.0], 1.5),
            (Math::Wrap, [-0.5, 3.0, 1.0], 1.5),
            (Math::Wrap, [5.5, 3.0, 3.0], 3.0),
            (Math::Snap, [5.5, 2.0, 0.0], 4.0),
            (Math::Snap, [-0.5, 2.0, 0.0], -2.0),
            (Math::PingPong, [3.5, 2.0, 0.0], 0.5),
            (Math::PingPong, [-0.5, 2.0, 0.0], 0.5),
            (Math::PingPong, [1.0, 0.0, 0.0], 0.0),
            (Math::Sine, [PI / 6.0, 0.0, 0.0], 0.5),
            (Math::Cosine, [PI / 3.0, 0.0, 0.0], 0.5),
            (Math::Tangent, [PI / 4.0, 0.0, 0.0], 1.0),
            (Math::Arcsine, [2.0, 0.0, 0.0], PI / 2.0),
            (Math::Arccosine, [0.5, 0.0, 0.0], PI / 3.0),
            (Math::Arctangent, [1.0, 0.0, 0.0], PI / 4.0),
            (Math::Arctangent2, [1.0, -1.0, 0.0], 0.75 * PI),
            (Math::Arctangent2, [0.0, 0.0, 0.0], 0.0),
            (Math::Sinh, [LN_2, 0.0, 0.0], 0.75),
            (Math::Cosh, [LN_2, 0.0, 0.0], 1.25),
            (Math::Tanh, [LN_2, 0.0, 0.0], 0.6),
            (Math::Radians, [180.0, 0.0, 0.0], PI),
            (Math::Degrees, [PI, 0.0, 0.0], 180.0),
            (Math::Clamp, [5.0, 0.0, 1.0], 1.0),
            (Math::ClampRange, [5.0, 1.0, 0.0], 1.0),
            (Math::Smoothstep, [0.25, 0.0, 1.0], 0.15625),
            (Math::Smoothstep, [2.0, 1.0, 1.0], 1.0),
        ] {
            let [a, b, c] = args.map(|x| [x; 4]);
            let [first, .., last] = math.eval(a, b, c);
            assert_eq!(math.number(args[0], args[1], args[2]), first);
            assert!((first - expected).abs() < 1e-12 && first == last, "{math:?} {args:?}: {first}");
        }
    }
}
