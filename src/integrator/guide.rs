//! Steps of a walk that lead out of a medium: directions towards the surface are chosen more often, and long steps
//! along them.
//!
//! Jaroslav Křivánek, Eugene d'Eon: *A Zero-variance-based Sampling Scheme for Monte Carlo Subsurface Scattering*,
//! SIGGRAPH Talks 2014. Johannes Meng, Johannes Hanika, Carsten Dachsbacher: *Improving the Dwivedi Sampling Scheme*,
//! EGSR 2016. Towards the opposite side of a thin object: Eugene d'Eon, Jaroslav Křivánek: *Zero-Variance Theory for
//! Efficient Subsurface Scattering*, SIGGRAPH 2020 course. The way Cycles mixes them.

use std::f32::consts::{FRAC_1_PI, TAU};

use crate::bsdf::Medium;
use crate::math::{Frame, Ray, Vec3, safe_sqrt, sqr};

/// Knows the way out.
pub struct Guide {
    /// Where light went in, and the normal there, outwards.
    p: Vec3,
    n: Vec3,
    /// Diffusion length in mean free paths, and ln((v + 1) / (v − 1)) of it.
    v: f32,
    log: f32,
    /// Extinction by which depths count.
    sigma: f32,
    /// Depth at which the opposite side was found.
    pub opposite: Option<f32>,
}

/// A change of direction, and with what density the guide would have chosen it.
pub struct Turn {
    /// The new direction.
    pub d: Vec3,
    /// Factor of the extinction by which the step's length is drawn.
    pub stretch: f32,
    /// Densities towards the surface and to the opposite side over that of the phase function, times their shares.
    pub forward: f32,
    /// See `forward`.
    pub backward: f32,
    /// Factors of the extinction for both.
    pub stretches: [f32; 2],
}

impl Guide {
    /// A guide for `medium` beneath the point `p` of a surface of normal `n`.
    pub fn new(medium: &Medium, p: Vec3, n: Vec3) -> Self {
        // The whitest channel: guided too strongly the others would be noisy.
        let albedo = medium.albedo.max_component();
        // d'Eon and Křivánek, equation 67.
        let power = 2.442_94 - 0.021_581_3 * albedo + 0.578_637 / albedo;
        let v = 1.0 / (1.0 - albedo.powf(power)).sqrt();
        let sigma_t = medium.sigma_t;
        let sigma = sigma_t.r.min(sigma_t.g).min(sigma_t.b);
        Self { p, n, v, log: ((v + 1.0) / (v - 1.0)).ln(), sigma, opposite: None }
    }

    /// A guided direction.
    pub fn turn(&self, ray: &Ray, g: f32, side: f32, [u, v]: [f32; 2]) -> Turn {
        let cos = self.v - (self.v + 1.0) * (-u * self.log).exp();
        let back = side < self.share_of_back(ray.o);
        let cos = if back { -cos } else { cos };
        let turn = self.follow(ray, g, about(self.n, cos.clamp(-1.0, 1.0), v));
        Turn { stretch: turn.stretches[usize::from(back)], ..turn }
    }

    /// The direction `d` that the phase function has chosen.
    pub fn follow(&self, ray: &Ray, g: f32, d: Vec3) -> Turn {
        let cos = d.dot(self.n).clamp(-1.0, 1.0);
        let back = self.share_of_back(ray.o);
        let phase = TAU * henyey_greenstein(ray.d.dot(d), g);
        let density = |cos: f32| 1.0 / ((self.v - cos) * self.log * phase);
        Turn {
            d,
            stretch: 1.0,
            forward: density(cos) * (1.0 - back),
            backward: density(-cos) * back,
            stretches: [1.0 - cos / self.v, 1.0 + cos / self.v],
        }
    }

    /// Probability of going to the opposite side from `p`.
    fn share_of_back(&self, p: Vec3) -> f32 {
        let Some(opposite) = self.opposite else { return 0.0 };
        let depth = (self.p - p).dot(self.n).clamp(0.0, opposite.max(0.0));
        1.0 / (1.0 + ((opposite - 2.0 * depth) * self.sigma / self.v).exp())
    }
}

/// The phase function of Henyey and Greenstein, by the cosine between the directions before and after.
fn henyey_greenstein(cos: f32, g: f32) -> f32 {
    let base = (1.0 + g * g - 2.0 * g * cos).max(1e-7);
    0.25 * FRAC_1_PI * (1.0 - sqr(g)) / (base * base.sqrt())
}

/// The unit direction at an angle of cosine `cos` to `axis`, turned by `u` of a full turn.
pub fn about(axis: Vec3, cos: f32, u: f32) -> Vec3 {
    let (sin_phi, cos_phi) = (u * TAU).sin_cos();
    let sin = safe_sqrt(1.0 - cos * cos);
    Frame::from_z(axis).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Bsdf, Inside, Method, Subsurface, Surface};
    use crate::math::Rgb;

    fn medium() -> Medium {
        let subsurface = Subsurface {
            weight: 1.0,
            color: Rgb::splat(0.6),
            radius: Rgb::splat(0.2),
            anisotropy: 0.0,
            ior: 1.4,
            method: Method::FreePath,
            shallow: false,
        };
        let surface = Surface { subsurface: Some(subsurface), ior: 1.0, ..Surface::default() };
        let bsdf = Bsdf::new(&surface, Vec3::Z, true);
        let beneath = bsdf.beneath(bsdf.sample(0.5, [0.5; 2]).unwrap().beneath.unwrap()).unwrap();
        let Inside::Medium(medium) = beneath.inside else { panic!("no medium") };
        medium
    }

    /// Guided directions, weighed by the phase function over their density, have the mean of the phase function's.
    #[test]
    fn guided_directions_are_chosen_by_the_density_that_is_told() {
        for (opposite, g) in [(None, 0.0), (Some(0.3), 0.0), (None, 0.5), (Some(0.1), 0.3)] {
            let guide = Guide { opposite, ..Guide::new(&medium(), Vec3::ZERO, Vec3::Z) };
            let ray = Ray::new(Vec3::new(0.0, 0.0, -0.07), Vec3::new(0.6, 0.0, 0.8));
            let n = 96;
            let (mut total, mut mean) = (0.0_f64, 0.0_f64);
            for i in 0..n * n * n {
                let at = |k: usize| ((i / k) % n) as f32 / n as f32 + 0.5 / n as f32;
                let turn = guide.turn(&ray, g, at(1), [at(n), at(n * n)]);
                let weight = 1.0 / f64::from(turn.forward + turn.backward);
                total += weight;
                mean += weight * f64::from(turn.d.dot(ray.d));
            }
            let count = (n * n * n) as f64;
            assert!((total / count - 1.0).abs() < 2e-3, "{opposite:?} {g}: {}", total / count);
            assert!((mean / count - f64::from(g)).abs() < 5e-3, "{opposite:?} {g}: {}", mean / count);
        }
    }
}
