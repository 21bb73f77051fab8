//! Shapes as they are traced, and what is known at a point on them.

mod mesh;

pub use mesh::{Attribute, Mesh, SurfacePoint};
