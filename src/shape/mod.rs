//! Shapes as they are traced, and what is known at a point on them.

mod any;
mod mesh;
mod motion;
mod round;

pub use any::{Placement, Shape, SurfaceGeometry};
pub use mesh::{Attribute, Mesh, SurfacePoint};
pub use motion::MeshMotion;
pub use round::{RoundMotion, RoundSurface, Rounds};
