//! Samples dealt over independently scrambled replicates, from which a pixel's error is known.
//!
//! The points of one scrambled sequence are correlated: the variance of its samples says nothing of the error of
//! their mean. So samples are dealt like cards over [`REPLICATES`] sequences, each scrambled on its own, and the
//! means of these differ by what they are off: Art Owen, *Monte Carlo variance of scrambled net quadrature*, SIAM
//! Journal on Numerical Analysis 34, 1997; Art Owen, *Monte Carlo theory, methods and examples*, section 17.3.

use std::array;
use std::sync::Arc;

/// How many independent sequences there are where errors are asked for.
pub const REPLICATES: usize = 8;

/// Samples that a replicate must have before an error is told of.
pub const LEAST_PER_REPLICATE: u32 = 2;

/// The place of sample `index` of a pixel in the sampler's sequences, of which the upper half of a place chooses one.
pub const fn place(index: u32) -> u64 {
    let replicates = REPLICATES as u32;
    ((index % replicates) as u64) << 32 | (index / replicates) as u64
}

/// The sums of each replicate, for the pixels of a tile.
#[derive(Clone, Debug)]
pub(super) struct Replicates {
    /// Which of the pixel's numbers are kept, ascending.
    numbers: Arc<[u32]>,
    /// Sum of weight × value, by pixel, replicate and number.
    sums: Vec<f64>,
    /// Samples taken in, by pixel and replicate.
    counts: Vec<u32>,
    /// Of the mean of the first three numbers the largest that a sample brought, per pixel.
    largest: Vec<f32>,
}

/// What the replicates of a pixel say about a value.
#[derive(Clone, Copy, Debug)]
pub(super) struct PseudoValues {
    /// Of each replicate, an estimate of the value's channels that is independent of the others; for a mean, the
    /// replicate's own.
    pub(super) values: [[f64; 4]; REPLICATES],
    /// Share of each replicate in the pixel's samples.
    pub(super) shares: [f64; REPLICATES],
}

impl Replicates {
    /// Bytes per pixel for `numbers` numbers.
    pub(super) const fn bytes_per_pixel(numbers: usize) -> usize {
        REPLICATES * (size_of::<f64>() * numbers + size_of::<u32>()) + size_of::<f32>()
    }

    pub(super) fn new(pixels: usize, numbers: Arc<[u32]>) -> Self {
        Self {
            sums: vec![0.0; pixels * REPLICATES * numbers.len()],
            numbers,
            counts: vec![0; pixels * REPLICATES],
            largest: vec![0.0; pixels],
        }
    }

    pub(super) fn bytes(&self) -> usize {
        self.largest.len() * Self::bytes_per_pixel(self.numbers.len())
    }

    /// Takes in sample `index` of a pixel, `values` being all of the pixel's numbers.
    pub(super) fn add(&mut self, pixel: usize, index: u32, weight: f32, values: &[f32]) {
        let replicate = pixel * REPLICATES + index as usize % REPLICATES;
        let n = self.numbers.len();
        for (sum, &number) in self.sums[replicate * n..][..n].iter_mut().zip(&*self.numbers) {
            *sum += f64::from(weight) * f64::from(values[number as usize]);
        }
        self.counts[replicate] += 1;
        let brought = self.numbers.iter().take(3).map(|&number| values[number as usize]).sum::<f32>() / 3.0;
        self.largest[pixel] = self.largest[pixel].max((weight * brought).abs());
    }

    /// All that is summed up, for [saving](super::tile::Tile::save): sums, counts, largest.
    pub(super) fn arrays(&self) -> (&[f64], &[u32], &[f32]) {
        (&self.sums, &self.counts, &self.largest)
    }

    /// The same, to be filled.
    pub(super) fn arrays_mut(&mut self) -> (&mut [f64], &mut [u32], &mut [f32]) {
        (&mut self.sums, &mut self.counts, &mut self.largest)
    }

