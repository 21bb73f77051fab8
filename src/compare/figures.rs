//! Numbers of one pass.

use super::side::Layer;
use super::verdict::Judgement;
use super::{Options, flip, verdict};

/// Keeps relMSE finite in the dark, as the field has it.
const DARK: f64 = 1e-2;

/// Distances from here on are the background's: Cycles writes 1e10.
const BACKGROUND: f32 = 1e9;

/// Worst pixels are so far apart, in pixels.
const APART: usize = 8;

/// How many worst pixels are told.
const MOST_WORST: usize = 5;

/// One channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelFigures {
    /// Its name.
    pub name: String,
    /// Mean of the reference.
    pub mean_a: f64,
    /// Mean of the other picture.
    pub mean_b: f64,
    /// Standard error of their difference, where the noise is known.
    pub standard_error: Option<f64>,
}

/// A pixel that differs much.
#[derive(Clone, Debug, PartialEq)]
pub struct Worst {
    /// Column.
    pub x: usize,
    /// Row, from the top.
    pub y: usize,
    /// Name of the channel that differs most.
    pub channel: String,
    /// Its value in the reference.
    pub a: f32,
    /// In the other picture.
    pub b: f32,
}

/// What is to be said of a pass. All sums leave out pixels with a value that is not finite, and those where both show
/// the background of a distance; means are over pixels and channels, alpha aside.
#[derive(Clone, Debug)]
pub struct Figures {
    /// By channel, alpha included.
    pub channels: Vec<ChannelFigures>,
    /// Mean of the reference's magnitude.
    pub mean: f64,
    /// Mean of the other picture minus the reference.
    pub bias: f64,
    /// Standard error of it, where the noise is known: its upper bound, since how channels go together is not known.
    pub standard_error: Option<f64>,
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// What noise alone would make of it, where the noise is known.
    pub noise_rmse: Option<f64>,
    /// Mean of difference² / (reference² + 0.01).
    pub rel_mse: f64,
    /// 20 log10 of the largest magnitude, 1 at least, over RMSE, in decibels (OpenImageIO's); infinite without difference.
    pub psnr: f64,
    /// Mean of HDR-FLIP (radiance) or LDR-FLIP (what is 0 to 1); `None` for what is no color.
    pub flip: Option<f64>,
    /// FLIP of each pixel, empty where there is none.
    pub flip_map: Vec<f32>,
    /// Those that differ most, the worst first.
    pub worst: Vec<Worst>,
    /// Values that are not finite, of either.
    pub not_finite: [usize; 2],
    /// Pixels at which one of both alone shows the background of a distance.
    pub background_of_one: usize,
    /// Whether they agree.
    pub judgement: Judgement,
}

/// The two layers, cut to what can be subtracted.
pub(super) struct Values<'a> {
    /// Channels per pixel.
    pub channels: usize,
    /// Of those how many are no alpha.
    pub colors: usize,
    /// Values of the reference.
    pub a: &'a [f32],
    /// Of the other.
    pub b: &'a [f32],
    /// Variance of the difference, or nothing.
    pub variance: Option<Vec<f32>>,
    /// Degrees of freedom of one pixel's.
    pub freedom: f64,
    /// Pixels that count.
    pub counts: Vec<bool>,
}

impl Values<'_> {
    /// Difference at a pixel's channel.
    pub fn difference(&self, pixel: usize, channel: usize) -> f64 {
        let i = pixel * self.channels + channel;
        f64::from(self.b[i]) - f64::from(self.a[i])
    }

    /// Variance of it; NaN where it is not known.
    pub fn variance_of(&self, pixel: usize, channel: usize) -> f64 {
        self.variance.as_ref().map_or(f64::NAN, |v| f64::from(v[pixel * self.channels + channel]))
    }
}

