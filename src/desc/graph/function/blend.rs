//! Ways to put two colors together.

use super::Value;
use super::color::{hsv_to_rgb, rgb_to_hsv};

/// How a second color b is put on a first one a, by a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Blend {
    /// `(1 − t) a + t b`, all four places, each with its own factor.
    Mix,
    /// `a + b`.
    Add,
    /// `a b`.
    Multiply,
    /// `a − b`.
    Subtract,
    /// `1 − (1 − a) (1 − b)`.
    Screen,
    /// `a / b`; a where b is 0.
    Divide,
    /// `|a − b|`.
    Difference,
    /// The darker, per channel.
    Darken,
    /// The lighter, per channel.
    Lighten,
    /// Multiplied where a is dark, screened where it is bright.
    Overlay,
    /// `a / (1 − b)`.
    Dodge,
    /// `1 − (1 − a) / b`.
    Burn,
    /// The hue of b.
    Hue,
    /// The saturation of b.
    Saturation,
    /// The value of b.
    Value,
    /// Hue and saturation of b.
    Color,
    /// Between multiplied and screened, by a.
    SoftLight,
    /// `a + t (2 b − 1)`.
    LinearLight,
    /// `a + b − 2 a b`, not below 0.
    Exclusion,
}

impl Blend {
    /// a and b mixed by the factors `t`, of which only the plain mix looks at more than the first.
    pub(super) fn eval(self, t: Value, a: Value, b: Value) -> Value {
        if self == Self::Mix {
            return std::array::from_fn(|i| (1.0 - t[i]) * a[i] + t[i] * b[i]);
        }
        let t = t[0];
        let each = |f: fn(f64, f64) -> f64| lerp(a, [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2])], t);
        let own = |f: fn(f64, f64, f64) -> f64| [f(t, a[0], b[0]), f(t, a[1], b[1]), f(t, a[2], b[2]), a[3]];
        match self {
            Self::Mix | Self::Add => each(|a, b| a + b),
            Self::Multiply => each(|a, b| a * b),
            Self::Subtract => each(|a, b| a - b),
            Self::Difference => each(|a, b| (a - b).abs()),
            Self::Darken => each(f64::min),
            Self::Lighten => each(f64::max),
            Self::Divide => each(|a, b| if b == 0.0 { a } else { a / b }),
            Self::Screen => each(screen),
            Self::SoftLight => each(|a, b| (1.0 - a) * a * b + a * screen(a, b)),
            Self::LinearLight => own(|t, a, b| a + t * (2.0 * b - 1.0)),
            Self::Exclusion => each(|a, b| a + b - 2.0 * a * b).map(|x| x.max(0.0)),
            Self::Overlay => each(|a, b| if a < 0.5 { 2.0 * a * b } else { 1.0 - 2.0 * (1.0 - a) * (1.0 - b) }),
            Self::Dodge => own(|t, a, b| {
                let left = 1.0 - t * b;
                match () {
                    () if a == 0.0 => 0.0,
                    () if left <= 0.0 => 1.0,
                    () => (a / left).min(1.0),
                }
            }),
            Self::Burn => own(|t, a, b| {
                let left = 1.0 - t + t * b;
                if left <= 0.0 { 0.0 } else { (1.0 - (1.0 - a) / left).clamp(0.0, 1.0) }
            }),
            Self::Hue | Self::Saturation | Self::Value | Self::Color => self.in_hsv(t, a, b),
        }
    }

    fn in_hsv(self, t: f64, a: Value, b: Value) -> Value {
        let ([h, s, v, alpha], [h2, s2, v2, _]) = (rgb_to_hsv(a), rgb_to_hsv(b));
        let between = |x: f64, y: f64| (1.0 - t) * x + t * y;
        let taken = |hsv: [f64; 3]| {
            let [h, s, v] = hsv;
            let [r, g, b, _] = hsv_to_rgb([h, s, v, alpha]);
            lerp(a, [r, g, b], t)
        };
        match self {
            // A gray has no hue to give.
            Self::Hue if s2 != 0.0 => taken([h2, s, v]),
            Self::Color if s2 != 0.0 => taken([h2, s2, v]),
            // And none whose saturation could grow.
            Self::Saturation if s != 0.0 => hsv_to_rgb([h, between(s, s2), v, alpha]),
            Self::Value => hsv_to_rgb([h, s, between(v, v2), alpha]),
            _ => a,
        }
    }
}

