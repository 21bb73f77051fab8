//! What pattern nodes compute: MaterialX's standard library, one value of four numbers in, one out.
//! A single number stands in all four places.
//!
//! MaterialX 1.39 specification, "Standard Nodes".

/// A value.
pub(super) type V = [f64; 4];

/// A function of up to four values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Add,
    Multiply,
    Divide,
    Modulo,
    Power,
    SafePower,
    Minimum,
    Maximum,
    Absolute,
    Sign,
    Floor,
    Ceil,
    Round,
    Fract,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan2,
    Sqrt,
    Ln,
    Exp,
    /// in, low, high.
    Clamp,
    /// in, low, high.
    Smoothstep,
    /// bg, fg, mix.
    Mix,
    /// value1, value2, in1, in2.
    IfGreater,
    IfGreaterOrEqual,
    IfEqual,
    /// Of the first so many numbers, the result in all places.
    Dot(u8),
    Length(u8),
    Normalize(u8),
    Cross,
    HsvToRgb,
    RgbToHsv,
    /// Which place each number comes from.
    Swizzle([u8; 4]),
    /// The first number of each.
    Combine,
    /// sRGB's curve to linear; alpha stays.
    FromSrgb,
    /// Gamma to linear; alpha stays.
    FromGamma(f64),
    /// Linear color to Rec.709.
    ToRec709([[f64; 3]; 3]),
}

impl Function {
    /// The value for `args`; missing ones are 0.
    pub fn eval(self, args: &[V]) -> V {
        let arg = |i: usize| args.get(i).copied().unwrap_or_default();
        let (a, b, c) = (arg(0), arg(1), arg(2));
        let one = |f: fn(f64) -> f64| a.map(f);
        let two = |f: fn(f64, f64) -> f64| -> V { std::array::from_fn(|i| f(a[i], b[i])) };
        let three = |f: fn(f64, f64, f64) -> f64| -> V { std::array::from_fn(|i| f(a[i], b[i], c[i])) };
        let choose = |yes: bool| if yes { c } else { arg(3) };
        match self {
            Self::Add => two(|a, b| a + b),
            Self::Multiply => two(|a, b| a * b),
            // What is divided by 0 is 0: an image with one such texel stays an image.
            Self::Divide => two(|a, b| if b == 0.0 { 0.0 } else { a / b }),
            Self::Modulo => two(|a, b| if b == 0.0 { 0.0 } else { a - b * (a / b).floor() }),
            Self::Power => two(f64::powf),
            Self::SafePower => two(|a, b| a.signum() * a.abs().powf(b)),
            Self::Minimum => two(f64::min),
            Self::Maximum => two(f64::max),
            Self::Absolute => one(f64::abs),
            Self::Sign => one(|a| if a == 0.0 { 0.0 } else { a.signum() }),
            Self::Floor => one(f64::floor),
            Self::Ceil => one(f64::ceil),
            Self::Round => one(f64::round),
            Self::Fract => one(|a| a - a.floor()),
            Self::Sin => one(f64::sin),
            Self::Cos => one(f64::cos),
            Self::Tan => one(f64::tan),
            Self::Asin => one(f64::asin),
            Self::Acos => one(f64::acos),
            Self::Atan2 => two(f64::atan2),
            Self::Sqrt => one(f64::sqrt),
            Self::Ln => one(f64::ln),
            Self::Exp => one(f64::exp),
            Self::Clamp => three(|a, low, high| a.max(low).min(high)),
            Self::Smoothstep => three(|a, low, high| {
                let t = if high > low { ((a - low) / (high - low)).clamp(0.0, 1.0) } else { f64::from(a >= high) };
                t * t * (3.0 - 2.0 * t)
            }),
            Self::Mix => three(|bg, fg, mix| bg + mix * (fg - bg)),
            Self::IfGreater => choose(a[0] > b[0]),
            Self::IfGreaterOrEqual => choose(a[0] >= b[0]),
            Self::IfEqual => choose(a[0] == b[0]),
            Self::Dot(n) => [dot(a, b, n); 4],
            Self::Length(n) => [dot(a, a, n).sqrt(); 4],
            Self::Normalize(n) => {
                let length = dot(a, a, n).sqrt();
                if length > 0.0 { a.map(|x| x / length) } else { a }
            }
            Self::Cross => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0],
            Self::HsvToRgb => hsv_to_rgb(a),
            Self::RgbToHsv => rgb_to_hsv(a),
            Self::Swizzle(places) => places.map(|place| a[usize::from(place.min(3))]),
            Self::Combine => [a[0], b[0], c[0], args.get(3).map_or(1.0, |d| d[0])],
            Self::FromSrgb => curve(a, from_srgb),
            Self::FromGamma(gamma) => {
                let [r, g, b, alpha] = a;
                let [r, g, b] = [r, g, b].map(|x| x.max(0.0).powf(gamma));
                [r, g, b, alpha]
            }
            Self::ToRec709(m) => {
                let row = |r: [f64; 3]| r[0] * a[0] + r[1] * a[1] + r[2] * a[2];
                [row(m[0]), row(m[1]), row(m[2]), a[3]]
            }
        }
    }
}

