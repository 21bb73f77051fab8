//! What ends a path whatever it carries, and what one of its contributions may add at most.

use crate::math::Rgb;
use crate::scene::PathState;
use crate::settings::Settings;

/// Limits of a render's paths, as Cycles has them.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    scatterings: u32,
    /// Of diffuse, glossy and transmitting lobes.
    by_lobe: [u32; 3],
    /// Largest sums of the three channels, of light that was scattered once or never and of other light.
    sums: [f32; 2],
}

impl Limits {
    /// Of rays that look for the first surface and scatter nowhere.
    pub const NONE: Self = Self { scatterings: u32::MAX, by_lobe: [u32::MAX; 3], sums: [f32::INFINITY; 2] };

    /// Those of `settings` for paths of at most `max_bounces` scatterings after the first hit.
    pub fn of(settings: &Settings, max_bounces: u32) -> Self {
        let of_lobe = |limit: Option<u32>| limit.unwrap_or(max_bounces).min(max_bounces);
        let sum = |clamp: f64| if clamp > 0.0 { 3.0 * clamp as f32 } else { f32::INFINITY };
        Self {
            scatterings: max_bounces,
            by_lobe: [settings.diffuse_bounces, settings.glossy_bounces, settings.transmission_bounces].map(of_lobe),
            sums: [sum(settings.clamp_direct), sum(settings.clamp_indirect)],
        }
    }

    /// True after `scatterings`, of which `state` knows the kinds: what is met now is seen for what it emits, and
    /// nothing more.
    #[inline]
    pub fn exhausted(&self, scatterings: u32, state: &PathState) -> bool {
        let [diffuse, glossy, transmission] = self.by_lobe;
        scatterings > self.scatterings
            || u32::from(state.diffuse) > diffuse
            || u32::from(state.glossy) > glossy
            || u32::from(state.transmission) > transmission
    }

    /// `l`, which was scattered so many times, dimmed to what one contribution may add.
    #[inline]
    pub fn clamp(&self, l: Rgb, scatterings: u32) -> Rgb {
        l * self.factor(l, scatterings)
    }

    /// What [`Self::clamp`] multiplies by.
    #[inline]
    pub fn factor(&self, l: Rgb, scatterings: u32) -> f32 {
        let most = self.sums[usize::from(scatterings > 1)];
        let sum = l.r.abs() + l.g.abs() + l.b.abs();
        if sum > most { most / sum } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::RayKind::{self, Diffuse, Glossy, Transmission};

    #[test]
    fn each_kind_of_scattering_has_its_own_limit() {
        let settings = Settings { diffuse_bounces: Some(1), glossy_bounces: Some(0), ..Settings::default() };
        let limits = Limits::of(&settings, 2);
        let after = |kinds: &[RayKind]| {
            let state = kinds.iter().fold(PathState::CAMERA, |state, &kind| state.scattered(kind, false));
            limits.exhausted(kinds.len() as u32, &state)
        };
        assert!(!after(&[]) && !after(&[Diffuse]) && after(&[Diffuse, Diffuse]));
        assert!(after(&[Glossy]) && after(&[Diffuse, Glossy]));
        assert!(!after(&[Transmission, Transmission]) && after(&[Transmission; 3]));
    }

    #[test]
    fn contributions_keep_their_color_when_they_are_clamped() {
        let settings = Settings { clamp_indirect: 2.0, ..Settings::default() };
        let limits = Limits::of(&settings, 12);
        let bright = Rgb::new(9.0, 2.0, 1.0);
        assert_eq!(limits.clamp(bright, 1), bright, "direct light is not");
        assert_eq!(limits.clamp(bright, 2), bright * 0.5);
        assert_eq!(limits.clamp(bright * 0.5, 2), bright * 0.5);
    }
}
