//! The way beneath a surface: where light that a walk inside will scatter goes in.
//!
//! As Cycles 5.0 has it: through microfacets that refract, or half of the time cosine-distributed (*Random Walk
//! (Skin)*). What it meets there is a [`Medium`], or a [`Profile`] alone; it comes out by Lambert's law.

use super::closure::unit;
use super::fresnel::refract;
use super::ggx::Ggx;
use super::lobe::{Drawn, Scatter, Sides, Value};
use super::medium::{Inversion, Medium};
use super::mixture::{Builder, Class};
use super::profile::Profile;
use super::thin::mirrored;
use crate::math::{Rgb, Vec3};
use crate::sampling::warp::sample_cosine_hemisphere;

/// Mean free paths below this, metres, are those of a surface: Cycles' limit.
const SMALLEST_RADIUS: f32 = 1e-8;

/// Longer ones, metres, are no different, and their squares are numbers.
const LARGEST_RADIUS: f32 = 1e12;

/// What the radius means, and how light goes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Blender's *Random Walk*: 4π times the mean free path; in by refraction.
    Walk,
    /// Blender's *Random Walk (Skin)*: the mean free path is shorter the whiter the color is; in by refraction at
    /// microfacets of width 1 and index `ior`, or cosine-distributed.
    Skin,
    /// The mean free path itself, as MaterialX and OpenPBR define it; in by refraction.
    FreePath,
    /// Blender's *Christensen-Burley*: 4π times the length of a profile of distances; no walk at all.
    Profile,
}

/// What light that goes beneath a surface finds there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inside {
    /// Something to walk in.
    Medium(Medium),
    /// Distances at which it comes out.
    Profile(Profile),
}

/// What lies beneath a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beneath {
    /// What it is.
    pub inside: Inside,
    /// See [`Subsurface::shallow`].
    pub shallow: bool,
}

/// Light that scatters beneath a surface, with colors of type `C` and numbers of type `S` as in
/// [`Surface`](super::Surface).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Subsurface<C = Rgb, S = f32> {
    /// Share of the diffuse light, 0 to 1.
    pub weight: S,
    /// What the half space reflects diffusely, 0 to 1.
    pub color: C,
    /// Metres, per channel; see [`Method`].
    pub radius: C,
    /// Mean cosine of scattering: 0 to 0.9, of a free path −0.99 to 0.99.
    pub anisotropy: S,
    /// Index of refraction by which light goes in, 1.01 to 3.8.
    pub ior: S,
    /// What the radius means.
    pub method: Method,
    /// True where it is Lambert's surface to light that has been scattered diffusely on its way to the eye.
    pub shallow: bool,
}

impl<C, S> Subsurface<C, S> {
    /// See [`Surface::map`](super::Surface::map).
    pub fn map<D, T>(&self, mut color: impl FnMut(&C) -> D, mut scalar: impl FnMut(&S) -> T) -> Subsurface<D, T> {
        Subsurface {
            weight: scalar(&self.weight),
            color: color(&self.color),
            radius: color(&self.radius),
            anisotropy: scalar(&self.anisotropy),
            ior: scalar(&self.ior),
            method: self.method,
            shallow: self.shallow,
        }
    }
}

/// A way in that is always taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct WayIn {
    color: Rgb,
    /// Mean free path but for Cycles' factor of anisotropy.
    radius: Rgb,
    anisotropy: f32,
    ior: f32,
    /// Microfacet width.
    alpha: f32,
    method: Method,
    shallow: bool,
}

impl WayIn {
    /// What it leads to.
    pub fn beneath(&self) -> Beneath {
        let medium = |by| Inside::Medium(Medium::new(self.color, self.radius, self.anisotropy, by));
        let inside = match self.method {
            Method::Walk | Method::Skin => medium(Inversion::Cycles),
            Method::FreePath => medium(Inversion::SimilarHalfSpaces),
            Method::Profile => Inside::Profile(Profile { length: self.radius }),
        };
        Beneath { inside, shallow: self.shallow }
    }
}

impl Scatter for WayIn {
    fn albedo(&self) -> Sides {
        Sides::above(Rgb::WHITE)
    }

    /// No light from outside is scattered where it arrives.
    fn eval(&self, _wo: Vec3, _wi: Vec3) -> Value {
        Value::default()
    }

    fn sample(&self, wo: Vec3, uc: f32, u: [f32; 2]) -> Option<Drawn> {
        let wi = if self.method == Method::Skin && uc < 0.5 {
            mirrored(sample_cosine_hemisphere(u))
        } else {
            let h = Ggx::new([self.alpha; 2]).map_or(Vec3::Z, |ggx| ggx.sample_visible(wo, u));
            // Whatever part of it a boundary would reflect: the layers above have had it.
            refract(wo, h, self.ior)?
        };
        Some(Drawn { wi, eta: 1.0, delta: Some((Rgb::WHITE, 1.0)) })
    }

    fn is_delta(&self) -> bool {
        true
    }
}

impl Builder<'_> {
    /// Adds the light that scatters beneath the surface, together times `weight`; `alpha` is the width of the
    /// microfacets through which it goes in.
    pub(super) fn add_beneath(&mut self, weight: Rgb, subsurface: &Subsurface, alpha: f32) {
        let color = subsurface.color.map(unit);
        let weight = weight * color;
        let walks = |radius: f32| radius >= SMALLEST_RADIUS;
        let of =
            |walked: bool| weight.zip(subsurface.radius, |w, radius| if walks(radius) == walked { w } else { 0.0 });
        self.add_diffuse(of(false), Rgb::WHITE, 0.0, false);
        if subsurface.radius.to_array().into_iter().any(walks) {
            self.push(of(true), Class::Diffuse, None, way_in(subsurface, color, alpha));
        }
    }
}

