//! Averages over the microfacets that a direction sees, by a midpoint rule over the random numbers
//! that would draw them.

use super::energy::{Plain, Refractive};
use super::fresnel::{Dielectric, edge, refract, schlick};
use super::ggx::{Ggx, MIN_ALPHA};
use super::reflection::reflect;
use crate::math::{Rgb, Vec3, safe_sqrt};

/// Azimuths of half a turn; the other half mirrors it.
const AZIMUTHS: usize = 24;
const HEIGHTS: usize = 256;

/// The random numbers that give an azimuth and a height: the concentric map of disks, inverted.
fn random_numbers(azimuth: usize, height: usize) -> [f32; 2] {
    let r = ((height as f32 + 0.5) / HEIGHTS as f32).sqrt();
    // In eighths of a turn.
    let phi = 4.0 * (azimuth as f32 + 0.5) / AZIMUTHS as f32;
    let [a, b] = if phi < 1.0 {
        [r, r * phi]
    } else if phi < 3.0 {
        [r * (2.0 - phi), r]
    } else {
        [-r, r * (4.0 - phi)]
    };
    [0.5 + 0.5 * a, 0.5 + 0.5 * b]
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
    /// Those seen at `cos` to the normal.
    pub fn new(alpha: f32, cos: f32) -> Self {
        let ggx = Ggx::round(alpha.max(MIN_ALPHA));
        let cos = cos.max(1e-5);
        let wo = Vec3::new(safe_sqrt(1.0 - cos * cos), 0.0, cos);
        let scale = 1.0 / (AZIMUTHS * HEIGHTS) as f32;
        let grid = |sample: &dyn Fn([f32; 2]) -> Microfacet| {
            (0..HEIGHTS).flat_map(|v| (0..AZIMUTHS).map(move |u| random_numbers(u, v))).map(sample).collect()
        };
        let reflecting = grid(&|u| {
            let h = ggx.sample_bounded(wo, u);
            let wi = reflect(wo, h);
            let weight = if wi.z > 0.0 { ggx.shadowing(wo, wi) * ggx.d(h) / ggx.pdf_bounded(wo, h) } else { 0.0 };
            Microfacet { h, cos: wo.dot(h).clamp(0.0, 1.0), weight: weight * scale }
        });
        let visible = grid(&|u| {
            let h = ggx.sample_visible(wo, u);
            Microfacet { h, cos: wo.dot(h).clamp(0.0, 1.0), weight: scale }
        });
        Self { ggx, wo, reflecting, visible }
    }

    pub fn plain(&self) -> Plain {
        let sum = |share: fn(f32) -> f32| {
            self.reflecting.iter().map(|m| f64::from(m.weight * share(m.cos))).sum::<f64>() as f32
        };
        Plain { reflected: sum(|_| 1.0), reflected_schlick: sum(schlick), reflected_edge: sum(edge) }
    }

    pub fn refractive(&self, eta: f32) -> Refractive {
        let dielectric = Dielectric::new(eta, Rgb::BLACK, 1.0);
        let blend = |m: &Microfacet| f64::from(m.weight * dielectric.blend(m.cos));
        let reflected_blend = self.reflecting.iter().map(blend).sum::<f64>() as f32;
        let (mut refracted, mut refracted_blend) = (0.0, 0.0);
        for m in &self.visible {
            if let Some(wi) = refract(self.wo, m.h, eta).filter(|wi| wi.z < 0.0) {
                // G2/G1(wo).
                let shadowing = 2.0 * self.ggx.shadowing(self.wo, wi) * (self.wo.z + self.ggx.slant(self.wo));
                refracted += f64::from(m.weight * shadowing);
                refracted_blend += f64::from(shadowing) * blend(m);
            }
        }
        Refractive { reflected_blend, refracted: refracted as f32, refracted_blend: refracted_blend as f32 }
    }
}
