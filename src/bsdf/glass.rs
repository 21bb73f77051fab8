//! A boundary between transparent media, or a sheet: light is reflected or passes.

use super::energy::{EtaPlace, LEAST, Refractive, RoughnessPlace, several_bounces};
use super::fresnel::{Dielectric, refract};
use super::ggx::Ggx;
use super::lobe::{Drawn, Scatter, Sides, Value};
use super::reflection::{self, mirrored, plain_at};
use super::thin_film::Film;
use super::{refraction, thin};
use crate::math::{Rgb, Vec3};

/// Where α |η − 1| is smaller, the spread of refraction can't be told from none.
const MIN_BEND: f32 = 2e-5;

/// Least share of reflection or passage where it is only estimated.
const LEAST_SHARE: f32 = 0.02;

/// What a boundary is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    /// As seen from the camera's side.
    pub fresnel: Dielectric,
    /// On it.
    pub film: Option<Film>,
    /// False where nothing is reflected, not even what can't pass.
    pub reflects: bool,
    /// Color of what is reflected and of what passes.
    pub tints: [Rgb; 2],
    /// Without inside.
    pub thin: bool,
}

/// A boundary, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Glass {
    /// `None` where it is smooth.
    ggx: Option<Ggx>,
    boundary: Boundary,
    passage: Passage,
    /// What makes up for light that would leave after several bounces.
    factor: Rgb,
    albedo: Sides,
}

/// How light passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passage {
    /// On in the same direction.
    Straight,
    /// Refracted at a smooth boundary.
    Bent,
    /// Scattered by a rough sheet.
    RoughThin,
    /// Refracted at a rough boundary.
    RoughBent,
}

impl Passage {
    fn of(ggx: Option<Ggx>, boundary: &Boundary) -> Self {
        match ggx {
            None if boundary.thin => Self::Straight,
            None => Self::Bent,
            Some(_) if boundary.thin => Self::RoughThin,
            Some(ggx) if ggx.mean() * (boundary.fresnel.eta - 1.0).abs() < MIN_BEND => Self::Straight,
            Some(_) => Self::RoughBent,
        }
    }
}

impl Boundary {
    /// Shares of reflection and of passage at a microfacet, with their tints.
    #[inline]
    fn split(&self, cos: f32) -> [Rgb; 2] {
        let f = match &self.film {
            Some(film) => film.reflectance(cos),
            None => self.fresnel.reflectance(cos),
        };
        let [reflection, passage] = self.tints;
        match self.reflects {
            true => [f * reflection, (Rgb::WHITE - f) * passage],
            // All that can pass does.
            false => [
                Rgb::BLACK,
                if refract(Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos), Vec3::Z, self.fresnel.eta).is_some()
                {
                    passage
                } else {
                    Rgb::BLACK
                },
            ],
        }
    }
}

impl Glass {
    /// Seen from `wo`. `multiscatter` gives back what scatters between microfacets.
    pub fn new(ggx: Option<Ggx>, boundary: Boundary, multiscatter: bool, wo: Vec3) -> Self {
        let passage = Passage::of(ggx, &boundary);
        let (factor, albedo) = energy(ggx, &boundary, passage, multiscatter, wo);
        Self { ggx, boundary, passage, factor, albedo }
    }

    /// See [`super::lobe::AnyLobe::width`].
    pub fn width(&self) -> f32 {
        self.ggx.map_or(0.0, Ggx::mean)
    }

    /// See [`super::lobe::AnyLobe::widen`].
    pub fn widen(&mut self, least: f32) {
        self.ggx = Ggx::widened(self.ggx, least);
        self.passage = Passage::of(self.ggx, &self.boundary);
        if self.boundary.reflects {
            // Facets that lean let some of either through where a smooth boundary has none.
            let [reflection, transmission] = self.boundary.tints;
            let least = |albedo: Rgb, tint: Rgb| albedo.zip(tint, |albedo, tint| albedo.max(LEAST_SHARE * tint));
            self.albedo.above = least(self.albedo.above, reflection);
            self.albedo.below = least(self.albedo.below, transmission);
        }
    }

