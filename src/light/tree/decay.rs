//! How the lights below the children of a node decay: a factor by distance on what the physical law
//! brings, for each child the mean of its lights.
//!
//! The factor is kept at a few distances; between them, and beyond, its logarithm is linear in that of
//! the distance. So it is about exact for powers of the distance, and within a third where one power goes
//! over into another.

use super::node::{Child, Node, WIDTH};
use crate::light::bounds::{Asked, bounded, larger, smaller};
use crate::light::{Decay, LightBounds};

/// Distances at which the factor is kept.
const KNOTS: usize = 8;

/// Octaves from one knot to the next.
const STEP: i32 = 2;

/// Octaves from the last knot down to the size of the tree.
const BEYOND: i32 = 3;

/// Logarithms of factors are between these.
const LOGS: [f32; 2] = [-126.0, 127.0];

/// The factors of one node's children.
#[derive(Clone, Debug)]
pub(super) struct Decays {
    /// log₂ of the first knot in metres, the same in all of the tree.
    first: f32,
    /// log₂ of the factor at the first knot.
    start: [f32; WIDTH],
    /// The slope there, and by how much it changes at each knot but the last.
    slopes: [[f32; WIDTH]; KNOTS - 1],
    /// Nothing arrives from lights that are farther away, metres.
    range: [f32; WIDTH],
}

/// Sums over some lights.
#[derive(Clone, Copy, Default)]
struct Sum {
    intensity: f64,
    /// Intensity times the factor at each knot.
    decayed: [f64; KNOTS],
    range: f32,
}

impl Sum {
    fn of(light: &LightBounds, decay: &Decay, first: i32) -> Self {
        let intensity = f64::from(light.intensity);
        let at = |i: usize| {
            let knot = |i: usize| f64::from(first + STEP * i as i32).exp2();
            // The window of one knot before: between that and the next it is no higher. Short of the
            // first knot it does not count at all.
            let near = if i < 2 { 0.0 } else { knot(i - 1) };
            intensity * decay.at_most(near, knot(i)).clamp(1e-30, 1e30)
        };
        let range = smaller(decay.range as f32, f32::MAX).next_up();
        Self { intensity, decayed: std::array::from_fn(at), range }
    }

    fn add(&mut self, other: &Self) {
        self.intensity += other.intensity;
        self.range = larger(self.range, other.range);
        self.decayed.iter_mut().zip(other.decayed).for_each(|(sum, v)| *sum += v);
    }
}

/// For each of the `nodes` of a tree over `lights`, which has the given `size` in metres, the factors
/// of its children; empty where all decay as in nature.
pub(super) fn of_nodes(nodes: &[Node], lights: &[LightBounds], decays: &[Decay], size: f32) -> Vec<Decays> {
    if decays.iter().all(|decay| *decay == Decay::PHYSICAL) {
        return Vec::new();
    }
    let octave = if size > 0.0 { size.log2().clamp(-80.0, 80.0).ceil() as i32 } else { 0 };
    let first = octave + BEYOND - STEP * (KNOTS as i32 - 1);
    let none =
        Decays { first: first as f32, start: [0.0; WIDTH], slopes: [[0.0; WIDTH]; KNOTS - 1], range: [0.0; WIDTH] };
    let mut all = vec![none; nodes.len()];
    let mut sums = vec![Sum::default(); nodes.len()];
    // Children come after their node.
    for (i, node) in nodes.iter().enumerate().rev() {
        for slot in 0..WIDTH {
            let sum = match node.child(slot) {
                Child::Node(child) => sums[child as usize],
                Child::Light(light) => Sum::of(&lights[light as usize], &decays[light as usize], first),
                Child::None => continue,
            };
            all[i].set(slot, &sum);
            sums[i].add(&sum);
        }
    }
    all
}

impl Decays {
    fn set(&mut self, slot: usize, sum: &Sum) {
        let logs = sum.decayed.map(|decayed| (decayed / sum.intensity).log2());
        self.start[slot] = logs[0] as f32;
        self.range[slot] = sum.range;
        let mut before = 0.0;
        for (slopes, ends) in self.slopes.iter_mut().zip(logs.windows(2)) {
            let slope = (ends[1] - ends[0]) / f64::from(STEP);
            slopes[slot] = (slope - before) as f32;
            before = slope;
        }
    }

