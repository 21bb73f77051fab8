//! Point patterns, one file each, and the list of them.
//!
//! Adding one: its file, a line in [`PATTERNS`], a variant, and its two arms in `Sampler`.

pub(super) mod independent;
pub(super) mod sobol;

use super::Dimension;
use super::hash::{GOLDEN, mix64};

/// How the points of the samples of a pixel are laid out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pattern {
    /// Owen-scrambled Sobol (0,2)-sequences, one per decision.
    #[default]
    Sobol,
    /// Independent random numbers.
    Independent,
}

/// A pattern's name on the command line and its help.
#[derive(Clone, Copy, Debug)]
pub struct PatternInfo {
    /// The pattern.
    pub pattern: Pattern,
    /// Name that users type.
    pub name: &'static str,
    /// One line for the help.
    pub help: &'static str,
}

/// All patterns, the default first.
pub const PATTERNS: &[PatternInfo] = &[
    PatternInfo {
        pattern: Pattern::Sobol,
        name: "sobol",
        help: "Owen-scrambled Sobol points: the error falls faster than with random points",
    },
    PatternInfo {
        pattern: Pattern::Independent,
        name: "independent",
        help: "independent random points: the plain Monte Carlo rate, for comparison",
    },
];

impl Pattern {
    /// The pattern that users call `name`; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        PATTERNS.iter().find(|info| info.name == name).map(|info| info.pattern)
    }

    /// Name that users type.
    pub fn name(self) -> &'static str {
        PATTERNS.iter().find(|info| info.pattern == self).map_or("", |info| info.name)
    }
}

/// What a pattern knows of a sample: which pixel (hashed, with the user's seed) and which sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) seed: u64,
    pub(super) index: u32,
    /// `index` with its bits reversed, as Owen scrambling wants it in every dimension.
    reversed_index: u32,
}

impl Point {
    pub(super) fn new(seed: u64, index: u32) -> Self {
        Self { seed, index, reversed_index: index.reverse_bits() }
    }

    /// 64 random bits for this pixel and decision, the same for all samples.
    #[inline]
    fn hash(&self, dimension: Dimension) -> u64 {
        mix64(self.seed ^ u64::from(dimension.index()).wrapping_mul(GOLDEN))
    }
}
