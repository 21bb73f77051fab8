//! Pixel reconstruction filters, by importance sampling.
//!
//! A pixel is the convolution of the picture with a filter f: `∫∫ f(x) f(y) L(x, y) / (∫ f)²`. Camera
//! rays are drawn from |f| about the pixel's centre, so that every sample belongs to one pixel only and
//! weighs `sign(f) · (∫|f| / ∫f)` per axis: Manfred Ernst, Marc Stamminger, Günther Greiner: *Filter
//! Importance Sampling*, IEEE Symposium on Interactive Ray Tracing 2006. All filters are separable.
//!
//! The default is Blackman-Harris with a half width of 1.5 pixels: it is Blender's, so that pictures
//! line up with Cycles' to the edge; its spectrum falls faster than that of every other filter here
//! (first side lobe -92 dB), and it has no negative weights, which would let pixels beside bright ones
//! turn negative.
//!
//! Width is Cycles' setting, in pixels, with Cycles' meaning for each filter (measured): the half
//! width of Blackman-Harris and triangle; four sigmas of the Gaussian; box is always one pixel wide.

use std::f64::consts::PI;
use std::fmt;

/// A row of [`FILTERS`].
#[derive(Debug)]
pub struct FilterRow {
    /// Name for `--filter`.
    pub name: &'static str,
    /// Width where none is given, in pixels.
    pub default_width: f32,
    /// One line for `--help` and the docs.
    pub help: &'static str,
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Box,
    Triangle,
    Gaussian,
    BlackmanHarris,
    Mitchell,
}

/// The filters; the first is the default.
#[rustfmt::skip]
pub static FILTERS: &[FilterRow] = &[
    FilterRow { name: "blackman_harris", default_width: 1.5, shape: Shape::BlackmanHarris,
        help: "smooth, no ringing, Blender's default; WIDTH is the half width in pixels" },
    FilterRow { name: "gaussian", default_width: 1.5, shape: Shape::Gaussian,
        help: "sigma is WIDTH / 4 pixels, cut at 6 sigma" },
    FilterRow { name: "triangle", default_width: 1.0, shape: Shape::Triangle,
        help: "tent; WIDTH is the half width in pixels" },
    FilterRow { name: "box", default_width: 1.0, shape: Shape::Box,
        help: "mean over the pixel; always one pixel wide" },
    FilterRow { name: "mitchell", default_width: 2.0, shape: Shape::Mitchell,
        help: "Mitchell-Netravali with B = C = 1/3, sharper, with negative lobes; WIDTH is the half width in pixels" },
];

/// Cells of the table that inverts a distribution function.
const CELLS: usize = 1024;

/// A filter ready to draw from.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    name: &'static str,
    shape: Shape,
    /// Half width of the support, in pixels.
    radius: f32,
    /// ∫|f| / ∫f along one axis; 1 for filters without negative lobes.
    scale: f32,
    /// |f|'s distribution function at the borders of [`CELLS`] equal cells from -radius to radius;
    /// empty for those inverted in closed form.
    cdf: Vec<f32>,
    /// For each of [`CELLS`] equal ranges of u, the cell where the search for u begins.
    guide: Vec<u16>,
}

impl fmt::Display for Filter {
    /// As [`Filter::parse`] takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.shape {
            Shape::Box => f.write_str(self.name),
            Shape::Gaussian => write!(f, "{}:{}", self.name, self.radius / 1.5),
            _ => write!(f, "{}:{}", self.name, self.radius),
        }
    }
}

impl Default for Filter {
    fn default() -> Self {
        Self::new(&FILTERS[0], FILTERS[0].default_width)
    }
}