    /// The largest that a sample of the pixel brought.
    pub(super) fn largest(&self, pixel: usize) -> f32 {
        self.largest[pixel]
    }

    /// The jackknife's pseudo-values of `value`, a function of a pixel's sums and their number of samples: for
    /// anything smooth, ratios among them, their spread is that of the value to first order.
    ///
    /// John Tukey, *Bias and confidence in not quite large samples*, 1958; Frank Busing, Erik Meijer, Rien van der
    /// Leeden, *Delete-m jackknife for unequal m*, Statistics and Computing 9, 1999. `None` where some replicate has
    /// fewer than [`LEAST_PER_REPLICATE`] samples. `rest` is scratch.
    pub(super) fn pseudo_values(
        &self,
        pixel: usize,
        sums: &[f64],
        rest: &mut Vec<f64>,
        value: impl Fn(&[f64], u32) -> [f64; 4],
    ) -> Option<PseudoValues> {
        let counts = &self.counts[pixel * REPLICATES..][..REPLICATES];
        if counts.iter().any(|&count| count < LEAST_PER_REPLICATE) {
            return None;
        }
        let n = self.numbers.len();
        let count: u32 = counts.iter().sum();
        let whole = value(sums, count);
        rest.clear();
        rest.extend_from_slice(sums);
        let values = array::from_fn(|r| {
            let own = &self.sums[(pixel * REPLICATES + r) * n..][..n];
            for (&number, own) in self.numbers.iter().zip(own) {
                rest[number as usize] = sums[number as usize] - own;
            }
            let without = value(rest, count - counts[r]);
            let h = f64::from(count) / f64::from(counts[r]);
            array::from_fn(|c| h * whole[c] - (h - 1.0) * without[c])
        });
        Some(PseudoValues { values, shares: array::from_fn(|r| f64::from(counts[r]) / f64::from(count)) })
    }
}

impl PseudoValues {
    /// Mean of channel `c`.
    fn mean(&self, c: usize) -> f64 {
        self.values.iter().zip(self.shares).map(|(value, share)| share * value[c]).sum()
    }

    /// Estimated variance of channel `c` of the value; without bias for a mean of equal replicates.
    pub(super) fn variance(&self, c: usize) -> f64 {
        let mean = self.mean(c);
        let parts = self.values.iter().zip(self.shares).map(|(value, share)| {
            let of_one = share / (1.0 - share);
            of_one * (value[c] - mean).powi(2)
        });
        parts.sum::<f64>() / REPLICATES as f64
    }

    /// Estimated square of that variance; without bias for a mean of equal replicates, whatever its distribution, and
    /// so below 0 at times.
    ///
    /// From E Σd⁴ and E (Σd²)² in cumulants of the replicates: Ronald Fisher, *Moments and product moments of
    /// sampling distributions*, 1930.
    pub(super) fn variance_squared(&self, c: usize) -> f64 {
        let n = REPLICATES as f64;
        let mean = self.mean(c);
        let squares = self.values.iter().map(|value| (value[c] - mean).powi(2));
        let (s2, s4) = squares.fold((0.0, 0.0), |(s2, s4), d2| (s2 + d2, s4 + d2 * d2));
        let k4 = (n * (n + 1.0) * s4 - 3.0 * (n - 1.0) * s2 * s2) / ((n - 1.0) * (n - 2.0) * (n - 3.0));
        let of_one = (s2 * s2 - (n - 1.0).powi(2) * k4 / n) / ((n - 1.0) * (n + 1.0));
        of_one / (n * n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform numbers, a fixed sequence.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / (1_u64 << 24) as f64
        }
    }

