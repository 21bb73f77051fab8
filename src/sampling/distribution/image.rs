//! An image of weights over the unit square, constant within each texel: rows by their sums, then
//! texels within the row.
//!
//! Random numbers have 24 bits, so cumulative weights are kept in units of 2⁻²⁴. Every texel with a
//! weight above 0 gets at least one unit: whatever has a density can be drawn, however large the
//! range, and the density returned is exactly that of drawing. Four bytes per texel, and
//! four more for every 64 in an index that keeps the search within a few cache lines.

use rayon::prelude::*;

/// Units of the whole, the resolution of the random numbers.
const UNITS: u32 = 1 << 24;

/// The largest place of a random number, in units.
const LAST_UNIT: f64 = UNITS as f64 - 1e-6;

/// Texels per entry of the index.
const BLOCK: usize = 64;

/// Draws points in proportion to an image.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    width: usize,
    height: usize,
    /// Cumulative units of the rows, `height + 1` of them.
    rows: Vec<u32>,
    /// Cumulative units within each row, `width + 1` per row.
    texels: Vec<u32>,
    /// Every `BLOCK`-th of `texels`, `blocks` per row.
    index: Vec<u32>,
    blocks: usize,
}

/// What [`Distribution2d::sample`] drew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSample {
    /// Point in [0, 1)²: x along the row, y down the rows in the order of the weights.
    pub p: [f32; 2],
    /// Density over the unit square, above 0; its mean over the square is 1.
    pub pdf: f32,
}

/// A texel, and where in it the random numbers point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Texel {
    /// Column.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// What is left of the random numbers, in [0, 1)².
    pub within: [f64; 2],
    /// Probability with which it is drawn, above 0.
    pub pmf: f64,
}

impl Distribution2d {
    /// A distribution over `width × height` texels, row by row; `weight(x, y)` that is negative or
    /// not finite counts as 0. `None` where all are 0, or where a side is longer than 2¹⁶.
    ///
    /// For a latitude-longitude image the weight is the texel's value times its solid angle.
    pub fn new(width: usize, height: usize, weight: impl Fn(usize, usize) -> f64 + Sync) -> Option<Self> {
        if width > 1 << 16 || height > 1 << 16 {
            return None;
        }
        let blocks = width.div_ceil(BLOCK);
        let mut texels = vec![0; (width + 1) * height];
        let mut row_sums = vec![0.0; height];
        let rows_of_texels = texels.par_chunks_exact_mut(width + 1).zip(row_sums.par_iter_mut());
        rows_of_texels.enumerate().for_each_init(
            || vec![0.0; width],
            |row, (y, (cumulative, row_sum))| {
                for (x, slot) in row.iter_mut().enumerate() {
                    let w = weight(x, y);
                    *slot = if w.is_finite() && w > 0.0 { w } else { 0.0 };
                }
                *row_sum = accumulate(row, cumulative);
            },
        );
        let mut rows = vec![0; height + 1];
        if accumulate(&row_sums, &mut rows) == 0.0 {
            return None;
        }
        let index =
            texels.chunks_exact(width + 1).flat_map(|row| row[..width].iter().step_by(BLOCK)).copied().collect();
        Some(Self { width, height, rows, texels, index, blocks })
    }

    /// Draws a point by `u` in [0, 1)².
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ImageSample {
        // A number of 24 bits stands for the middle of its unit.
        let Texel { x, y, within, pmf } = self.sample_texel(u.map(|u| f64::from(u) + 0.5 / f64::from(UNITS)));
        ImageSample {
            p: [place(x, within[0], self.width), place(y, within[1], self.height)],
            pdf: (pmf * self.width as f64 * self.height as f64) as f32,
        }
    }

    /// Draws a texel by `u` in [0, 1)², for those who place the point in it themselves.
    #[inline]
    pub(super) fn sample_texel(&self, u: [f64; 2]) -> Texel {
        let u = u.map(|u| (u * f64::from(UNITS)).clamp(0.0, LAST_UNIT));
        let (y, v, row_units) = draw(&self.rows, u[1]);
        let index = &self.index[y * self.blocks..(y + 1) * self.blocks];
        let first = BLOCK * (index.partition_point(|&c| c <= u[0] as u32) - 1);
        let (x, w, texel_units) = draw(&self.row(y)[first..(first + BLOCK).min(self.width) + 1], u[0]);
        Texel { x: first + x, y, within: [w, v], pmf: probability(row_units, texel_units) }
    }

    /// Probability with which [`Distribution2d::sample_texel`] draws this texel.
    #[inline]
    pub(super) fn pmf(&self, x: usize, y: usize) -> f64 {
        let row = self.row(y);
        probability(self.rows[y + 1] - self.rows[y], row[x + 1] - row[x])
    }

    /// Density of [`Distribution2d::sample`] at a point of the unit square; points outside count
    /// as on its border.
    #[inline]
    pub fn pdf(&self, p: [f32; 2]) -> f32 {
        let x = ((p[0] * self.width as f32) as usize).min(self.width - 1);
        let y = ((p[1] * self.height as f32) as usize).min(self.height - 1);
        (self.pmf(x, y) * self.width as f64 * self.height as f64) as f32
    }

    fn row(&self, y: usize) -> &[u32] {
        &self.texels[y * (self.width + 1)..(y + 1) * (self.width + 1)]
    }
}

