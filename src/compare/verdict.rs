//! Noise passes, bias fails.
//!
//! The mean difference of every block of 16 × 16 pixels, of every channel, and of the whole picture is one test. It
//! fails where it is beyond three standard errors, corrected for the number of tests (Z. Šidák, JASA 62 (1967):
//! each at level 1 - (1 - α)^(1/n)), and beyond half a percent of the pass's mean.

use super::figures::Values;
use super::side::Noise;
use crate::film::PASSES;
use crate::math::normal_quantile;

/// Pixels on each side of a block.
pub(super) const BLOCK: usize = 16;

/// Standard errors that a single test would be allowed.
const SIGMAS: f64 = 3.0;

/// Both tails of a normal distribution beyond three standard errors.
const ALPHA: f64 = 0.002_699_796_063_260_189;

/// Share of the pass's mean that is no difference worth a word.
const SHARE: f64 = 0.005;

/// Passes that tell of the render, not of the scene.
const OF_THE_RENDER: &[&str] = &["Debug Sample Count", "Render Time", "Noisy Image"];

/// Whether two layers agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Bit for bit.
    Same,
    /// But for noise, or by less than half a percent.
    Agrees,
    /// By more than noise.
    Differs,
    /// The pass tells of the render.
    NotJudged,
}

/// The block, or whole picture, that is farthest from agreement.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// Column and row of its first pixel; `None` for the whole picture.
    pub at: Option<[usize; 2]>,
    /// Index of the channel.
    pub channel: usize,
    /// Mean difference.
    pub bias: f64,
    /// Over the mean of the pass's magnitude.
    pub share: f64,
    /// Over its standard error; infinite where there is no noise.
    pub sigmas: f64,
}

/// The verdict and what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// What came out.
    pub verdict: Verdict,
    /// Where the noise of either side is known from; where of neither, it is taken from how differences vary
    /// within blocks, which bias that varies widens.
    pub noise: [Noise; 2],
    /// How many means were tested.
    pub tests: usize,
    /// How many of them failed.
    pub failed: usize,
    /// Standard errors that each was allowed.
    pub limit: f64,
    /// The worst of those that failed, or else the one with the most standard errors.
    pub extreme: Option<Extreme>,
}

/// True for a pass that tells of the render.
pub(super) fn is_of_the_render(name: &str) -> bool {
    let pass = name.rsplit('.').next().unwrap_or(name);
    OF_THE_RENDER.contains(&pass) || PASSES.iter().any(|row| row.is_error() && row.layer == pass)
}

/// Mean and its variance of one block's channel, and the degrees of freedom that this has.
struct Tested {
    at: Option<[usize; 2]>,
    channel: usize,
    bias: f64,
    variance: f64,
    freedom: f64,
}

impl Tested {
    /// Standard errors of a normal distribution that are as rare as what was found is by chance.
    ///
    /// D. L. Wallace: *Bounds on normal approximations to Student's and the chi-square distributions*, Annals of
    /// Mathematical Statistics 30 (1959).
    fn sigmas(&self) -> f64 {
        if self.bias == 0.0 {
            return 0.0;
        }
        let (t, n) = (self.bias.abs() / self.variance.sqrt(), self.freedom);
        if !(t.is_finite() && n.is_finite()) {
            return t;
        }
        (8.0 * n + 1.0) / (8.0 * n + 3.0) * (n * (t * t / n).ln_1p()).sqrt()
    }
}

/// Variances of independent numbers, added up.
#[derive(Clone, Copy, Default)]
struct Variances {
    sum: f64,
    squares: f64,
}

impl Variances {
    fn add(&mut self, variance: f64) {
        self.sum += variance;
        self.squares += variance * variance;
    }

    /// Degrees of freedom of the sum of variances that have `each`: few of them may hold most of it.
    ///
    /// F. E. Satterthwaite: *An approximate distribution of estimates of variance components*, Biometrics 2 (1946); the
    /// square of an estimate is by 1 + 2/n too large.
    fn freedom(&self, each: f64) -> f64 {
        if self.squares > 0.0 { (each + 2.0) * self.sum * self.sum / self.squares } else { f64::INFINITY }
    }
}

