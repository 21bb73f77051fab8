//! Averages over the microfacets that a direction sees, by a midpoint rule over the random numbers
//! that would draw them.

use super::energy::{Plain, Refractive};
use super::fresnel::{Dielectric, refract, schlick};
use super::ggx::{Ggx, MIN_ALPHA};
use super::reflection::reflect;
use crate::math::{Rgb, Vec3, safe_sqrt};

/// How many azimuths of half a turn (the other half mirrors it), and how many heights.
pub(super) struct Rule {
    pub azimuths: usize,
    pub heights: usize,
}

/// The microfacets seen from a direction.
pub(super) struct Seen {
    ggx: Ggx,
    wo: Vec3,
    /// Those that mostly reflect upwards.
    reflecting: Vec<Microfacet>,
    /// All that are visible, each of the same weight.
    visible: Vec<Microfacet>,
}

struct Microfacet {
    h: Vec3,
    /// wo·h.
    cos: f32,
    /// Its share of the reflected energy; 0 where it reflects down.
    weight: f32,
}

impl Seen {
    pub fn new(alpha: f32, cos: f32, rule: &Rule) -> Self {
        let ggx = Ggx { alpha: alpha.max(MIN_ALPHA) };
        let cos = cos.max(1e-5);
        let wo = Vec3::new(safe_sqrt(1.0 - cos * cos), 0.0, cos);
        let scale = 1.0 / (rule.azimuths * rule.heights) as f32;
        let grid = |sample: &dyn Fn([f32; 2]) -> Microfacet| {
            let heights = (0..rule.heights).map(|v| (v as f32 + 0.5) / rule.heights as f32);
            let azimuths = |v: f32| (0..rule.azimuths).map(move |u| [0.5 * (u as f32 + 0.5) / rule.azimuths as f32, v]);
            heights.flat_map(azimuths).map(sample).collect()
        };
        let reflecting = grid(&|u| {
            let h = ggx.sample_bounded(wo, u);
            let wi = reflect(wo, h);
            let weight =
                if wi.z > 0.0 { wi.z * ggx.visibility(wo, wi) * ggx.d(h) / ggx.pdf_bounded(wo, h) } else { 0.0 };
            Microfacet { h, cos: wo.dot(h).clamp(0.0, 1.0), weight: weight * scale }
        });
        let visible = grid(&|u| {
            let h = ggx.sample_visible(wo, u);
            Microfacet { h, cos: wo.dot(h).clamp(0.0, 1.0), weight: scale }
        });
        Self { ggx, wo, reflecting, visible }
    }

    pub fn plain(&self) -> Plain {
        Plain {
            reflected: self.reflecting.iter().map(|m| m.weight).sum(),
            reflected_schlick: self.reflecting.iter().map(|m| m.weight * schlick(m.cos)).sum(),
        }
    }

    pub fn refractive(&self, eta: f32) -> Refractive {
        let dielectric = Dielectric::new(eta, Rgb::BLACK, 1.0);
        let reflected_blend = self.reflecting.iter().map(|m| m.weight * dielectric.blend(m.cos)).sum();
        let mut sum = Refractive { reflected_blend, ..Refractive::default() };
        for m in &self.visible {
            if let Some(wi) = refract(self.wo, m.h, eta).filter(|wi| wi.z < 0.0) {
                // G2/G1(wo).
                let shadowing = 2.0 * -wi.z * self.ggx.visibility(self.wo, wi) * (self.wo.z + self.ggx.slant(self.wo));
                sum.refracted += m.weight * shadowing;
                sum.refracted_blend += m.weight * shadowing * dielectric.blend(m.cos);
            }
        }
        sum
    }
}
