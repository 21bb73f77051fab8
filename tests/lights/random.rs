//! Random receivers and lights.

use penumbra::light::{LightBounds, Receiver};
use penumbra::math::{Bounds, Frame, Vec3};
use penumbra::sampling::warp;

/// SplitMix64.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// In [0, 1), 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    pub fn range(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * self.unit()
    }

    /// Below `n`.
    pub fn index(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    pub fn in_box(&mut self, half: f32) -> Vec3 {
        Vec3::new(self.range(-half, half), self.range(-half, half), self.range(-half, half))
    }

    pub fn direction(&mut self) -> Vec3 {
        warp::sample_uniform_sphere([self.unit(), self.unit()])
    }

    /// A direction within `angle` of `axis`.
    pub fn in_cone(&mut self, axis: Vec3, angle: f32) -> Vec3 {
        if angle == 0.0 {
            return axis;
        }
        let local = warp::sample_cone([self.unit(), self.unit()], 1.0 - angle.cos());
        Frame::from_z(axis).to_world(local).normalize()
    }

    /// A point on something opaque, or, now and then, one that light can reach from any side.
    pub fn receiver(&mut self, half: f32) -> Receiver {
        let p = self.in_box(half);
        let n = (self.index(5) > 0).then(|| self.direction());
        Receiver { n, ..Receiver::everywhere(p) }
    }

    /// A small surface, a point, or a narrow beam.
    pub fn light(&mut self, half: f32) -> LightBounds {
        let p = self.in_box(half);
        let size = if self.index(3) == 0 { Vec3::ZERO } else { self.in_box(0.05 * half).abs() };
        let (cos_normals, cos_emission) = match self.index(4) {
            0 => (-1.0, 0.0),
            1 => (1.0, self.range(0.0, 1.0)),
            2 => (self.range(-1.0, 1.0), 0.0),
            _ => (1.0, 0.0),
        };
        LightBounds {
            bounds: Bounds { min: p - size, max: p + size },
            axis: self.direction(),
            cos_normals,
            cos_emission,
            intensity: self.unit().powi(4) + 1e-3,
            two_sided: cos_normals > 0.0 && self.index(3) == 0,
        }
    }
}

/// The lowest and the highest of `values`.
pub fn range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
