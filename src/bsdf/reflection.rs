//! Reflection at GGX microfacets or at a mirror: f cos θi = F(wo·h) D(h) G2 / (4 cos θo).

use super::conductor::Conductor;
use super::energy::{Energy, EtaPlace, LEAST, Plain, RoughnessPlace, compensation, several_bounces};
use super::fresnel::{Dielectric, Metal, schlick};
use super::ggx::Ggx;
use super::lobe::{Drawn, Scatter, Sides, Value};
use super::thin_film::Film;
use crate::math::{Rgb, Vec3};

/// Which share a microfacet reflects.
#[derive(Clone, Copy, Debug)]
pub(super) enum Fresnel {
    /// The same from everywhere.
    Constant(Rgb),
    /// By a boundary between dielectrics.
    Dielectric(Dielectric),
    /// By a metal.
    Metal(Metal),
    /// By a metal of known index.
    Conductor(Conductor),
    /// By a thin film on one of them.
    Film(Film),
}

/// Microfacets that reflect.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection {
    /// `None` for a mirror.
    ggx: Option<Ggx>,
    fresnel: Fresnel,
    /// What makes up for light that would leave after several bounces.
    factor: Rgb,
    albedo: Rgb,
    /// What is gone for what lies below.
    taken: Rgb,
}

impl Fresnel {
    #[inline]
    pub fn reflectance(&self, cos: f32) -> Rgb {
        match self {
            Self::Constant(color) => *color,
            Self::Dielectric(fresnel) => fresnel.reflectance(cos),
            Self::Metal(fresnel) => fresnel.reflectance(cos),
            Self::Conductor(fresnel) => fresnel.reflectance(cos),
            Self::Film(fresnel) => fresnel.reflectance(cos),
        }
    }

    /// Mean over the hemisphere.
    fn average(&self) -> Rgb {
        match self {
            Self::Constant(color) => *color,
            Self::Dielectric(fresnel) => fresnel.average(),
            Self::Metal(fresnel) => fresnel.average(),
            Self::Conductor(fresnel) => fresnel.fit().average(),
            Self::Film(fresnel) => fresnel.average(),
        }
    }

    /// What single scattering keeps of a view at `cos`.
    fn albedo(&self, cos: f32, energy: Option<Energy>, plain: Plain) -> Rgb {
        match self {
            Self::Constant(color) => *color * plain.reflected,
            Self::Dielectric(fresnel) => {
                let blend = energy.map_or_else(|| fresnel.blend(cos), |e| e.reflected_blend(EtaPlace::of(fresnel.eta)));
                fresnel.albedo(plain, blend)
            }
            Self::Metal(fresnel) => fresnel.albedo(plain),
            Self::Conductor(fresnel) => match energy {
                Some(_) => fresnel.fit().albedo(plain),
                None => fresnel.reflectance(cos),
            },
            // Approximation: there are no tables for films, so that of a smooth surface, as far as microfacets keep it;
            // Cycles has the same.
            Self::Film(fresnel) => fresnel.reflectance(cos) * plain.reflected,
        }
        .map(|c| c.max(0.0))
    }
}

/// What single scattering keeps of white microfacets seen at `cos`.
pub(super) fn plain_at(energy: Option<Energy>, cos: f32) -> Plain {
    energy.map_or_else(
        || Plain { reflected: 1.0, reflected_schlick: schlick(cos), reflected_edge: super::fresnel::edge(cos) },
        |energy| energy.plain(),
    )
}

impl Reflection {
    /// Seen from `wo`. `multiscatter` gives back what scatters between microfacets.
    pub fn new(ggx: Option<Ggx>, fresnel: Fresnel, multiscatter: bool, wo: Vec3) -> Self {
        let cos = wo.z.min(1.0);
        // Approximation: stretched microfacets lose light as round ones of their mean width do, which leaves up to
        // 3 % too much near grazing along the wider direction and up to 23 % too little across; as in Cycles.
        let place = ggx.map(|ggx| RoughnessPlace::of(ggx.mean()));
        let energy = place.map(|place| place.at(cos));
        let plain = plain_at(energy, cos);
        let factor = match place {
            Some(place) if multiscatter => {
                compensation(several_bounces(fresnel.average(), place.reflected_average()), plain.reflected)
            }
            _ => Rgb::WHITE,
        };
        let single = fresnel.albedo(cos, energy, plain);
        let albedo = factor * single;
        // Light that is lost between microfacets does not get below either, as in Cycles.
        let taken = if multiscatter { albedo } else { single * (1.0 / plain.reflected.max(LEAST)) };
        Self { ggx, fresnel, factor, albedo, taken }
    }

