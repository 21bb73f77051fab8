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
//! plain textures ([`TextureRef`](super::TextureRef)). Others are averaged over the differences of their
//! coordinates between the hit and two points one footprint beside it, on the plane of the triangle; whole
//! numbers are taken off these, for images repeat. Bumps evaluate their height at two such points.

mod affine;
mod allocate;
mod compile;
mod hit;
mod procedural;
mod program;
mod steps;

#[cfg(test)]
mod tests;

pub use compile::{Compiled, Compiler, Resolve, Resolved};
pub use hit::{Beside, HERE, Hit};
pub use program::{Asks, Program};