impl Judgement {
    /// Of a pass, rows of `width` pixels, one of so many passes that are judged.
    pub(super) fn of(
        name: &str,
        values: &Values<'_>,
        width: usize,
        noise: [Noise; 2],
        background_of_one: usize,
        among: u32,
    ) -> Self {
        let is_same = values.a.iter().zip(values.b).all(|(a, b)| a.to_bits() == b.to_bits() || a == b);
        let mut result = Self { verdict: Verdict::Same, noise, tests: 0, failed: 0, limit: SIGMAS, extreme: None };
        if is_of_the_render(name) {
            result.verdict = Verdict::NotJudged;
        }
        if is_same || result.verdict == Verdict::NotJudged {
            return result;
        }
        let tested = tested(values, width);
        result.tests = tested.len();
        // Within rounding of 1 for thousands of tests: by the logarithm.
        let all = tested.len().max(1) as f64 * f64::from(among.max(1));
        let each = -((-ALPHA).ln_1p() / all).exp_m1();
        result.limit = -normal_quantile(0.5 * each);
        let means = means(values);
        let extremes = tested.iter().map(|it| {
            let share = if it.bias == 0.0 { 0.0 } else { it.bias.abs() / means[it.channel] };
            Extreme { at: it.at, channel: it.channel, bias: it.bias, share, sigmas: it.sigmas() }
        });
        let mut most: Option<(bool, Extreme)> = None;
        for extreme in extremes {
            let fails = extreme.sigmas > result.limit && extreme.share > SHARE;
            result.failed += usize::from(fails);
            // Of failures the one that is most of the pass, else the one that noise explains least.
            let rank = |fails: bool, it: &Extreme| (fails, if fails { it.share } else { it.sigmas });
            if most.as_ref().is_none_or(|(known, it)| rank(*known, it) < rank(fails, &extreme)) {
                most = Some((fails, extreme));
            }
        }
        result.extreme = most.map(|(_, extreme)| extreme);
        let holes = background_of_one as f64 > SHARE * (values.counts.len() as f64);
        let nowhere = !values.counts.iter().any(|counts| *counts);
        let agrees = result.failed == 0 && !holes && (!nowhere || background_of_one == 0);
        result.verdict = if agrees { Verdict::Agrees } else { Verdict::Differs };
        result
    }
}

/// Mean magnitude of the reference: of all colors together, of alpha by itself.
fn means(values: &Values<'_>) -> Vec<f64> {
    let (mut sums, mut count) = (vec![0.0; values.channels], 0.0_f64);
    for pixel in (0..values.counts.len()).filter(|&pixel| values.counts[pixel]) {
        count += 1.0;
        for (channel, sum) in sums.iter_mut().enumerate() {
            *sum += f64::from(values.a[pixel * values.channels + channel]).abs();
        }
    }
    let of_colors = sums[..values.colors].iter().sum::<f64>() / values.colors as f64;
    let of = |channel: usize| if channel < values.colors { of_colors } else { sums[channel] };
    (0..values.channels).map(|channel| of(channel) / count.max(1.0)).collect()
}

