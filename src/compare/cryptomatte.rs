//! Cryptomatte layers: ranked ids and coverages can't be subtracted channel by channel, coverages of ids can.
//!
//! All ranks of one kind become one layer of one channel: 1 in the reference, and in the other picture what both
//! agree on, 1 - Σ |coverage in one - coverage in the other| / 2 over all ids and what has none. So its bias is minus
//! the share of the picture that is given to something else.

use super::side::{Layer, Noise};

/// Ids, as the bits of their floats, and coverages of each pixel.
pub(super) type Coverage = Vec<Vec<(u32, f32)>>;

/// `CryptoObject00` is rank 0 of CryptoObject.
fn rank(pass: &str) -> Option<(&str, &str)> {
    let digits = pass.len().checked_sub(2)?;
    let (stem, rank) = (pass.get(..digits)?, pass.get(digits..)?);
    (stem.starts_with("Crypto") && rank.bytes().all(|b| b.is_ascii_digit())).then_some((stem, rank))
}

/// The layers, with all ranks of a kind as one.
pub(super) fn joined(layers: Vec<Layer>) -> Vec<Layer> {
    let mut result: Vec<Layer> = Vec::with_capacity(layers.len());
    for layer in layers {
        let Some(stem) = rank(&layer.names.pass).map(|(stem, _)| stem.to_owned()).filter(|_| layer.channels.len() == 4)
        else {
            result.push(layer);
            continue;
        };
        let pairs = layer.mean.chunks_exact(4).map(|p| [(p[0].to_bits(), p[1]), (p[2].to_bits(), p[3])]);
        let known = result.iter_mut().find(|known| {
            known.coverage.is_some() && known.names.pass == stem && known.names.view_layer == layer.names.view_layer
        });
        if let Some(Layer { coverage: Some(coverage), .. }) = known {
            coverage.iter_mut().zip(pairs).for_each(|(ids, pair)| ids.extend(pair));
            continue;
        }
        let coverage: Coverage = pairs.map(Vec::from).collect();
        let names = super::Names { pass: stem, ..layer.names };
        let mean = vec![1.0; coverage.len()];
        let (channels, noise) = (vec!["coverage".to_owned()], Noise::Unknown);
        let layer =
            Layer { names, channels, mean, variance: Vec::new(), noise, is_color: false, coverage: Some(coverage) };
        result.push(layer);
    }
    result
}

/// What each pixel of `b` agrees with `a` on.
pub(super) fn agreement(a: &Coverage, b: &Coverage) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| 1.0 - misplaced(a, b)).collect()
}

fn misplaced(a: &[(u32, f32)], b: &[(u32, f32)]) -> f32 {
    let of = |list: &[(u32, f32)], id: u32| -> f32 {
        list.iter().filter(|(other, share)| *other == id && *share > 0.0).map(|(_, share)| share).sum()
    };
    let nothing = |list: &[(u32, f32)]| 1.0 - list.iter().map(|(_, share)| share.max(0.0)).sum::<f32>();
    let mut ids: Vec<u32> = a.iter().chain(b).filter(|(_, share)| *share > 0.0).map(|(id, _)| *id).collect();
    ids.sort_unstable();
    ids.dedup();
    let apart: f32 = ids.iter().map(|&id| (of(a, id) - of(b, id)).abs()).sum();
    0.5 * (apart + (nothing(a) - nothing(b)).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_given_to_another_counts_once() {
        let (cat, dog) = (7, 9);
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a} {b}");
        close(misplaced(&[(cat, 0.75), (dog, 0.25)], &[(dog, 0.25), (cat, 0.75)]), 0.0);
        close(misplaced(&[(cat, 0.75), (dog, 0.25)], &[(dog, 0.5), (cat, 0.5)]), 0.25);
        close(misplaced(&[(cat, 1.0)], &[(dog, 1.0)]), 1.0);
        close(misplaced(&[(cat, 1.0)], &[(cat, 0.4), (0, 0.0)]), 0.6);
        close(misplaced(&[(0, 0.0)], &[]), 0.0);
    }

    #[test]
    fn ranks_are_recognised() {
        assert_eq!(rank("CryptoObject00"), Some(("CryptoObject", "00")));
        assert_eq!(rank("CryptoAsset"), None);
        assert_eq!(rank("é"), None);
        assert_eq!(rank("Shadow_02"), None);
    }
}
