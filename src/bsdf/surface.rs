//! The parameters of the layered surface.
//!
//! Colors are of type `C` and numbers of type `S`: values at a point, or the inputs of a material from which they
//! are evaluated.

use super::Subsurface;
use crate::math::{Frame, Rgb};

/// A surface's parameters. Values outside their ranges are clamped when it is added to a [`super::Bsdf`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<C = Rgb, S = f32> {
    /// Diffuse albedo of a dielectric, reflectance of a metal at normal incidence, tint of what is
    /// transmitted; 0 to 1.
    pub base_color: C,
    /// True where `base_color` may be above 1 for the diffuse part.
    pub gains: bool,
    /// 0 dielectric, 1 metal.
    pub metallic: S,
    /// What a metal reflects near grazing, at 82 degrees, over what it would by Schlick's curve.
    pub metal_edge: C,
    /// Roughness of the diffuse part, 0 (Lambert) to 1.
    pub diffuse_roughness: S,
    /// Perceptual roughness, 0 to 1; the microfacet width is its square.
    pub roughness: S,
    /// Microfacet widths along x and y of the frame, for reflection, where they differ.
    pub stretched: Option<Stretched>,
    /// True where light that scatters between microfacets is not lost.
    pub multiscatter: bool,
    /// Index of refraction of the inside over the outside. 0 stands for infinite, as in
    /// KHR_materials_ior; where it is below 1, opaque parts take its inverse.
    pub ior: S,
    /// Weight of the dielectric's reflection, 0 to 1 (KHR_materials_specular).
    pub specular: S,
    /// Tint of the dielectric's reflection at normal incidence, from 0; the product with the
    /// reflectance stops at 1.
    pub specular_color: C,
    /// Factor of the opaque dielectric's reflectance at normal incidence that changes its index with it
    /// (twice Blender's Specular IOR Level).
    pub specular_level: S,
    /// Share of a dielectric's light that passes instead of scattering beneath the surface, 0 to 1.
    pub transmission: S,
    /// True for a sheet without inside: what passes isn't bent and is tinted once by `base_color`;
    /// else each boundary bends it and tints by the square root of `base_color`.
    pub thin: bool,
    /// Share of the diffuse light that leaves on the other side, 0 to 1.
    pub translucent: S,
    /// Its color, in place of `base_color`.
    pub translucent_color: C,
    /// Light that scatters beneath, in place of diffuse light.
    pub subsurface: Option<Subsurface<C, S>>,
    /// A clear layer on top.
    pub coat: Option<Coat<C, S>>,
    /// Fibers on top of all.
    pub sheen: Option<Sheen<C, S>>,
    /// A thin film beneath the coat.
    pub film: Option<ThinFilm<S>>,
}

/// Microfacets that are wider along one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretched {
    /// Widths along x and y of `frame`.
    pub alpha: [f32; 2],
    /// In the surface's own frame; z is the normal of both.
    pub frame: Frame,
}

/// A clear coat: a dielectric that absorbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat<C = Rgb, S = f32> {
    /// 0 to 1.
    pub weight: S,
    /// Perceptual roughness.
    pub roughness: S,
    /// Index of refraction, from 1.
    pub ior: S,
    /// What is left of light that goes through it straight down and up.
    pub tint: C,
    /// Its normal as a frame within the surface's own, where it has one.
    pub frame: Option<Frame>,
}

/// Fibers that stand off the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheen<C = Rgb, S = f32> {
    /// Weight times tint.
    pub color: C,
    /// 0 to 1.
    pub roughness: S,
}

/// A film so thin that light interferes in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinFilm<S = f32> {
    /// Nanometres.
    pub thickness: S,
    /// Index of refraction.
    pub ior: S,
    /// How much of the surface has it, 0 to 1.
    pub weight: S,
    /// False where metal has none.
    pub on_metal: bool,
}

impl Default for Surface {
    /// A white diffuse dielectric of index 1.5.
    fn default() -> Self {
        Self {
            base_color: Rgb::WHITE,
            gains: false,
            metallic: 0.0,
            metal_edge: Rgb::WHITE,
            diffuse_roughness: 0.0,
            roughness: 1.0,
            stretched: None,
            multiscatter: true,
            ior: 1.5,
            specular: 1.0,
            specular_color: Rgb::WHITE,
            specular_level: 1.0,
            transmission: 0.0,
            thin: false,
            translucent: 0.0,
            translucent_color: Rgb::WHITE,
            subsurface: None,
            coat: None,
            sheen: None,
            film: None,
        }
    }
}

impl<C, S> Surface<C, S> {
    /// The same surface with other types of color and number.
    pub fn map<D, T>(&self, mut color: impl FnMut(&C) -> D, mut scalar: impl FnMut(&S) -> T) -> Surface<D, T> {
        Surface {
            base_color: color(&self.base_color),
            gains: self.gains,
            metallic: scalar(&self.metallic),
            metal_edge: color(&self.metal_edge),
            diffuse_roughness: scalar(&self.diffuse_roughness),
            roughness: scalar(&self.roughness),
            stretched: self.stretched,
            multiscatter: self.multiscatter,
            ior: scalar(&self.ior),
            specular: scalar(&self.specular),
            specular_color: color(&self.specular_color),
            specular_level: scalar(&self.specular_level),
            transmission: scalar(&self.transmission),
            thin: self.thin,
            translucent: scalar(&self.translucent),
            translucent_color: color(&self.translucent_color),
            subsurface: self.subsurface.as_ref().map(|beneath| beneath.map(&mut color, &mut scalar)),
            coat: self.coat.as_ref().map(|coat| Coat {
                weight: scalar(&coat.weight),
                roughness: scalar(&coat.roughness),
                ior: scalar(&coat.ior),
                tint: color(&coat.tint),
                frame: coat.frame,
            }),
            sheen: self.sheen.as_ref().map(|sheen| sheen.map(&mut color, &mut scalar)),
            film: self.film.as_ref().map(|film| film.map(&mut scalar)),
        }
    }
}

impl<C, S> Sheen<C, S> {
    /// See [`Surface::map`].
    pub fn map<D, T>(&self, color: impl FnOnce(&C) -> D, scalar: impl FnOnce(&S) -> T) -> Sheen<D, T> {
        Sheen { color: color(&self.color), roughness: scalar(&self.roughness) }
    }
}

impl<S> ThinFilm<S> {
    /// See [`Surface::map`].
    pub fn map<T>(&self, mut scalar: impl FnMut(&S) -> T) -> ThinFilm<T> {
        let Self { thickness, ior, weight, on_metal } = self;
        ThinFilm { thickness: scalar(thickness), ior: scalar(ior), weight: scalar(weight), on_metal: *on_metal }
    }
}