    /// The factor of child `slot`, whose lights are about `dist` away and none nearer than `nearest`; 0 only where none is within its range. Without branches, for the sake of vector code.
    #[inline(always)]
    pub fn factor(&self, slot: usize, dist: f32, nearest: f32) -> f32 {
        let x = log2(dist) - self.first;
        let mut log = self.start[slot] + self.slopes[0][slot] * x;
        for (knot, change) in self.slopes.iter().enumerate().skip(1) {
            log += change[slot] * larger(x - (STEP * knot as i32) as f32, 0.0);
        }
        let factor = exp2(larger(smaller(log, LOGS[1]), LOGS[0]));
        if nearest < self.range[slot] { factor } else { 0.0 }
    }

    /// Multiplies the odds of the children of `node`.
    #[inline]
    pub fn apply(&self, node: &Node, at: &Asked, odds: &mut [f32; WIDTH]) {
        for (i, odds) in odds.iter_mut().enumerate() {
            let [dist, nearest] = node.lobe(i).distances(at);
            let factor = self.factor(i, dist, nearest);
            *odds = if *odds > 0.0 && factor > 0.0 { bounded(*odds * factor) } else { 0.0 };
        }
    }
}

const MANTISSA: f32 = (1_u32 << 23) as f32;

/// Logarithm of a positive number: exact for powers of 2, linear between them.
#[inline(always)]
fn log2(x: f32) -> f32 {
    x.to_bits() as f32 / MANTISSA - 127.0
}

/// The inverse of [`log2`].
#[inline(always)]
fn exp2(x: f32) -> f32 {
    f32::from_bits(((x + 127.0) * MANTISSA) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::{Falloff, LightTree};
    use crate::math::{Bounds, Vec3};

    /// The factor of a tree over two lights that decay by `decay`, 10 m apart, at the distance `dist`.
    fn factor_of(decay: Decay) -> impl Fn(f64) -> f64 {
        let light = |p| LightBounds {
            bounds: Bounds { min: p, max: p },
            axis: Vec3::Z,
            cos_normals: -1.0,
            cos_emission: 0.0,
            intensity: 1.0,
            two_sided: false,
        };
        let tree = LightTree::decaying(&[light(Vec3::ZERO), light(Vec3::X * 10.0)], &[decay; 2]).expect("they shine");
        move |dist| tree.decays.first().map_or(1.0, |decays| f64::from(decays.factor(0, dist as f32, dist as f32)))
    }

    #[test]
    fn the_factor_of_one_light_is_about_that_of_its_law() {
        let laws = [
            Falloff::Constant,
            Falloff::Linear,
            Falloff::Quadratic,
            Falloff::Polynomial { kc: 1.0, kl: 0.0, kq: 0.01 },
            Falloff::Polynomial { kc: 0.0, kl: 3.0, kq: 7.0 },
            Falloff::Polynomial { kc: 1.0, kl: 1e-3, kq: 1e-6 },
        ];
        for (falloff, smooth) in laws.into_iter().flat_map(|law| [(law, 0.0), (law, 2.0)]) {
            let decay = Decay { falloff, smooth, ..Decay::PHYSICAL };
            let factor = factor_of(decay);
            for i in -48..=32 {
                let dist = (f64::from(i) / 4.0).exp2();
                let ratio = factor(dist) / decay.factor(dist);
                assert!((0.7..1.5).contains(&ratio), "{decay:?} at {dist}: {ratio}");
            }
        }
    }

    #[test]
    fn a_range_ends_where_it_does() {
        for range in [1e-3, 0.4, 5.0, 1e4] {
            let decay = Decay { range, ..Decay::PHYSICAL };
            let factor = factor_of(decay);
            assert!(factor(range * (1.0 - 1e-7)) > 0.0 && factor(range * 1.0001) == 0.0);
            for share in [0.01, 0.1, 0.5, 0.8, 0.9] {
                let ratio = factor(share * range) / decay.factor(share * range);
                assert!((0.95..4.0).contains(&ratio), "range {range}, {share}: {ratio}");
            }
        }
    }
}
