//! The single lobes that shader nodes name, with what they are made of.

use super::fresnel::{Dielectric, Metal, f0_from_eta};
use super::ggx::Ggx;
use super::glass::{Boundary, Glass};
use super::lambert::Lambert;
use super::mixture::{Builder, Class};
use super::oren_nayar::OrenNayar;
use super::principled;
use super::reflection::{Fresnel, Reflection};
use super::sheen::SheenLobe;
use super::subsurface::Subsurface;
use super::surface::{Stretched, Surface, ThinFilm};
use super::thin_film::{Base, Film, THINNEST};
use super::toon::Toon;
use super::translucent::Translucent;
use super::{Conductor, surface::Sheen};
use crate::math::{Frame, Rgb, sqr};

/// Microfacets of a lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets<S = f32> {
    /// Perceptual roughness, 0 to 1.
    pub roughness: S,
    /// Widths along two directions, where they differ.
    pub stretched: Option<Stretched>,
    /// True where light that scatters between them is not lost.
    pub multiscatter: bool,
}

/// One term of a mixture, with colors of type `C` and numbers of type `S` as in [`Surface`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closure<C = Rgb, S = f32> {
    /// All layers.
    Layered(Surface<C, S>),
    /// Diffuse reflection, roughness 0 for Lambert's.
    Diffuse {
        /// Albedo.
        color: C,
        /// 0 to 1.
        roughness: S,
        /// True where light that scatters more than once is not lost.
        multiscatter: bool,
    },
    /// Scattering beneath the surface, its weight counted.
    Beneath {
        /// What is there.
        subsurface: Subsurface<C, S>,
        /// Width of the microfacets through which light goes in, 0 to 1.
        alpha: S,
    },
    /// Diffuse passage.
    Translucent {
        /// Albedo.
        color: C,
    },
    /// Reflection of the same color from everywhere.
    Glossy {
        /// Color.
        color: C,
        /// Its microfacets.
        facets: Microfacets<S>,
    },
    /// Reflection at metal, by two reflectances.
    Metal {
        /// At normal incidence.
        base: C,
        /// At 82 degrees, over that of Schlick's curve.
        edge: C,
        /// Its microfacets.
        facets: Microfacets<S>,
        /// On it.
        film: Option<ThinFilm<S>>,
    },
    /// Reflection at metal, by its index.
    Conductor {
        /// The index.
        index: Conductor<C>,
        /// Its microfacets.
        facets: Microfacets<S>,
        /// On it.
        film: Option<ThinFilm<S>>,
    },
    /// Reflection and refraction.
    Glass {
        /// Color of both.
        color: C,
        /// Index of the inside over the outside.
        ior: S,
        /// Its microfacets.
        facets: Microfacets<S>,
        /// On it.
        film: Option<ThinFilm<S>>,
    },
    /// Refraction alone.
    Refraction {
        /// Color.
        color: C,
        /// Index of the inside over the outside.
        ior: S,
        /// Its microfacets.
        facets: Microfacets<S>,
    },
    /// Fibers.
    Sheen(Sheen<C, S>),
    /// Light within a cone.
    Toon {
        /// Color.
        color: C,
        /// Angle up to which it is full, and the width of its edge, as shares of a right angle.
        size: [S; 2],
        /// About the mirror direction instead of the normal.
        glossy: bool,
    },
}

impl<S> Microfacets<S> {
    /// See [`Surface::map`].
    fn map<T>(&self, scalar: impl FnOnce(&S) -> T) -> Microfacets<T> {
        Microfacets { roughness: scalar(&self.roughness), stretched: self.stretched, multiscatter: self.multiscatter }
    }
}

impl<C, S> Closure<C, S> {
    /// See [`Surface::map`].
    pub fn map<D, T>(&self, mut c: impl FnMut(&C) -> D, mut s: impl FnMut(&S) -> T) -> Closure<D, T> {
        match self {
            Self::Layered(surface) => Closure::Layered(surface.map(c, s)),
            Self::Diffuse { color, roughness, multiscatter } => {
                Closure::Diffuse { color: c(color), roughness: s(roughness), multiscatter: *multiscatter }
            }
            Self::Beneath { subsurface, alpha } => {
                Closure::Beneath { subsurface: subsurface.map(c, &mut s), alpha: s(alpha) }
            }
            Self::Translucent { color } => Closure::Translucent { color: c(color) },
            Self::Glossy { color, facets } => Closure::Glossy { color: c(color), facets: facets.map(s) },
            Self::Metal { base, edge, facets, film } => Closure::Metal {
                base: c(base),
                edge: c(edge),
                facets: facets.map(&mut s),
                film: film.as_ref().map(|film| film.map(s)),
            },
            Self::Conductor { index, facets, film } => Closure::Conductor {
                index: Conductor { eta: c(&index.eta), k: c(&index.k) },
                facets: facets.map(&mut s),
                film: film.as_ref().map(|film| film.map(s)),
            },
            Self::Glass { color, ior, facets, film } => Closure::Glass {
                color: c(color),
                ior: s(ior),
                facets: facets.map(&mut s),
                film: film.as_ref().map(|film| film.map(s)),
            },
            Self::Refraction { color, ior, facets } => {
                Closure::Refraction { color: c(color), ior: s(ior), facets: facets.map(s) }
            }
            Self::Sheen(sheen) => Closure::Sheen(sheen.map(c, s)),
            Self::Toon { color, size: [size, smooth], glossy } => {
                Closure::Toon { color: c(color), size: [s(size), s(smooth)], glossy: *glossy }
            }
        }
    }
}

