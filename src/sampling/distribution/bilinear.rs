//! A latitude-longitude image of weights at the centres of its texels, bilinear in between: around in x,
//! and 0 at the upper and lower border, as the sine of the polar angle makes it.
//!
//! A patch between four centres is chosen by its integral, then a point in it by the inverse of the
//! bilinear's marginal in y and of its conditional in x: Matt Pharr, Wenzel Jakob, Greg Humphreys,
//! *Physically Based Rendering*, 4th edition, A.5.1 (linear) and A.5.2 (bilinear). The density returned
//! is exactly that of drawing, since the probability of a patch is the one that its table has.

use super::Distribution2d;
use super::image::Texel;

/// Draws points in proportion to a bilinear image. Weights are not kept: who has them gives them again.
#[derive(Clone, Debug)]
pub struct BilinearImage {
    width: usize,
    height: usize,
    /// `width` × `height + 1` patches: patch (x, y) lies right of column x, and below row y − 1.
    patches: Distribution2d,
}

/// What [`BilinearImage::sample`] drew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BilinearSample {
    /// Point in [0, 1]²: x along the row, y down the rows.
    pub p: [f64; 2],
    /// Density over the unit square, above 0; its mean over the square is 1.
    pub pdf: f64,
}

impl BilinearImage {
    /// A distribution over an image of `width × height` texels. `weight(x, y)`, at least 0 and finite,
    /// is that at the centre of a texel. `None` where all are 0, or where a side is 2¹⁶ or longer.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Option<Self> {
        let patches = Distribution2d::new(width, height + 1, |x, y| {
            mean(corners(width, height, x, y, &weight)) * patch_height(height, y)
        })?;
        Some(Self { width, height, patches })
    }

    /// Draws a point by `u` in [0, 1)²; `weight` is that of [`BilinearImage::new`].
    #[inline]
    pub fn sample(&self, u: [f64; 2], weight: impl Fn(usize, usize) -> f64) -> BilinearSample {
        let Texel { x, y, within, pmf } = self.patches.sample_texel(u);
        let c = corners(self.width, self.height, x, y, weight);
        let t = sample_linear(within[1], c[0][0] + c[0][1], c[1][0] + c[1][1]);
        let s = sample_linear(within[0], lerp(c[0][0], c[1][0], t), lerp(c[0][1], c[1][1], t));
        let p = [(x as f64 + 0.5 + s) / self.width as f64, self.row_at(y) + t * patch_height(self.height, y)];
        BilinearSample { p: [if p[0] >= 1.0 { p[0] - 1.0 } else { p[0] }, p[1]], pdf: self.density(pmf, c, [s, t], y) }
    }

    /// Density of [`BilinearImage::sample`] at a point of the unit square.
    #[inline]
    pub fn pdf(&self, p: [f64; 2], weight: impl Fn(usize, usize) -> f64) -> f64 {
        let x = p[0] * self.width as f64 - 0.5;
        let x = if x < 0.0 { x + self.width as f64 } else { x };
        let (column, s) = split(x, self.width - 1);
        let row = ((p[1] * self.height as f64 + 0.5).max(0.0) as usize).min(self.height);
        let t = ((p[1] - self.row_at(row)) / patch_height(self.height, row)).clamp(0.0, 1.0);
        let c = corners(self.width, self.height, column, row, weight);
        self.density(self.patches.pmf(column, row), c, [s, t], row)
    }

    /// y of the upper edge of a row of patches.
    fn row_at(&self, y: usize) -> f64 {
        if y == 0 { 0.0 } else { (y as f64 - 0.5) / self.height as f64 }
    }

    fn density(&self, pmf: f64, c: [[f64; 2]; 2], [s, t]: [f64; 2], y: usize) -> f64 {
        if pmf == 0.0 {
            return 0.0;
        }
        let value = lerp(lerp(c[0][0], c[0][1], s), lerp(c[1][0], c[1][1], s), t);
        pmf * self.width as f64 / patch_height(self.height, y) * (value / mean(c))
    }
}

/// Weights at the corners of a patch, the upper two first.
#[inline]
fn corners(width: usize, height: usize, x: usize, y: usize, weight: impl Fn(usize, usize) -> f64) -> [[f64; 2]; 2] {
    let right = if x + 1 == width { 0 } else { x + 1 };
    let row = |y: usize| [weight(x, y), weight(right, y)];
    [if y == 0 { [0.0; 2] } else { row(y - 1) }, if y == height { [0.0; 2] } else { row(y) }]
}

fn mean(c: [[f64; 2]; 2]) -> f64 {
    0.25 * (c[0][0] + c[0][1] + c[1][0] + c[1][1])
}

/// Patches at the borders are half as high.
fn patch_height(height: usize, y: usize) -> f64 {
    (if y == 0 || y == height { 0.5 } else { 1.0 }) / height as f64
}

/// Whole part, at most `last`, and the rest.
fn split(x: f64, last: usize) -> (usize, f64) {
    let whole = (x as usize).min(last);
    (whole, (x - whole as f64).clamp(0.0, 1.0))
}

fn lerp(a: f64, b: f64, t: f64) -> f64 {
    a * (1.0 - t) + b * t
}

/// A point of [0, 1] with a density linear from `a` to `b`: `x (a + √((1 − u) a² + u b²)) = u (a + b)`.
#[inline]
fn sample_linear(u: f64, a: f64, b: f64) -> f64 {
    // Relative, so that no square leaves the range.
    let largest = a.max(b);
    if largest <= 0.0 {
        return u;
    }
    let (a, b) = (a / largest, b / largest);
    let divisor = a + lerp(a * a, b * b, u).sqrt();
    if divisor > 0.0 { (u * (a + b) / divisor).min(1.0) } else { 0.0 }
}
