//! How many samples each pixel gets where noisy pixels get more.
//!
//! For a given sum of samples the mean squared error is least where each pixel has as many as its samples' standard
//! deviation, here on the display's scale, calls for (Neyman's allocation). A pixel whose own samples decide how many
//! it gets is biased: by chance too dark, it is taken for clean and stays so. Here a pixel's number follows from its
//! neighbours' samples, which are independent of its own, and never from itself.

use std::ops::Range;

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
#[derive(Debug)]
pub(super) struct Plan {
    tiles: Vec<TilePlan>,
    pixels: u64,
}

/// Per pixel of a tile, row by row, samples taken and samples wanted.
#[derive(Debug)]
struct TilePlan {
    taken: Vec<u32>,
    goal: Vec<u32>,
}

impl Plan {
    pub(super) fn new(film: &Film) -> Self {
        let tile = |tile: &crate::film::Tile| {
            let pixels = tile.pixels().count();
            TilePlan { taken: vec![0; pixels], goal: vec![0; pixels] }
        };
        let pixels = u64::from(film.width()) * u64::from(film.height());
        Self { tiles: film.tiles().iter().map(tile).collect(), pixels }
    }

    /// Samples per pixel when the goals are reached, the mean.
    pub(super) fn spp(&self) -> f64 {
        let sum = self.tiles.iter().flat_map(|tile| &tile.goal).map(|&goal| u64::from(goal)).sum::<u64>();
        sum as f64 / self.pixels as f64
    }

    /// Sets the goals for `spp` samples per pixel in the mean; the same for each where nothing is known of `errors`.
    pub(super) fn aim(&mut self, film: &Film, errors: Option<&PixelErrors>, spp: u32) {
        let weights = errors.map(|errors| weights(film, errors));
        let Some(weights) = weights.filter(|weights| weights.iter().flatten().any(|&w| w > 0.0)) else {
            self.tiles.iter_mut().for_each(|tile| tile.goal.iter_mut().for_each(|goal| *goal = spp.max(*goal)));
            return;
        };
        let budget = u64::from(spp) * self.pixels;
        let sum = |scale: f64| {
            let of_tile = |(tile, weights): (&TilePlan, &Vec<f64>)| {
                tile.taken.iter().zip(weights).map(|(&taken, &w)| u64::from(goal(taken, scale * w))).sum::<u64>()
            };
            self.tiles.par_iter().zip(&weights).map(of_tile).sum::<u64>()
        };
        // The scale that spends the budget, by bisection of its logarithm's range.
        let largest = weights.iter().flatten().fold(0.0, |a: f64, &b| a.max(b));
        let (mut low, mut high) = (0.0, f64::from(u32::MAX) / largest);
        for _ in 0..64 {
            let middle = if low > 0.0 { f64::sqrt(low * high) } else { high * 1e-9 };
            if sum(middle) <= budget { low = middle } else { high = middle }
        }
        for (tile, weights) in self.tiles.iter_mut().zip(&weights) {
            for ((wanted, &taken), &w) in tile.goal.iter_mut().zip(&tile.taken).zip(weights) {
                *wanted = goal(taken, low * w);
            }
        }
    }

    /// The samples of a pixel, by its tile and place in it, in a wave of at most `longest`.
    pub(super) fn samples(&self, tile: usize, pixel: usize, longest: u32) -> Range<u32> {
        let TilePlan { taken, goal } = &self.tiles[tile];
        taken[pixel]..goal[pixel].min(taken[pixel] + longest)
    }

    /// Takes a wave for done; true where the goals are reached by it.
    pub(super) fn advance(&mut self, longest: u32) -> bool {
        let mut reached = true;
        for TilePlan { taken, goal } in &mut self.tiles {
            for (taken, &goal) in taken.iter_mut().zip(goal.iter()) {
                *taken = goal.min(*taken + longest);
                reached &= *taken == goal;
            }
        }
        reached
    }
}

/// Whole rounds of the replicates, never fewer than there are.
fn goal(taken: u32, wanted: f64) -> u32 {
    let round = REPLICATES as u32;
    let wanted = wanted.min(f64::from(taken.saturating_mul(MOST_GROWTH))) as u32;
    taken.max(wanted.div_ceil(round).saturating_mul(round))
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
        plan.aim(&film, None, 16);
        assert!(plan.advance(16) && plan.spp() == 16.0);
        plan.aim(&film, film.errors().as_ref(), 32);
        assert!((31.0..=32.0).contains(&plan.spp()), "{}", plan.spp());
        for (i, tile) in film.tiles().iter().enumerate() {
            for (pixel, (x, _)) in tile.pixels().enumerate() {
                let samples = plan.samples(i, pixel, u32::MAX - 16);
                assert!(samples.start == 16 && samples.end.is_multiple_of(8) && samples.end <= 64);
                if x < 18 {
                    assert_eq!(samples.end, 16);
                } else if x >= 22 {
                    assert!(samples.end >= 40, "{samples:?}");
                }
            }
        }
        let mut waves = 1;
        while !plan.advance(16) {
            waves += 1;
        }
        assert!((2..=3).contains(&waves));
    }

    #[test]
    fn a_picture_without_noise_is_sampled_alike() {
        let mut film = Film::new(3, 3, PassSet::default().with_error());
        let tile = &mut film.tiles_mut()[0];
        for ((x, y), index) in tile.pixels().flat_map(|at| (0..16).map(move |index| (at, index))).collect::<Vec<_>>() {
            tile.add(SampleId { x, y, index }, 1.0, &PixelSample::default());
        }
        let mut plan = Plan::new(&film);
        plan.aim(&film, film.errors().as_ref(), 24);
        assert_eq!(plan.spp(), 24.0);
        assert_eq!(plan.samples(0, 4, 16), 0..16);
    }
}
