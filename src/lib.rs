//! Penumbra: a production render engine for shadows, ambient occlusion and honest noise figures.

pub mod bvh;
pub mod error;
pub mod math;
