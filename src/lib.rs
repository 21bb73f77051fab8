//! Penumbra: a production render engine for shadows, ambient occlusion and honest noise figures.

pub mod bvh;
pub mod camera;
pub mod desc;
pub mod error;
pub mod film;
pub mod import;
pub mod light;
pub mod math;
pub mod sampling;
pub mod shape;