    /// One pixel, of `sums` of two numbers, and its replicates.
    fn pixel(samples: impl Iterator<Item = [f32; 2]>) -> (Replicates, Vec<f64>) {
        let mut replicates = Replicates::new(1, [0, 1].into());
        let mut sums = vec![0.0; 2];
        for (i, values) in samples.enumerate() {
            replicates.add(0, i as u32, 1.0, &values);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += f64::from(value));
        }
        (replicates, sums)
    }

    fn mean(sums: &[f64], count: u32) -> [f64; 4] {
        [sums[0] / f64::from(count), 0.0, 0.0, 0.0]
    }

    #[test]
    fn samples_are_dealt_over_the_sequences() {
        assert_eq!([0, 1, 7, 8, 17].map(place), [0, 1 << 32, 7 << 32, 1, 1 << 32 | 2]);
    }

    #[test]
    fn the_variance_is_that_of_the_replicates_means() {
        let (replicates, sums) = pixel((0..16).map(|i| [if i % 8 == 3 { 8.0 } else { 0.0 }, 0.0]));
        let pseudo = replicates.pseudo_values(0, &sums, &mut Vec::new(), mean).expect("two samples each");
        // Means of the replicates: seven of 0 and one of 8.
        assert!((pseudo.variance(0) - (7.0 + 49.0) / 56.0).abs() < 1e-12);
        assert!((f64::from(replicates.largest(0)) - 8.0 / 2.0 / 1.5).abs() < 1e-6);
    }

    #[test]
    fn fewer_than_two_samples_in_a_replicate_say_nothing() {
        let (replicates, sums) = pixel((0..15).map(|_| [1.0, 0.0]));
        assert!(replicates.pseudo_values(0, &sums, &mut Vec::new(), mean).is_none());
    }

    /// Bernoulli samples: Var = p (1 - p) / n. Over many pixels the estimates, and those of their squares, come out
    /// at it; so do those of a number of samples that the replicates share unequally.
    #[test]
    fn estimates_are_unbiased_for_bernoulli_samples() {
        let mut u = numbers();
        for (p, n) in [(0.5, 16), (0.1, 64), (0.3, 61)] {
            let exact = p * (1.0 - p) / f64::from(n);
            let pixels = 40_000;
            let (mut variance, mut squared, mut spread) = (0.0, 0.0, 0.0);
            for _ in 0..pixels {
                let (replicates, sums) = pixel((0..n).map(|_| [if u() < p { 1.0 } else { 0.0 }, 0.0]));
                let pseudo = replicates.pseudo_values(0, &sums, &mut Vec::new(), mean).expect("enough");
                variance += pseudo.variance(0) / f64::from(pixels);
                spread += pseudo.variance(0).powi(2) / f64::from(pixels);
                squared += pseudo.variance_squared(0) / f64::from(pixels);
            }
            let sigma = ((spread - variance * variance) / f64::from(pixels)).sqrt();
            assert!((variance - exact).abs() < 4.0 * sigma, "{p} {n}: {variance} for {exact} ± {sigma}");
            if n % 8 == 0 {
                assert!((squared / (exact * exact) - 1.0).abs() < 0.05, "{p} {n}: {squared} for {}", exact * exact);
            }
        }
    }

    /// The ratio of two means, against its true spread over many pixels.
    #[test]
    fn ratios_are_known_to_first_order() {
        let mut u = numbers();
        let ratio = |sums: &[f64], _| [sums[0] / sums[1], 0.0, 0.0, 0.0];
        let pixels = 20_000;
        let (mut estimated, mut first, mut second) = (0.0, 0.0, 0.0);
        for _ in 0..pixels {
            let samples = (0..64).map(|_| {
                let all = 0.5 + u() as f32;
                [if u() < 0.4 { all } else { 0.0 }, all]
            });
            let (replicates, sums) = pixel(samples.collect::<Vec<_>>().into_iter());
            let pseudo = replicates.pseudo_values(0, &sums, &mut Vec::new(), ratio).expect("enough");
            let value = sums[0] / sums[1];
            estimated += pseudo.variance(0) / f64::from(pixels);
            first += value / f64::from(pixels);
            second += value * value / f64::from(pixels);
        }
        let exact = second - first * first;
        assert!((estimated / exact - 1.0).abs() < 0.04, "{estimated} for {exact}");
    }
}
