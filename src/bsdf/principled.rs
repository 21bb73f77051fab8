//! The layered surface of glTF 2.0 (metallic-roughness with KHR_materials_specular, _ior and
//! _transmission), which is Blender's Principled node: metal over transmission over the dielectric's
//! reflection over diffuse, the diffuse part scaled by what the reflection leaves.
//!
//! All reflections share one roughness, so they are one microfacet lobe whose Fresnel term is the
//! sum of theirs. Here is what doesn't depend on directions; `view.rs` has the rest.

use super::energy::{EtaPlace, RoughnessPlace, several_bounces};
use super::fresnel::{Dielectric, Metal, f0_from_eta};
use super::ggx::{Ggx, MIN_ALPHA};
use super::{BsdfEval, BsdfSample, ByLobe, Surface, View};
use crate::math::{Rgb, Vec3, sqr};

/// Where α |η − 1| is smaller, the spread of refraction can't be told from none.
const MIN_BEND: f32 = 2e-5;

/// Stands for an infinite index of refraction; the reflectance is 0.996.
const LARGEST_IOR: f32 = 1e3;

/// A surface ready to scatter. It depends on no direction, so the one of a surface without textures
/// can be kept, one for each side.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    /// `None` for a smooth surface.
    pub(super) rough: Option<Rough>,
    pub(super) metal: Option<MetalLayer>,
    pub(super) glass: Option<GlassLayer>,
    pub(super) specular: Option<SpecularLayer>,
    /// Diffuse albedo below the specular layer, times its weight.
    pub(super) diffuse: Rgb,
}

/// The microfacets.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rough {
    pub ggx: Ggx,
    pub place: RoughnessPlace,
}

/// Reflection at metal.
#[derive(Clone, Copy, Debug)]
pub(super) struct MetalLayer {
    pub fresnel: Metal,
    pub several_bounces: Rgb,
    pub weight: f32,
}

/// Reflection over the diffuse part.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpecularLayer {
    pub fresnel: Dielectric,
    pub place: EtaPlace,
    pub several_bounces: Rgb,
    pub weight: f32,
}

/// Reflection and passage at a boundary between transparent media or at a thin sheet.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlassLayer {
    /// As seen from the camera's side.
    pub fresnel: Dielectric,
    pub place: EtaPlace,
    pub passage: Passage,
    pub tint: Rgb,
    pub weight: f32,
}

/// How light passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passage {
    /// On in the same direction.
    Straight,
    /// Refracted at a smooth boundary.
    Bent,
    /// Scattered by a rough sheet.
    RoughThin,
    /// Refracted at a rough boundary.
    RoughBent,
}

impl Bsdf {
    /// The BSDF of `surface`. `entering` is true where `wo` is on the outside, the side to which the
    /// geometric normal points; it has no meaning for thin surfaces. Roughness below 0.01 counts as
    /// 0, a perfect mirror.
    pub fn new(surface: &Surface, entering: bool) -> Self {
        let base = surface.base_color.map(unit);
        let ior = match surface.ior {
            0.0 => LARGEST_IOR,
            ior if ior > 0.0 => ior.clamp(1.0 / LARGEST_IOR, LARGEST_IOR),
            _ => 1.0,
        };
        let alpha = sqr(unit(surface.roughness));
        let rough = (alpha >= MIN_ALPHA).then(|| Rough { ggx: Ggx { alpha }, place: RoughnessPlace::of(alpha) });
        let lost = |average: Rgb| rough.map_or(Rgb::WHITE, |r| several_bounces(average, r.place.reflected_average()));

        let weight = unit(surface.metallic);
        let fresnel = Metal { f0: base };
        let metal = (weight > 0.0).then(|| MetalLayer { fresnel, several_bounces: lost(fresnel.average()), weight });

        let below_metal = 1.0 - weight;
        let transmission = unit(surface.transmission);
        let glass = (below_metal * transmission > 0.0)
            .then(|| GlassLayer::new(surface, base, ior, alpha, entering, below_metal * transmission));

        let weight = below_metal * (1.0 - transmission);
        // Approximation: an opaque surface of an index below 1 has no critical angle, the step in
        // which the tables can't hold.
        let ior = ior.max(1.0 / ior);
        let fresnel = tinted(surface, ior, ior);
        let visible = weight > 0.0 && ior != 1.0 && (fresnel.f90 > 0.0 || !fresnel.f0.is_black());
        let specular = visible.then(|| SpecularLayer {
            fresnel,
            place: EtaPlace::of(ior),
            several_bounces: lost(fresnel.average()),
            weight,
        });
        Self { rough, metal, glass, specular, diffuse: base * weight }
    }

    /// The BSDF seen from `wo`: what all questions about it share.
    pub fn view(&self, wo: Vec3) -> View<'_> {
        View::new(self, wo)
    }

    /// Draws a direction: `uc` chooses the lobe, `u` the direction. `None` where nothing scatters.
    pub fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        self.view(wo).sample(uc, u)
    }

    /// The value for a pair of directions.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> BsdfEval {
        self.view(wo).eval(wi)
    }

    /// The directional albedo per class, which the color passes hold.
    pub fn albedo(&self, wo: Vec3) -> ByLobe {
        self.view(wo).albedo()
    }

    /// True where `eval` is 0 for all directions: asking lights is of no use.
    pub fn is_delta_only(&self) -> bool {
        let straight = self.glass.is_none_or(|glass| matches!(glass.passage, Passage::Straight | Passage::Bent));
        let reflects = self.metal.is_some() || self.specular.is_some() || self.glass.is_some();
        !self.has_diffuse() && straight && (self.rough.is_none() || !reflects)
    }

    /// True where some light scatters beneath the surface.
    pub fn has_diffuse(&self) -> bool {
        !self.diffuse.is_black()
    }
}

impl GlassLayer {
    fn new(surface: &Surface, base: Rgb, ior: f32, alpha: f32, entering: bool, weight: f32) -> Self {
        let eta = if entering || surface.thin { ior } else { 1.0 / ior };
        let smooth = alpha < MIN_ALPHA;
        let passage = match surface.thin {
            true if smooth => Passage::Straight,
            true => Passage::RoughThin,
            false if smooth => Passage::Bent,
            false if alpha * (eta - 1.0).abs() < MIN_BEND => Passage::Straight,
            false => Passage::RoughBent,
        };
        let tint = if surface.thin { base } else { base.map(f32::sqrt) };
        Self { fresnel: tinted(surface, ior, eta), place: EtaPlace::of(eta), passage, tint, weight }
    }
}

/// The dielectric's reflectance at relative index `eta`, `ior` or its inverse.
fn tinted(surface: &Surface, ior: f32, eta: f32) -> Dielectric {
    let weight = unit(surface.specular);
    let f0 = surface.specular_color.map(|c| (c.max(0.0) * f0_from_eta(ior)).min(1.0) * weight);
    // Total reflection is total, whatever weight reflection has.
    let f90 = if eta < 1.0 { 1.0 } else { weight };
    Dielectric::new(eta, f0, f90)
}

/// `x` within 0 to 1; 0 for NaN.
fn unit(x: f32) -> f32 {
    if x > 0.0 { x.min(1.0) } else { 0.0 }
}
