//! A [`Bsdf`] seen from one direction: albedos, the choice between lobes, evaluation and sampling.

use super::energy::{Energy, LEAST, Plain, Refractive, compensation};
use super::fresnel::{Dielectric, refract, schlick};
use super::ggx::Ggx;
use super::principled::{GlassLayer, Passage};
use super::{Bsdf, BsdfEval, BsdfSample, ByLobe, Lobe, lambert, reflection, refraction, thin};
use crate::math::{ONE_MINUS_EPSILON, Rgb, Vec3};

/// A BSDF seen from one direction.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    bsdf: &'a Bsdf,
    /// With z ≥ 0.
    wo: Vec3,
    /// The sign of the given z.
    side: f32,
    /// Factors of the layers' Fresnel terms: weight times what makes up for several bounces.
    metal: Rgb,
    specular: Rgb,
    glass: Rgb,
    /// Albedo of each part.
    reflected: Rgb,
    glass_reflected: Rgb,
    transmitted: Rgb,
    diffuse: Rgb,
    /// Probability of each choice. Rough glass decides between reflection and passage at the
    /// microfacet, so that its reflection belongs to `p_passage`; smooth glass's to `p_reflection`.
    p_diffuse: f32,
    p_reflection: f32,
    p_passage: f32,
}

impl<'a> View<'a> {
    /// True where light can come from the other side of the surface.
    pub fn transmits(&self) -> bool {
        self.bsdf.glass.is_some()
    }

    /// True where some channel is not scattered beneath the surface.
    pub fn lacks_diffuse(&self) -> bool {
        self.diffuse.r == 0.0 || self.diffuse.g == 0.0 || self.diffuse.b == 0.0
    }

    pub(super) fn new(bsdf: &'a Bsdf, wo: Vec3) -> Self {
        let side = if wo.z < 0.0 { -1.0 } else { 1.0 };
        let wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        let mut view = Self {
            bsdf,
            wo,
            side,
            metal: Rgb::BLACK,
            specular: Rgb::BLACK,
            glass: Rgb::BLACK,
            reflected: Rgb::BLACK,
            glass_reflected: Rgb::BLACK,
            transmitted: Rgb::BLACK,
            diffuse: bsdf.diffuse,
            p_diffuse: if bsdf.has_diffuse() { 1.0 } else { 0.0 },
            p_reflection: 0.0,
            p_passage: 0.0,
        };
        if bsdf.metal.is_some() || bsdf.specular.is_some() || bsdf.glass.is_some() {
            view.add_layers();
            view.choose_probabilities();
        }
        view
    }

    fn add_layers(&mut self) {
        let bsdf = self.bsdf;
        let cos = self.wo.z.min(1.0);
        let energy = bsdf.rough.map(|rough| rough.place.at(cos));
        let plain = energy.map_or(Plain { reflected: 1.0, reflected_schlick: schlick(cos) }, |e| e.plain());
        if let Some(layer) = &bsdf.metal {
            self.metal = compensation(layer.several_bounces, plain.reflected) * layer.weight;
            let Plain { reflected, reflected_schlick } = plain;
            self.reflected +=
                self.metal * layer.fresnel.f0.map(|f0| f0 * (reflected - reflected_schlick) + reflected_schlick);
        }
        if let Some(layer) = &bsdf.specular {
            let blend = energy.map_or_else(|| layer.fresnel.blend(cos), |e| e.reflected_blend(layer.place));
            let factor = compensation(layer.several_bounces, plain.reflected);
            let albedo = factor * reflected(&layer.fresnel, plain, blend);
            self.specular = factor * layer.weight;
            self.reflected += albedo * layer.weight;
            self.diffuse *= (1.0 - albedo.max_component()).max(0.0);
        }
        if let Some(layer) = &bsdf.glass {
            self.add_glass(layer, energy, plain);
        }
    }

    fn add_glass(&mut self, layer: &GlassLayer, energy: Option<Energy>, plain: Plain) {
        let fresnel = &layer.fresnel;
        let averages = match energy {
            Some(energy) => energy.refractive(layer.place),
            None => Refractive { reflected_blend: fresnel.blend(self.wo.z.min(1.0)), ..Refractive::default() },
        };
        let reflected = reflected(fresnel, plain, averages.reflected_blend);
        let passed = match layer.passage {
            Passage::RoughBent => {
                let Refractive { refracted, refracted_blend, .. } = averages;
                fresnel.f0.map(|f0| {
                    (refracted - f0 * (refracted - refracted_blend) - fresnel.f90 * refracted_blend).max(LEAST)
                })
            }
            _ => reflected.map(|r| (plain.reflected - r).max(0.0)),
        };
        self.glass = (reflected + passed).map(|sum| layer.weight / sum);
        self.glass_reflected = reflected * self.glass;
        self.transmitted = passed * self.glass * layer.tint;
    }

