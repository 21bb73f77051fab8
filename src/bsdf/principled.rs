//! The layered surface of glTF 2.0 (metallic-roughness with KHR_materials_specular, _ior and
//! _transmission), which is Blender's Principled node: metal over transmission over the dielectric's
//! reflection over diffuse, the diffuse part scaled by what the reflection leaves.
//!
//! All reflections share one roughness, so they are one microfacet lobe whose Fresnel term is the
//! sum of theirs.

use super::energy::{Energy, Plain, Refractive, compensation};
use super::fresnel::{Dielectric, Metal, f0_from_eta, refract, schlick};
use super::ggx::{Ggx, MIN_ALPHA};
use super::response::{BsdfEval, BsdfSample, ByLobe, Lobe};
use super::{Surface, lambert, reflection, refraction, thin};
use crate::math::{ONE_MINUS_EPSILON, Rgb, Vec3, sqr};

/// Where α |η − 1| is smaller, the spread of refraction can't be told from none.
const MIN_BEND: f32 = 2e-5;

/// How light passes the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passage {
    /// It doesn't.
    None,
    /// On in the same direction.
    Straight,
    /// Refracted at a smooth boundary.
    Bent,
    /// Scattered by a rough sheet.
    RoughThin,
    /// Refracted at a rough boundary.
    RoughBent,
}

/// A surface ready to scatter.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf {
    alpha: f32,
    metal: Metal,
    metal_weight: f32,
    /// The reflection over the diffuse part.
    coat: Dielectric,
    /// The boundary that light passes, seen from the camera's side.
    glass: Dielectric,
    glass_weight: f32,
    glass_tint: Rgb,
    passage: Passage,
    diffuse: Rgb,
    diffuse_weight: f32,
}

impl Bsdf {
    /// The BSDF of `surface`. `entering` is true where `wo` is on the outside, the side to which the
    /// geometric normal points; it has no meaning for thin surfaces.
    pub fn new(surface: &Surface, entering: bool) -> Self {
        let unit = |x: f32| x.max(0.0).min(1.0);
        let base = surface.base_color.map(unit);
        let metallic = unit(surface.metallic);
        let transmission = unit(surface.transmission);
        let specular = unit(surface.specular);
        let alpha = sqr(unit(surface.roughness));
        let ior = if surface.ior > 0.0 { surface.ior.clamp(1e-3, 1e3) } else { 1.0 };
        let f0 = surface.specular_color.map(|c| (c.max(0.0) * f0_from_eta(ior)).min(1.0) * specular);
        let eta = if entering || surface.thin { ior } else { 1.0 / ior };
        // Total reflection must be total, whatever weight the reflection has.
        let f90 = if eta < 1.0 { 1.0 } else { specular };
        let glass_weight = (1.0 - metallic) * transmission;
        let smooth = alpha < MIN_ALPHA;
        let passage = match surface.thin {
            _ if glass_weight == 0.0 => Passage::None,
            true if smooth => Passage::Straight,
            true => Passage::RoughThin,
            false if smooth => Passage::Bent,
            false if alpha * (eta - 1.0).abs() < MIN_BEND => Passage::Straight,
            false => Passage::RoughBent,
        };
        Self {
            alpha,
            metal: Metal { f0: base },
            metal_weight: metallic,
            coat: Dielectric { eta: ior, f0, f90: specular },
            glass: Dielectric { eta, f0, f90 },
            glass_weight,
            glass_tint: if surface.thin { base } else { base.map(f32::sqrt) },
            passage,
            diffuse: base,
            diffuse_weight: (1.0 - metallic) * (1.0 - transmission),
        }
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

    /// The directional albedo per class, the color passes.
    pub fn albedo(&self, wo: Vec3) -> ByLobe {
        self.view(wo).albedo()
    }

    /// True where `eval` is 0 for all directions: asking lights is of no use.
    pub fn is_delta_only(&self) -> bool {
        self.is_smooth() && !self.has_diffuse()
    }

    /// True where some light scatters beneath the surface.
    pub fn has_diffuse(&self) -> bool {
        self.diffuse_weight > 0.0 && !self.diffuse.is_black()
    }

    fn is_smooth(&self) -> bool {
        self.alpha < MIN_ALPHA
    }
}

/// A BSDF seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    bsdf: &'a Bsdf,
    /// With z ≥ 0.
    wo: Vec3,
    /// The sign of the given z.
    side: f32,
    /// Factors of the Fresnel terms: weight times energy compensation.
    metal: Rgb,
    coat: Rgb,
    glass: Rgb,
    /// Albedo of each part.
    reflected: Rgb,
    glass_reflected: Rgb,
    transmitted: Rgb,
    diffuse: Rgb,
    /// Probability of each component; `reflection` holds smooth glass's, rough glass has its own in
    /// `passage`.
    p_diffuse: f32,
    p_reflection: f32,
    p_passage: f32,
}

