//! Error against seconds, split into noise and bias.

use super::{Reference, Shot};

/// Keeps relMSE finite in the dark, as the field has it.
const DARK: f64 = 1e-2;

/// Bias is told from noise where its square is beyond so many standard errors.
const SIGMAS: f64 = 3.0;

/// One point of a curve: means over seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Samples per pixel.
    pub spp: f64,
    /// Seconds of rendering, and of denoising where it is.
    pub seconds: f64,
    /// Mean squared error of one picture, over pixels and channels, without that of the reference.
    pub mse: f64,
    /// Mean of squared error / (reference² + 0.01), likewise.
    pub rel_mse: f64,
    /// The part of `mse` that differs between seeds.
    pub variance: f64,
    /// The part that does not; may be negative by noise.
    pub bias_squared: f64,
    /// Standard error of it.
    pub bias_error: f64,
    /// The picture of the first seed.
    pub picture: Vec<f32>,
}

impl Point {
    /// Square of the bias, where it is more than noise may look like.
    pub fn known_bias(&self) -> f64 {
        if self.bias_squared > SIGMAS * self.bias_error { self.bias_squared } else { 0.0 }
    }
}

/// What a way of rendering gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// By growing time.
    pub points: Vec<Point>,
    /// Exponent of RMSE's noise over seconds: -0.5 for independent samples; `None` for fewer than two points or no noise.
    pub slope: Option<f64>,
}

impl Curve {
    /// Of runs with different seeds, each with pictures at the same samples.
    pub(super) fn of(runs: &[Vec<Shot>], reference: &Reference) -> Self {
        let steps = runs.iter().map(Vec::len).min().unwrap_or(0);
        let points: Vec<Point> =
            (0..steps).map(|step| point(&runs.iter().map(|run| &run[step]).collect::<Vec<_>>(), reference)).collect();
        let slope = slope(&points);
        Self { points, slope }
    }

    /// One over mean squared error times seconds, of the last point.
    pub fn efficiency(&self) -> Option<f64> {
        self.points.last().map(|p| 1.0 / (p.mse * p.seconds)).filter(|value| value.is_finite())
    }

    /// Seconds to an RMSE, by the last point and the slope; `None` where bias keeps it from being reached.
    pub fn seconds_to(&self, rmse: f64) -> Option<f64> {
        let (last, slope) = (self.points.last()?, self.slope?);
        let noise = (rmse * rmse - last.known_bias()).sqrt();
        let seconds = last.seconds * (noise / last.variance.sqrt()).powf(1.0 / slope);
        seconds.is_finite().then_some(seconds)
    }
}

fn point(shots: &[&Shot], reference: &Reference) -> Point {
    let n = shots.len() as f64;
    let (mut variance, mut bias, mut bias_squares, mut relative) = (0.0, 0.0, 0.0, 0.0);
    let pixels = reference.values.len() / 3;
    for pixel in 0..pixels {
        // Channels of a pixel go together.
        let mut of_pixel = 0.0;
        for i in 3 * pixel..3 * pixel + 3 {
            let truth = f64::from(reference.values[i]);
            let values = shots.iter().map(|shot| f64::from(shot.values[i]));
            let mean = values.clone().sum::<f64>() / n;
            let of_noise = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let of_bias = (mean - truth).powi(2) - of_noise / n - reference.variance_at(i);
            variance += of_noise;
            of_pixel += of_bias;
            relative += (of_noise + of_bias) / (truth * truth + DARK);
        }
        bias += of_pixel;
        bias_squares += of_pixel * of_pixel;
    }
    let all = 3.0 * pixels.max(1) as f64;
    let (variance, bias_squared) = (variance / all, bias / all);
    let per_pixel = all / 3.0;
    let spread = (bias_squares / per_pixel - (bias / per_pixel).powi(2)).max(0.0);
    Point {
        spp: shots.iter().map(|shot| shot.spp).sum::<f64>() / n,
        seconds: shots.iter().map(|shot| shot.seconds).sum::<f64>() / n,
        mse: (variance + bias_squared).max(0.0),
        rel_mse: (relative / all).max(0.0),
        variance,
        bias_squared,
        bias_error: (spread / per_pixel).sqrt() / 3.0,
        picture: shots[0].values.clone(),
    }
}