    /// In proportion to the albedos.
    fn choose_probabilities(&mut self) {
        let diffuse = self.diffuse.mean();
        let mut reflection = self.reflected.mean();
        let mut passage = self.transmitted.mean();
        match self.passage() {
            Some(Passage::RoughThin | Passage::RoughBent) => passage += self.glass_reflected.mean(),
            _ => reflection += self.glass_reflected.mean(),
        }
        let total = diffuse + reflection + passage;
        let scale = if total > 0.0 { 1.0 / total } else { 0.0 };
        self.p_diffuse = diffuse * scale;
        self.p_reflection = reflection * scale;
        self.p_passage = passage * scale;
    }

    /// The directional albedo per class.
    pub fn albedo(&self) -> ByLobe {
        ByLobe { diffuse: self.diffuse, glossy: self.reflected + self.glass_reflected, transmission: self.transmitted }
    }

    /// The value towards `wi`.
    pub fn eval(&self, wi: Vec3) -> BsdfEval {
        let wi = self.turned(wi);
        if wi.z > 0.0 {
            self.eval_above(wi)
        } else if wi.z < 0.0 {
            self.eval_below(wi)
        } else {
            BsdfEval::default()
        }
    }

    fn eval_above(&self, wi: Vec3) -> BsdfEval {
        let lambert = lambert::f_cos(wi);
        let mut f_cos = ByLobe::only(Lobe::Diffuse, self.diffuse * lambert);
        let mut pdf = self.p_diffuse * lambert;
        if let Some(ggx) = self.reflecting() {
            let h = reflection::half_vector(self.wo, wi);
            let cos = self.wo.dot(h).clamp(0.0, 1.0);
            f_cos.glossy = self.reflectance(cos) * reflection::f_cos(ggx, self.wo, wi, h);
            let pdf_reflection = reflection::pdf(ggx, self.wo, h);
            pdf += self.p_reflection * pdf_reflection;
            pdf += match self.bsdf.glass {
                Some(GlassLayer { passage: Passage::RoughThin, fresnel, tint, .. }) => {
                    self.p_passage * pick_reflection(&fresnel, tint, cos) * pdf_reflection
                }
                Some(GlassLayer { passage: Passage::RoughBent, fresnel, tint, .. }) => {
                    self.p_passage * pick_reflection(&fresnel, tint, cos) * reflection::pdf_visible(ggx, self.wo, h)
                }
                _ => 0.0,
            };
        }
        BsdfEval { f_cos, pdf }
    }

    fn eval_below(&self, wi: Vec3) -> BsdfEval {
        let (Some(ggx), Some(glass)) = (self.reflecting(), &self.bsdf.glass) else { return BsdfEval::default() };
        let eta = glass.fresnel.eta;
        let (h, value, pdf) = match glass.passage {
            Passage::RoughThin => {
                let wi = thin::mirrored(wi);
                let h = reflection::half_vector(self.wo, wi);
                (h, reflection::f_cos(ggx, self.wo, wi, h), reflection::pdf(ggx, self.wo, h))
            }
            Passage::RoughBent => {
                let Some(h) = refraction::half_vector(self.wo, wi, eta) else { return BsdfEval::default() };
                (h, refraction::f_cos(ggx, self.wo, wi, h, eta), refraction::pdf(ggx, self.wo, wi, h, eta))
            }
            Passage::Straight | Passage::Bent => return BsdfEval::default(),
        };
        let cos = self.wo.dot(h).clamp(0.0, 1.0);
        let color = self.glass * glass.tint * (Rgb::WHITE - glass.fresnel.reflectance(cos));
        let p_below = 1.0 - pick_reflection(&glass.fresnel, glass.tint, cos);
        BsdfEval { f_cos: ByLobe::only(Lobe::Transmission, color * value), pdf: self.p_passage * p_below * pdf }
    }

    /// Draws a direction: `uc` chooses the lobe, `u` the direction. `None` where nothing scatters.
    pub fn sample(&self, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let in_passage = uc - self.p_diffuse - self.p_reflection;
        if uc < self.p_diffuse {
            self.finish(lambert::sample(u), Lobe::Diffuse, 1.0)
        } else if in_passage < 0.0 || self.p_passage == 0.0 {
            match self.bsdf.rough {
                Some(rough) => self.finish(reflection::sample(rough.ggx, self.wo, u)?, Lobe::Glossy, 1.0),
                None => self.delta(Vec3::new(-self.wo.x, -self.wo.y, self.wo.z), Lobe::Glossy, 1.0),
            }
        } else {
            let uc = (in_passage / self.p_passage).min(ONE_MINUS_EPSILON);
            self.sample_passage(&self.bsdf.glass?, uc, u)
        }
    }