/// Writes the cumulative units of `weights` (all ≥ 0), `UNITS` in the end and at least one for each
/// weight above 0, and returns the sum; leaves zeros where the sum is 0.
fn accumulate(weights: &[f64], cumulative: &mut [u32]) -> f64 {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    let total: f64 = weights.iter().map(|w| w / largest).sum();
    let present = weights.iter().filter(|&&w| w > 0.0).count();
    let shared = f64::from(UNITS) - present as f64;
    let (mut sum, mut seen) = (0.0, 0u32);
    for (slot, &weight) in cumulative[1..].iter_mut().zip(weights) {
        sum += weight / largest;
        seen += u32::from(weight > 0.0);
        *slot = if seen as usize == present { UNITS } else { seen + (sum / total * shared) as u32 };
    }
    (total * largest).min(f64::MAX)
}

#[inline]
fn probability(row_units: u32, texel_units: u32) -> f64 {
    let scale = 1.0 / f64::from(UNITS);
    f64::from(row_units) * scale * (f64::from(texel_units) * scale)
}

/// Inverts a cumulative list at `at` units: the index, the place within it in [0, 1) and its units.
#[inline]
fn draw(cumulative: &[u32], at: f64) -> (usize, f64, u32) {
    let index = cumulative.partition_point(|&c| c <= at as u32) - 1;
    let units = cumulative[index + 1] - cumulative[index];
    (index, (at - f64::from(cumulative[index])) / f64::from(units), units)
}

/// The coordinate at `within` of cell `index` of `count`, never rounded into another cell.
#[inline]
fn place(index: usize, within: f64, count: usize) -> f32 {
    let end = (index + 1) as f32 / count as f32;
    (((index as f64 + within) / count as f64) as f32).min(end.next_down())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integral(d: &Distribution2d) -> f64 {
        let mut sum = 0.0;
        for y in 0..d.height {
            for x in 0..d.width {
                let p = [place(x, 0.5, d.width), place(y, 0.5, d.height)];
                sum += f64::from(d.pdf(p)) / (d.width * d.height) as f64;
            }
        }
        sum
    }

    #[test]
    fn density_follows_the_weights() {
        let weight = |x: usize, y: usize| if (x + y).is_multiple_of(5) { 0.0 } else { (1 + x * y) as f64 };
        let d = Distribution2d::new(37, 19, weight).unwrap();
        let total: f64 = (0..19).flat_map(|y| (0..37).map(move |x| weight(x, y))).sum();
        assert!((integral(&d) - 1.0).abs() < 1e-6);
        for y in 0..19 {
            for x in 0..37 {
                let exact = weight(x, y) / total * (37.0 * 19.0);
                let pdf = f64::from(d.pdf([place(x, 0.5, 37), place(y, 0.5, 19)]));
                assert!((pdf - exact).abs() < 1e-4, "{x} {y}: {pdf} {exact}");
                assert_eq!(exact == 0.0, pdf == 0.0);
            }
        }
    }

    #[test]
    fn sampled_density_is_the_density_there() {
        let d = Distribution2d::new(1000, 333, |x, y| if x == 700 && y == 7 { 1e8 } else { 1e-3 + (x ^ y) as f64 })
            .unwrap();
        for i in 0..10_000 {
            let u = [(i as f32 * 0.618_034).fract(), (i as f32 * 0.754_877).fract()];
            let s = d.sample(u);
            assert_eq!(d.pdf(s.p), s.pdf, "{s:?}");
        }
    }

    /// The grid of random numbers reaches a texel of 1e-11 of the energy, as often as its density says.
    #[test]
    fn faint_texels_can_be_drawn() {
        let d = Distribution2d::new(256, 4, |x, _| if x == 100 { 1e8 } else { 1e-3 }).unwrap();
        assert!((integral(&d) - 1.0).abs() < 1e-6);
        let mut hits = vec![0u32; 256];
        for k in 0..UNITS {
            let s = d.sample([k as f32 / UNITS as f32, 0.1]);
            hits[(s.p[0] * 256.0) as usize] += 1;
        }
        for (x, &h) in hits.iter().enumerate() {
            let pdf = d.pdf([place(x, 0.5, 256), 0.1]);
            assert!(h > 0 && (f64::from(pdf) * f64::from(UNITS) / 256.0 - f64::from(h)).abs() < 1e-2 * f64::from(h));
        }
    }

    #[test]
    fn corners_one_texel_and_none() {
        let d = Distribution2d::new(1, 1, |_, _| 5.0).unwrap();
        assert_eq!(d.sample([0.0, 0.999_999_94]).pdf, 1.0);
        let d = Distribution2d::new(3, 3, |x, y| if x == 1 && y == 1 { 1.0 } else { 0.0 }).unwrap();
        for u in [[0.0, 0.0], [0.999_999_94; 2]] {
            let s = d.sample(u);
            assert!(s.pdf == 9.0 && s.p.iter().all(|&c| (1.0 / 3.0..2.0 / 3.0).contains(&c)));
        }
        assert!(Distribution2d::new(4, 4, |_, _| 0.0).is_none());
        assert!(Distribution2d::new(0, 4, |_, _| 1.0).is_none());
        assert!(Distribution2d::new(2, 2, |_, _| f64::NAN).is_none());
        let huge = Distribution2d::new(2, 2, |_, _| 1e308).unwrap();
        assert_eq!(huge.pdf([0.2, 0.2]), 1.0);
    }
}
