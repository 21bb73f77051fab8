//! A list of weights, sampled in constant time by Walker's alias method.
//!
//! Michael Vose, *A Linear Algorithm for Generating Random Numbers with a Given Distribution*, IEEE
//! Transactions on Software Engineering 17(9), 1991.

use crate::math::ONE_MINUS_EPSILON;

/// Chooses indices in proportion to weights.
#[derive(Clone, Debug)]
pub struct AliasTable {
    bins: Vec<Bin>,
}

#[derive(Clone, Copy, Debug)]
struct Bin {
    /// Share of the bin that is its own index's; the rest is `alias`'s.
    own: f32,
    alias: u32,
    /// Probability of its own index over the whole table.
    pmf: f32,
}

/// What [`AliasTable::sample`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AliasSample {
    /// The index.
    pub index: usize,
    /// Its probability, above 0.
    pub pmf: f32,
    /// What is left of the random number, uniform in [0, 1) again; with fewer bits by log₂ of the
    /// table's length.
    pub u: f32,
}

impl AliasTable {
    /// A table for `weights`; those that are negative or not finite count as 0. `None` where all
    /// are 0, or where there are more than `u32` can number.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let clean = |w: f64| if w.is_finite() && w > 0.0 { w } else { 0.0 };
        let largest = weights.iter().copied().map(clean).fold(0.0, f64::max);
        if largest == 0.0 || u32::try_from(weights.len()).is_err() {
            return None;
        }
        // Relative to the largest, so that the sum can't overflow.
        let relative: Vec<f64> = weights.iter().map(|&w| clean(w) / largest).collect();
        let total: f64 = relative.iter().sum();
        let count = weights.len() as f64;
        let mut bins: Vec<Bin> = relative
            .iter()
            .enumerate()
            .map(|(i, w)| Bin { own: 1.0, alias: i as u32, pmf: (w / total) as f32 })
            .collect();

        let mut share: Vec<f64> = relative.iter().map(|w| w / total * count).collect();
        let (mut poor, mut rich): (Vec<usize>, Vec<usize>) = (0..share.len()).partition(|&i| share[i] < 1.0);
        while let (Some(&needy), Some(&giver)) = (poor.last(), rich.last()) {
            poor.pop();
            bins[needy].own = share[needy] as f32;
            bins[needy].alias = giver as u32;
            share[giver] -= 1.0 - share[needy];
            if share[giver] < 1.0 {
                rich.pop();
                poor.push(giver);
            }
        }
        // Rounding may leave a full bin among the poor, but an empty one must not become certain.
        let fallback = relative.iter().position(|&w| w == 1.0)? as u32;
        for i in poor {
            if relative[i] == 0.0 {
                bins[i].own = 0.0;
                bins[i].alias = fallback;
            }
        }
        Some(Self { bins })
    }

    /// How many weights there are, the zeros among them.
    pub fn len(&self) -> usize {
        self.bins.len()
    }

    /// Never true: a table has at least one weight above 0.
    pub fn is_empty(&self) -> bool {
        self.bins.is_empty()
    }

    /// Chooses an index by `u` in [0, 1).
    #[inline]
    pub fn sample(&self, u: f32) -> AliasSample {
        let scaled = f64::from(u) * self.bins.len() as f64;
        let slot = (scaled as usize).min(self.bins.len() - 1);
        let bin = self.bins[slot];
        let within = (scaled - slot as f64) as f32;
        if within < bin.own {
            AliasSample { index: slot, pmf: bin.pmf, u: (within / bin.own).min(ONE_MINUS_EPSILON) }
        } else {
            let index = bin.alias as usize;
            let u = ((within - bin.own) / (1.0 - bin.own)).min(ONE_MINUS_EPSILON);
            AliasSample { index, pmf: self.bins[index].pmf, u: u.max(0.0) }
        }
    }

    /// Probability of `index`; 0 beyond the end.
    #[inline]
    pub fn pmf(&self, index: usize) -> f32 {
        self.bins.get(index).map_or(0.0, |bin| bin.pmf)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probability of each index that sampling really has: the measure of its parts of bins.
    fn realized(table: &AliasTable) -> Vec<f64> {
        let mut p = vec![0.0; table.len()];
        for (i, bin) in table.bins.iter().enumerate() {
            p[i] += f64::from(bin.own) / table.len() as f64;
            p[bin.alias as usize] += (1.0 - f64::from(bin.own)) / table.len() as f64;
        }
        p
    }

    #[test]
    fn probabilities_are_the_weights() {
        let ranges: Vec<f64> = (0..300).map(|i| 10f64.powi(i % 30 - 15)).collect();
        let lists = [vec![3.0], vec![1.0; 7], vec![0.0, 2.0, 0.0, 6.0, 0.0], vec![1e300; 4], ranges];
        for weights in lists {
            let table = AliasTable::new(&weights).unwrap();
            let largest = weights.iter().copied().fold(0.0, f64::max);
            let total: f64 = weights.iter().map(|w| w / largest).sum();
            for (i, p) in realized(&table).iter().enumerate() {
                let exact = weights[i] / largest / total;
                assert!((p - exact).abs() < 1e-7, "{i}: {p} {exact}");
                assert!((f64::from(table.pmf(i)) - exact).abs() <= 1e-7 * exact);
                assert_eq!(exact == 0.0, *p == 0.0, "{i}");
            }
        }
    }

    #[test]
    fn samples_are_in_range_and_uniform_within() {
        let table = AliasTable::new(&[0.0, 1.0, 0.0, 3.0, 1e-9, 0.5]).unwrap();
        let mut mean = [0.0; 6];
        let mut count = [0.0; 6];
        let n = 1 << 16;
        for i in 0..n {
            let s = table.sample(i as f32 / n as f32);
            assert!(s.pmf == table.pmf(s.index) && s.pmf > 0.0);
            assert!((0.0..1.0).contains(&s.u));
            mean[s.index] += f64::from(s.u);
            count[s.index] += 1.0;
        }
        for i in [1, 3, 5] {
            assert!((count[i] / f64::from(n) - f64::from(table.pmf(i))).abs() < 1e-3);
            assert!((mean[i] / count[i] - 0.5).abs() < 1e-3);
        }
        assert_eq!(count[0] + count[2], 0.0);
    }

    #[test]
    fn nothing_to_choose_from() {
        for weights in [&[][..], &[0.0, 0.0], &[f64::NAN, -1.0, f64::INFINITY]] {
            assert!(AliasTable::new(weights).is_none());
        }
    }
}
