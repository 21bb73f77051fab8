//! The parameters of a surface at a point.

use crate::math::Rgb;

/// A surface's parameters where it was hit, textures evaluated. Values outside their ranges are
/// clamped by [`super::Bsdf::new`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Diffuse albedo of a dielectric, reflectance of a metal at normal incidence, tint of what is
    /// transmitted; 0 to 1.
    pub base_color: Rgb,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1; the microfacet width is its square.
    pub roughness: f32,
    /// Index of refraction of the inside over the outside. 0 stands for infinite, as in
    /// KHR_materials_ior; where it is below 1, opaque parts take its inverse.
    pub ior: f32,
    /// Weight of the dielectric's reflection, 0 to 1 (KHR_materials_specular).
    pub specular: f32,
    /// Tint of the dielectric's reflection at normal incidence, from 0; the product with the
    /// reflectance stops at 1.
    pub specular_color: Rgb,
    /// Share of a dielectric's light that passes instead of scattering beneath the surface, 0 to 1.
    pub transmission: f32,
    /// True for a sheet without inside: what passes isn't bent and is tinted once by `base_color`;
    /// else each boundary bends it and tints by the square root of `base_color`.
    pub thin: bool,
}

impl Default for Surface {
    /// A white diffuse dielectric of index 1.5.
    fn default() -> Self {
        Self {
            base_color: Rgb::WHITE,
            metallic: 0.0,
            roughness: 1.0,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::WHITE,
            transmission: 0.0,
            thin: false,
        }
    }
}
