//! Names of the random decisions of a path.
//!
//! A decision is looked up by name and bounce and never by a running counter: an effect which the
//! scene lacks draws nothing and shifts nothing.

/// One random decision of a sample, in one or two dimensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Dimension(u32);

/// What is decided at a vertex of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum Decision {
    /// Which lobe scatters (1D).
    BsdfLobe,
    /// The direction in which it scatters (2D).
    BsdfDirection,
    /// Which light is asked (1D).
    LightChoice,
    /// The point on that light (2D).
    LightPoint,
    /// Whether the path goes on (1D).
    Roulette,
    /// Whether a surface with opacity counts as hit by the path's ray (1D).
    Opacity,
    /// The same for the ray to a light (1D).
    ShadowOpacity,
    /// Direction of an ambient occlusion ray (2D).
    Ao,
    /// Whether a surface with opacity counts as hit by an ambient occlusion ray (1D).
    AoOpacity,
    /// Point on a light for the shadow passes, where they draw their own (2D).
    ShadowPoint,
    /// Which light is asked for those (1D).
    ShadowChoice,
    /// For which channel a step beneath a surface is drawn (1D).
    WalkChannel,
    /// How far that step goes (1D).
    WalkDistance,
    /// In which direction (2D).
    WalkDirection,
    /// Whether it is guided (1D).
    WalkGuide,
    /// To which side (1D).
    WalkSide,
}

/// Decisions of the camera come first, then each bounce has `STRIDE` of its own.
const FIRST_BOUNCE: u32 = 16;
const STRIDE: u32 = 32;
/// Repetitions of a decision lie this far apart: room for 2¹⁵ bounces and 2¹² repetitions.
const REPETITION: u32 = 1 << 20;

impl Dimension {
    /// Position in the pixel filter (2D).
    pub const PIXEL: Self = Self(0);
    /// Point on the lens (2D).
    pub const LENS: Self = Self(1);
    /// Moment within the shutter (1D).
    pub const TIME: Self = Self(2);
    /// Whatever a caller that is no path tracer wants to draw.
    pub const FREE: Self = Self(3);

    /// `decision` at path vertex `bounce`; 0 is the camera's first hit.
    pub const fn at_bounce(bounce: u32, decision: Decision) -> Self {
        Self(FIRST_BOUNCE.wrapping_add(bounce.wrapping_mul(STRIDE)).wrapping_add(decision as u32))
    }

    /// The `k`-th repetition of this decision, for loops such as the surfaces along a ray; the
    /// 0th is the decision itself.
    pub const fn nth(self, k: u32) -> Self {
        Self(self.0.wrapping_add(k.wrapping_mul(REPETITION)))
    }

    /// The number by which patterns tell decisions apart.
    pub const fn index(self) -> u32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_are_distinct() {
        let decisions = [Decision::BsdfLobe, Decision::LightPoint, Decision::WalkSide];
        assert!((Decision::WalkSide as u32) < STRIDE);
        let mut seen = HashSet::from([Dimension::PIXEL, Dimension::LENS, Dimension::TIME, Dimension::FREE]);
        for bounce in (0..64).chain([(1 << 15) - 2]) {
            for decision in decisions {
                for k in [0, 1, 2, 4095] {
                    assert!(seen.insert(Dimension::at_bounce(bounce, decision).nth(k)));
                }
            }
        }
    }

    #[test]
    fn the_extremes_do_not_overflow() {
        let _ = Dimension::at_bounce(u32::MAX, Decision::Ao).nth(u32::MAX);
    }
}
