//! Light beneath a surface by how far from where it went in it comes out.
//!
//! Per Christensen, Brent Burley: *Approximate Reflectance Profiles for Efficient Subsurface Scattering*, Pixar 15-04, 2015:
//! R(r) 2πr = (e^(−r/d) + e^(−r/3d)) / 4d. As Cycles has it: cut off, and of the length d itself.

use crate::math::{Rgb, safe_sqrt, sqr};

/// Where it is cut off, in lengths.
const LARGEST: f32 = 16.0;
/// Share of the light up to there.
const WITHIN: f32 = 0.996_379_1;

/// Lengths d per channel, metres; 0 where a channel has no part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    pub(super) length: Rgb,
}

impl Profile {
    /// A distance from where light went in, and half of the height in which to look for a surface there; `u` chooses
    /// one of the channels.
    pub fn sample(&self, u: f32) -> [f32; 2] {
        let mut channels = self.length.to_array().into_iter().filter(|&d| d > 0.0);
        let scaled = u * channels.clone().count() as f32;
        let d = channels.clone().nth(scaled as usize).or(channels.next_back()).unwrap_or(0.0);
        let r = inverse(scaled.fract() * WITHIN) * d;
        [r, safe_sqrt(sqr(LARGEST * d) - sqr(r))]
    }

    /// Light per distance `r`, per channel.
    pub fn eval(&self, r: f32) -> Rgb {
        self.length.map(|d| {
            if d <= 0.0 || r <= 0.0 || r >= LARGEST * d {
                return 0.0;
            }
            let third = (-r / (3.0 * d)).exp();
            (third * third * third + third) / (4.0 * d * WITHIN)
        })
    }

    /// Density of the distance that [`Profile::sample`] gives.
    pub fn pdf(&self, r: f32) -> f32 {
        let channels = self.length.to_array().into_iter().filter(|&d| d > 0.0).count();
        3.0 * self.eval(r).mean() / channels.max(1) as f32
    }
}

/// The distance in lengths within which the share `u` of the light comes out: Newton's method on
/// 1 − e^(−r)/4 − 3 e^(−r/3)/4.
fn inverse(u: f32) -> f32 {
    let mut r = if u <= 0.9 { (u * u * 2.4).exp() - 1.0 } else { 15.0 };
    for _ in 0..10 {
        let third = (-r / 3.0_f32).exp();
        let whole = third * third * third;
        let slope = 0.25 * (whole + third);
        let off = 1.0 - 0.25 * whole - 0.75 * third - u;
        if off.abs() < 1e-6 || slope == 0.0 {
            break;
        }
        r = (r - off / slope).max(0.0);
    }
    r
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: Profile = Profile { length: Rgb::new(0.3, 0.0, 0.05) };

    #[test]
    fn all_light_comes_out_somewhere() {
        let n = 100_000;
        let step = 5.0 / n as f32;
        let sum: Rgb = (0..n).map(|i| TWO.eval((i as f32 + 0.5) * step)).sum();
        let sum = sum * step;
        assert!((sum.r - 1.0).abs() < 1e-3 && sum.g == 0.0 && (sum.b - 1.0).abs() < 1e-3, "{sum:?}");
    }

    #[test]
    fn distances_are_drawn_by_their_density() {
        let n = 4096;
        for limit in [0.05, 0.2, 0.8] {
            let drawn = (0..n).filter(|&i| TWO.sample((i as f32 + 0.5) / n as f32)[0] < limit).count();
            let steps = 10_000;
            let step = limit / steps as f32;
            let expected = (0..steps).map(|i| TWO.pdf((i as f32 + 0.5) * step)).sum::<f32>() * step;
            assert!((drawn as f32 / n as f32 - expected).abs() < 2e-3, "{limit}: {drawn}, {expected}");
        }
        for i in 0..64 {
            let [r, h] = TWO.sample(i as f32 / 64.0);
            assert!(r >= 0.0 && h >= 0.0 && r.is_finite() && h.is_finite());
        }
    }
}
