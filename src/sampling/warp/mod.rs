//! Warps: maps of the unit square onto domains, each with its density.
//!
//! Directions are local with the axis along z; densities of directions are in solid angle. All are
//! bijections without branches that depend on rejected points, so well spread points stay so.

mod cone;
mod disk;
mod elliptic_cone;
mod hemisphere;
mod spherical_rect;
mod spherical_triangle;
mod triangle;

pub use cone::{one_minus_cos, pdf_cone, sample_cone};
pub use disk::{PDF_DISK, sample_disk};
pub use elliptic_cone::EllipticCone;
pub use hemisphere::{
    PDF_UNIFORM_HEMISPHERE, PDF_UNIFORM_SPHERE, pdf_cosine_hemisphere, sample_cosine_hemisphere,
    sample_uniform_hemisphere, sample_uniform_sphere,
};
pub use spherical_rect::SphericalRect;
pub use spherical_triangle::{SphericalTriangle, solid_angle_of_triangle};
pub use triangle::sample_triangle;
