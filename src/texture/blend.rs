//! Blends of texels that are not plain linear ones: of stored values, of colours times alpha, by a cubic B-spline.
//!
//! Cycles' ways of looking an image up (its `kernel/device/cpu/image.h` and `kernel/svm/image.h`): the values that are
//! stored are blended, divided by the alpha that comes out, and decoded last.

use super::lookup::fold;
use super::srgb;
use super::texel::{Level, Reader};
use crate::desc::{Blending, Filter, Wrap};

/// The texels that count along one axis, and how much each of them does.
#[derive(Clone, Copy)]
pub(super) struct Taps {
    index: [usize; 4],
    /// Whether each lies in the image; only [`Wrap::Black`] has others.
    inside: [bool; 4],
    weights: [f32; 4],
    count: usize,
}

impl Taps {
    /// Those about the coordinate `u` of a level `n` texels long.
    pub(super) fn at(u: f32, n: u32, wrap: Wrap, filter: Filter) -> Self {
        let u = match wrap {
            // Far enough beyond the edge for all taps to be there.
            Wrap::Clamp | Wrap::Black => u.clamp(-4.0, 5.0),
            _ => fold(u, wrap),
        };
        let s = u * n as f32 - 0.5;
        let (first, weights, count) = kernel(s, filter);
        let n = n as i32;
        let texel = |k: usize| first + k as i32;
        let index = |i: i32| match wrap {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::Mirror => {
                let i = i.rem_euclid(2 * n);
                if i < n { i } else { 2 * n - 1 - i }
            }
            Wrap::Clamp | Wrap::Black => i.clamp(0, n - 1),
        };
        Self {
            index: std::array::from_fn(|k| index(texel(k)) as usize),
            inside: std::array::from_fn(|k| wrap != Wrap::Black || (0..n).contains(&texel(k))),
            weights,
            count,
        }
    }
}

/// The first texel that counts at `s`, in texels from the first one's centre, the weights from there on, and how many
/// there are. They sum to 1.
pub(super) fn kernel(s: f32, filter: Filter) -> (i32, [f32; 4], usize) {
    let (floor, t) = (s.floor(), s - s.floor());
    if filter != Filter::Cubic {
        return (floor as i32, [1.0 - t, t, 0.0, 0.0], 2);
    }
    let [t2, t3] = [t * t, t * t * t];
    let weights = [1.0 - 3.0 * t + 3.0 * t2 - t3, 4.0 - 6.0 * t2 + 3.0 * t3, 1.0 + 3.0 * t + 3.0 * t2 - 3.0 * t3, t3];
    (floor as i32 - 1, weights.map(|w| w / 6.0), 4)
}

/// The blend of the texels `x` by `y`, in the form `first + Σ w (texel - first)`, so that equal texels give their own
/// value to the bit.
pub(super) struct Window<'a> {
    pub level: &'a Level,
    pub x: Taps,
    pub y: Taps,
    /// Whether colours are to be multiplied by alpha first.
    pub associate: bool,
}

impl Reader<[f32; 4]> for Window<'_> {
    #[inline(always)]
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> [f32; 4] {
        let Self { level, x, y, associate } = self;
        let at = |i: usize, j: usize| {
            if !(x.inside[i] && y.inside[j]) {
                return [0.0; 4];
            }
            let texel = texel(level.offset(x.index[i], y.index[j]));
            if associate { multiplied(texel) } else { texel }
        };
        let first = at(0, 0);
        let mut sum = first;
        for j in 0..y.count {
            for i in 0..x.count {
                let weight = x.weights[i] * y.weights[j];
                for (sum, (value, first)) in sum.iter_mut().zip(at(i, j).into_iter().zip(first)) {
                    *sum += weight * (value - first);
                }
            }
        }
        sum
    }
}

/// What a blend of stored values is: light and alpha.
pub(super) fn finish(value: [f32; 4], blending: Blending) -> [f32; 4] {
    let value = if blending.associated { divided(value) } else { value };
    if blending.encoded.is_some() { srgb::decode_all(value) } else { value }
}

/// Colours times alpha.
pub(super) fn multiplied([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    [r * a, g * a, b * a, a]
}

/// The inverse of [`multiplied`]; where there is no alpha, the colours as they are.
pub(super) fn divided([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    if a == 0.0 || a == 1.0 { [r, g, b, a] } else { [r / a, g / a, b / a, a] }
}
