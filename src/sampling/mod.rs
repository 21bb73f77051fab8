//! Random decisions: point patterns, warps with their densities, discrete and image distributions,
//! and the weights of multiple importance sampling.
//!
//! A [`Sampler`] answers for one sample of one pixel; each decision of the path has a name, its
//! [`Dimension`], so that a decision which isn't drawn shifts no other.

mod dimension;
pub mod distribution;
mod hash;
mod mis;
mod pattern;
mod sampler;
pub mod warp;

pub use dimension::{Decision, Dimension};
pub use distribution::{AliasTable, BilinearImage, Distribution2d};
pub use mis::{balance_heuristic, power_heuristic};
pub use pattern::{PATTERNS, Pattern, PatternInfo};
pub use sampler::Sampler;