/// All blocks of all channels, then the whole picture by channel.
fn tested(values: &Values<'_>, width: usize) -> Vec<Tested> {
    let height = values.counts.len() / width.max(1);
    let mut result = Vec::new();
    for channel in 0..values.channels {
        let first = result.len();
        let (mut all, mut pixels_of_all) = (Variances::default(), 0.0_f64);
        let mut total = 0.0;
        for y in (0..height).step_by(BLOCK) {
            for x in (0..width).step_by(BLOCK) {
                let rows = y..height.min(y + BLOCK);
                let pixels = rows.flat_map(|y| (x..width.min(x + BLOCK)).map(move |x| y * width + x));
                let counting: Vec<usize> = pixels.filter(|&pixel| values.counts[pixel]).collect();
                let n = counting.len() as f64;
                if counting.len() < 2 {
                    continue;
                }
                let sum = counting.iter().map(|&pixel| values.difference(pixel, channel)).sum::<f64>();
                let bias = sum / n;
                let mut of_block = Variances::default();
                counting.iter().for_each(|&pixel| of_block.add(values.variance_of(pixel, channel)));
                let mut freedom = of_block.freedom(values.freedom);
                if !of_block.sum.is_finite() {
                    let of = |&pixel: &usize| (values.difference(pixel, channel) - bias).powi(2);
                    let spread = counting.iter().map(of).sum::<f64>() * n / (n - 1.0);
                    (of_block, freedom) = (Variances { sum: spread, squares: spread * spread }, n - 1.0);
                }
                (total, pixels_of_all) = (total + sum, pixels_of_all + n);
                (all.sum, all.squares) = (all.sum + of_block.sum, all.squares + of_block.squares);
                result.push(Tested { at: Some([x, y]), channel, bias, variance: of_block.sum / (n * n), freedom });
            }
        }
        if result.len() > first + 1 {
            let n = pixels_of_all;
            let freedom = all.freedom(values.freedom);
            result.push(Tested { at: None, channel, bias: total / n, variance: all.sum / (n * n), freedom });
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 64;

    /// Noise of variance 1/12 by a hash of the pixel.
    fn noise(i: usize) -> f32 {
        let mut x = (i as u32).wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
        x = (x ^ (x >> 16)).wrapping_mul(0x21f0_aaad);
        x = (x ^ (x >> 15)).wrapping_mul(0x735a_2d97);
        ((x ^ (x >> 15)) >> 8) as f32 / (1 << 24) as f32 - 0.5
    }

    fn judge(a: &[f32], b: &[f32], variance: Option<f32>) -> Judgement {
        let counts = vec![true; a.len()];
        let variance = variance.map(|v| vec![v; a.len()]);
        let values = Values { channels: 1, colors: 1, a, b, variance, freedom: 1e9, counts };
        Judgement::of("Pass", &values, WIDTH, [Noise::Unknown; 2], 0, 1)
    }

    fn pictures(add: impl Fn(usize) -> f32) -> (Vec<f32>, Vec<f32>) {
        let n = WIDTH * WIDTH;
        ((0..n).map(|i| 4.0 + noise(i)).collect(), (0..n).map(|i| 4.0 + noise(i + n) + add(i)).collect())
    }

    #[test]
    fn noise_passes_and_bias_fails() {
        for variance in [Some(2.0 / 12.0), None] {
            let (a, b) = pictures(|_| 0.0);
            assert_eq!(judge(&a, &b, variance).verdict, Verdict::Agrees);
            // 2 % everywhere.
            let (a, b) = pictures(|_| 0.08);
            let judgement = judge(&a, &b, variance);
            assert_eq!(judgement.verdict, Verdict::Differs);
            assert_eq!(judgement.tests, 17);
            // 5 % in one block; the whole differs by a sixteenth of it.
            let (a, b) = pictures(|i| if i % WIDTH < 16 && i / WIDTH < 16 { 0.2 } else { 0.0 });
            let judgement = judge(&a, &b, variance);
            assert_eq!(judgement.verdict, Verdict::Differs);
            assert_eq!(judgement.extreme.unwrap().at, Some([0, 0]));
        }
    }

    #[test]
    fn less_than_half_a_percent_agrees_without_noise() {
        let a = vec![1.0; WIDTH * WIDTH];
        assert_eq!(judge(&a, &vec![1.004; a.len()], None).verdict, Verdict::Agrees);
        assert_eq!(judge(&a, &vec![1.006; a.len()], None).verdict, Verdict::Differs);
        assert_eq!(judge(&a, &a.clone(), None).verdict, Verdict::Same);
    }

    /// Of many pictures that differ by noise alone about α fail.
    #[test]
    fn the_level_is_that_of_three_standard_errors() {
        let n = WIDTH * WIDTH;
        let fails = |round: usize| {
            let a: Vec<f32> = (0..n).map(|i| 1.0 + noise(2 * round * n + i)).collect();
            let b: Vec<f32> = (0..n).map(|i| 1.0 + noise((2 * round + 1) * n + i)).collect();
            usize::from(judge(&a, &b, Some(2.0 / 12.0)).verdict == Verdict::Differs)
        };
        let failed: usize = (0..400).map(fails).sum();
        // 1.1 expected of 400; those below half a percent are let pass, too.
        assert!(failed <= 5, "{failed}");
    }

    /// Noise in few pixels, known from two renders of each side, has few degrees of freedom.
    #[test]
    fn estimates_of_noise_are_noisy_themselves() {
        let freedom = |variances: &[f64], each| {
            let mut sum = Variances::default();
            variances.iter().for_each(|v| sum.add(*v));
            sum.freedom(each)
        };
        assert_eq!(freedom(&[2.0], 1.0), 3.0);
        assert_eq!(freedom(&[1.0; 100], 2.0), 400.0);
        // Quantiles of Student's distribution with 5 degrees of freedom that are as rare as 2 and 4 standard errors.
        for (t, z) in [(2.648_65, 2.0), (12.281_4, 4.0)] {
            let tested = Tested { at: None, channel: 0, bias: t, variance: 1.0, freedom: 5.0 };
            assert!((tested.sigmas() - z).abs() < 0.05, "{} {z}", tested.sigmas());
        }
    }

    #[test]
    fn what_tells_of_the_render_is_not_judged() {
        assert!(is_of_the_render("ViewLayer.Debug Sample Count") && is_of_the_render("Error"));
        assert!(!is_of_the_render("Combined") && !is_of_the_render("Depth"));
    }
}
