//! How far a picture is from what it tends to: the errors of its pixels, and numbers for the whole.
//!
//! The error of Combined is estimated per pixel from its [replicates](super::replicates). Errors of pixels are
//! independent of each other, so that a sum over pixels of estimated variances `v` differs from that of the squared
//! errors which the picture has by a variance of `Σ 2K/(K-1) v²`, whatever the distribution: the fourth cumulants
//! of both cancel. The interval of a [`Figure`] follows from it.

use rayon::prelude::*;

use super::replicates::{PseudoValues, REPLICATES};
use super::store::Film;
use super::tile::Tile;

/// A figure whose interval is wider than by this factor to either side is none.
const WIDEST: f64 = 1.2;

/// Nor is one where so large a share of the squared error lies in a thousandth of the pixels.
const MOST_IN_FEW: f64 = 0.5;

/// A pixel's error is not believed where one sample holds more than this of it: four equal ones hold a half each.
const MOST_IN_ONE: f64 = 0.5;

/// Keeps relMSE finite in the dark, as the field has it.
const DARK: f64 = 1e-2;

/// Errors of less than this share of a value are rounding.
const ROUNDING: f64 = 1e-12;

/// Half widths of a normal distribution's 95 % interval.
const Z95: f64 = 1.959_964;

/// A number and the interval that holds the truth in 95 of 100 renders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// Estimate.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Why there is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// Some pixel has fewer than two samples in each replicate.
    TooFewSamples,
    /// A thousandth of the pixels holds most of the error: bright paths are found by few samples, and there may be
    /// others that none has found yet.
    HeavyTail,
    /// The interval is too wide.
    TooWide,
}

impl std::fmt::Display for Doubt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::TooFewSamples => "it takes 16 samples in every pixel",
            Self::HeavyTail => "most of it lies in a few pixels, in which rare bright paths were found",
            Self::TooWide => "too few pixels or samples tell of it",
        })
    }
}

/// Errors of a whole picture's Combined, scene-linear but for the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Root of the mean squared error over pixels and channels.
    pub rmse: Result<Figure, Doubt>,
    /// Mean of squared error / (value² + 0.01) over pixels and channels, the value being the median of 3 × 3 pixels.
    pub rel_mse: Result<Figure, Doubt>,
    /// Root mean square, over pixels and channels, of the error times the slope of the display's curve: 0.01 is a
    /// hundredth of the display's range.
    pub display: Result<Figure, Doubt>,
}

/// What is known of one pixel.
#[derive(Clone, Copy, Debug)]
struct PixelError {
    value: [f64; 3],
    /// Of the mean.
    variance: [f64; 3],
    variance_squared: [f64; 3],
    count: u32,
    /// The largest that one sample brought.
    largest: f64,
}

/// The errors of Combined, pixel by pixel.
#[derive(Clone, Debug)]
pub struct PixelErrors {
    width: usize,
    height: usize,
    pixels: Vec<PixelError>,
}

impl Film {
    /// The errors of Combined; `None` where they were not asked for, or where a pixel has too few samples.
    pub fn errors(&self) -> Option<PixelErrors> {
        if !self.passes().has_error() {
            return None;
        }
        let of_tile = |tile: &Tile| {
            let mut rest = Vec::new();
            tile.pixels().map(|(x, y)| PixelError::of(tile, x, y, &mut rest)).collect::<Option<Vec<_>>>()
        };
        let tiles: Option<Vec<Vec<PixelError>>> = self.tiles().par_iter().map(of_tile).collect();
        let (width, height) = (self.width() as usize, self.height() as usize);
        let nothing =
            PixelError { value: [0.0; 3], variance: [0.0; 3], variance_squared: [0.0; 3], count: 0, largest: 0.0 };
        let mut pixels = vec![nothing; width * height];
        for (tile, errors) in self.tiles().iter().zip(tiles?) {
            for ((x, y), error) in tile.pixels().zip(errors) {
                pixels[y as usize * width + x as usize] = error;
            }
        }
        Some(PixelErrors { width, height, pixels })
    }

    /// The picture's numbers; `None` where they were not asked for.
    pub fn accuracy(&self) -> Option<Accuracy> {
        let unknown = Err(Doubt::TooFewSamples);
        let nothing = Accuracy { rmse: unknown, rel_mse: unknown, display: unknown };
        self.passes().has_error().then(|| self.errors().map_or(nothing, |errors| errors.accuracy()))
    }

    /// Per pixel, whether the error of Combined is to be believed.
    pub(super) fn trust(&self) -> Vec<bool> {
        let none = || vec![false; self.width() as usize * self.height() as usize];
        self.errors().map_or_else(none, |errors| errors.trust())
    }
}

