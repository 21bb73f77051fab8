//! Octaves of a feature: as fBm sums noise, with blends in place of some sums.

use super::features::Found;
use crate::texture::procedural::round::mix;

/// How octaves are put together.
pub struct Octaves {
    /// Octaves beyond the first; its fraction blends the last one in.
    pub detail: f32,
    /// Amplitude of an octave relative to the one before.
    pub roughness: f32,
    /// Frequency of an octave relative to the one before.
    pub lacunarity: f32,
    /// Divides by the largest value that can come out.
    pub normalize: bool,
}

impl Octaves {
    /// A feature that finds points; `farthest` bounds its distance.
    pub fn points<const N: usize>(
        &self,
        p: [f32; N],
        farthest: f32,
        feature: impl Fn([f32; N]) -> Found<N>,
    ) -> Found<N> {
        let single = self.is_single();
        let mut sum = Found { distance: 0.0, color: [0.0; 3], position: [0.0; N] };
        let (mut amplitude, mut most, mut scale) = (1.0, 0.0, 1.0);
        for octave in 0..=self.detail.ceil() as u32 {
            let found = feature(p.map(|x| x * scale));
            if single {
                (most, sum) = (1.0, found);
                break;
            }
            let share = self.share(octave);
            most = mix(most, most + amplitude, share);
            sum.distance = mix(sum.distance, sum.distance + found.distance * amplitude, share);
            for (sum, found) in sum.color.iter_mut().zip(found.color) {
                *sum = mix(*sum, *sum + found * amplitude, share);
            }
            for (sum, found) in sum.position.iter_mut().zip(found.position) {
                *sum = mix(*sum, mix(*sum, found / scale, amplitude), share);
            }
            scale *= self.lacunarity;
            amplitude *= self.roughness;
        }
        if self.normalize {
            sum.distance /= most * farthest;
            sum.color = sum.color.map(|c| c / most);
        }
        sum
    }

    /// Distance to the edge; `farthest` bounds it.
    pub fn edge<const N: usize>(&self, p: [f32; N], farthest: f32, feature: impl Fn([f32; N]) -> f32) -> f32 {
        /// Further than any edge.
        const FAR: f32 = 8.0;
        let single = self.is_single();
        let (mut amplitude, mut most, mut scale, mut distance) = (1.0, farthest, 1.0, FAR);
        for octave in 0..=self.detail.ceil() as u32 {
            let found = feature(p.map(|x| x * scale));
            if single {
                distance = found;
                break;
            }
            let share = self.share(octave);
            most = mix(most, mix(most, farthest / scale, amplitude), share);
            let nearer = mix(distance, distance.min(found / scale), amplitude);
            distance = mix(distance, nearer, share);
            scale *= self.lacunarity;
            amplitude *= self.roughness;
        }
        if self.normalize { distance / most } else { distance }
    }

    fn is_single(&self) -> bool {
        self.detail == 0.0 || self.roughness == 0.0
    }

    /// How much of an octave counts: all, or of the last one a fraction.
    fn share(&self, octave: u32) -> f32 {
        if octave as f32 <= self.detail { 1.0 } else { self.detail.fract() }
    }
}
