//! Reflectance of interfaces between media, for unpolarized light.
//!
//! Christopher Kulla and Alejandro Conty, *Revisiting Physically Based Shading at Imageworks*,
//! SIGGRAPH course 2017, for the averages over the hemisphere.

use super::energy::Plain;
use crate::math::{Rgb, Vec3, sqr};

/// Reflectance of a dielectric by Fresnel's equations. `cos` ≥ 0 is that of the incident angle and
/// `eta` the index beyond the interface over the index before it; 1 for total internal reflection.
#[inline]
pub fn fresnel_dielectric(cos: f32, eta: f32) -> f32 {
    let cos_t_squared = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if cos_t_squared <= 0.0 {
        return 1.0;
    }
    let cos_t = cos_t_squared.sqrt();
    let perpendicular = (cos - eta * cos_t) / (cos + eta * cos_t);
    let parallel = (eta * cos - cos_t) / (eta * cos + cos_t);
    0.5 * (sqr(perpendicular) + sqr(parallel))
}

/// Reflectance of a dielectric at normal incidence, ((η − 1)/(η + 1))².
#[inline]
pub fn f0_from_eta(eta: f32) -> f32 {
    sqr((eta - 1.0) / (eta + 1.0))
}

/// Mean reflectance of a dielectric, 2 ∫ F(μ) μ dμ: fit by Kulla and Conty, within 0.007
/// for indices of 0.5 to 3.
pub(super) fn average_dielectric(eta: f32) -> f32 {
    let fit = if eta >= 1.0 {
        (eta - 1.0) / (4.085_67 + 1.000_71 * eta)
    } else {
        0.997_118 + eta * (0.1014 - eta * (0.965_241 + eta * 0.130_607))
    };
    fit.clamp(0.0, 1.0)
}

/// A tinted dielectric: between `f0` at normal incidence and `f90` at grazing as a dielectric of
/// index `eta` goes from its own reflectance at normal incidence to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric {
    pub eta: f32,
    pub f0: Rgb,
    pub f90: f32,
    /// Reflectance at normal incidence without tint, and one over what is left to 1.
    real_f0: f32,
    scale: f32,
}

impl Dielectric {
    pub fn new(eta: f32, f0: Rgb, f90: f32) -> Self {
        let real_f0 = f0_from_eta(eta);
        Self { eta, f0, f90, real_f0, scale: 1.0 / (1.0 - real_f0) }
    }

    /// How far between normal and grazing reflectance, 0 to 1.
    #[inline]
    pub fn blend(&self, cos: f32) -> f32 {
        ((fresnel_dielectric(cos, self.eta) - self.real_f0) * self.scale).clamp(0.0, 1.0)
    }

    #[inline]
    pub fn at_blend(&self, blend: f32) -> Rgb {
        self.f0.lerp(Rgb::splat(self.f90), blend)
    }

    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        self.at_blend(self.blend(cos))
    }

    /// What single scattering keeps, by its averages E and S.
    pub fn albedo(&self, plain: Plain, blend: f32) -> Rgb {
        self.f0.map(|f0| f0 * (plain.reflected - blend) + self.f90 * blend)
    }

    /// Mean over the hemisphere.
    pub fn average(&self) -> Rgb {
        self.at_blend(((average_dielectric(self.eta) - self.real_f0) * self.scale).clamp(0.0, 1.0))
    }
}

/// A metal by Schlick's approximation with a tint near grazing: `f0 + (1 − f0)(1 − cos θ)⁵ − b cos θ (1 − cos θ)⁶`.
///
/// Peter Kutz, Miloš Hašan and Dave Edmondson, *Novel aspects of the Adobe Standard Material*, 2023: `b` is such
/// that at cos θ = 1/7, some 82 degrees, where the last term is largest, Schlick's value is multiplied by the tint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metal {
    pub f0: Rgb,
    b: Rgb,
}

impl Metal {
    /// By Schlick's approximation alone where `edge` is white.
    pub fn new(f0: Rgb, edge: Rgb) -> Self {
        Self::through(f0, f0.lerp(Rgb::WHITE, schlick(1.0 / 7.0)) * edge)
    }

    /// With reflectance `f82` at cos θ = 1/7.
    pub fn through(f0: Rgb, f82: Rgb) -> Self {
        // 7 (7/6)⁶.
        const SCALE: f32 = 17.651_377;
        let b = (f0.lerp(Rgb::WHITE, schlick(1.0 / 7.0)) - f82) * SCALE;
        Self { f0, b }
    }

    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        let schlick = schlick(cos);
        let edge = edge(cos);
        self.f0.zip(self.b, |f0, b| (f0 + (1.0 - f0) * schlick - b * edge).clamp(0.0, 1.0))
    }

    /// Mean over the hemisphere: 2 ∫ (1 − μ)⁵ μ dμ = 1/21, 2 ∫ μ (1 − μ)⁶ μ dμ = 1/126.
    pub fn average(&self) -> Rgb {
        self.f0.zip(self.b, |f0, b| (f0 + (1.0 - f0) / 21.0 - b / 126.0).clamp(0.0, 1.0))
    }

    /// What single scattering keeps, by its averages.
    pub fn albedo(&self, plain: Plain) -> Rgb {
        let Plain { reflected, reflected_schlick, reflected_edge } = plain;
        self.f0.zip(self.b, |f0, b| f0 * (reflected - reflected_schlick) + reflected_schlick - b * reflected_edge)
    }
}