impl<'a> View<'a> {
    fn new(bsdf: &'a Bsdf, wo: Vec3) -> Self {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        let averages = Averages::of(bsdf, wo.z);
        let plain = averages.plain;
        let metal = compensation(plain, bsdf.metal.average()) * bsdf.metal_weight;
        let coat = compensation(plain, bsdf.coat.average());
        let coat_albedo = coat * reflected(&bsdf.coat, plain, averages.coat);
        let coat = coat * bsdf.diffuse_weight;

        let (glass_reflected, transmitted, glass) = averages.glass_albedo(bsdf);
        let metal_albedo =
            metal * bsdf.metal.f0.map(|f0| f0 * (plain.reflected - plain.reflected_schlick) + plain.reflected_schlick);
        let left = bsdf.diffuse_weight * (1.0 - coat_albedo.max_component()).max(0.0);

        let mut view = Self {
            bsdf,
            wo,
            side,
            metal,
            coat,
            glass,
            reflected: metal_albedo + coat_albedo * bsdf.diffuse_weight,
            glass_reflected,
            transmitted,
            diffuse: bsdf.diffuse * left,
            p_diffuse: 0.0,
            p_reflection: 0.0,
            p_passage: 0.0,
        };
        view.choose_probabilities();
        view
    }

    fn choose_probabilities(&mut self) {
        let diffuse = self.diffuse.mean();
        let mut reflection = self.reflected.mean();
        let mut passage = self.transmitted.mean();
        match self.bsdf.passage {
            Passage::RoughThin | Passage::RoughBent => passage += self.glass_reflected.mean(),
            _ => reflection += self.glass_reflected.mean(),
        }
        let total = diffuse + reflection + passage;
        if total > 0.0 {
            self.p_diffuse = diffuse / total;
            self.p_reflection = reflection / total;
            self.p_passage = passage / total;
        }
    }

    /// The directional albedo per class.
    pub fn albedo(&self) -> ByLobe {
        ByLobe { diffuse: self.diffuse, glossy: self.reflected + self.glass_reflected, transmission: self.transmitted }
    }

    /// The value towards `wi`.
    pub fn eval(&self, wi: Vec3) -> BsdfEval {
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        if wi.z > 0.0 {
            self.eval_reflected(wi)
        } else if wi.z < 0.0 {
            self.eval_transmitted(wi)
        } else {
            BsdfEval::default()
        }
    }

    fn eval_reflected(&self, wi: Vec3) -> BsdfEval {
        let lambert = lambert::f_cos(wi);
        let mut f_cos = ByLobe::only(Lobe::Diffuse, self.diffuse * lambert);
        let mut pdf = self.p_diffuse * lambert;
        if let Some(ggx) = self.ggx() {
            let h = reflection::half_vector(self.wo, wi);
            let cos = self.wo.dot(h).clamp(0.0, 1.0);
            f_cos.glossy = self.reflectance(cos) * reflection::f_cos(ggx, self.wo, wi, h);
            let pdf_reflection = reflection::pdf(ggx, self.wo, h);
            pdf += self.p_reflection * pdf_reflection;
            pdf += match self.bsdf.passage {
                Passage::RoughThin => self.p_passage * self.pick_reflection(cos) * pdf_reflection,
                Passage::RoughBent => {
                    self.p_passage * self.pick_reflection(cos) * ggx.pdf_visible(self.wo, h) / (4.0 * cos)
                }
                _ => 0.0,
            };
        }
        BsdfEval { f_cos, pdf }
    }