impl PixelError {
    fn of(tile: &Tile, x: u32, y: u32, rest: &mut Vec<f64>) -> Option<Self> {
        let pseudo = tile.pseudo_values(x, y, |m| m.combined(), rest)?;
        let value = tile.value(x, y, |m| m.combined());
        let value = [value[0], value[1], value[2]];
        // What rounding leaves of a pixel without error is none.
        let is_exact = |c: usize| pseudo.variance(c) <= (ROUNDING * value[c]).powi(2);
        let unless_exact =
            |of: fn(&PseudoValues, usize) -> f64| [0, 1, 2].map(|c| if is_exact(c) { 0.0 } else { of(&pseudo, c) });
        let [variance, variance_squared] = [PseudoValues::variance, PseudoValues::variance_squared].map(unless_exact);
        let (count, largest) = (tile.count(x, y), f64::from(tile.largest(x, y)));
        Some(Self { value, variance, variance_squared, count, largest })
    }

    fn mean_variance(&self) -> f64 {
        self.variance.iter().sum::<f64>() / 3.0
    }

    /// True where one sample holds most of the error, which without it is about `sigma`.
    fn hangs_on_one(&self, sigma: f64) -> bool {
        let mean = self.value.iter().sum::<f64>() / 3.0;
        let excess = self.largest - mean;
        // A float's rounding is no sample that stands out.
        excess > 1e-5 * mean.abs() && excess > MOST_IN_ONE * sigma * f64::from(self.count)
    }

    fn luminance(&self) -> f64 {
        let [r, g, b] = self.value;
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
}

impl PixelErrors {
    /// The picture's numbers.
    pub fn accuracy(&self) -> Accuracy {
        let rel_mse = self.figure(|x, y| std::array::from_fn(|c| 1.0 / (self.median(x, y, c).powi(2) + DARK)));
        Accuracy { rmse: root(self.figure(|_, _| [1.0; 3])), rel_mse, display: self.display() }
    }

    /// The error on the display's scale alone.
    pub fn display(&self) -> Result<Figure, Doubt> {
        root(self.figure(|x, y| {
            let around = self.square(x, y, 1).map(|i| (self.pixels[i].luminance(), 1.0));
            let (sum, n) = around.fold((0.0, 0.0), |(sum, n), (l, one)| (sum + l, n + one));
            [display_slope(sum / n).powi(2); 3]
        }))
    }

    /// Middle one of the values of a pixel and its neighbours: noise, and a bright sample most of all, would make a
    /// pixel's own stand for more than it is.
    fn median(&self, x: usize, y: usize, c: usize) -> f64 {
        let mut values: Vec<f64> = self.square(x, y, 1).map(|i| self.pixels[i].value[c]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Mean over pixels and channels of variance × weight.
    fn figure(&self, weights: impl Fn(usize, usize) -> [f64; 3] + Sync) -> Result<Figure, Doubt> {
        let k = REPLICATES as f64;
        let of_pixel = |(i, pixel): (usize, &PixelError)| {
            let weights = weights(i % self.width, i / self.width);
            let part: f64 = weights.iter().zip(pixel.variance).map(|(weight, v)| weight * v).sum();
            // As if channels went along with each other, when the spread is largest.
            let channels = weights.iter().zip(pixel.variance_squared);
            (part, weights.iter().sum::<f64>() * channels.map(|(weight, v2)| weight * v2).sum::<f64>())
        };
        let pixels: Vec<(f64, f64)> = self.pixels.par_iter().enumerate().map(of_pixel).collect();
        let (mut sum, mut squared, mut plain) = (0.0, 0.0, 0.0);
        let mut parts = Vec::with_capacity(pixels.len());
        for (part, part_squared) in pixels {
            parts.push(part);
            sum += part;
            plain += part * part;
            squared += part_squared;
        }
        if sum <= 0.0 {
            return Ok(Figure { value: 0.0, low: 0.0, high: 0.0 });
        }
        // Squares of estimates overstate: for normal errors by (k + 1) / (k - 1). The unbiased sum is never trusted
        // to be far below.
        let squared = squared.max(0.25 * plain);
        let relative = (2.0 * k / (k - 1.0) * squared).sqrt() / sum;
        let few = (parts.len() / 1000).max(1);
        parts.select_nth_unstable_by(few - 1, |a, b| b.total_cmp(a));
        if parts[..few].iter().sum::<f64>() > MOST_IN_FEW * sum && parts.len() > 1000 {
            return Err(Doubt::HeavyTail);
        }
        let factor = (Z95 * relative).exp();
        // Of the root, half in the exponent.
        if factor.sqrt() > WIDEST {
            return Err(Doubt::TooWide);
        }
        let value = sum / (3.0 * self.pixels.len() as f64);
        Ok(Figure { value, low: value / factor, high: value * factor })
    }

    /// Per pixel, whether its error is to be believed: where a sample stands out, neighbours may have missed its like.
    fn trust(&self) -> Vec<bool> {
        let at = |i: usize| (i % self.width, i / self.width);
        let lone = |i: usize| {
            let ((x, y), pixel) = (at(i), &self.pixels[i]);
            let around = self.square(x, y, 1).map(|i| self.pixels[i].mean_variance());
            let (n, sum) = around.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v));
            pixel.hangs_on_one(pixel.mean_variance().max(sum / n).sqrt())
        };
        let lone: Vec<bool> = (0..self.pixels.len()).map(lone).collect();
        let trusted = |i: usize| {
            let (x, y) = at(i);
            self.square(x, y, 1).all(|i| !lone[i])
        };
        (0..self.pixels.len()).map(trusted).collect()
    }

