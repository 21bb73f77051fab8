//! Scattering at surfaces.
//!
//! Directions are unit, local, with z along the shading normal; `wo` points to the camera, `wi` to
//! the light, both on either side. One file per lobe, listed in `lobe.rs`; `principled.rs` composes
//! them to the layered surface that all doors share, `closure.rs` lists the single lobes that shader
//! nodes name, and a [`Bsdf`] is the mixture that comes of it, seen from one direction.

mod cie;
mod closure;
mod conductor;
mod energy;
mod fresnel;
mod ggx;
mod glass;
mod lambert;
mod lobe;
mod medium;
mod mixture;
mod oren_nayar;
mod principled;
mod profile;
#[cfg(test)]
mod quadrature;
mod reflection;
mod refraction;
mod response;
mod sheen;
mod softening;
mod subsurface;
mod surface;
#[cfg(test)]
mod tabulate;
mod thin;
mod thin_film;
mod toon;
mod translucent;
mod upright;

pub use closure::{Closure, Microfacets};
pub use conductor::Conductor;
pub use fresnel::{f0_from_eta, fresnel_dielectric};
pub use medium::Medium;
pub use mixture::{Bsdf, Builder, Widening};
pub use principled::{coat_albedo, sheen_albedo};
pub use profile::Profile;
pub use response::{BsdfEval, BsdfSample, ByLobe, Features, Lobe};
pub use softening::Softening;
pub use subsurface::{Beneath, Inside, Method, Subsurface};
pub use surface::{Coat, Sheen, Stretched, Surface, ThinFilm};
