//! How many samples each pixel gets where noisy pixels get more.
//!
//! For a given sum of samples the mean squared error is least where each pixel has as many as its samples' standard
//! deviation, here on the display's scale, calls for (Neyman's allocation). A pixel whose own samples decide how many
//! it gets is biased: by chance too dark, it is taken for clean and stays so. Here a pixel's number follows from its
//! neighbours' samples, which are independent of its own, and never from itself.

use std::io::{self, Read, Write};

use rayon::prelude::*;

use crate::film::{Film, PixelErrors, REPLICATES};

/// Pixels at most so far away tell of a pixel.
const RADIUS: usize = 2;

/// What every pixel is taken to have of the picture's mean variance at least: what is clean to sixteen samples may
/// hide light that they missed.
const LEAST_SHARE: f64 = 0.02;

/// A pixel's samples grow by this at most from one aim to the next.
const MOST_GROWTH: u32 = 4;

/// The plan of a render.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    tiles: Vec<TilePlan>,
    pixels: u64,
}

/// Per pixel of a tile, row by row.
#[derive(Clone, Debug)]
struct TilePlan {
    /// Samples that there were when the errors were looked at.
    base: Vec<u32>,
    /// What its neighbours' errors were then; empty where nothing is known.
    weights: Vec<f64>,
    /// Samples that are wanted.
    goal: Vec<u32>,
}

impl Plan {
    pub(super) fn new(film: &Film) -> Self {
        let tile = |tile: &crate::film::Tile| {
            let pixels = tile.pixels().count();
            TilePlan { base: vec![0; pixels], weights: Vec::new(), goal: vec![0; pixels] }
        };
        let pixels = u64::from(film.width()) * u64::from(film.height());
        Self { tiles: film.tiles().iter().map(tile).collect(), pixels }
    }

    /// Samples per pixel when the goals are reached, the mean.
    #[cfg(test)]
    fn spp(&self) -> f64 {
        let sum = self.tiles.iter().flat_map(|tile| &tile.goal).map(|&goal| u64::from(goal)).sum::<u64>();
        sum as f64 / self.pixels as f64
    }

    /// From now on goals follow from `errors` of the film as it is; from none they are the same for every pixel.
    pub(super) fn learn(&mut self, film: &Film, errors: Option<&PixelErrors>) {
        let weights = errors.map(|errors| weights(film, errors));
        let weights = weights.filter(|weights| weights.iter().flatten().any(|&w| w > 0.0));
        let mut weights = weights.map(Vec::into_iter);
        for (plan, tile) in self.tiles.iter_mut().zip(film.tiles()) {
            plan.weights = weights.as_mut().and_then(Iterator::next).unwrap_or_default();
            plan.base.iter_mut().enumerate().for_each(|(i, base)| *base = tile.given(i));
        }
    }

    /// Sets the goals for `spp` samples per pixel in the mean. Those for more are no smaller in any pixel: on the way to
    /// more the fewer are passed.
    pub(super) fn aim(&mut self, spp: u32) {
        if self.tiles.iter().any(|tile| tile.weights.is_empty()) {
            for TilePlan { base, goal, .. } in &mut self.tiles {
                base.iter().zip(goal).for_each(|(&base, goal)| *goal = spp.max(base));
            }
            return;
        }
        let budget = u64::from(spp) * self.pixels;
        let sum = |scale: f64| {
            let of_tile = |tile: &TilePlan| {
                tile.base.iter().zip(&tile.weights).map(|(&base, &w)| u64::from(goal(base, scale * w))).sum::<u64>()
            };
            self.tiles.par_iter().map(of_tile).sum::<u64>()
        };
        // The scale that spends the budget, by bisection of its logarithm's range.
        let largest = self.tiles.iter().flat_map(|tile| &tile.weights).fold(0.0, |a: f64, &b| a.max(b));
        let (mut low, mut high) = (0.0, f64::from(u32::MAX) / largest);
        for _ in 0..64 {
            let middle = if low > 0.0 { f64::sqrt(low * high) } else { high * 1e-9 };
            if sum(middle) <= budget { low = middle } else { high = middle }
        }
        for TilePlan { base, weights, goal: goals } in &mut self.tiles {
            for ((wanted, &base), &w) in goals.iter_mut().zip(&*base).zip(&*weights) {
                *wanted = goal(base, low * w);
            }
        }
    }

    /// Samples that are wanted of a pixel, by its tile and place in it.
    pub(super) fn goal(&self, tile: usize, pixel: usize) -> u32 {
        self.tiles[tile].goal[pixel]
    }

    /// Writes what goals follow from.
    pub(super) fn save(&self, out: &mut dyn Write) -> io::Result<()> {
        for TilePlan { base, weights, goal: _ } in &self.tiles {
            out.write_all(bytemuck::cast_slice(base))?;
            out.write_all(&[u8::from(!weights.is_empty())])?;
            out.write_all(bytemuck::cast_slice(weights))?;
        }
        Ok(())
    }

