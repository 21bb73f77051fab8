//! Cryptomatte layers: ranked ids and coverages can't be subtracted channel by channel, coverages of ids can.
//!
//! All ranks of one kind become one layer with a channel for each of the ids that cover most of either picture, and
//! one for all others.

use std::collections::HashMap;

use super::side::{Layer, mean_and_variance};

/// Ids, as the bits of their floats, and coverages of each pixel.
pub(super) type Coverage = Vec<Vec<(u32, f32)>>;

/// How many ids have a channel of their own.
const MOST: usize = 15;

/// `CryptoObject00` is rank 0 of CryptoObject.
fn stem(pass: &str) -> Option<&str> {
    let digits = pass.len().checked_sub(2)?;
    let (stem, rank) = (pass.get(..digits)?, pass.get(digits..)?);
    (stem.starts_with("Crypto") && rank.bytes().all(|b| b.is_ascii_digit())).then_some(stem)
}

/// The layers of one render, with all ranks of a kind as one, whose `coverage` alone is filled.
pub(super) fn joined(layers: Vec<Layer>) -> Vec<Layer> {
    let mut result: Vec<Layer> = Vec::with_capacity(layers.len());
    for layer in layers {
        let Some(stem) = stem(&layer.names.pass).filter(|_| layer.channels.len() == 4).map(str::to_owned) else {
            result.push(layer);
            continue;
        };
        let pairs = layer.mean.chunks_exact(4).map(|p| [(p[0].to_bits(), p[1]), (p[2].to_bits(), p[3])]);
        let known = result.iter_mut().find(|known| {
            !known.coverage.is_empty() && known.names.pass == stem && known.names.view_layer == layer.names.view_layer
        });
        match known {
            Some(known) => known.coverage[0].iter_mut().zip(pairs).for_each(|(ids, pair)| ids.extend(pair)),
            None => {
                let coverage = vec![pairs.map(Vec::from).collect()];
                let names = super::Names { pass: stem, ..layer.names };
                result.push(Layer {
                    names,
                    channels: Vec::new(),
                    mean: Vec::new(),
                    coverage,
                    is_color: false,
                    ..layer
                });
            }
        }
    }
    result
}

/// Gives both layers the channels that their coverages have together.
pub(super) fn spread(a: &mut Layer, b: &mut Layer) {
    let mut totals: HashMap<u32, f64> = HashMap::new();
    for (id, share) in a.coverage.iter().chain(&b.coverage).flatten().flatten().filter(|(_, share)| *share > 0.0) {
        *totals.entry(*id).or_default() += f64::from(*share);
    }
    let mut ids: Vec<(u32, f64)> = totals.into_iter().collect();
    ids.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    let ids: Vec<u32> = ids.into_iter().take(MOST).map(|(id, _)| id).collect();
    for layer in [a, b] {
        let renders: Vec<Vec<f32>> = layer.coverage.iter().map(|coverage| channels(coverage, &ids)).collect();
        let others: Vec<&[f32]> = renders[1..].iter().map(|values| &values[..]).collect();
        (layer.mean, layer.variance) = mean_and_variance(&renders[0], &others);
        layer.channels = ids.iter().map(|id| format!("{id:08x}")).chain(["others".to_owned()]).collect();
        layer.coverage.clear();
    }
}

/// Coverage of each of the ids, then of all others.
fn channels(coverage: &Coverage, ids: &[u32]) -> Vec<f32> {
    let n = ids.len() + 1;
    let mut values = vec![0.0; coverage.len() * n];
    for (pixel, list) in values.chunks_exact_mut(n).zip(coverage) {
        for (id, share) in list.iter().filter(|(_, share)| *share > 0.0) {
            pixel[ids.iter().position(|known| known == id).unwrap_or(n - 1)] += share;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_have_channels_and_the_rest_has_one() {
        let (cat, dog) = (7, 9);
        let coverage = vec![vec![(cat, 0.75), (dog, 0.25)], vec![(dog, 1.0), (0, 0.0)], vec![(3, 0.5), (4, 0.25)]];
        assert_eq!(channels(&coverage, &[cat, dog]), [0.75, 0.25, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.75]);
    }

    #[test]
    fn ranks_are_recognised() {
        assert_eq!(stem("CryptoObject00"), Some("CryptoObject"));
        assert_eq!(stem("CryptoAsset"), None);
        assert_eq!(stem("é"), None);
        assert_eq!(stem("Shadow_02"), None);
    }
}