/// cos (1 − cos)⁶.
#[inline]
pub(super) fn edge(cos: f32) -> f32 {
    cos * schlick(cos) * (1.0 - cos).max(0.0)
}

/// (1 − cos)⁵.
#[inline]
pub(super) fn schlick(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    sqr(sqr(m)) * m
}

/// `wo` refracted at the normal `h`, wo·h ≥ 0; `None` for total internal reflection. `eta` as in
/// [`fresnel_dielectric`].
#[inline]
pub(super) fn refract(wo: Vec3, h: Vec3, eta: f32) -> Option<Vec3> {
    let cos = wo.dot(h);
    let inverse = 1.0 / eta;
    let cos_t_squared = 1.0 - inverse * inverse * (1.0 - cos * cos);
    (cos_t_squared > 0.0).then(|| (h * (inverse * cos - cos_t_squared.sqrt()) - wo * inverse).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 ∫ F(μ) μ dμ.
    fn average(f: impl Fn(f32) -> f32) -> f32 {
        let n = 20_000;
        let mu = |i: i32| (i as f32 + 0.5) / n as f32;
        (0..n).map(|i| f64::from(2.0 * f(mu(i)) * mu(i) / n as f32)).sum::<f64>() as f32
    }

    #[test]
    fn known_reflectances() {
        // Index 1.5 at 0, 45, 60, 75 and 85 degrees.
        for (degrees, f) in [(0.0_f32, 0.0400), (45.0, 0.0502), (60.0, 0.0892), (75.0, 0.2531), (85.0, 0.6128)] {
            assert!((fresnel_dielectric(degrees.to_radians().cos(), 1.5) - f).abs() < 1e-4);
        }
        assert_eq!(fresnel_dielectric(0.0, 1.5), 1.0);
        assert_eq!(fresnel_dielectric(0.7, 1.0), 0.0);
        assert_eq!(fresnel_dielectric(0.7, 1.0 / 1.5), 1.0);
        // Brewster's angle reflects one polarization only: ((1 − η²)/(1 + η²))²/2.
        let eta = 1.5_f32;
        let brewster = (1.0 / (1.0 + eta * eta)).sqrt();
        let expected = 0.5 * sqr((1.0 - eta * eta) / (1.0 + eta * eta));
        assert!((fresnel_dielectric(brewster, eta) - expected).abs() < 1e-6);
    }

    #[test]
    fn both_sides_of_an_interface_reflect_alike() {
        for cos in [0.1_f32, 0.4, 0.9, 1.0] {
            let cos_t = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
            assert!((fresnel_dielectric(cos, 1.5) - fresnel_dielectric(cos_t, 1.0 / 1.5)).abs() < 1e-5);
        }
    }

    #[test]
    fn averages_are_integrals() {
        for eta in [0.5, 0.7, 0.9, 1.1, 1.5, 2.0, 3.0] {
            let exact = average(|mu| fresnel_dielectric(mu, eta));
            assert!((average_dielectric(eta) - exact).abs() < 7e-3, "{eta}: {exact}");
        }
        for edge in [Rgb::WHITE, Rgb::new(0.7, 0.5, 1.0)] {
            let metal = Metal::new(Rgb::new(0.1, 0.5, 0.9), edge);
            let exact = Rgb::new(
                average(|mu| metal.reflectance(mu).r),
                average(|mu| metal.reflectance(mu).g),
                average(|mu| metal.reflectance(mu).b),
            );
            let d = metal.average() - exact;
            assert!(d.to_array().iter().all(|d| d.abs() < 1e-4), "{edge:?}: {d:?}");
            // The tint is that of 82 degrees.
            let at = metal.reflectance(1.0 / 7.0).g / Metal::new(metal.f0, Rgb::WHITE).reflectance(1.0 / 7.0).g;
            assert!((at - edge.g).abs() < 1e-5, "{at}");
        }
    }

    #[test]
    fn refraction_obeys_snell() {
        let wo = Vec3::new(0.6, 0.0, 0.8);
        for eta in [1.0, 1.5, 1.0 / 1.2] {
            let wi = refract(wo, Vec3::Z, eta).unwrap();
            assert!((eta * wi.x + wo.x).abs() < 1e-6 && wi.z < 0.0);
        }
        assert!(refract(wo, Vec3::Z, 0.59).is_none());
    }
}