    /// See [`super::lobe::AnyLobe::keep`].
    pub fn keep(&mut self, [reflected, passed]: [bool; 2]) -> bool {
        let [reflection, transmission] = &mut self.boundary.tints;
        for (kept, tint, albedo) in
            [(reflected, reflection, &mut self.albedo.above), (passed, transmission, &mut self.albedo.below)]
        {
            if !kept {
                (*tint, *albedo) = (Rgb::BLACK, Rgb::BLACK);
            }
        }
        !self.albedo.sum().is_black()
    }

    /// Probability of reflection over passage at a microfacet.
    #[inline]
    fn pick(&self, [reflected, passed]: [Rgb; 2]) -> f32 {
        let (r, t) = (reflected.mean(), passed.mean());
        if r + t > 0.0 { r / (r + t) } else { 1.0 }
    }
}

/// What a film changes in the light that single scattering keeps: of the difference in reflectance what is kept more
/// by reflection than by passage. There are no tables for films, a few visible normals stand for all.
fn film_keeps(film: &Film, bare: &Dielectric, ggx: Ggx, wo: Vec3) -> Rgb {
    const SEEN: usize = 16;
    // G2/G1 of either way that light goes on.
    let kept = |wi: Vec3| 2.0 * ggx.shadowing(wo, wi) * (wo.z + ggx.slant(wo));
    let change = |i: usize| {
        // A lattice of the golden ratio.
        let u = [(i as f32 + 0.5) / SEEN as f32, (0.5 + i as f32 * 0.618_034).fract()];
        let h = ggx.sample_visible(wo, u);
        let cos = wo.dot(h).clamp(0.0, 1.0);
        let up = Some(reflection::reflect(wo, h)).filter(|wi| wi.z > 0.0).map_or(0.0, kept);
        let down = refract(wo, h, bare.eta).filter(|wi| wi.z < 0.0).map_or(0.0, kept);
        (film.reflectance(cos) - bare.reflectance(cos)) * (up - down)
    };
    (0..SEEN).map(change).sum::<Rgb>() * (1.0 / SEEN as f32)
}

/// The factor that makes up for lost light, and the albedos with it.
fn energy(ggx: Option<Ggx>, boundary: &Boundary, passage: Passage, multiscatter: bool, wo: Vec3) -> (Rgb, Sides) {
    let cos = wo.z.min(1.0);
    let fresnel = &boundary.fresnel;
    let place = ggx.map(|ggx| RoughnessPlace::of(ggx.mean()));
    let energy = place.map(|place| place.at(cos));
    let plain = plain_at(energy, cos);
    let averages = match energy {
        Some(energy) => energy.refractive(EtaPlace::of(fresnel.eta)),
        None => Refractive { reflected_blend: fresnel.blend(cos), ..Refractive::default() },
    };
    let reflected = fresnel.albedo(plain, averages.reflected_blend);
    let passed = match passage {
        Passage::RoughBent => {
            let Refractive { refracted, refracted_blend, .. } = averages;
            fresnel
                .f0
                .map(|f0| (refracted - f0 * (refracted - refracted_blend) - fresnel.f90 * refracted_blend).max(LEAST))
        }
        _ => reflected.map(|r| (plain.reflected - r).max(0.0)),
    };
    let mut sum = reflected + passed;
    if let (Passage::RoughBent, Some(film), Some(ggx)) = (passage, &boundary.film, ggx) {
        sum = (sum + film_keeps(film, fresnel, ggx, wo)).map(|kept| kept.clamp(LEAST_SHARE, 1.0));
    }
    let [reflection, transmission] = boundary.tints;
    let factor = match place {
        Some(_) if multiscatter && transmission == Rgb::WHITE => sum.map(|sum| 1.0 / sum),
        Some(place) if multiscatter => {
            let average = match passage {
                Passage::RoughBent => place.glass_average(EtaPlace::of(fresnel.eta)),
                _ => place.reflected_average(),
            };
            // Approximation: what scatters again is colored as what passes, of which most of it is; as in Cycles.
            let again = several_bounces(transmission.map(|c| c.clamp(0.0, 1.0)), average);
            sum.zip(again, |sum, again| 1.0 + again * (1.0 - sum) / sum)
        }
        _ => Rgb::WHITE,
    };
    let albedo = if !boundary.reflects {
        let passed = if matches!(passage, Passage::RoughBent) {
            averages.refracted.max(LEAST)
        } else {
            boundary.split(cos)[1].max_component()
        };
        Sides { above: Rgb::BLACK, below: transmission * passed }
    } else if boundary.film.is_some() {
        // No tables for films: as a smooth boundary splits it, a little of either where that has none.
        let [r, t] = boundary.split(cos).map(|share| share.map(|c| c.max(LEAST_SHARE)));
        Sides { above: r * sum * factor, below: t * sum * factor }
    } else {
        Sides { above: reflected * factor * reflection, below: passed * factor * transmission }
    };
    (factor, albedo)
}