impl Figures {
    /// Of a pass called `name`, rows of `width` pixels; the layers have the same channels.
    pub(super) fn of(name: &str, a: &Layer, b: &Layer, width: usize, options: &Options) -> Self {
        let n = a.channels.len();
        let is_rgba = n == 4 && a.channels[3] == "A";
        let is_distance = n == 1 && a.channels[0] == "Z";
        let (values_a, values_b) = (&a.mean[..], &b.mean[..]);
        let not_finite = [values_a, values_b].map(|values| values.iter().filter(|v| !v.is_finite()).count());
        let mut background_of_one = 0;
        let counts = values_a.chunks_exact(n).zip(values_b.chunks_exact(n)).map(|(a, b)| {
            let far = [a, b].map(|pixel| is_distance && pixel[0] >= BACKGROUND);
            background_of_one += usize::from(far[0] != far[1]);
            !far[0] && !far[1] && a.iter().chain(b).all(|v| v.is_finite())
        });
        let counts = counts.collect();
        let colors = if is_rgba { 3 } else { n };
        let (variance, freedom) = (sum_of_variances(a, b), a.freedom + b.freedom);
        let values = Values { channels: n, colors, a: values_a, b: values_b, variance, freedom, counts };
        let judgement = Judgement::of(name, &values, width, [a.noise, b.noise], background_of_one, options.among);
        let (flip, flip_map) = match flip_of(name, a, &values, width).filter(|_| options.flip) {
            Some(map) => (Some(flip::mean(&map)), map),
            None => (None, Vec::new()),
        };
        let (channels, sums) = (sums_of_channels(&a.channels, &values), Sums::of(&values));
        let per = |sum: f64| if sums.count == 0.0 { 0.0 } else { sum / sums.count };
        let rmse = per(sums.squares).sqrt();
        let standard_error = channels[..colors].iter().map(|channel| channel.standard_error).sum::<Option<f64>>();
        Self {
            bias: channels[..colors].iter().map(|c| c.mean_b - c.mean_a).sum::<f64>() / colors as f64,
            standard_error: standard_error.map(|sum| sum / colors as f64),
            channels,
            mean: per(sums.magnitude),
            rmse,
            noise_rmse: sums.variance.is_finite().then(|| per(sums.variance).sqrt()),
            rel_mse: per(sums.relative),
            psnr: if rmse > 0.0 { 20.0 * (sums.largest.max(1.0) / rmse).log10() } else { f64::INFINITY },
            flip,
            flip_map,
            worst: worst(&a.channels, &values, width),
            not_finite,
            background_of_one,
            judgement,
        }
    }
}

/// Variance of the difference; of both sides, or of the one that is known.
fn sum_of_variances(a: &Layer, b: &Layer) -> Option<Vec<f32>> {
    match (a.variance.is_empty(), b.variance.is_empty()) {
        (true, true) => None,
        (false, true) => Some(a.variance.clone()),
        (true, false) => Some(b.variance.clone()),
        (false, false) => Some(a.variance.iter().zip(&b.variance).map(|(a, b)| a + b).collect()),
    }
}

fn sums_of_channels(names: &[String], values: &Values<'_>) -> Vec<ChannelFigures> {
    let count = values.counts.iter().filter(|counts| **counts).count().max(1) as f64;
    let of = |(channel, name): (usize, &String)| {
        let (mut a, mut b, mut variance) = (0.0, 0.0, 0.0);
        for pixel in (0..values.counts.len()).filter(|&pixel| values.counts[pixel]) {
            let i = pixel * values.channels + channel;
            a += f64::from(values.a[i]);
            b += f64::from(values.b[i]);
            variance += values.variance_of(pixel, channel);
        }
        let standard_error = variance.is_finite().then(|| variance.sqrt() / count);
        ChannelFigures { name: name.clone(), mean_a: a / count, mean_b: b / count, standard_error }
    };
    names.iter().enumerate().map(of).collect()
}

/// Sums over pixels and colors.
#[derive(Default)]
struct Sums {
    count: f64,
    squares: f64,
    relative: f64,
    magnitude: f64,
    largest: f64,
    variance: f64,
}

impl Sums {
    fn of(values: &Values<'_>) -> Self {
        let mut sums = Self::default();
        for pixel in (0..values.counts.len()).filter(|&pixel| values.counts[pixel]) {
            for channel in 0..values.colors {
                let i = pixel * values.channels + channel;
                let (a, b) = (f64::from(values.a[i]), f64::from(values.b[i]));
                let square = (b - a).powi(2);
                sums.count += 1.0;
                sums.squares += square;
                sums.relative += square / (a * a + DARK);
                sums.magnitude += a.abs();
                sums.largest = sums.largest.max(a.abs()).max(b.abs());
                sums.variance += values.variance_of(pixel, channel);
            }
        }
        sums
    }
}

/// The pixels that differ most, none beside another.
fn worst(names: &[String], values: &Values<'_>, width: usize) -> Vec<Worst> {
    const CANDIDATES: usize = 4096;
    let by_channel = |pixel: usize| (0..values.channels).map(move |c| (values.difference(pixel, c).abs(), c));
    let largest = |pixel: usize| by_channel(pixel).fold((0.0, 0), |most, it| if it.0 > most.0 { it } else { most });
    let mut differing: Vec<(f64, usize)> = (0..values.counts.len())
        .filter(|&pixel| values.counts[pixel])
        .map(|pixel| (largest(pixel).0, pixel))
        .filter(|(difference, _)| *difference > 0.0)
        .collect();
    let order = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
    if differing.len() > CANDIDATES {
        differing.select_nth_unstable_by(CANDIDATES, order);
        differing.truncate(CANDIDATES);
    }
    differing.sort_by(order);
    let mut found: Vec<Worst> = Vec::new();
    for (_, pixel) in differing {
        let (x, y) = (pixel % width, pixel / width);
        if found.len() < MOST_WORST && found.iter().all(|w| w.x.abs_diff(x).max(w.y.abs_diff(y)) >= APART) {
            let channel = largest(pixel).1;
            let i = pixel * values.channels + channel;
            found.push(Worst { x, y, channel: names[channel].clone(), a: values.a[i], b: values.b[i] });
        }
    }
    found
}

