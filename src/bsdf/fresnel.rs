//! Reflectance of interfaces between media, for unpolarized light.
//!
//! Christopher Kulla and Alejandro Conty, *Revisiting Physically Based Shading at Imageworks*,
//! SIGGRAPH course 2017, for the averages over the hemisphere.

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

/// Mean reflectance of a dielectric, 2 ∫ F(μ) μ dμ: fit by Kulla and Conty.
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

    /// Mean over the hemisphere.
    pub fn average(&self) -> Rgb {
        self.at_blend(((average_dielectric(self.eta) - self.real_f0) * self.scale).clamp(0.0, 1.0))
    }
}

/// A metal by Schlick's approximation: `f0 + (1 − f0)(1 − cos θ)⁵`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metal {
    pub f0: Rgb,
}

impl Metal {
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        self.f0.lerp(Rgb::WHITE, schlick(cos))
    }

    /// Mean over the hemisphere: 2 ∫ (1 − μ)⁵ μ dμ = 1/21.
    pub fn average(&self) -> Rgb {
        self.f0.lerp(Rgb::WHITE, 1.0 / 21.0)
    }
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
