//! Interference at a thin film on a surface.
//!
//! Laurent Belcour and Pascal Barla, *A Practical Extension to Microfacet Theory for the Modeling of Varying
//! Iridescence*, SIGGRAPH 2017: Airy's sum over the bounces within the film, its spectrum integrated against the
//! eye's sensitivity in Fourier space. Metals of two given reflectances get an index of refraction by Ole
//! Gulbrandsen, *Artist Friendly Metallic Fresnel*, JCGT 3(4), 2014.

use std::f64::consts::TAU;
use std::sync::LazyLock;

use super::cie;
use super::conductor::Conductor;
use super::fresnel::{Dielectric, Metal, f0_from_eta};
use crate::math::{Rgb, sqr};

/// Thinner films are not there, nanometres.
pub(super) const THINNEST: f32 = 0.1;

/// Bounces within the film beyond the first; more make no difference.
const BOUNCES: u32 = 3;

/// What is beneath the film.
#[derive(Clone, Copy, Debug)]
pub(super) enum Base {
    Dielectric(Dielectric),
    Metal(Metal),
    Conductor(Conductor),
}

/// A film on a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Film {
    base: Base,
    /// Nanometres.
    thickness: f32,
    ior: f32,
    /// How much of the surface it covers.
    weight: f32,
}

/// A complex number.
#[derive(Clone, Copy, Debug)]
struct Complex {
    re: f32,
    im: f32,
}

impl Complex {
    fn times(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}

/// Reflectance and phase, as a unit complex number, of light polarized along s and along p.
#[derive(Clone, Copy)]
struct Polarized {
    r: [f32; 2],
    phase: [Complex; 2],
}

impl Film {
    /// Over the share `weight` of `base`.
    pub fn new(base: Base, thickness: f32, ior: f32, weight: f32) -> Self {
        // Below a nanometre the sum of waves has no meaning, and the film fades away.
        let t = thickness.clamp(0.0, 1.0);
        let ior = 1.0 + (ior.max(1e-5) - 1.0) * t * t * (3.0 - 2.0 * t);
        Self { base, thickness, ior, weight }
    }

    /// Reflectance at a microfacet.
    pub fn reflectance(&self, cos: f32) -> Rgb {
        let (film, plain) = match &self.base {
            Base::Dielectric(base) => (scaled(base, self.over_dielectric(cos, base.eta)), base.reflectance(cos)),
            Base::Metal(base) => (self.over_metal(cos, base), base.reflectance(cos)),
            Base::Conductor(base) => (self.over_conductor(cos, base), base.reflectance(cos)),
        };
        plain.lerp(film, self.weight)
    }

    /// Mean over the hemisphere. Approximation: that of the surface without the film, as in Cycles.
    pub fn average(&self) -> Rgb {
        match &self.base {
            Base::Dielectric(base) => base.average(),
            Base::Metal(base) => base.average(),
            Base::Conductor(base) => base.fit().average(),
        }
    }

    fn over_dielectric(&self, cos: f32, eta: f32) -> Rgb {
        self.airy(cos, |cos2| Some([dielectric(cos2, eta / self.ior)?; 3]))
    }

    fn over_metal(&self, cos: f32, metal: &Metal) -> Rgb {
        let edge = metal.reflectance(1.0 / 7.0).to_array();
        let f0 = metal.f0.to_array();
        self.airy(cos, |cos2| {
            Some(std::array::from_fn(|i| {
                let (r, g) = (f0[i].min(0.999), edge[i]);
                let root = r.sqrt();
                let a = (1.0 + root) / (1.0 - root);
                let eta = a + ((1.0 - r) / (1.0 + r) - a) * g;
                let k = ((r * sqr(eta + 1.0) - sqr(eta - 1.0)) / (1.0 - r)).max(0.0).sqrt();
                let mut below = conductor(cos2, self.ior, eta, k);
                // What the film does to the metal's own curve.
                let f0 = reflectance_at_normal(eta / self.ior, k / self.ior);
                let curve = Metal::through(Rgb::splat(f0), Rgb::splat(g)).reflectance(cos2).r;
                below.r = [curve; 2];
                below
            }))
        })
    }

    fn over_conductor(&self, cos: f32, metal: &Conductor) -> Rgb {
        let (eta, k) = (metal.eta.to_array(), metal.k.to_array());
        self.airy(cos, |cos2| Some(std::array::from_fn(|i| conductor(cos2, self.ior, eta[i], k[i]))))
    }

