//! Where a path scattered last, and what that means for the light that its ray finds.

use crate::bsdf::ByLobe;
use crate::light::{EmitterHit, Receiver, Rules};
use crate::math::{Rgb, Vec3};
use crate::sampling::power_heuristic;
use crate::scene::Scene;

/// A scattering that a ray comes from.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// Where.
    pub from: Receiver,
    /// Density of the ray's direction, infinite for a delta.
    pub pdf: f32,
    /// Light samples that were taken there.
    pub light_samples: f32,
    /// Share of each class of lobes in what was scattered; they sum to 1.
    pub shares: ByLobe,
}

impl Scattering {
    /// MIS weight of the light of `light` that the ray has found along `wi`, against that of light
    /// sampling.
    pub fn mis_weight(&self, scene: &Scene, light: u32, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        if self.pdf.is_finite() {
            power_heuristic(self.pdf, self.light_samples * scene.lights.pdf_li(&self.from, light, wi, hit))
        } else {
            1.0
        }
    }
}

/// `by_lobe` less the classes that do not see a light with `rules`, times its factors.
pub fn seen(by_lobe: ByLobe, rules: &Rules) -> ByLobe {
    let seen = rules.seen;
    let keep = |color: Rgb, keep: bool| if keep { color } else { Rgb::BLACK };
    let kept = ByLobe {
        diffuse: keep(by_lobe.diffuse, seen.diffuse),
        glossy: keep(by_lobe.glossy, seen.glossy),
        transmission: keep(by_lobe.transmission, seen.transmission),
    };
    match rules.response {
        None => kept,
        Some([diffuse, specular]) => ByLobe {
            diffuse: kept.diffuse * diffuse,
            glossy: kept.glossy * specular,
            transmission: kept.transmission * specular,
        },
    }
}