impl Scatter for Glass {
    fn albedo(&self) -> Sides {
        self.albedo
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Value {
        let Some(ggx) = self.ggx else { return Value::default() };
        let eta = self.boundary.fresnel.eta;
        if wi.z > 0.0 {
            let h = reflection::half_vector(wo, wi);
            let split = self.boundary.split(wo.dot(h).clamp(0.0, 1.0));
            let pdf = match self.passage {
                Passage::RoughThin => reflection::pdf(ggx, wo, h),
                Passage::RoughBent => reflection::pdf_visible(ggx, wo, h),
                // Then a reflection is chosen by the albedos.
                _ => {
                    let pdf = self.p_above() * reflection::pdf(ggx, wo, h);
                    return Value { f_cos: self.factor * split[0] * reflection::f_cos(ggx, wo, wi, h), pdf };
                }
            };
            let f_cos = self.factor * split[0] * reflection::f_cos(ggx, wo, wi, h);
            return Value { f_cos, pdf: self.pick(split) * pdf };
        }
        let (h, value, pdf) = match self.passage {
            Passage::RoughThin => {
                let wi = thin::mirrored(wi);
                let h = reflection::half_vector(wo, wi);
                (h, reflection::f_cos(ggx, wo, wi, h), reflection::pdf(ggx, wo, h))
            }
            Passage::RoughBent => {
                let Some(h) = refraction::half_vector(wo, wi, eta) else { return Value::default() };
                (h, refraction::f_cos(ggx, wo, wi, h, eta), refraction::pdf(ggx, wo, wi, h, eta))
            }
            Passage::Straight | Passage::Bent => return Value::default(),
        };
        let split = self.boundary.split(wo.dot(h).clamp(0.0, 1.0));
        Value { f_cos: self.factor * split[1] * value, pdf: (1.0 - self.pick(split)) * pdf }
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<Drawn> {
        let eta = self.boundary.fresnel.eta;
        let reflects = |h: Vec3| uc < self.pick(self.boundary.split(wo.dot(h).clamp(0.0, 1.0)));
        match (self.passage, self.ggx) {
            (Passage::RoughThin, Some(ggx)) => {
                let wi = reflection::sample(ggx, wo, u)?;
                let above = reflects(reflection::half_vector(wo, wi));
                Some(Drawn::plain(if above { wi } else { thin::mirrored(wi) }))
            }
            (Passage::RoughBent, Some(ggx)) => {
                let h = ggx.sample_visible(wo, u);
                if reflects(h) {
                    Some(Drawn::plain(reflection::reflect(wo, h))).filter(|drawn| drawn.wi.z > 0.0)
                } else {
                    Some(Drawn { wi: refraction::direction(wo, h, eta)?, eta, delta: None })
                }
            }
            (_, ggx) => {
                let p_above = self.p_above();
                if uc < p_above {
                    return match ggx {
                        Some(ggx) => reflection::sample(ggx, wo, u).map(Drawn::plain),
                        None => Some(Drawn { wi: mirrored(wo), eta: 1.0, delta: Some((self.albedo.above, p_above)) }),
                    };
                }
                let (wi, eta) = match self.passage {
                    Passage::Bent => (refract(wo, Vec3::Z, eta)?, eta),
                    // A thin sheet has the same medium on both sides, and a boundary that is passed straight an
                    // index that can't be told from 1.
                    _ => (-wo, 1.0),
                };
                Some(Drawn { wi, eta, delta: Some((self.albedo.below, 1.0 - p_above)) })
            }
        }
    }

    fn is_delta(&self) -> bool {
        self.ggx.is_none()
    }

    fn transmits(&self) -> bool {
        true
    }
}

impl Glass {
    /// Probability of a reflection where the albedos decide.
    fn p_above(&self) -> f32 {
        self.pick([self.albedo.above, self.albedo.below])
    }
}