impl Filter {
    /// `NAME` or `NAME:WIDTH`.
    ///
    /// # Errors
    /// A message that says what is wrong and which filters there are.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, width) = text.split_once(':').map_or((text, None), |(name, width)| (name, Some(width)));
        let alias = if name == "tent" { "triangle" } else { name };
        let Some(row) = FILTERS.iter().find(|row| row.name.eq_ignore_ascii_case(alias)) else {
            let names: Vec<&str> = FILTERS.iter().map(|row| row.name).collect();
            return Err(format!("there is no filter '{name}'; there are: {}", names.join(", ")));
        };
        let width = match width {
            None => row.default_width,
            Some(width) => match width.trim().parse::<f32>() {
                Ok(width) if (0.01..=20.0).contains(&width) => width,
                _ => return Err(format!("filter width '{width}' is not a number of pixels from 0.01 to 20")),
            },
        };
        Ok(Self::new(row, width))
    }

    fn new(row: &FilterRow, width: f32) -> Self {
        let radius = match row.shape {
            Shape::Box => 0.5,
            Shape::Gaussian => 1.5 * width,
            Shape::Triangle | Shape::BlackmanHarris | Shape::Mitchell => width,
        };
        let mut filter =
            Self { name: row.name, shape: row.shape, radius, scale: 1.0, cdf: Vec::new(), guide: Vec::new() };
        if !matches!(row.shape, Shape::Box | Shape::Triangle) {
            filter.tabulate();
        }
        filter
    }

    /// Name in [`FILTERS`].
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Half width of the support, in pixels.
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The filter along one axis, `x` in pixels from the centre; not normalised.
    pub fn eval(&self, x: f32) -> f32 {
        let t = f64::from(x / self.radius);
        if t.abs() >= 1.0 { 0.0 } else { self.shape.eval(t) as f32 }
    }

    /// An offset from the pixel's centre, in pixels, and the weight of a sample there.
    pub fn sample(&self, u: [f32; 2]) -> (f32, f32, f32) {
        let (dx, wx) = self.sample_axis(u[0]);
        let (dy, wy) = self.sample_axis(u[1]);
        (dx, dy, wx * wy)
    }

    fn sample_axis(&self, u: f32) -> (f32, f32) {
        let x = match self.shape {
            Shape::Box => u - 0.5,
            // Inverse of the tent's distribution function, each half on its own.
            Shape::Triangle if u < 0.5 => self.radius * ((2.0 * u).sqrt() - 1.0),
            Shape::Triangle => self.radius * (1.0 - (2.0 * (1.0 - u)).sqrt()),
            _ => self.invert(u),
        };
        if self.shape == Shape::Mitchell { (x, self.scale * self.eval(x).signum()) } else { (x, 1.0) }
    }

    /// Where the tabulated distribution function reaches `u`, linear within a cell: |f| is taken as
    /// constant there, an error of its second moment below 1e-6.
    fn invert(&self, u: f32) -> f32 {
        let mut cell = usize::from(self.guide[((u * CELLS as f32) as usize).min(CELLS - 1)]);
        while cell < CELLS - 1 && self.cdf[cell + 1] <= u {
            cell += 1;
        }
        let (low, high) = (self.cdf[cell], self.cdf[cell + 1]);
        let within = if high > low { ((u - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        self.radius * ((cell as f32 + within) * (2.0 / CELLS as f32) - 1.0)
    }

    fn tabulate(&mut self) {
        // Integrate |f| over each cell by the midpoint rule with 16 points.
        const POINTS: usize = 16;
        let (mut absolute, mut signed) = (0.0, 0.0);
        let mut sums = vec![0.0];
        for i in 0..CELLS * POINTS {
            let t = (i as f64 + 0.5) * (2.0 / (CELLS * POINTS) as f64) - 1.0;
            let f = self.shape.eval(t);
            signed += f;
            absolute += f.abs();
            if i % POINTS == POINTS - 1 {
                sums.push(absolute);
            }
        }
        self.scale = (absolute / signed) as f32;
        self.cdf = sums.into_iter().map(|sum| (sum / absolute) as f32).collect();
        // Chen and Asau 1974: the search is as long as there are cells in a range, about one on average.
        let begin = |range: usize| self.cdf.partition_point(|&c| c <= range as f32 / CELLS as f32).clamp(1, CELLS) - 1;
        self.guide = (0..CELLS).map(|range| begin(range) as u16).collect();
    }
}

impl Shape {
    /// The filter at `t` in -1 to 1, fractions of the radius; not normalised.
    fn eval(self, t: f64) -> f64 {
        match self {
            Self::Box => 1.0,
            Self::Triangle => 1.0 - t.abs(),
            // The radius is six sigmas.
            Self::Gaussian => (-18.0 * t * t).exp(),
            // Fredric Harris: On the Use of Windows for Harmonic Analysis with the DFT, 1978, four terms.
            Self::BlackmanHarris => {
                let x = PI * t;
                0.35875 + 0.48829 * x.cos() + 0.14128 * (2.0 * x).cos() + 0.01168 * (3.0 * x).cos()
            }
            // Don Mitchell, Arun Netravali: Reconstruction Filters in Computer Graphics, 1988, B = C = 1/3.
            Self::Mitchell => {
                let x = 2.0 * t.abs();
                if x < 1.0 {
                    (7.0 * x * x * x - 12.0 * x * x + 16.0 / 3.0) / 6.0
                } else {
                    (-7.0 / 3.0 * x * x * x + 12.0 * x * x - 20.0 * x + 32.0 / 3.0) / 6.0
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Filter> {
        FILTERS.iter().map(|row| Filter::new(row, row.default_width)).collect()
    }

    /// Signed moments ∫ tᵏ f / ∫ f over -radius to radius, in pixels, by the midpoint rule in f64.
    fn moment(filter: &Filter, k: i32) -> f64 {
        let radius = f64::from(filter.radius);
        let n = 200_000;
        let (mut top, mut bottom) = (0.0, 0.0);
        for i in 0..n {
            let t = (f64::from(i) + 0.5) * (2.0 / f64::from(n)) - 1.0;
            let f = filter.shape.eval(t);
            top += (radius * t).powi(k) * f;
            bottom += f;
        }
        top / bottom
    }

    #[test]
    fn weighted_samples_have_the_analytic_moments() {
        for filter in all() {
            let n = 100_000;
            let mut sums = [0.0_f64; 5];
            for i in 0..n {
                let (x, w) = filter.sample_axis((i as f32 + 0.5) / n as f32);
                assert!(x.abs() <= filter.radius, "{}", filter.name);
                for (k, sum) in sums.iter_mut().enumerate() {
                    *sum += f64::from(w) * f64::from(x).powi(k as i32) / f64::from(n);
                }
            }
            for (k, sum) in sums.iter().enumerate() {
                let analytic = moment(&filter, k as i32);
                assert!((sum - analytic).abs() < 2e-5, "{} moment {k}: {sum} is not {analytic}", filter.name);
            }
        }
    }

    #[test]
    fn samples_fill_bins_as_the_filter_does() {
        for filter in all() {
            let (bins, n) = (64, 64_000);
            let mut counts = vec![0.0; bins];
            for i in 0..n {
                let (x, _) = filter.sample_axis((i as f32 + 0.5) / n as f32);
                let bin = (f64::from(x / filter.radius) + 1.0) * 0.5 * bins as f64;
                counts[(bin as usize).min(bins - 1)] += 1.0;
            }
            let mass: Vec<f64> = (0..bins)
                .map(|bin| {
                    (0..1000).map(move |i| (bin as f64 + (f64::from(i) + 0.5) / 1000.0) / (0.5 * bins as f64) - 1.0)
                })
                .map(|points| points.map(|t| filter.shape.eval(t).abs()).sum())
                .collect();
            let total: f64 = mass.iter().sum();
            for (bin, (count, mass)) in counts.iter().zip(&mass).enumerate() {
                // Stratified input: a bin is off by the one sample at each of its borders at most.
                let expected = f64::from(n) * mass / total;
                assert!((count - expected).abs() <= 2.0, "{} bin {bin}: {count} is not {expected}", filter.name);
            }
        }
    }

    #[test]
    fn gaussian_and_blackman_harris_have_cycles_widths() {
        let deviation = |text: &str| moment(&Filter::parse(text).expect("known"), 2).sqrt();
        assert!((deviation("gaussian:1.5") - 0.375).abs() < 1e-6);
        assert!((deviation("box:7") - (1.0_f64 / 12.0).sqrt()).abs() < 1e-5);
        assert!((deviation("tent:2") - 2.0 / 6.0_f64.sqrt()).abs() < 1e-5);
        assert_eq!(Filter::parse("blackman_harris:2").expect("known").radius(), 2.0);
    }

    #[test]
    fn the_ends_of_u_stay_inside() {
        for filter in all() {
            for u in [0.0, f32::MIN_POSITIVE, 0.5, crate::math::ONE_MINUS_EPSILON] {
                let (x, y, w) = filter.sample([u, u]);
                assert!(x.is_finite() && x.abs() <= filter.radius && x == y && w.is_finite(), "{} {u}", filter.name);
            }
        }
    }

    #[test]
    fn what_is_not_a_filter_is_told_with_what_is() {
        let message = Filter::parse("lanczos").expect_err("unknown");
        assert!(message.contains("lanczos") && message.contains("mitchell"), "{message}");
        for bad in ["box:", "box:x", "box:0", "box:-1", "box:nan", "box:1e9"] {
            assert!(Filter::parse(bad).is_err(), "{bad}");
        }
        assert_eq!(Filter::default().name(), "blackman_harris");
    }
}
