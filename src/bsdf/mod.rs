//! Scattering at surfaces.
//!
//! Directions are unit, local, with z along the shading normal; `wo` points to the camera, `wi` to
//! the light, both on either side. One file per lobe; [`Bsdf`] composes them to the surface of
//! glTF 2.0 and of Blender's Principled node.

mod energy;
mod fresnel;
mod ggx;
mod lambert;
mod principled;
#[cfg(test)]
mod quadrature;
mod reflection;
mod refraction;
mod response;
mod surface;
mod thin;
mod view;

pub use fresnel::{f0_from_eta, fresnel_dielectric};
pub use principled::Bsdf;
pub use response::{BsdfEval, BsdfSample, ByLobe, Lobe};
pub use surface::Surface;
pub use view::View;
