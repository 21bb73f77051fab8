//! Penumbra: a production render engine for shadows, ambient occlusion and honest noise figures.

pub mod desc;
pub mod error;
pub mod film;
pub mod import;
pub mod math;
pub mod output;
pub mod texture;