    /// What the neighbours of a pixel, at most `radius` away, say of it, itself left out: the mean variance of a
    /// sample in units of the display's range. `None` where it has no neighbours.
    pub fn around(&self, x: usize, y: usize, radius: usize) -> Option<f64> {
        let neighbours = self.square(x, y, radius).filter(|i| *i != y * self.width + x).map(|i| &self.pixels[i]);
        let (mut n, mut variance, mut luminance) = (0.0, 0.0, 0.0);
        for pixel in neighbours {
            n += 1.0;
            variance += pixel.mean_variance() * f64::from(pixel.count);
            luminance += pixel.luminance();
        }
        (n > 0.0).then(|| display_slope(luminance / n).powi(2) * variance / n)
    }

    /// Indices of the pixels at most `radius` columns and rows from one.
    fn square(&self, x: usize, y: usize, radius: usize) -> impl Iterator<Item = usize> + use<> {
        let rows = y.saturating_sub(radius)..(y + radius + 1).min(self.height);
        let columns = x.saturating_sub(radius)..(x + radius + 1).min(self.width);
        let width = self.width;
        rows.flat_map(move |y| columns.clone().map(move |x| y * width + x))
    }
}

fn root(figure: Result<Figure, Doubt>) -> Result<Figure, Doubt> {
    figure.map(|Figure { value, low, high }| Figure { value: value.sqrt(), low: low.sqrt(), high: high.sqrt() })
}

/// Slope at `y` of the curve from luminance to display values: sRGB's (IEC 61966-2-1) up to white, and beyond, where
/// a display clips but exposure may be lowered, a logarithm that goes on from there.
fn display_slope(y: f64) -> f64 {
    const AT_WHITE: f64 = 1.055 / 2.4;
    if y <= 0.003_130_8 {
        12.92
    } else if y <= 1.0 {
        AT_WHITE * y.powf(1.0 / 2.4 - 1.0)
    } else {
        AT_WHITE / y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PassSet, PixelSample, SampleId};
    use crate::math::Rgb;

    /// A film of `size`² pixels with errors, of which each has `n` samples.
    fn film(size: u32, n: u32, mut sample: impl FnMut(u32, u32) -> f32) -> Film {
        let mut film = Film::new(size, size, PassSet::parse("combined,error,error_trust").expect("known"));
        for tile in film.tiles_mut() {
            for (x, y) in tile.pixels() {
                for index in 0..n {
                    let sample = PixelSample { combined: Rgb::splat(sample(x, y)), ..PixelSample::default() };
                    assert!(tile.add(SampleId { x, y, index }, 1.0, &sample));
                }
            }
        }
        film
    }

    /// Uniform numbers, a fixed sequence.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        }
    }

    #[test]
    fn constant_pixels_have_no_error() {
        let film = film(5, 24, |x, _| x as f32 * 0.1);
        let accuracy = film.accuracy().expect("asked for");
        for figure in [accuracy.rmse, accuracy.display] {
            assert!(figure.expect("known").high < 1e-12, "{accuracy:?}");
        }
        let picture = film.develop();
        assert!(picture.layer("Error").expect("there").data.iter().all(|&v| v < 1e-12));
        assert!(picture.layer("Error Trust").expect("there").data.iter().all(|&v| v == 1.0));
    }

    #[test]
    fn below_sixteen_samples_there_is_no_number() {
        let film = film(3, 15, |_, _| 1.0);
        assert_eq!(film.accuracy().expect("asked for").rmse, Err(Doubt::TooFewSamples));
        let picture = film.develop();
        assert!(picture.layers.iter().skip(1).all(|layer| layer.data.iter().all(|&v| v == 0.0)));
    }