/// `x` within 0 to 1; 0 for NaN.
pub(super) fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}

/// `base` beneath `film`, if there is one.
pub(super) fn beneath(film: &Option<ThinFilm>, base: Base) -> Option<Film> {
    film.as_ref()
        .filter(|film| film.thickness > THINNEST && film.weight > 0.0)
        .map(|film| Film::new(base, film.thickness, film.ior, unit(film.weight)))
}

impl Builder<'_> {
    /// Adds `closure` times `weight`, in the frame that was set last.
    pub fn add(&mut self, weight: Rgb, closure: &Closure) {
        match closure {
            Closure::Layered(surface) => principled::add(self, weight, surface),
            Closure::Diffuse { color, roughness, multiscatter } => {
                self.add_diffuse(weight, *color, *roughness, *multiscatter);
            }
            Closure::Beneath { subsurface, alpha } => {
                self.add_beneath(weight * unit(subsurface.weight), subsurface, *alpha)
            }
            Closure::Translucent { color } => self.push(weight * *color, Class::Diffuse, None, Translucent),
            Closure::Glossy { color, facets } => {
                self.add_reflection(weight, Fresnel::Constant(color.map(|c| c.max(0.0))), facets);
            }
            Closure::Metal { base, edge, facets, film } => {
                let metal = Metal::new(base.map(unit), edge.map(unit));
                let fresnel = beneath(film, Base::Metal(metal)).map_or(Fresnel::Metal(metal), Fresnel::Film);
                self.add_reflection(weight, fresnel, facets);
            }
            Closure::Conductor { index, facets, film } => {
                let fresnel = beneath(film, Base::Conductor(*index)).map_or(Fresnel::Conductor(*index), Fresnel::Film);
                self.add_reflection(weight, fresnel, facets);
            }
            Closure::Glass { color, ior, facets, film } => self.add_boundary(weight, *color, *ior, facets, film, true),
            Closure::Refraction { color, ior, facets } => {
                self.add_boundary(weight, *color, *ior, facets, &None, false);
            }
            Closure::Sheen(sheen) => {
                if let Some(lobe) = SheenLobe::new(unit(sheen.roughness), self.wo(None)) {
                    self.push(weight * sheen.color, Class::Diffuse, None, lobe);
                }
            }
            Closure::Toon { color, size: [size, smooth], glossy } => {
                let class = if *glossy { Class::Interface } else { Class::Diffuse };
                self.push(weight * *color, class, None, Toon::new(*size, *smooth, *glossy));
            }
        }
    }

    /// A microfacet distribution, and the frame it is stretched along.
    pub(super) fn facets(&self, roughness: f32, stretched: &Option<Stretched>) -> (Option<Ggx>, Option<Frame>) {
        match stretched {
            Some(stretched) => (self.ggx(stretched.alpha), Some(stretched.frame)),
            None => (self.ggx([sqr(unit(roughness)); 2]), None),
        }
    }

    pub(super) fn add_diffuse(&mut self, weight: Rgb, color: Rgb, roughness: f32, multiscatter: bool) {
        if unit(roughness) < 1e-5 {
            self.push(weight * color, Class::Diffuse, None, Lambert);
        } else {
            let lobe = OrenNayar::new(color, roughness, multiscatter, self.wo(None));
            self.push(weight * color, Class::Diffuse, None, lobe);
        }
    }

    fn add_reflection(
        &mut self,
        color: Rgb,
        fresnel: Fresnel,
        Microfacets { roughness, stretched, multiscatter }: &Microfacets,
    ) {
        let (ggx, frame) = self.facets(*roughness, stretched);
        let frame = self.frame(frame);
        let frame = self.upright(frame);
        let lobe = Reflection::new(ggx, fresnel, *multiscatter, self.wo(frame));
        self.push(color, Class::Interface, frame, lobe);
    }

    fn add_boundary(
        &mut self,
        weight: Rgb,
        color: Rgb,
        ior: f32,
        facets: &Microfacets,
        film: &Option<ThinFilm>,
        reflects: bool,
    ) {
        let ior = if ior > 0.0 && ior.is_finite() { ior.clamp(1e-3, 1e3) } else { 1.0 };
        let eta = if self.entering() { ior } else { 1.0 / ior };
        let fresnel = Dielectric::new(eta, Rgb::splat(f0_from_eta(ior)), 1.0);
        let film = self.film_seen(film, ior);
        let boundary = Boundary {
            fresnel,
            film: beneath(&film, Base::Dielectric(fresnel)),
            reflects,
            tints: [color.map(|c| c.max(0.0)); 2],
            thin: false,
        };
        let ggx = self.ggx([sqr(unit(facets.roughness)); 2]);
        let frame = self.upright(None);
        let lobe = Glass::new(ggx, boundary, facets.multiscatter && reflects, self.wo(frame));
        self.push(weight, Class::Interface, frame, lobe);
    }
}
