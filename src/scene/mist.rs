//! Mist that grows with the distance from the camera.

use super::Scene;
use crate::math::{Vec3, sqr};
use crate::settings::{MistFalloff, Settings};

/// Where mist begins and ends, and how it grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mist {
    start: f32,
    /// Over 1: the distance from start to end; 0 where there is none.
    per_depth: f32,
    falloff: MistFalloff,
}

impl Mist {
    /// As set.
    pub fn of(settings: &Settings) -> Self {
        let depth = settings.mist_depth as f32;
        let per_depth = if depth > 0.0 { 1.0 / depth } else { 0.0 };
        Self { start: settings.mist_start as f32, per_depth, falloff: settings.mist_falloff }
    }

    /// How thick it is at `distance`: 0 to 1.
    fn at(&self, distance: f32) -> f32 {
        let share = ((distance - self.start) * self.per_depth).clamp(0.0, 1.0);
        match self.falloff {
            MistFalloff::Linear => share,
            MistFalloff::Quadratic => sqr(share),
            MistFalloff::InverseQuadratic => share.sqrt(),
        }
    }
}

impl Scene {
    /// How much of the view to `p` is clear: 1 less the mist.
    pub fn clear_of_mist(&self, p: Vec3) -> f32 {
        1.0 - self.mist.at(self.camera.distance(p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mist_grows_from_its_start_to_its_end() {
        let mist = |mist_falloff, mist_depth| {
            Mist::of(&Settings { mist_start: 2.0, mist_depth, mist_falloff, ..Settings::default() })
        };
        for (falloff, half) in
            [(MistFalloff::Linear, 0.25), (MistFalloff::Quadratic, 0.0625), (MistFalloff::InverseQuadratic, 0.5)]
        {
            let mist = mist(falloff, 8.0);
            assert_eq!([0.0, 2.0, 4.0, 10.0, f32::INFINITY].map(|d| mist.at(d)), [0.0, 0.0, half, 1.0, 1.0]);
        }
        // As in Cycles: none where it has no depth.
        assert_eq!(mist(MistFalloff::Linear, 0.0).at(5.0), 0.0);
    }
}
