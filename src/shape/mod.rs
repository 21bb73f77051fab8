//! Shapes as they are traced, and what is known at a point on them.

mod any;
mod mesh;
mod round;

pub use any::{Placement, Shape, SurfaceGeometry};
pub use mesh::{Attribute, Mesh, SurfacePoint};
pub use round::{RoundSurface, Rounds};
