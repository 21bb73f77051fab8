//! One of the two pictures: the mean of its renders, and what is known of their noise.

use super::cryptomatte;
use super::names::Names;
use crate::film::{PASSES, Picture, REPLICATES, Storage};

/// Where the noise of a layer is known from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Renders with other seeds.
    Seeds,
    /// The `error` pass of the file.
    ErrorPass,
    /// Not at all.
    Unknown,
}

/// A layer of one side.
#[derive(Clone, Debug)]
pub struct Layer {
    /// View layer and pass.
    pub names: Names,
    /// Names of the channels, `RGBA` or `XYZW` in that order.
    pub channels: Vec<String>,
    /// Mean of the renders, channels interleaved, rows from the top.
    pub mean: Vec<f32>,
    /// Variance of it, of the same shape; NaN for channels of which nothing is known, empty where that holds for all.
    pub variance: Vec<f32>,
    /// Where that is from.
    pub noise: Noise,
    /// True for colors.
    pub is_color: bool,
    /// Degrees of freedom of the variance of one pixel's channel; 0 where it is not known.
    pub freedom: f64,
    /// Of a Cryptomatte pass the ids and coverages of each render, until both sides say which channels it has.
    pub(super) coverage: Vec<cryptomatte::Coverage>,
}

/// A picture, or several of other seeds.
#[derive(Clone, Debug)]
pub struct Side {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Its layers.
    pub layers: Vec<Layer>,
}

impl Side {
    /// Of renders that differ by their seed alone, the first of which says which layers there are.
    ///
    /// # Errors
    /// The index of a render of another size, or that lacks a layer of the first.
    pub fn of(renders: Vec<Picture>) -> Result<Self, usize> {
        let mut renders = renders.into_iter();
        let Some(first) = renders.next().map(whole) else {
            return Ok(Self { width: 0, height: 0, layers: Vec::new() });
        };
        let mut others = Vec::new();
        for (index, other) in renders.map(whole).enumerate() {
            let lacks = first
                .layers
                .iter()
                .any(|layer| !other.layers.iter().any(|b| b.name == layer.name && b.channels == layer.channels));
            if lacks || (other.width, other.height) != (first.width, first.height) {
                return Err(index + 1);
            }
            others.push(other);
        }
        let errors = error_layers(&first);
        let (width, height) = (first.width, first.height);
        let mut layers = of_render(first);
        let others: Vec<Vec<Layer>> = others.into_iter().map(of_render).collect();
        for layer in &mut layers {
            let same = |other: &&Layer| other.names == layer.names;
            let others: Vec<&Layer> = others.iter().filter_map(|layers| layers.iter().find(same)).collect();
            if !others.is_empty() {
                layer.coverage.extend(others.iter().flat_map(|other| other.coverage.clone()));
                let values: Vec<&[f32]> = others.iter().map(|other| &other.mean[..]).collect();
                (layer.mean, layer.variance) = mean_and_variance(&layer.mean, &values);
                (layer.noise, layer.freedom) = (Noise::Seeds, others.len() as f64);
            } else if let Some((_, error)) = errors.iter().find(|(of, _)| *of == layer.names) {
                layer.variance = spread(error, layer.channels.len());
                (layer.noise, layer.freedom) = (Noise::ErrorPass, REPLICATES as f64 - 1.0);
            }
        }
        Ok(Self { width, height, layers })
    }
}

/// The layers of one render.
fn of_render(picture: Picture) -> Vec<Layer> {
    let of = |layer: crate::film::Layer| Layer {
        names: Names::of(&layer.name),
        channels: layer.channels,
        mean: layer.data,
        variance: Vec::new(),
        noise: Noise::Unknown,
        is_color: layer.storage == Storage::Color,
        freedom: 0.0,
        coverage: Vec::new(),
    };
    cryptomatte::joined(picture.layers.into_iter().map(of).collect())
}

/// The picture with its error passes and channels of no layer told apart: bare R, G, B, A are Combined, Z is Depth.
fn whole(mut picture: Picture) -> Picture {
    let bare = picture.layers.iter().position(|layer| layer.name.is_empty());
    if let Some(bare) = bare.map(|index| picture.layers.remove(index)) {
        let (color, others): (Vec<usize>, Vec<usize>) =
            (0..bare.channels.len()).partition(|&i| matches!(bare.channels[i].as_str(), "R" | "G" | "B" | "A" | "Y"));
        let part = |name: String, of: &[usize], storage| crate::film::Layer {
            name,
            channels: of.iter().map(|&i| bare.channels[i].clone()).collect(),
            data: bare.data.chunks_exact(bare.channels.len()).flat_map(|p| of.iter().map(|&i| p[i])).collect(),
            storage,
        };
        if !color.is_empty() {
            picture.layers.push(part("Combined".to_owned(), &color, Storage::Color));
        }
        for i in others {
            picture.layers.push(part(bare.channels[i].clone(), &[i], Storage::Data));
        }
    }
    picture
}