    /// Share of light that does not reach a layer below.
    pub fn taken(&self) -> Rgb {
        self.taken
    }

    /// See [`super::lobe::AnyLobe::width`].
    pub fn width(&self) -> f32 {
        self.ggx.map_or(0.0, Ggx::mean)
    }

    /// See [`super::lobe::AnyLobe::widen`].
    pub fn widen(&mut self, least: f32) {
        self.ggx = Ggx::widened(self.ggx, least);
    }
}

impl Scatter for Reflection {
    fn albedo(&self) -> Sides {
        Sides::above(self.albedo)
    }

    #[inline]
    fn eval(&self, wo: Vec3, wi: Vec3) -> Value {
        let Some(ggx) = self.ggx.filter(|_| wi.z > 0.0) else { return Value::default() };
        let h = half_vector(wo, wi);
        let cos = wo.dot(h).clamp(0.0, 1.0);
        let f_cos = self.factor * self.fresnel.reflectance(cos) * f_cos(ggx, wo, wi, h);
        Value { f_cos, pdf: pdf(ggx, wo, h) }
    }

    #[inline]
    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        match self.ggx {
            Some(ggx) => sample(ggx, wo, u).map(Drawn::plain),
            None => Some(Drawn { wi: mirrored(wo), eta: 1.0, delta: Some((self.albedo, 1.0)) }),
        }
    }

    fn is_delta(&self) -> bool {
        self.ggx.is_none()
    }
}

/// The mirror image of `wo` about the normal.
#[inline]
pub(super) fn mirrored(wo: Vec3) -> Vec3 {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// Half vector of a reflection, wo and wi above the surface.
#[inline]
pub(super) fn half_vector(wo: Vec3, wi: Vec3) -> Vec3 {
    (wo + wi).normalize_or(Vec3::Z)
}

/// The mirror image of `wo` about `h`.
#[inline]
pub(super) fn reflect(wo: Vec3, h: Vec3) -> Vec3 {
    (h * (2.0 * wo.dot(h)) - wo).normalize()
}

/// D G2 / (4 cos θo) for half vector `h`.
#[inline]
pub(super) fn f_cos(ggx: Ggx, wo: Vec3, wi: Vec3, h: Vec3) -> f32 {
    ggx.d(h) * ggx.shadowing(wo, wi)
}

/// Density of [`sample`].
#[inline]
pub(super) fn pdf(ggx: Ggx, wo: Vec3, h: Vec3) -> f32 {
    ggx.pdf_bounded(wo, h)
}

/// Density of reflecting at a visible normal, whether upwards or not.
#[inline]
pub(super) fn pdf_visible(ggx: Ggx, wo: Vec3, h: Vec3) -> f32 {
    0.5 * ggx.d(h) / (wo.z + ggx.slant(wo))
}

/// A reflected direction; `None` where it points into the surface.
#[inline]
pub(super) fn sample(ggx: Ggx, wo: Vec3, u: [f32; 2]) -> Option<Vec3> {
    let wi = reflect(wo, ggx.sample_bounded(wo, u));
    (wi.z > 0.0).then_some(wi)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn single_scattering_is_reciprocal() {
        let (a, b) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.9, 0.1).normalize());
        let h = half_vector(a, b);
        for alpha in [1e-4, 0.01, 0.3, 1.0] {
            let ggx = Ggx::round(alpha);
            let (f, g) = (f_cos(ggx, a, b, h) / b.z, f_cos(ggx, b, a, h) / a.z);
            assert!((f / g - 1.0).abs() < 1e-5, "{alpha}: {f} {g}");
        }
    }
}