    fn sample_passage(&self, glass: &GlassLayer, uc: f32, u: [f32; 2]) -> Option<BsdfSample> {
        let (wo, eta) = (self.wo, glass.fresnel.eta);
        let reflects = |h: Vec3| uc < pick_reflection(&glass.fresnel, glass.tint, wo.dot(h).clamp(0.0, 1.0));
        match (glass.passage, self.bsdf.rough) {
            (Passage::Bent, _) => self.delta(refract(wo, Vec3::Z, eta)?, Lobe::Transmission, eta),
            (Passage::RoughThin, Some(rough)) => {
                let wi = reflection::sample(rough.ggx, wo, u)?;
                if reflects(reflection::half_vector(wo, wi)) {
                    self.finish(wi, Lobe::Glossy, 1.0)
                } else {
                    self.finish(thin::mirrored(wi), Lobe::Transmission, 1.0)
                }
            }
            (Passage::RoughBent, Some(rough)) => {
                let h = rough.ggx.sample_visible(wo, u);
                if reflects(h) {
                    self.finish(Some(reflection::reflect(wo, h)).filter(|wi| wi.z > 0.0)?, Lobe::Glossy, 1.0)
                } else {
                    self.finish(refraction::direction(wo, h, eta)?, Lobe::Transmission, eta)
                }
            }
            // A thin sheet has the same medium on both sides, and a boundary that is passed straight
            // an index that can't be told from 1.
            _ => self.delta(-wo, Lobe::Transmission, 1.0),
        }
    }

    /// The sample of a direction that `eval` knows.
    fn finish(&self, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        let BsdfEval { f_cos, pdf } = if wi.z > 0.0 { self.eval_above(wi) } else { self.eval_below(wi) };
        let wi = self.turned(wi);
        (pdf > 0.0).then(|| BsdfSample { wi, weight: f_cos * (1.0 / pdf), pdf, lobe, delta: false, eta })
    }

    /// The sample of a lobe of zero width.
    fn delta(&self, wi: Vec3, lobe: Lobe, eta: f32) -> Option<BsdfSample> {
        let (color, pdf) = match lobe {
            Lobe::Transmission => (self.transmitted, self.p_passage),
            _ => (self.reflected + self.glass_reflected, self.p_reflection),
        };
        let weight = ByLobe::only(lobe, color * (1.0 / pdf));
        (pdf > 0.0).then(|| BsdfSample { wi: self.turned(wi), weight, pdf, lobe, delta: true, eta })
    }

    /// The sum of the layers' Fresnel terms at a microfacet.
    fn reflectance(&self, cos: f32) -> Rgb {
        let mut sum = Rgb::BLACK;
        if let Some(layer) = &self.bsdf.metal {
            sum += self.metal * layer.fresnel.reflectance(cos);
        }
        if let Some(layer) = &self.bsdf.specular {
            sum += self.specular * layer.fresnel.reflectance(cos);
        }
        if let Some(layer) = &self.bsdf.glass {
            sum += self.glass * layer.fresnel.reflectance(cos);
        }
        sum
    }

    /// The microfacets, where anything reflects at them.
    fn reflecting(&self) -> Option<Ggx> {
        let Bsdf { rough, metal, specular, glass, .. } = self.bsdf;
        rough.filter(|_| metal.is_some() || specular.is_some() || glass.is_some()).map(|rough| rough.ggx)
    }

    fn passage(&self) -> Option<Passage> {
        self.bsdf.glass.map(|glass| glass.passage)
    }

    /// Between the caller's hemisphere and that in which `wo` is above; its own inverse.
    fn turned(&self, w: Vec3) -> Vec3 {
        Vec3::new(w.x, w.y, w.z * self.side)
    }
}

/// Probability of reflection over passage at a microfacet of glass.
fn pick_reflection(fresnel: &Dielectric, tint: Rgb, cos: f32) -> f32 {
    let f = fresnel.reflectance(cos);
    let r = f.mean();
    let t = ((Rgb::WHITE - f) * tint).mean();
    if r + t > 0.0 { r / (r + t) } else { 1.0 }
}

/// Albedo of single scattering reflection, by its averages E and S.
fn reflected(fresnel: &Dielectric, plain: Plain, blend: f32) -> Rgb {
    fresnel.f0.map(|f0| f0 * (plain.reflected - blend) + fresnel.f90 * blend)
}
