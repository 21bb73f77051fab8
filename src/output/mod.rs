//! Files out: the multi-layer EXR that production reads, and a PNG to look at.

pub mod exr;
mod file;
mod metadata;
pub mod png;

pub use file::check_writable;
pub use metadata::Metadata;