fn screen(a: f64, b: f64) -> f64 {
    1.0 - (1.0 - a) * (1.0 - b)
}

fn lerp(a: Value, [r, g, b]: [f64; 3], t: f64) -> Value {
    [(1.0 - t) * a[0] + t * r, (1.0 - t) * a[1] + t * g, (1.0 - t) * a[2] + t * b, a[3]]
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;

    /// At factor 0 it is a, at 1 the closed form, at 0.5 the mean of the two where it is linear in it.
    #[test]
    fn blends_have_their_closed_forms() {
        let (a, b) = ([0.25, 0.75, 0.5, 1.0], [0.5, 0.25, 1.0, 1.0]);
        for (blend, expected, linear) in [
            (Blend::Mix, [0.5, 0.25, 1.0], true),
            (Blend::Add, [0.75, 1.0, 1.5], true),
            (Blend::Multiply, [0.125, 0.1875, 0.5], true),
            (Blend::Subtract, [-0.25, 0.5, -0.5], true),
            (Blend::Screen, [0.625, 0.8125, 1.0], true),
            (Blend::Divide, [0.5, 3.0, 0.5], true),
            (Blend::Difference, [0.25, 0.5, 0.5], true),
            (Blend::Darken, [0.25, 0.25, 0.5], true),
            (Blend::Lighten, [0.5, 0.75, 1.0], true),
            (Blend::Overlay, [0.25, 0.625, 1.0], true),
            (Blend::Dodge, [0.5, 1.0, 1.0], false),
            (Blend::Burn, [0.0, 0.0, 0.5], false),
            (Blend::SoftLight, [0.25 * 0.75 * 0.5 + 0.25 * 0.625, 0.75 * 0.25 * 0.25 + 0.75 * 0.8125, 0.75], true),
            (Blend::LinearLight, [0.25, 0.25, 1.5], true),
            (Blend::Exclusion, [0.5, 0.625, 0.5], true),
        ] {
            let at = |t: f64| Function::Mix { blend, clamp_factor: true, clamp_result: false }.eval(&[[t; 4], a, b]);
            let close = |got: Value, expected: [f64; 3]| {
                assert!(got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{blend:?}: {got:?}");
            };
            close(at(0.0), [a[0], a[1], a[2]]);
            close(at(1.0), expected);
            close(at(7.0), expected);
            if linear {
                close(at(0.5), std::array::from_fn(|i| 0.5 * (a[i] + expected[i])));
            }
        }
    }

    #[test]
    fn parts_of_a_color_are_taken() {
        let (red, pale_blue, gray) = ([0.8, 0.4, 0.4, 1.0], [0.5, 0.5, 1.0, 1.0], [0.3, 0.3, 0.3, 1.0]);
        let at = |blend: Blend, b: Value| {
            rgb_to_hsv(Function::Mix { blend, clamp_factor: true, clamp_result: true }.eval(&[[1.0; 4], red, b]))
        };
        let close = |got: Value, expected: [f64; 3]| {
            assert!(got.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{got:?}");
        };
        close(at(Blend::Hue, pale_blue), [2.0 / 3.0, 0.5, 0.8]);
        close(at(Blend::Hue, gray), [0.0, 0.5, 0.8]);
        close(at(Blend::Saturation, gray), [0.0, 0.0, 0.8]);
        close(at(Blend::Value, pale_blue), [0.0, 0.5, 1.0]);
        close(at(Blend::Color, [0.0, 0.0, 0.5, 1.0]), [2.0 / 3.0, 1.0, 0.8]);
    }

    #[test]
    fn a_plain_mix_has_a_factor_for_each_place() {
        let mix = Function::Mix { blend: Blend::Mix, clamp_factor: false, clamp_result: true };
        assert_eq!(mix.eval(&[[0.0, 0.5, 1.0, 2.0], [0.0; 4], [1.0, 1.0, 1.0, 1.0]]), [0.0, 0.5, 1.0, 1.0]);
    }
}