    #[test]
    fn without_the_question_nothing_is_kept() {
        let film = Film::new(4, 4, PassSet::default());
        assert!(film.accuracy().is_none() && film.errors().is_none());
        let with = Film::new(4, 4, PassSet::default().with_error());
        assert_eq!(with.bytes() - film.bytes(), 16 * (8 * (3 * 8 + 4) + 4));
        let needed = |passes: &PassSet| Film::bytes_needed(4, 4, passes);
        assert_eq!(needed(with.passes()) - needed(film.passes()), 16 * (8 * (3 * 8 + 4) + 4));
    }

    /// Bernoulli pixels, whose standard error is known; the interval holds the error that the picture has.
    #[test]
    fn numbers_and_intervals_hold_for_bernoulli_pixels() {
        let mut u = numbers();
        let (n, size, renders) = (64, 32, 100);
        let exact = (0.25_f64 / f64::from(n)).sqrt();
        let mut held = [0; 2];
        for _ in 0..renders {
            let film = film(size, n, |_, _| if u() < 0.5 { 1.0 } else { 0.0 });
            let Accuracy { rmse, display, .. } = film.accuracy().expect("asked for");
            let (rmse, display) = (rmse.expect("known"), display.expect("known"));
            assert!((rmse.value / exact - 1.0).abs() < 0.06, "{rmse:?} for {exact}");
            let picture = film.develop();
            let values = picture.layers[0].data.chunks_exact(4).map(|pixel| f64::from(pixel[0]) - 0.5);
            let truth = (values.map(|error| error * error).sum::<f64>() / f64::from(size * size)).sqrt();
            let slope = display_slope(0.5);
            for (held, (figure, truth)) in held.iter_mut().zip([(rmse, truth), (display, truth * slope)]) {
                *held += u32::from((figure.low..figure.high).contains(&truth));
            }
        }
        // 95 of 100, within three standard deviations.
        assert!(held.iter().all(|held| (88..=100).contains(held)), "{held:?}");
    }

    #[test]
    fn a_bright_sample_weighs_no_less_for_its_own_brightness() {
        let film = film(3, 16, |x, y| if (x, y) == (1, 1) { 100.0 } else { 0.5 });
        assert_eq!(film.errors().expect("known").median(1, 1, 0), 0.5);
    }

    #[test]
    fn rare_bright_samples_are_told_and_give_no_number() {
        let mut u = numbers();
        let film = film(48, 32, |_, _| if u() < 5e-5 { 1e4 } else { 0.5 + 0.1 * u() as f32 });
        let accuracy = film.accuracy().expect("asked for");
        assert!(matches!(accuracy.rmse, Err(Doubt::HeavyTail | Doubt::TooWide)), "{accuracy:?}");
        let picture = film.develop();
        let trust = picture.layer("Error Trust").expect("there");
        assert!(picture.layers[0].data.iter().any(|v| *v > 100.0), "a rare sample was drawn");
        for (x, y) in (0..48_u32).flat_map(|y| (0..48_u32).map(move |x| (x, y))) {
            let bright = |x: u32, y: u32| picture.layers[0].pixel(48, x, y)[0] > 1.0;
            let near = (y.saturating_sub(1)..(y + 2).min(48))
                .any(|y| (x.saturating_sub(1)..(x + 2).min(48)).any(|x| bright(x, y)));
            assert_eq!(trust.pixel(48, x, y)[0] == 0.0, near, "({x}, {y})");
        }
    }

    #[test]
    fn the_displays_slope_is_that_of_its_curve() {
        let curve = |y: f64| if y <= 0.003_130_8 { 12.92 * y } else { 1.055 * y.powf(1.0 / 2.4) - 0.055 };
        for y in [1e-3, 0.01, 0.18, 0.5, 0.999] {
            let slope = (curve(y * 1.000_01) - curve(y)) / (y * 0.000_01);
            assert!((display_slope(y) / slope - 1.0).abs() < 1e-4, "{y}");
        }
        assert_eq!(display_slope(-1.0), 12.92);
        assert!((display_slope(1.0 + 1e-9) / display_slope(1.0) - 1.0).abs() < 1e-6);
        assert_eq!(display_slope(4.0) * 2.0, display_slope(2.0));
    }

    #[test]
    fn a_pixel_is_judged_by_its_neighbours_alone() {
        let mut u = numbers();
        let quiet = film(5, 16, |_, _| 0.5);
        let noisy = film(5, 16, |x, y| if (x, y) == (2, 2) { u() as f32 } else { 0.5 });
        let at = |film: &Film, x, y| film.errors().expect("known").around(x, y, 2).expect("neighbours");
        assert!(at(&quiet, 2, 2) < 1e-20 && at(&noisy, 2, 2) < 1e-20);
        assert!(at(&noisy, 1, 1) > 1e-6);
        assert!(film(1, 16, |_, _| 1.0).errors().expect("known").around(0, 0, 2).is_none());
    }
}
