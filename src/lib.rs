//! Penumbra: a production render engine for shadows, ambient occlusion and honest noise figures.

pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod desc;
pub mod error;
pub mod film;
pub mod import;
pub mod integrator;
pub mod light;
pub mod math;
pub mod output;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod settings;
pub mod shape;
pub mod texture;