    /// The sum over bounces for what `below` says of each channel at the cosine within the film; all is
    /// reflected where it says nothing.
    fn airy(&self, cos: f32, below: impl Fn(f32) -> Option<[Polarized; 3]>) -> Rgb {
        let Some(above) = dielectric(cos, self.ior) else { return Rgb::WHITE };
        let cos2 = (1.0 - (1.0 - cos * cos) / sqr(self.ior)).max(0.0).sqrt();
        let Some(below) = below(cos2) else { return Rgb::WHITE };
        let difference = 2.0 * self.ior * self.thickness * cos2;
        let waves: [[Complex; 3]; BOUNCES as usize] = std::array::from_fn(|m| sensitivity((m + 1) as f32 * difference));
        let channel = |i: usize| {
            let sum = |side: usize| {
                let (r12, r23) = (above.r[side], below[i].r[side]);
                // Reflection at the film's top from within has the opposite phase.
                let phase = below[i].phase[side];
                let phase = Complex { re: -phase.re * above.phase[side].re, im: -phase.im * above.phase[side].re };
                let passed = 1.0 - r12;
                let once = passed * passed * r23 / (1.0 - r12 * r23).max(1e-6);
                let mut total = once + r12;
                let (mut amplitude, mut turned) = (once - passed, phase);
                for wave in &waves {
                    amplitude *= (r12 * r23).sqrt();
                    total += 2.0 * amplitude * (turned.re * wave[i].re + turned.im * wave[i].im);
                    turned = turned.times(phase);
                }
                total
            };
            (0.5 * (sum(0) + sum(1))).clamp(0.0, 1.0)
        };
        Rgb::new(channel(0), channel(1), channel(2))
    }
}

/// The reflectance of a film over a dielectric whose reflectance at normal incidence is set apart from its
/// index: in proportion near it, not at all where everything is reflected.
fn scaled(base: &Dielectric, film: Rgb) -> Rgb {
    let real = f0_from_eta(base.eta);
    if real <= 1e-5 {
        return film;
    }
    film.zip(base.f0, |f, f0| {
        let s = ((1.0 - f) / (1.0 - real)).clamp(0.0, 1.0);
        f * (1.0 + (f0 / real - 1.0) * s)
    })
}

/// At a boundary to relative index `eta`; `None` for total reflection. Phases are those of the sign.
fn dielectric(cos: f32, eta: f32) -> Option<Polarized> {
    let cos_t_squared = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if cos_t_squared <= 0.0 {
        return None;
    }
    let cos_t = cos_t_squared.sqrt();
    let s = (cos - eta * cos_t) / (cos + eta * cos_t);
    let p = (eta * cos - cos_t) / (eta * cos + cos_t);
    let sign = |x: f32| Complex { re: if x >= 0.0 { 1.0 } else { -1.0 }, im: 0.0 };
    Some(Polarized { r: [s * s, p * p], phase: [sign(s), sign(p)] })
}

fn reflectance_at_normal(eta: f32, k: f32) -> f32 {
    (sqr(eta - 1.0) + k * k) / (sqr(eta + 1.0) + k * k)
}

/// At a boundary from index `from` to the metal's `eta + ik`: Max Born and Emil Wolf, *Principles of Optics*,
/// section 14.4.1.
fn conductor(cos: f32, from: f32, eta: f32, k: f32) -> Polarized {
    let (eta2, k2) = (eta * eta, k * k);
    let t1 = eta2 - k2 - from * from * (1.0 - cos * cos);
    let t2 = (t1 * t1 + sqr(2.0 * eta * k)).sqrt();
    let (u2, v2) = ((0.5 * (t2 + t1)).max(0.0), (0.5 * (t2 - t1)).max(0.0));
    let (u, v) = (u2.sqrt(), v2.sqrt());
    let divide = |a: f32, b: f32| if b > 0.0 { a / b } else { 1.0 };
    let rs = divide(sqr(from * cos - u) + v2, sqr(from * cos + u) + v2);
    let (t3, t4) = ((eta2 - k2) * cos, 2.0 * eta * k * cos);
    let rp = divide(sqr(t3 - from * u) + sqr(t4 - from * v), sqr(t3 + from * u) + sqr(t4 + from * v));
    let unit = |re: f32, im: f32| {
        let length = (re * re + im * im).sqrt();
        if length > 0.0 { Complex { re: re / length, im: im / length } } else { Complex { re: 1.0, im: 0.0 } }
    };
    let s = unit(sqr(from * cos) - u2 - v2, -2.0 * from * cos * v);
    let p = unit(
        sqr((eta2 + k2) * cos) - from * from * (u2 + v2),
        2.0 * from * cos * (2.0 * eta * k * u - (eta2 - k2) * v),
    );
    Polarized { r: [rs, rp], phase: [s, p] }
}

const NODES: usize = 1024;
/// Optical path difference of the last node, nanometres; beyond it the eye sees no interference.
const LARGEST: f32 = 12_000.0;

/// ∫ s(λ) exp(−2πi d/λ) dλ at evenly spaced d, for the sensitivity s of each channel, ∫ s = 1.
static SENSITIVITY: LazyLock<Vec<[Complex; 3]>> = LazyLock::new(|| {
    // Rec. 709 from XYZ.
    const TO_RGB: [[f64; 3]; 3] = [
        [3.240_97, -1.537_383_2, -0.498_610_76],
        [-0.969_243_65, 1.875_967_5, 0.041_555_06],
        [0.055_630_08, -0.203_976_96, 1.056_971_5],
    ];
    let channels: Vec<[f64; 3]> =
        cie::COLOR_MATCHING.iter().map(|xyz| TO_RGB.map(|row| row.iter().zip(xyz).map(|(m, x)| m * x).sum())).collect();
    let total: [f64; 3] = std::array::from_fn(|i| channels.iter().map(|c| c[i]).sum());
    let node = |node: usize| {
        let difference = f64::from(LARGEST) * node as f64 / (NODES - 1) as f64;
        std::array::from_fn(|i| {
            let mut sum = [0.0, 0.0];
            for (k, channel) in channels.iter().enumerate() {
                let phase = TAU * difference / (cie::FIRST + cie::STEP * k as f64);
                sum[0] += channel[i] * phase.cos();
                sum[1] -= channel[i] * phase.sin();
            }
            Complex { re: (sum[0] / total[i]) as f32, im: (sum[1] / total[i]) as f32 }
        })
    };
    (0..NODES).map(node).collect()
});

fn sensitivity(difference: f32) -> [Complex; 3] {
    let scaled = difference * ((NODES - 1) as f32 / LARGEST);
    if scaled >= (NODES - 1) as f32 {
        return [Complex { re: 0.0, im: 0.0 }; 3];
    }
    let (node, table) = (scaled as usize, &*SENSITIVITY);
    let t = scaled - node as f32;
    std::array::from_fn(|i| {
        let (a, b) = (table[node][i], table[node + 1][i]);
        Complex { re: a.re + t * (b.re - a.re), im: a.im + t * (b.im - a.im) }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing tells s from p at normal incidence.
    #[test]
    fn polarizations_are_one_at_normal_incidence() {
        for (eta, k) in [(0.2, 3.0), (1.4, 0.5), (3.0, 0.0)] {
            let (above, below) = (dielectric(1.0, 1.6).unwrap(), conductor(1.0, 1.6, eta, k));
            let turned = |side: usize| [below.phase[side].re, below.phase[side].im].map(|x| x * above.phase[side].re);
            let [s, p] = [turned(0), turned(1)];
            assert!((s[0] - p[0]).abs() < 1e-5 && (s[1] - p[1]).abs() < 1e-5, "{eta} {k}: {s:?} {p:?}");
            assert!((below.r[0] - below.r[1]).abs() < 1e-5);
        }
    }

    /// White furnace of smooth metal in Cycles 5.0.1 (`benches/cycles/materials.py`), films of index 1.6 at 0, 60 and 85
    /// degrees.
    #[test]
    fn films_on_metal_are_those_of_cycles() {
        let gray = Base::Metal(Metal::new(Rgb::splat(0.7), Rgb::WHITE));
        let index = Conductor { eta: Rgb::new(0.183, 0.422, 1.373), k: Rgb::new(3.424, 2.346, 1.770) };
        let table = [
            (gray, 100.0, [[0.4681, 0.5591, 0.6713], [0.4091, 0.4658, 0.6087], [0.6256, 0.6205, 0.8264]]),
            (gray, 600.0, [[0.5685, 0.5444, 0.5585], [0.6061, 0.6781, 0.5543], [0.7505, 0.7336, 0.7809]]),
            (
                Base::Conductor(index),
                300.0,
                [[0.9092, 0.8210, 0.2290], [0.8820, 0.6905, 0.4501], [0.9912, 0.7324, 0.6122]],
            ),
        ];
        for (base, thickness, expected) in table {
            let film = Film::new(base, thickness, 1.6, 1.0);
            for (degrees, expected) in [0.0_f32, 60.0, 85.0].into_iter().zip(expected) {
                let found = film.reflectance(degrees.to_radians().cos()).to_array();
                for (found, expected) in found.into_iter().zip(expected) {
                    assert!((found / expected - 1.0_f32).abs() < 0.01, "{thickness} nm, {degrees}: {found} {expected}");
                }
            }
        }
    }
}
