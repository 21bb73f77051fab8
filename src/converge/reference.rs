//! What a picture should be.

use crate::compare::{Layer, Side};
use crate::film::Picture;

/// The layer that is looked at, without noise or with little.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Three numbers per pixel.
    pub values: Vec<f32>,
    /// Variance of each, where it is known.
    pub variance: Option<Vec<f32>>,
    /// Where it is from, in words.
    pub origin: String,
}

impl Reference {
    /// The layer of pictures that differ by their seed, their mean.
    ///
    /// # Errors
    /// A sentence: a layer that is not there, or is no color.
    pub fn of(pictures: Vec<Picture>, layer: &str, origin: String) -> Result<Self, String> {
        let side = Side::of(pictures).map_err(|_| format!("{origin}: pictures of different size or passes"))?;
        let (width, height) = (side.width, side.height);
        let found = side.layers.into_iter().find(|it| it.names.pass == layer && it.channels.len() >= 3);
        let Some(Layer { channels, mean, variance, .. }) = found else {
            return Err(format!("{origin}: has no pass {layer} of three channels"));
        };
        let n = channels.len();
        let three = |values: &[f32]| -> Vec<f32> { values.chunks_exact(n).flat_map(|p| p[..3].to_vec()).collect() };
        if let Some(bad) = mean.iter().position(|v| !v.is_finite()) {
            return Err(format!("{origin}: pixel {} is not finite", bad / n));
        }
        let variance = (!variance.is_empty()).then(|| three(&variance));
        Ok(Self { width, height, values: three(&mean), variance, origin })
    }

    /// Variance at an index, 0 where it is not known.
    pub(super) fn variance_at(&self, i: usize) -> f64 {
        self.variance.as_ref().map_or(0.0, |variance| f64::from(variance[i]))
    }

    /// Mean of the values' magnitude.
    pub fn mean(&self) -> f64 {
        self.values.iter().map(|v| f64::from(v.abs())).sum::<f64>() / self.values.len().max(1) as f64
    }
}