fn way_in(subsurface: &Subsurface, color: Rgb, alpha: f32) -> WayIn {
    let method = subsurface.method;
    let ior = if subsurface.ior > 1.01 { subsurface.ior.min(3.8) } else { 1.01 };
    let radius = subsurface.radius.map(|r| if r >= SMALLEST_RADIUS { r.min(LARGEST_RADIUS) } else { 0.0 });
    let radius = match method {
        Method::Walk | Method::Profile => radius * (0.25 * std::f32::consts::FRAC_1_PI),
        Method::Skin => radius.zip(color, |r, c| r * (3.0 * (1.0 - dipole_albedo(c, ior))).sqrt()),
        Method::FreePath => radius,
    };
    let range = if method == Method::FreePath { [-0.99, 0.99] } else { [0.0, 0.9] };
    let anisotropy = subsurface.anisotropy;
    let anisotropy = if anisotropy.is_nan() { 0.0 } else { anisotropy.clamp(range[0], range[1]) };
    let alpha = if method == Method::Skin { 1.0 } else { unit(alpha) };
    WayIn { color, radius, anisotropy, ior, alpha, method, shallow: subsurface.shallow }
}

/// The reduced albedo of a medium of index `ior` whose half space reflects `color` by the dipole: Jensen, Marschner,
/// Levoy and Hanrahan, *A Practical Model for Subsurface Light Transport*, SIGGRAPH 2001, section 2.4.
fn dipole_albedo(color: f32, ior: f32) -> f32 {
    if color < 1e-4 {
        return 0.0;
    }
    if color >= 0.995 {
        return 0.999_999;
    }
    let inverse = 1.0 / ior;
    let reflected = inverse * (0.710 - 1.440 * inverse) + 0.668 + 0.0636 * ior;
    let four_thirds_a = 4.0 / 3.0 * (1.0 + reflected) / (1.0 - reflected);
    let reflectance = |albedo: f32| {
        let s = (3.0 * (1.0 - albedo)).sqrt();
        0.5 * albedo * (1.0 + (-four_thirds_a * s).exp()) * (-s).exp()
    };
    // Bisected, as often as Cycles does it: its steps can be seen in the last digits.
    let [mut low, mut high] = [0.0_f32, 1.0];
    let mut middle = 0.5;
    for _ in 0..12 {
        middle = 0.5 * (low + high);
        if reflectance(middle) < color {
            low = middle;
        } else {
            high = middle;
        }
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dipole_reflects_the_color_that_its_albedo_was_found_for() {
        // Index-matched, a conservative half space reflects everything.
        assert!(dipole_albedo(0.99, 1.0) > 0.999);
        let mut last = 0.0;
        for color in [0.05, 0.2, 0.5, 0.8, 0.95] {
            let albedo = dipole_albedo(color, 1.4);
            assert!(albedo > last && albedo < 1.0, "{color}: {albedo}");
            last = albedo;
        }
    }

    #[test]
    fn light_goes_in_and_never_stays_above() {
        let white = Subsurface {
            weight: 1.0,
            color: Rgb::WHITE,
            radius: Rgb::splat(0.1),
            anisotropy: 0.0,
            ior: 1.4,
            method: Method::Walk,
            shallow: false,
        };
        let wo = Vec3::new(0.8, 0.0, 0.6);
        for method in [Method::Walk, Method::Skin, Method::FreePath, Method::Profile] {
            for (i, alpha) in [(0, 0.0), (1, 0.25), (2, 1.0)] {
                let lobe = way_in(&Subsurface { method, ..white }, Rgb::WHITE, alpha);
                for k in 0..64 {
                    let u = [(k as f32 + 0.5) / 64.0, (k * 13 % 64) as f32 / 64.0];
                    let wi = lobe.sample(wo, u[1], u).unwrap().wi;
                    assert!(wi.z < 0.0 && (wi.length_squared() - 1.0).abs() < 1e-5, "{method:?} {i}: {wi}");
                }
            }
        }
        // Smooth: Snell's law.
        let wi = way_in(&white, Rgb::WHITE, 0.0).sample(wo, 0.5, [0.5; 2]).unwrap().wi;
        assert!((wi.x + 0.8 / 1.4).abs() < 1e-6, "{wi}");
    }

    #[test]
    fn channels_of_no_radius_are_lamberts() {
        let mut bsdf = crate::bsdf::Bsdf::none();
        let mut builder = Builder::new(&mut bsdf, Vec3::Z, Vec3::Z, true);
        let subsurface = Subsurface {
            weight: 1.0,
            color: Rgb::new(0.5, 0.6, 0.7),
            radius: Rgb::new(0.1, 0.0, -1.0),
            anisotropy: 0.0,
            ior: 1.4,
            method: Method::Walk,
            shallow: false,
        };
        builder.add_beneath(Rgb::WHITE, &subsurface, 0.25);
        builder.finish();
        let diffuse = bsdf.eval(Vec3::Z).f_cos.diffuse * std::f32::consts::PI;
        assert_eq!((diffuse.r, (diffuse.g - 0.6).abs() < 1e-6, (diffuse.b - 0.7).abs() < 1e-6), (0.0, true, true));
        let entering = bsdf.sample(0.999, [0.5; 2]).unwrap();
        let beneath = bsdf.beneath(entering.beneath.unwrap());
        assert!(entering.wi.z < 0.0 && beneath.is_some());
        assert_eq!(entering.weight.diffuse.g, 0.0);
        assert_eq!(bsdf.color().diffuse.r, 0.5);
    }
}
