//! Functions of colors; alpha stays unless they say otherwise.

use super::Value;

/// IEC 61966-2-1.
pub(super) fn from_srgb(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

pub(super) fn per_channel([r, g, b, a]: Value, f: impl Fn(f64) -> f64) -> Value {
    [f(r), f(g), f(b), a]
}

pub(super) fn primaries(m: &[[f64; 3]; 3], a: Value) -> Value {
    let row = |r: [f64; 3]| r[0] * a[0] + r[1] * a[1] + r[2] * a[2];
    [row(m[0]), row(m[1]), row(m[2]), a[3]]
}

/// Red, green and blue of a hue (a sixth of the circle to each of 0 to 6) between the darkest channel, which
/// is 0, and the brightest, which is 1: A. R. Smith: *Color Gamut Transform Pairs*, SIGGRAPH 1978.
fn hue(h: f64) -> [f64; 3] {
    let h = 6.0 * (h - h.floor());
    [(h - 3.0).abs() - 1.0, 2.0 - (h - 2.0).abs(), 2.0 - (h - 4.0).abs()].map(|x| x.clamp(0.0, 1.0))
}

pub(super) fn hsv_to_rgb([h, s, v, a]: Value) -> Value {
    let [r, g, b] = hue(h).map(|x| v * (1.0 - s + s * x));
    [r, g, b, a]
}

/// Hue 0 to 1 of a color whose brightest channel is `high`, `range` above the darkest.
fn hue_of([r, g, b]: [f64; 3], high: f64, range: f64) -> f64 {
    let h = match () {
        () if range == 0.0 => 0.0,
        () if r == high => (g - b) / range,
        () if g == high => 2.0 + (b - r) / range,
        () => 4.0 + (r - g) / range,
    } / 6.0;
    if h < 0.0 { h + 1.0 } else { h }
}

pub(super) fn rgb_to_hsv([r, g, b, a]: Value) -> Value {
    let high = r.max(g).max(b);
    let range = high - r.min(g).min(b);
    let s = if high == 0.0 { 0.0 } else { range / high };
    [hue_of([r, g, b], high, if s == 0.0 { 0.0 } else { range }), s, high, a]
}

pub(super) fn hsl_to_rgb([h, s, l, a]: Value) -> Value {
    let chroma = (1.0 - (2.0 * l - 1.0).abs()) * s;
    let [r, g, b] = hue(h).map(|x| (x - 0.5) * chroma + l);
    [r, g, b, a]
}

pub(super) fn rgb_to_hsl([r, g, b, a]: Value) -> Value {
    let (high, low) = (r.max(g).max(b), r.min(g).min(b));
    let l = (0.5 * (high + low)).min(1.0);
    let range = high - low;
    let s = match () {
        () if range == 0.0 => 0.0,
        () if l > 0.5 => range / (2.0 - high - low),
        () => range / (high + low),
    };
    [hue_of([r, g, b], high, range), s, l, a]
}

/// Blender's Hue/Saturation/Value: hue 0.5, saturation 1 and value 1 change nothing.
pub(super) fn adjust([hue, saturation, value]: [f64; 3], factor: f64, color: Value) -> Value {
    let [h, s, v, a] = rgb_to_hsv(color);
    let changed = hsv_to_rgb([h + hue + 0.5, (s * saturation).clamp(0.0, 1.0), v * value, a]);
    let [r, g, b]: [f64; 3] = std::array::from_fn(|i| (factor * changed[i] + (1.0 - factor) * color[i]).max(0.0));
    [r, g, b, a]
}

/// Brightness is added, contrast grows what is above 0.5.
pub(super) fn bright_contrast(color: Value, brightness: f64, contrast: f64) -> Value {
    per_channel(color, |x| ((1.0 + contrast) * x + brightness - 0.5 * contrast).max(0.0))
}

/// A power of what is above 0; the rest stays, but for the power 0.
pub(super) fn gamma(color: Value, gamma: f64) -> Value {
    per_channel(color, |x| match () {
        () if gamma == 0.0 => 1.0,
        () if x > 0.0 => x.powf(gamma),
        () => x,
    })
}

pub(super) fn invert(factor: f64, color: Value) -> Value {
    per_channel(color, |x| factor * (1.0 - x) + (1.0 - factor) * x)
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;

    fn close(a: Value, b: Value) {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} is not {b:?}");
    }

    const COLORS: [Value; 6] = [
        [0.8, 0.3, 0.1, 0.5],
        [0.1, 0.2, 0.7, 1.0],
        [0.2, 0.9, 0.4, 1.0],
        [0.9, 0.1, 0.5, 1.0],
        [0.5, 0.5, 0.5, 1.0],
        [0.0, 0.0, 0.0, 1.0],
    ];

    #[test]
    fn hues_go_round_the_circle_and_back() {
        close(hsv_to_rgb([0.0, 1.0, 1.0, 1.0]), [1.0, 0.0, 0.0, 1.0]);
        close(hsv_to_rgb([1.0 / 12.0, 1.0, 1.0, 1.0]), [1.0, 0.5, 0.0, 1.0]);
        close(hsv_to_rgb([1.0 / 3.0, 0.5, 0.8, 1.0]), [0.4, 0.8, 0.4, 1.0]);
        close(hsv_to_rgb([-1.0 / 3.0, 1.0, 2.0, 1.0]), [0.0, 0.0, 2.0, 1.0]);
        close(rgb_to_hsv([0.0, 0.5, 0.5, 1.0]), [0.5, 1.0, 0.5, 1.0]);
        close(rgb_to_hsl([0.75, 0.25, 0.25, 1.0]), [0.0, 0.5, 0.5, 1.0]);
        close(hsl_to_rgb([2.0 / 3.0, 1.0, 0.75, 1.0]), [0.5, 0.5, 1.0, 1.0]);
        for rgb in COLORS {
            close(hsv_to_rgb(rgb_to_hsv(rgb)), rgb);
            close(hsl_to_rgb(rgb_to_hsl(rgb)), rgb);
        }
    }

    #[test]
    fn adjustments_have_their_closed_forms() {
        for rgb in COLORS {
            close(Function::HueSaturationValue.eval(&[[0.5; 4], [1.0; 4], [1.0; 4], [1.0; 4], rgb]), rgb);
        }
        let red = [1.0, 0.0, 0.0, 1.0];
        close(Function::HueSaturationValue.eval(&[[1.0; 4], [1.0; 4], [2.0; 4], [0.5; 4], red]), [0.5, 1.0, 1.0, 1.0]);
        let color = [0.25, 0.5, -1.0, 0.5];
        close(Function::BrightContrast.eval(&[color, [0.1; 4], [1.0; 4]]), [0.1, 0.6, 0.0, 0.5]);
        close(Function::Gamma.eval(&[color, [2.0; 4]]), [0.0625, 0.25, -1.0, 0.5]);
        close(Function::Gamma.eval(&[color, [0.0; 4]]), [1.0, 1.0, 1.0, 0.5]);
        close(Function::Invert.eval(&[[1.0; 4], color]), [0.75, 0.5, 2.0, 0.5]);
        close(Function::FromGamma(2.0).eval(&[color]), [0.0625, 0.25, 0.0, 0.5]);
        assert!((Function::FromSrgb.eval(&[[0.5, 0.0, 1.0, 0.5]])[0] - 0.214041).abs() < 1e-6);
        let swap = Function::Primaries(Box::new([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0]]));
        close(swap.eval(&[color]), [0.5, 0.25, -2.0, 0.5]);
    }
}
