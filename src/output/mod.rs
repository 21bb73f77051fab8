//! Files out: the multi-layer EXR that production reads, a PNG to look at, and the state that a render goes on from.

pub mod exr;
mod file;
mod metadata;
pub mod png;
pub mod state;

pub use file::check_writable;
pub use metadata::Metadata;