    fn eval_transmitted(&self, wi: Vec3) -> BsdfEval {
        let Some(ggx) = self.ggx() else { return BsdfEval::default() };
        let eta = self.bsdf.glass.eta;
        let (value, pdf, cos) = match self.bsdf.passage {
            Passage::RoughThin => {
                let wi = thin::mirrored(wi);
                let h = reflection::half_vector(self.wo, wi);
                (reflection::f_cos(ggx, self.wo, wi, h), reflection::pdf(ggx, self.wo, h), self.wo.dot(h))
            }
            Passage::RoughBent => {
                let Some(h) = refraction::half_vector(self.wo, wi, eta) else { return BsdfEval::default() };
                let value = refraction::f_cos(ggx, self.wo, wi, h, eta);
                (value, refraction::pdf(ggx, self.wo, wi, h, eta), self.wo.dot(h))
            }
            _ => return BsdfEval::default(),
        };
        let cos = cos.clamp(0.0, 1.0);
        let color = self.glass * self.bsdf.glass_tint * (Rgb::WHITE - self.bsdf.glass.reflectance(cos));
        let pdf = self.p_passage * (1.0 - self.pick_reflection(cos)) * pdf;
        BsdfEval { f_cos: ByLobe::only(Lobe::Transmission, color * value), pdf }
    }

    /// Draws a direction: `uc` chooses the lobe, `u` the direction. `None` where nothing scatters.
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let (wo, eta) = (self.wo, self.bsdf.glass.eta);
        let in_passage = uc - self.p_diffuse - self.p_reflection;
        if uc < self.p_diffuse {
            return self.finish(lambert::sample(u), Lobe::Diffuse, 1.0);
        }
        if in_passage < 0.0 || self.p_passage == 0.0 {
            return match self.ggx() {
                Some(ggx) => self.finish(reflection::sample(ggx, wo, u)?, Lobe::Glossy, 1.0),
                None => self.delta(Vec3::new(-wo.x, -wo.y, wo.z), Lobe::Glossy, 1.0),
            };
        }
        let uc = (in_passage / self.p_passage).min(ONE_MINUS_EPSILON);
        match (self.bsdf.passage, self.ggx()) {
            (Passage::Bent, _) => self.delta(refract(wo, Vec3::Z, eta)?, Lobe::Transmission, eta),
            (Passage::Straight, _) => self.delta(-wo, Lobe::Transmission, self.eta_through()),
            (Passage::RoughThin, Some(ggx)) => {
                let wi = reflection::sample(ggx, wo, u)?;
                let cos = wo.dot(reflection::half_vector(wo, wi)).clamp(0.0, 1.0);
                if uc < self.pick_reflection(cos) {
                    self.finish(wi, Lobe::Glossy, 1.0)
                } else {
                    self.finish(thin::mirrored(wi), Lobe::Transmission, 1.0)
                }
            }
            (Passage::RoughBent, Some(ggx)) => {
                let h = ggx.sample_visible(wo, u);
                if uc < self.pick_reflection(wo.dot(h).clamp(0.0, 1.0)) {
                    let wi = reflection::reflect(wo, h);
                    if wi.z > 0.0 { self.finish(wi, Lobe::Glossy, 1.0) } else { None }
                } else {
                    self.finish(refraction::direction(wo, h, eta)?, Lobe::Transmission, eta)
                }
            }
            _ => None,
        }
    }

    /// The sample of a direction that `eval` knows.
    fn finish(&self, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        let BsdfEval { f_cos, pdf } = self.eval(wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f_cos * (1.0 / pdf), pdf, lobe, delta: false, eta })
    }

    /// The sample of a lobe of zero width.
    fn delta(&self, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        let (color, pdf) = match lobe {
            Lobe::Transmission => (self.transmitted, self.p_passage),
            _ => (self.reflected + self.glass_reflected, self.p_reflection),
        };
        let wi = Vec3::new(wi.x, wi.y, wi.z * self.side);
        let weight = ByLobe::only(lobe, color * (1.0 / pdf));
        (pdf > 0.0).then_some(BsdfSample { wi, weight, pdf, lobe, delta: true, eta })
    }

    /// The sum of the Fresnel terms at a microfacet.
    fn reflectance(&self, cos: f32) -> Rgb {
        let bsdf = self.bsdf;
        let mut sum = Rgb::BLACK;
        if bsdf.metal_weight > 0.0 {
            sum += self.metal * bsdf.metal.reflectance(cos);
        }
        if bsdf.diffuse_weight > 0.0 {
            sum += self.coat * bsdf.coat.reflectance(cos);
        }
        if bsdf.glass_weight > 0.0 {
            sum += self.glass * bsdf.glass.reflectance(cos);
        }
        sum
    }

    /// Probability of reflection over passage at a microfacet of glass.
    fn pick_reflection(&self, cos: f32) -> f32 {
        let f = self.bsdf.glass.reflectance(cos);
        let r = f.mean();
        let t = ((Rgb::WHITE - f) * self.bsdf.glass_tint).mean();
        if r + t > 0.0 { r / (r + t) } else { 1.0 }
    }

    fn ggx(&self) -> Option<Ggx> {
        (!self.bsdf.is_smooth()).then_some(Ggx { alpha: self.bsdf.alpha })
    }

    fn eta_through(&self) -> f32 {
        // A thin sheet has the same medium on both sides; a boundary passed straight has an index
        // that can't be told from 1.
        1.0
    }
}

