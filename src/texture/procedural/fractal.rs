//! Sums and products of octaves of noise.
//!
//! Kenton Musgrave in David Ebert et al.: *Texturing and Modeling*, 3rd edition, 2003, chapter 16: fBm,
//! multifractal, heterogeneous terrain, hybrid and ridged multifractal. A fraction of an octave is
//! blended in, so that `detail` has no steps; the ridged one has steps, as in Cycles.

use super::perlin::{signed, signed_vector};
use super::round::{mix, saturate, within};

/// Octaves beyond this have frequencies beyond what a float holds.
const MOST_DETAIL: f32 = 32.0;

/// The numbers that shape a fractal.
#[derive(Clone, Copy, Debug)]
pub struct Octaves {
    whole: u32,
    fraction: f32,
    roughness: f32,
    lacunarity: f32,
}

impl Octaves {
    /// `detail` octaves beyond the first; amplitude times `roughness` and frequency times `lacunarity`
    /// from one to the next.
    pub fn new(detail: f32, roughness: f32, lacunarity: f32) -> Self {
        let detail = within(detail, 0.0, MOST_DETAIL);
        let whole = detail as u32;
        Self { whole, fraction: detail - whole as f32, roughness, lacunarity }
    }

    /// Fractional Brownian motion of three noises at once, by whole octaves.
    pub fn fbm_vector<const N: usize>(&self, p: [f32; N]) -> [f32; 3] {
        let (mut frequency, mut amplitude, mut sum) = (1.0, 1.0, [0.0; 3]);
        for _ in 0..=self.whole {
            let noise = signed_vector(p.map(|x| frequency * x));
            sum = std::array::from_fn(|i| sum[i] + amplitude * noise[i]);
            amplitude *= self.roughness;
            frequency *= self.lacunarity;
        }
        sum
    }

    /// Fractional Brownian motion; `normalize` maps it to about 0 to 1.
    pub fn fbm<const N: usize>(&self, p: [f32; N], normalize: bool) -> f32 {
        let (mut frequency, mut amplitude, mut most, mut sum) = (1.0, 1.0, 0.0, 0.0);
        for _ in 0..=self.whole {
            sum += signed(p.map(|x| frequency * x)) * amplitude;
            most += amplitude;
            amplitude *= self.roughness;
            frequency *= self.lacunarity;
        }
        let scaled = |sum: f32, most: f32| if normalize { 0.5 * sum / most + 0.5 } else { sum };
        let value = scaled(sum, most);
        if self.fraction == 0.0 {
            return value;
        }
        let finer = sum + signed(p.map(|x| frequency * x)) * amplitude;
        mix(value, scaled(finer, most + amplitude), self.fraction)
    }

    /// A product of octaves.
    pub fn multifractal<const N: usize>(&self, mut p: [f32; N]) -> f32 {
        let (mut value, mut amplitude) = (1.0, 1.0);
        for _ in 0..=self.whole {
            value *= amplitude * signed(p) + 1.0;
            amplitude *= self.roughness;
            p = self.finer(p);
        }
        if self.fraction != 0.0 {
            value *= self.fraction * amplitude * signed(p) + 1.0;
        }
        value
    }

    /// Terrain whose roughness grows with its height.
    pub fn hetero_terrain<const N: usize>(&self, mut p: [f32; N], offset: f32) -> f32 {
        let mut amplitude = self.roughness;
        let mut value = offset + signed(p);
        p = self.finer(p);
        for _ in 1..=self.whole {
            value += (signed(p) + offset) * amplitude * value;
            amplitude *= self.roughness;
            p = self.finer(p);
        }
        if self.fraction != 0.0 {
            value += self.fraction * ((signed(p) + offset) * amplitude * value);
        }
        value
    }

    /// Smooth valleys, rough peaks.
    pub fn hybrid_multifractal<const N: usize>(&self, mut p: [f32; N], offset: f32, gain: f32) -> f32 {
        const FLAT: f32 = 0.001;
        let (mut amplitude, mut value, mut weight) = (1.0, 0.0, 1.0_f32);
        for _ in 0..=self.whole {
            if weight <= FLAT {
                return value;
            }
            weight = weight.min(1.0);
            let signal = (signed(p) + offset) * amplitude;
            amplitude *= self.roughness;
            value += weight * signal;
            weight *= gain * signal;
            p = self.finer(p);
        }
        if self.fraction != 0.0 && weight > FLAT {
            value += self.fraction * weight.min(1.0) * ((signed(p) + offset) * amplitude);
        }
        value
    }

    /// Ridges where the noise crosses 0.
    pub fn ridged_multifractal<const N: usize>(&self, mut p: [f32; N], offset: f32, gain: f32) -> f32 {
        let ridge = |p: [f32; N]| {
            let height = offset - signed(p).abs();
            height * height
        };
        let mut amplitude = self.roughness;
        let mut signal = ridge(p);
        let mut value = signal;
        for _ in 1..=self.whole {
            p = self.finer(p);
            let weight = saturate(signal * gain);
            signal = ridge(p) * weight;
            value += signal * amplitude;
            amplitude *= self.roughness;
        }
        value
    }

    fn finer<const N: usize>(&self, p: [f32; N]) -> [f32; N] {
        p.map(|x| x * self.lacunarity)
    }
}
