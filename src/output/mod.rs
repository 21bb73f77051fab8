//! Files out: the multi-layer EXR that production reads, a PNG to look at, the state that a render goes on from, reports.

pub mod exr;
mod file;
mod metadata;
pub mod png;
pub mod report;
pub mod state;

pub use file::check_writable;
pub use metadata::Metadata;
