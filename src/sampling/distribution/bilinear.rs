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
    /// Density over the unit square, whose mean over the square is 1; 0 only where a number of exactly 0
    /// falls on an edge of no weight.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact for a bilinear density: two Gauss points each way in every patch.
    fn integral(d: &BilinearImage, weight: impl Fn(usize, usize) -> f64 + Copy) -> f64 {
        let nodes = [0.5 - 0.5 / 3.0_f64.sqrt(), 0.5 + 0.5 / 3.0_f64.sqrt()];
        let mut sum = 0.0;
        for y in 0..=d.height {
            let high = patch_height(d.height, y);
            for x in 0..d.width {
                for s in nodes {
                    for t in nodes {
                        let p = [((x as f64 + 0.5 + s) / d.width as f64).fract(), d.row_at(y) + t * high];
                        sum += 0.25 * d.pdf(p, weight) * high / d.width as f64;
                    }
                }
            }
        }
        sum
    }

    const SIZES: [[usize; 2]; 7] = [[1, 1], [1, 5], [5, 1], [2, 2], [17, 9], [64, 33], [200, 3]];

    #[test]
    fn integrates_to_one_and_follows_the_weights() {
        let weights: [fn(usize, usize) -> f64; 4] = [
            |_, _| 3.0,
            |x, y| (1 + x * y) as f64,
            |x, y| if (x + y) % 3 == 0 { 1.0 + x as f64 } else { 0.0 },
            |x, y| if (x, y) == (0, 0) { 1e8 } else { 1e-3 },
        ];
        for [w, h] in SIZES {
            for (i, weight) in weights.into_iter().enumerate() {
                let d = BilinearImage::new(w, h, weight).unwrap();
                assert!((integral(&d, weight) - 1.0).abs() < 1e-12, "{w} × {h}, {i}");
                // The integral of the weights by the trapezoids that the patches are.
                let total: f64 = (0..h)
                    .flat_map(|y| (0..w).map(move |x| (x, y)))
                    .map(|(x, y)| {
                        let height = 0.5 * (patch_height(h, y) + patch_height(h, y + 1));
                        weight(x, y) * height / w as f64
                    })
                    .sum();
                for y in 0..h {
                    for x in 0..w {
                        let p = [(x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64];
                        let (pdf, exact) = (d.pdf(p, weight), weight(x, y) / total);
                        // Patches have whole units of 2⁻²⁴, at least one in their row and column.
                        let unit = 3.0 * (w * (h + 1)) as f64 / 16_777_216.0 * (1.0 + exact);
                        let near = (pdf - exact).abs() <= 2e-3 * exact + unit * 100.0;
                        assert!(
                            near && (exact == 0.0) == (pdf < 1e-9 * exact.max(1e-3)),
                            "{w} × {h}, {i}: {pdf} {exact}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn sampled_density_is_the_density_there() {
        for [w, h] in SIZES {
            for weight in [|x, y| ((x * 7 + y * 3) % 5) as f64, |x, y| if x + y == 0 { 1e8 } else { 1e-3 }] {
                let Some(d) = BilinearImage::new(w, h, weight) else {
                    assert_eq!([w, h], [1, 1]);
                    continue;
                };
                for i in 0..20_000 {
                    let u = [(i as f64 * 0.618_033_988_7 + 1e-9).fract(), (i as f64 * 0.754_877_666_2 + 1e-9).fract()];
                    let s = d.sample(u, weight);
                    assert!(s.pdf > 0.0 && s.p.iter().all(|p| (0.0..=1.0).contains(p)), "{w} × {h}: {s:?}");
                    let asked = d.pdf(s.p, weight);
                    // Next to an edge of no weight the rounding of the place is a part of the density.
                    let step = 1e-12 * s.pdf.max(d.density(1.0, [[1.0; 2]; 2], [0.5; 2], 0));
                    assert!((asked - s.pdf).abs() <= 1e-9 * s.pdf + step, "{w} × {h}: {s:?} {asked}");
                }
            }
        }
    }

    #[test]
    fn random_numbers_of_0_and_nearly_1_stay_inside() {
        let weight = |x: usize, _| if x == 1 { 1.0 } else { 0.0 };
        let d = BilinearImage::new(4, 2, weight).unwrap();
        for u in [0.0, 1e-300, 0.5, 1.0 - 1e-16, 1.0] {
            for v in [0.0, 1e-300, 0.5, 1.0 - 1e-16, 1.0] {
                let s = d.sample([u, v], weight);
                assert!(s.pdf >= 0.0 && s.pdf.is_finite() && (0.125..=0.625).contains(&s.p[0]), "{s:?}");
                assert!((0.0..=1.0).contains(&s.p[1]), "{s:?}");
            }
        }
        assert!(BilinearImage::new(3, 3, |_, _| 0.0).is_none());
        assert!(BilinearImage::new(0, 3, |_, _| 1.0).is_none());
    }
}