/// FLIP of colors: of what is 0 to 1 by its meaning as on a display, of radiance over all exposures.
fn flip_of(name: &str, layer: &Layer, values: &Values<'_>, width: usize) -> Option<Vec<f32>> {
    if !layer.is_color || values.colors != 3 || verdict::is_of_the_render(name) {
        return None;
    }
    let rgb = |data: &[f32]| -> Vec<[f32; 3]> {
        let finite = |v: f32| if v.is_finite() { v.max(0.0) } else { 0.0 };
        data.chunks_exact(values.channels).map(|p| [finite(p[0]), finite(p[1]), finite(p[2])]).collect()
    };
    let (a, b) = (rgb(values.a), rgb(values.b));
    let is_share = name.ends_with("Color")
        || name.ends_with("Denoising Albedo")
        || name.ends_with("Ambient Occlusion")
        || name.rsplit('.').next().is_some_and(|pass| pass.starts_with("Shadow"));
    Some(if is_share { flip::of_display(&a, &b, width) } else { flip::of_scene(&a, &b, width) })
}

#[cfg(test)]
mod tests {
    use super::super::side::{Noise, Side};
    use super::*;
    use crate::film::{Layer as Raw, Picture, Storage};

    fn layer(name: &str, channels: &str, width: u32, data: Vec<f32>) -> Layer {
        let height = data.len() as u32 / width / channels.len() as u32;
        let channels = channels.chars().map(String::from).collect();
        let raw = Raw { name: name.to_owned(), channels, data, storage: Storage::Color };
        Side::of(vec![Picture { width, height, layers: vec![raw] }]).unwrap().layers.remove(0)
    }

    #[test]
    fn figures_by_hand() {
        let a = layer("Combined", "RGBA", 2, vec![1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        let b = layer("Combined", "RGBA", 2, vec![1.0, 2.0, 6.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
        let figures = Figures::of("Combined", &a, &b, 2, &Options { flip: false, ..Options::default() });
        assert_eq!(figures.bias, 0.5);
        assert_eq!(figures.rmse, (9.0_f64 / 6.0).sqrt());
        assert_eq!(figures.rel_mse, 9.0 / 9.01 / 6.0);
        assert_eq!(figures.psnr, 20.0 * (6.0 / (9.0_f64 / 6.0).sqrt()).log10());
        assert_eq!(figures.mean, 1.0);
        assert_eq!(figures.channels[3].mean_b, 0.25);
        let worst = Worst { x: 0, y: 0, channel: "B".to_owned(), a: 3.0, b: 6.0 };
        assert_eq!(figures.worst, [worst]);
        assert_eq!(figures.standard_error, None);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_left_out() {
        let a = layer("Combined", "RGB", 2, vec![1.0, 1.0, 1.0, f32::NAN, 1.0, 1.0]);
        let b = layer("Combined", "RGB", 2, vec![2.0, 2.0, 2.0, 9.0, f32::INFINITY, 9.0]);
        let figures = Figures::of("Combined", &a, &b, 2, &Options { flip: false, ..Options::default() });
        assert_eq!(figures.not_finite, [1, 1]);
        assert_eq!((figures.bias, figures.rmse), (1.0, 1.0));
    }

    #[test]
    fn backgrounds_of_distances_are_left_out_and_their_edges_counted() {
        let a = layer("Depth", "Z", 3, vec![4.0, 1e10, 1e10]);
        let b = layer("Depth", "Z", 3, vec![5.0, 1e10, 5.0]);
        let figures = Figures::of("Depth", &a, &b, 3, &Options { flip: false, ..Options::default() });
        assert_eq!((figures.bias, figures.mean, figures.background_of_one), (1.0, 4.0, 1));
    }

    #[test]
    fn noise_of_both_sides_adds_up() {
        let with = |variance: f32| {
            let mut layer = layer("Emission", "RGB", 2, vec![1.0; 12]);
            layer.variance = vec![variance; 12];
            layer.noise = Noise::Seeds;
            layer
        };
        let figures =
            Figures::of("Emission", &with(0.03), &with(0.01), 2, &Options { flip: false, ..Options::default() });
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} {b}");
        close(figures.standard_error.unwrap(), (0.04_f64 / 4.0).sqrt());
        close(figures.noise_rmse.unwrap(), 0.2);
    }
}