/// By least squares over the logarithms.
fn slope(points: &[Point]) -> Option<f64> {
    let at: Vec<(f64, f64)> = points
        .iter()
        .filter(|p| p.variance > 0.0 && p.seconds > 0.0)
        .map(|p| (p.seconds.ln(), 0.5 * p.variance.ln()))
        .collect();
    let n = at.len() as f64;
    let (mx, my) = (at.iter().map(|p| p.0).sum::<f64>() / n, at.iter().map(|p| p.1).sum::<f64>() / n);
    let xx: f64 = at.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let xy: f64 = at.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    Some(xy / xx).filter(|slope| slope.is_finite() && *slope < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number between -1/2 and 1/2 by a hash, of variance 1/12.
    fn noise(i: usize) -> f64 {
        let mut x = (i as u32).wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
        x = (x ^ (x >> 16)).wrapping_mul(0x21f0_aaad);
        x = (x ^ (x >> 15)).wrapping_mul(0x735a_2d97);
        f64::from((x ^ (x >> 15)) >> 8) / f64::from(1 << 24) - 0.5
    }

    fn runs(bias: f64, seeds: usize) -> (Vec<Vec<Shot>>, Reference) {
        const COUNT: usize = 30_000;
        let reference = Reference {
            width: 100,
            height: 100,
            values: vec![2.0; COUNT],
            variance: None,
            origin: "closed form".to_owned(),
        };
        let shot = |seed: usize, step: u32| Shot {
            spp: f64::from(1 << step),
            seconds: 0.25 * f64::from(1 << step),
            values: (0..COUNT)
                .map(|i| {
                    (2.0 + bias + noise(i + COUNT * (seed * 8 + step as usize)) / f64::from(1 << step).sqrt()) as f32
                })
                .collect(),
        };
        ((0..seeds).map(|seed| (2..7).map(|step| shot(seed, step)).collect()).collect(), reference)
    }

    #[test]
    fn noise_and_bias_are_told_apart() {
        for (bias, seeds) in [(0.0, 2), (0.1, 2), (0.1, 4)] {
            let (runs, reference) = runs(bias, seeds);
            let curve = Curve::of(&runs, &reference);
            let slope = curve.slope.unwrap();
            assert!((slope + 0.5).abs() < 0.02, "{slope}");
            for point in &curve.points {
                let expected = 1.0 / 12.0 / point.spp;
                assert!((point.variance / expected - 1.0).abs() < 0.04, "{point:?}");
                assert!((point.bias_squared - bias * bias).abs() < 5.0 * point.bias_error + 1e-9);
                assert!((point.mse - expected - bias * bias).abs() < 0.1 * expected);
            }
            let last = curve.points.last().unwrap();
            assert_eq!(last.known_bias() > 0.0, bias > 0.0);
        }
    }

    #[test]
    fn targets_are_reached_by_the_slope_or_never() {
        let (all, reference) = runs(0.0, 3);
        let curve = Curve::of(&all, &reference);
        let (last, slope) = (curve.points.last().unwrap(), curve.slope.unwrap());
        let twice = curve.seconds_to(0.5 * last.variance.sqrt()).unwrap();
        assert!((twice / last.seconds - 0.5_f64.powf(1.0 / slope)).abs() < 1e-9);
        let (all, reference) = runs(0.1, 3);
        let curve = Curve::of(&all, &reference);
        assert_eq!(curve.seconds_to(0.05), None, "bias of 0.1");
        assert!(curve.seconds_to(0.2).is_some());
    }
}