    /// Takes it in again.
    pub(super) fn load(&mut self, from: &mut dyn Read) -> io::Result<()> {
        for TilePlan { base, weights, goal: _ } in &mut self.tiles {
            from.read_exact(bytemuck::cast_slice_mut(base))?;
            let mut is_known = [0];
            from.read_exact(&mut is_known)?;
            *weights = if is_known[0] == 1 { vec![0.0; base.len()] } else { Vec::new() };
            from.read_exact(bytemuck::cast_slice_mut(weights))?;
        }
        Ok(())
    }
}

/// Whole rounds of the replicates, never fewer than there are.
fn goal(base: u32, wanted: f64) -> u32 {
    let round = REPLICATES as u32;
    let wanted = wanted.min(f64::from(base.saturating_mul(MOST_GROWTH))) as u32;
    base.max(wanted.div_ceil(round).saturating_mul(round))
}

/// By tile and pixel, the standard deviation of a sample as the neighbours have it.
fn weights(film: &Film, errors: &PixelErrors) -> Vec<Vec<f64>> {
    let of_tile = |tile: &crate::film::Tile| -> Vec<f64> {
        tile.pixels().map(|(x, y)| errors.around(x as usize, y as usize, RADIUS).unwrap_or(0.0)).collect()
    };
    let mut variances: Vec<Vec<f64>> = film.tiles().par_iter().map(of_tile).collect();
    let mean = variances.iter().flatten().sum::<f64>() / (f64::from(film.width()) * f64::from(film.height()));
    for variance in variances.iter_mut().flatten() {
        *variance = (*variance + LEAST_SHARE * mean).sqrt();
    }
    variances
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{PassSet, PixelSample, SampleId};
    use crate::math::Rgb;

    /// A film of which the right half is noisy and the left is not, after 16 samples.
    fn film() -> Film {
        let mut film = Film::new(40, 24, PassSet::default().with_error());
        for tile in film.tiles_mut() {
            for (x, y) in tile.pixels() {
                for index in 0..16 {
                    let noise = (index * 7 + x * 3 + y * 5) % 16;
                    let value = if x < 20 { 0.5 } else { noise as f32 / 16.0 };
                    let sample = PixelSample { combined: Rgb::splat(value), ..PixelSample::default() };
                    tile.add(SampleId { x, y, index }, 1.0, &sample);
                }
            }
        }
        film
    }

    #[test]
    fn noise_gets_the_samples_and_the_budget_is_kept() {
        let film = film();
        let mut plan = Plan::new(&film);
        plan.aim(16);
        assert!(plan.spp() == 16.0 && plan.goal(1, 7) == 16);
        plan.learn(&film, film.errors().as_ref());
        plan.aim(32);
        assert!((31.0..=32.0).contains(&plan.spp()), "{}", plan.spp());
        for (i, tile) in film.tiles().iter().enumerate() {
            for (pixel, (x, _)) in tile.pixels().enumerate() {
                let goal = plan.goal(i, pixel);
                assert!(goal.is_multiple_of(8) && (16..=64).contains(&goal));
                if x < 18 {
                    assert_eq!(goal, 16);
                } else if x >= 22 {
                    assert!(goal >= 40, "{goal}");
                }
            }
        }
    }

    #[test]
    fn fewer_samples_are_on_the_way_to_more() {
        let film = film();
        let mut plan = Plan::new(&film);
        plan.learn(&film, film.errors().as_ref());
        let mut goals = |spp| {
            plan.aim(spp);
            (0..film.tiles().len()).flat_map(|i| plan.tiles[i].goal.clone()).collect::<Vec<u32>>()
        };
        let mut before = goals(17);
        for spp in 18..48 {
            let after = goals(spp);
            assert!(before.iter().zip(&after).all(|(before, after)| before <= after), "{spp}");
            before = after;
        }
    }

    #[test]
    fn what_goals_follow_from_comes_back() {
        let film = film();
        for learns in [false, true] {
            let mut plan = Plan::new(&film);
            if learns {
                plan.learn(&film, film.errors().as_ref());
            }
            let (mut bytes, mut other) = (Vec::new(), Plan::new(&film));
            plan.save(&mut bytes).expect("written");
            other.load(&mut &*bytes).expect("read");
            plan.aim(40);
            other.aim(40);
            assert!(plan.tiles.iter().zip(&other.tiles).all(|(a, b)| a.goal == b.goal));
            assert!(other.load(&mut &bytes[..bytes.len() - 1]).is_err());
        }
    }

    #[test]
    fn a_picture_without_noise_is_sampled_alike() {
        let mut film = Film::new(3, 3, PassSet::default().with_error());
        let tile = &mut film.tiles_mut()[0];
        for ((x, y), index) in tile.pixels().flat_map(|at| (0..16).map(move |index| (at, index))).collect::<Vec<_>>() {
            tile.add(SampleId { x, y, index }, 1.0, &PixelSample::default());
        }
        let mut plan = Plan::new(&film);
        plan.learn(&film, film.errors().as_ref());
        plan.aim(24);
        assert!(plan.spp() == 24.0 && plan.goal(0, 4) == 24);
    }
}
