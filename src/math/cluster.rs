//! Where most of some points are, whatever a few of them do.

use super::DVec3;

/// More points than this tell no more.
const SAMPLE: usize = 1024;

/// The middle of most points and how far from it half of them are at least along some axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Median by axis.
    pub middle: DVec3,
    /// The largest of the medians of the distances from it along the axes.
    pub spread: f64,
}

impl Cluster {
    /// That of the finite ones of `points`, by about a thousand of them; `None` where there is none.
    pub fn of(points: &[[f32; 3]]) -> Option<Self> {
        let step = points.len().div_ceil(SAMPLE).max(1);
        let finite = |p: &&[f32; 3]| p.iter().all(|x| x.is_finite());
        let sample: Vec<[f32; 3]> = points.iter().step_by(step).filter(finite).copied().collect();
        let mut of_axis = [0, 1, 2].map(|axis| sample.iter().map(|p| f64::from(p[axis])).collect::<Vec<_>>());
        let mut middle = [0.0; 3];
        let mut spread: f64 = 0.0;
        for (values, middle) in of_axis.iter_mut().zip(&mut middle) {
            *middle = median(values)?;
            values.iter_mut().for_each(|value| *value = (*value - *middle).abs());
            spread = spread.max(median(values)?);
        }
        Some(Self { middle: middle.into(), spread })
    }

    /// How many spreads from the middle `p` is, along the axis where that is most.
    pub fn distance(&self, p: [f32; 3]) -> f64 {
        (DVec3::from(p.map(f64::from)) - self.middle).abs().max_element() / self.spread
    }
}

fn median(values: &mut [f64]) -> Option<f64> {
    let half = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(half, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_points_far_away_or_without_place_change_nothing() {
        let mut points: Vec<[f32; 3]> = (0..5000).map(|i| [(i % 101) as f32, 7.0, 0.0]).collect();
        let alone = Cluster::of(&points).unwrap();
        assert!((alone.middle.x - 50.0).abs() < 2.0 && alone.middle.y == 7.0);
        assert!((alone.spread - 25.0).abs() < 2.0, "{}", alone.spread);
        points[5] = [1e17, -1e17, f32::NAN];
        points[10] = [1e17, -1e17, 1e17];
        let found = Cluster::of(&points).unwrap();
        assert!((found.middle - alone.middle).length() < 1.0 && (found.spread - alone.spread).abs() < 1.0);
        assert!(found.distance(points[10]) > 1e15 && found.distance(points[11]) < 3.0);
        assert_eq!(Cluster::of(&[[f32::NAN; 3]]), None);
    }
}