/// Standard errors by the layers that they are of.
fn error_layers(picture: &Picture) -> Vec<(Names, Vec<f32>)> {
    let mut found = Vec::new();
    for layer in &picture.layers {
        let Names { view_layer, pass } = Names::of(&layer.name);
        if PASSES.iter().any(|row| row.is_error() && row.layer == pass && row.channels == layer.channels.concat()) {
            let of = pass.strip_prefix("Error").map(str::trim_start).unwrap_or_default();
            let pass = if of.is_empty() { "Combined".to_owned() } else { of.to_owned() };
            found.push((Names { view_layer, pass }, layer.data.clone()));
        }
    }
    found
}

/// Squares of standard errors of three channels for a layer of `n`; the others are unknown.
fn spread(error: &[f32], n: usize) -> Vec<f32> {
    error.chunks_exact(3).flat_map(|e| (0..n).map(|c| e.get(c).map_or(f32::NAN, |e| e * e))).collect()
}

/// Of the mean of `first` and `others`; the variance is empty where there are no others.
pub(super) fn mean_and_variance(first: &[f32], others: &[&[f32]]) -> (Vec<f32>, Vec<f32>) {
    if others.is_empty() {
        return (first.to_vec(), Vec::new());
    }
    let n = (others.len() + 1) as f64;
    let of = |i: usize| {
        let values = || std::iter::once(first[i]).chain(others.iter().map(|other| other[i])).map(f64::from);
        let mean = values().sum::<f64>() / n;
        let squares: f64 = values().map(|value| (value - mean).powi(2)).sum();
        (mean as f32, (squares / (n - 1.0) / n) as f32)
    };
    (0..first.len()).map(of).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(name: &str, channels: &str, data: &[f32]) -> crate::film::Layer {
        let channels = channels.chars().map(String::from).collect();
        crate::film::Layer { name: name.to_owned(), channels, data: data.to_vec(), storage: Storage::Color }
    }

    fn picture(layers: Vec<crate::film::Layer>) -> Picture {
        Picture { width: 1, height: 1, layers }
    }

    #[test]
    fn renders_of_other_seeds_give_a_mean_and_its_variance() {
        let of = |value| picture(vec![layer("V.Combined", "RGB", &[value, 2.0, 0.0])]);
        let side = Side::of(vec![of(1.0), of(2.0), of(6.0)]).unwrap();
        assert_eq!(side.layers[0].mean, [3.0, 2.0, 0.0]);
        assert_eq!(side.layers[0].noise, Noise::Seeds);
        // (4 + 1 + 9) / 2 / 3.
        assert_eq!(side.layers[0].variance, [14.0_f32 / 6.0, 0.0, 0.0]);
        assert_eq!(Side::of(vec![of(1.0), picture(vec![])]).unwrap_err(), 1);
    }

    #[test]
    fn error_passes_are_found_for_what_they_are_of() {
        let side = Side::of(vec![picture(vec![
            layer("V.Combined", "RGBA", &[1.0; 4]),
            layer("V.Error", "RGB", &[0.5, 0.25, 0.0]),
            layer("V.Ambient Occlusion", "RGB", &[1.0; 3]),
            layer("V.Error Ambient Occlusion", "RGB", &[0.1; 3]),
            layer("V.Emission", "RGB", &[1.0; 3]),
        ])])
        .unwrap();
        let noise: Vec<Noise> = side.layers.iter().map(|layer| layer.noise).collect();
        let (known, unknown) = (Noise::ErrorPass, Noise::Unknown);
        assert_eq!(noise, [known, unknown, known, unknown, unknown]);
        assert_eq!(side.layers[0].variance[..3], [0.25, 0.0625, 0.0]);
        assert!(side.layers[0].variance[3].is_nan());
    }

    #[test]
    fn bare_channels_are_combined_and_depth() {
        let side = Side::of(vec![picture(vec![layer("", "RGBAZ", &[1.0, 2.0, 3.0, 4.0, 5.0])])]).unwrap();
        let found: Vec<(&str, String, &[f32])> =
            side.layers.iter().map(|l| (l.names.pass.as_str(), l.channels.concat(), &l.mean[..])).collect();
        let expected: [(&str, String, &[f32]); 2] =
            [("Combined", "RGBA".to_owned(), &[1.0, 2.0, 3.0, 4.0]), ("Depth", "Z".to_owned(), &[5.0])];
        assert_eq!(found, expected);
    }
}
