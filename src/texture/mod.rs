//! Images looked up along rays (mip pyramids in the stored size, filtered by the ray's footprint),
//! textures computed from a position ([`procedural`]) or a direction ([`sky`]), and graphs of them ([`graph`]).

mod area;
mod blend;
pub mod graph;
mod image;
mod lookup;
pub mod procedural;
mod pyramid;
pub mod sky;
mod srgb;
mod texel;
mod transform;

pub use image::Image;
pub use lookup::Texture;
pub use transform::{TextureRef, UvTransform};
