//! Shadows that are not black or do not reach everywhere (UsdLux ShadowAPI).

use crate::math::Rgb;

/// How the shadows of a light look; lights whose shadows are black and without end have none of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowLook {
    /// Share of the light that arrives in full shadow.
    color: Rgb,
    /// Metres from the receiver within which a blocker counts; may be infinite.
    distance: f32,
    /// Metres before `distance` over which a blocker counts less and less; at most `distance`.
    falloff: f32,
    gamma: f32,
}

impl ShadowLook {
    /// Lengths are in metres, `distance` is infinite for shadows without end; a `falloff` beyond it ends where
    /// it does. `None` for shadows that are black and without end.
    pub fn new(color: Rgb, distance: f32, falloff: f32, gamma: f32) -> Option<Self> {
        let falloff = if distance.is_finite() { falloff.min(distance) } else { 0.0 };
        (!color.is_black() || distance.is_finite()).then_some(Self { color, distance, falloff, gamma })
    }

    /// Metres from the receiver at which blockers cease to count.
    pub fn distance(&self) -> f32 {
        self.distance
    }

    /// True where they count less and less up to there.
    pub fn fades(&self) -> bool {
        self.falloff > 0.0
    }

    /// How much a blocker counts that is `dist` metres from the receiver: 1 up to where the zone of falloff begins,
    /// `((distance − dist) / falloff)^gamma` in it, 0 beyond.
    pub fn strength(&self, dist: f32) -> f32 {
        let left = self.distance - dist;
        match () {
            () if left <= 0.0 => 0.0,
            () if left >= self.falloff => 1.0,
            () => (left / self.falloff).powf(self.gamma),
        }
    }

    /// Share of the light that arrives where `visible` of it passes all blockers: `color + (1 − color) · visible`.
    pub fn arriving(&self, visible: Rgb) -> Rgb {
        self.color.zip(visible, |color, visible| color + (1.0 - color) * visible)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blockers_count_by_their_distance() {
        let look = |falloff, gamma| ShadowLook::new(Rgb::BLACK, 4.0, falloff, gamma).unwrap();
        for (look, expected) in [
            (look(0.0, 1.0), [1.0, 1.0, 1.0, 0.0, 0.0]),
            (look(2.0, 1.0), [1.0, 1.0, 0.5, 0.0, 0.0]),
            (look(2.0, 2.0), [1.0, 1.0, 0.25, 0.0, 0.0]),
            // No longer than the distance itself.
            (look(9.0, 1.0), [1.0, 0.5, 0.25, 0.0, 0.0]),
        ] {
            assert_eq!([0.0, 2.0, 3.0, 4.0, 5.0].map(|dist| look.strength(dist)), expected, "{look:?}");
        }
    }

    #[test]
    fn what_is_no_look_is_none() {
        assert_eq!(ShadowLook::new(Rgb::BLACK, f32::INFINITY, 1.0, 2.0), None);
        let red = ShadowLook::new(Rgb::new(0.5, 0.0, 0.0), f32::INFINITY, 1.0, 2.0).unwrap();
        assert_eq!((red.strength(1e30), red.fades()), (1.0, false));
        assert_eq!(red.arriving(Rgb::BLACK), Rgb::new(0.5, 0.0, 0.0));
        assert_eq!(red.arriving(Rgb::splat(0.5)), Rgb::new(0.75, 0.5, 0.5));
        assert_eq!(red.arriving(Rgb::WHITE), Rgb::WHITE);
    }
}