/// IEC 61966-2-1.
pub(super) fn from_srgb(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

fn curve([r, g, b, a]: V, f: fn(f64) -> f64) -> V {
    [f(r), f(g), f(b), a]
}

fn dot(a: V, b: V, n: u8) -> f64 {
    a.iter().zip(b).take(usize::from(n)).map(|(a, b)| a * b).sum()
}

/// `mx_hsvtorgb`: hue, saturation and value, the hue 0 to 1.
fn hsv_to_rgb([h, s, v, a]: V) -> V {
    let h = 6.0 * (h - h.floor());
    let f = h - h.floor();
    let (p, q, t) = (v * (1.0 - s), v * (1.0 - s * f), v * (1.0 - s * (1.0 - f)));
    let [r, g, b] = match h as u8 {
        0 => [v, t, p],
        1 => [q, v, p],
        2 => [p, v, t],
        3 => [p, q, v],
        4 => [t, p, v],
        _ => [v, p, q],
    };
    [r, g, b, a]
}

fn rgb_to_hsv([r, g, b, a]: V) -> V {
    let high = r.max(g).max(b);
    let range = high - r.min(g).min(b);
    let s = if high > 0.0 { range / high } else { 0.0 };
    let h = if range <= 0.0 {
        0.0
    } else if r >= high {
        (g - b) / range
    } else if g >= high {
        2.0 + (b - r) / range
    } else {
        4.0 + (r - g) / range
    } / 6.0;
    [if h < 0.0 { h + 1.0 } else { h }, s, high, a]
}

#[cfg(test)]
mod tests {
    use super::Function::*;

    #[test]
    fn functions_compute_what_materialx_says() {
        let v = [0.25, -0.5, 2.0, 1.0];
        assert_eq!(Clamp.eval(&[v, [0.0; 4], [1.0; 4]]), [0.25, 0.0, 1.0, 1.0]);
        assert_eq!(Modulo.eval(&[[5.5, -0.5, 3.0, 0.0], [2.0; 4]]), [1.5, 1.5, 1.0, 0.0]);
        assert_eq!(Divide.eval(&[v, [0.0; 4]]), [0.0; 4]);
        assert_eq!(IfGreater.eval(&[[2.0; 4], [1.0; 4], v, [0.0; 4]]), v);
        assert_eq!(Dot(3).eval(&[v, [1.0; 4]]), [1.75; 4]);
        assert_eq!(Swizzle([2, 2, 0, 3]).eval(&[v]), [2.0, 2.0, 0.25, 1.0]);
        assert_eq!(Combine.eval(&[[1.0; 4], [2.0; 4], [3.0; 4]]), [1.0, 2.0, 3.0, 1.0]);
        assert_eq!(Smoothstep.eval(&[[0.5; 4], [0.0; 4], [1.0; 4]]), [0.5; 4]);
        for rgb in [[0.8, 0.3, 0.1, 1.0], [0.1, 0.2, 0.7, 1.0], [0.2, 0.9, 0.4, 1.0], [0.5, 0.5, 0.5, 1.0]] {
            let back = HsvToRgb.eval(&[RgbToHsv.eval(&[rgb])]);
            assert!(rgb.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{rgb:?} {back:?}");
        }
        assert!((FromSrgb.eval(&[[0.5, 0.0, 1.0, 0.5]])[0] - 0.214041).abs() < 1e-6);
    }
}