/// Averages over the microfacets that a view sees.
struct Averages {
    plain: Plain,
    coat: Refractive,
    glass: Refractive,
}

impl Averages {
    fn of(bsdf: &Bsdf, cos: f32) -> Self {
        if bsdf.is_smooth() {
            let refractive = |dielectric: &Dielectric| {
                let blend = dielectric.blend(cos);
                Refractive { reflected_blend: blend, refracted: 1.0, refracted_blend: blend }
            };
            let plain = Plain { reflected: 1.0, reflected_schlick: schlick(cos), reflected_average: 1.0 };
            return Self { plain, coat: refractive(&bsdf.coat), glass: refractive(&bsdf.glass) };
        }
        let energy = Energy::at(cos, bsdf.alpha);
        let refractive = |needed: bool, eta| if needed { energy.refractive(eta) } else { Refractive::default() };
        Self {
            plain: energy.plain(),
            coat: refractive(bsdf.diffuse_weight > 0.0, bsdf.coat.eta),
            glass: refractive(bsdf.passage != Passage::None, bsdf.glass.eta),
        }
    }

    /// What glass reflects, what it lets pass, and the factor of both by which nothing is lost.
    fn glass_albedo(&self, bsdf: &Bsdf) -> (Rgb, Rgb, Rgb) {
        let reflected = reflected(&bsdf.glass, self.plain, self.glass);
        let passed = match bsdf.passage {
            Passage::None => return (Rgb::BLACK, Rgb::BLACK, Rgb::BLACK),
            Passage::RoughBent => {
                let Refractive { refracted, refracted_blend, .. } = self.glass;
                bsdf.glass
                    .f0
                    .map(|f0| refracted - f0 * (refracted - refracted_blend) - bsdf.glass.f90 * refracted_blend)
            }
            _ => reflected.map(|r| (self.plain.reflected - r).max(0.0)),
        };
        let factor = (reflected + passed).map(|sum| bsdf.glass_weight / sum);
        (reflected * factor, passed * factor * bsdf.glass_tint, factor)
    }
}

/// Albedo of single scattering reflection.
fn reflected(dielectric: &Dielectric, plain: Plain, averages: Refractive) -> Rgb {
    let blend = averages.reflected_blend;
    dielectric.f0.map(|f0| f0 * (plain.reflected - blend) + dielectric.f90 * blend)
}
