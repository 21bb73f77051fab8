//! Shader graphs as they are evaluated at hits: programs of a few steps, each of which makes a value.
//!
//! ```text
//! desc::graph::Graph ─► compile: lower (fold, share, filter) ─► allocate registers ─► Program ─► run at a Hit
//! ```
//!
//! A material has one program for each question that is asked of it (what it lets pass, what it emits, what
//! scatters, which way its normal points), so that a shadow ray evaluates its opacity alone. Compiling folds
//! what is the same everywhere, shares what is computed twice, and drops what nothing uses; running takes its
//! registers from the stack and allocates nothing.
//!
//! **Filtering.** Image lookups whose coordinates are an affine map of one UV set become the very lookups of
//! plain textures ([`TextureRef`](super::TextureRef)). Others are averaged over as much as
//! their coordinates change along the ray's footprint, which two more evaluations tell that are a 64th of it
//! beside the hit, on the plane of the triangle. Bumps evaluate their height twice more, a footprint away.

mod affine;
mod allocate;
mod compile;
mod hit;
mod procedural;
mod program;
mod sky;
mod steps;

#[cfg(test)]
mod tests;

pub use compile::{Compiler, Resolve, Resolved};
pub use hit::{Beside, HERE, Hit, of_no_object};
pub use program::{Asks, Program};
pub use sky::{Sky, sun_disk};
