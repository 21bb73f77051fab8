//! A medium of one kind everywhere, by what its half space reflects.
//!
//! Matt Jen-Yuan Chiang, Peter Kutz, Brent Burley: *Practical and Controllable Subsurface Scattering for Production
//! Path Tracing*, SIGGRAPH Talks 2016; with anisotropy: Magnus Wrenninge, Ryusuke Villemin, Christophe Hery: *Path
//! Traced Subsurface Scattering using Anisotropic Phase Functions and Non-Exponential Free Flights*, Pixar 17-07,
//! whose fit Cycles has. Eugene d'Eon: *A Hitchhiker's Guide to Multiple Scattering*, 0.3.2, equation 53.7, which
//! OpenPBR takes over.

use crate::math::{Rgb, sqr};

/// Largest albedo: what loses nothing need never come out.
const LARGEST_ALBEDO: f32 = 0.999_999;

/// Smallest albedo that a walk has; below it the walk's weight goes down in its place, as Cycles has it, since
/// steps that are guided by the albedo would have no bound.
const SMALLEST_ALBEDO: f32 = 0.2;

/// How the albedo of a medium is found from the color of its half space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Inversion {
    /// By the fit of Wrenninge et al. for 0 to 0.9 of anisotropy; the radius is the mean free path of a medium of
    /// none that looks alike.
    Cycles,
    /// By van de Hulst's similarity, for any anisotropy; the radius is the mean free path.
    SimilarHalfSpaces,
}

/// A medium that scatters and absorbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Extinction per metre.
    pub sigma_t: Rgb,
    /// Single-scattering albedo.
    pub albedo: Rgb,
    /// Mean cosine of scattering.
    pub anisotropy: f32,
    /// What the color of the surface, times this, leaves to the walk.
    pub scale: Rgb,
}

impl Medium {
    /// The medium whose half space is of `color`, 0 to 1, with mean free paths `radius` in metres.
    pub(super) fn new(color: Rgb, radius: Rgb, anisotropy: f32, by: Inversion) -> Self {
        let radius = radius.map(|r| r.max(1e-16));
        let (sigma_t, albedo) = match by {
            Inversion::Cycles => {
                let fit = Fit::new(anisotropy);
                (radius.map(|r| 1.0 / (r * (1.0 - anisotropy))), color.map(|c| fit.albedo(c)))
            }
            Inversion::SimilarHalfSpaces => (radius.map(|r| 1.0 / r), color.map(|c| similar(c, anisotropy))),
        };
        let albedo = albedo.map(|a| a.clamp(0.0, LARGEST_ALBEDO));
        let scale = albedo.zip(color, |a, c| if c > 0.0 { (a / SMALLEST_ALBEDO).min(1.0) / c } else { 0.0 });
        Self { sigma_t, albedo: albedo.map(|a| a.max(SMALLEST_ALBEDO)), anisotropy, scale }
    }
}

/// d'Eon, equation 53.7.
fn similar(color: f32, g: f32) -> f32 {
    let s = 4.208_63 * color - (9.592_17 + 41.680_8 * color + 17.712_6 * sqr(color)).sqrt() + 4.097_12;
    (1.0 - sqr(s)) / (1.0 - g * sqr(s)).max(1e-6)
}

/// The fit of Wrenninge et al. for one anisotropy.
struct Fit {
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
    f: f32,
}

impl Fit {
    fn new(g: f32) -> Self {
        let polynomial = |k: &[f64]| k.iter().rev().fold(0.0, |sum, k| sum * f64::from(g) + k);
        let b = [0.0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505, 2731.71560286, -1935.41424244];
        let b = polynomial(&[&b[..], &[559.009054474]].concat());
        let e = [0.0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998, 7116.60171912, -4763.54467887];
        let e = polynomial(&[&e[..], &[1303.5318055]].concat());
        Self {
            a: polynomial(&[
                1.8260523782,
                -1.28451056436,
                -1.79904629312,
                9.19393289202,
                -22.8215585862,
                32.0234874259,
                -23.6264803333,
                7.21067002658,
            ]) as f32,
            b: (4.98511194385 + 0.127355959438 * b.exp()) as f32,
            c: polynomial(&[
                1.09686102424,
                -0.394704063468,
                1.05258115941,
                -8.83963712726,
                28.8643230661,
                -46.8802913581,
                38.5402837518,
                -12.7181042538,
            ]) as f32,
            d: polynomial(&[
                0.496310210422,
                0.360146581622,
                -2.15139309747,
                17.8896899217,
                -55.2984010333,
                82.065982243,
                -58.5106008578,
                15.8478295021,
            ]) as f32,
            e: (4.23190299701 + 0.00310603949088 * e.exp()) as f32,
            f: polynomial(&[
                2.40602999408,
                -2.51814844609,
                9.18494908356,
                -79.2191708682,
                259.082868209,
                -403.613804597,
                302.85712436,
                -87.4370473567,
            ]) as f32,
        }
    }

    fn albedo(&self, color: f32) -> f32 {
        let blend = color.powf(0.25);
        (1.0 - blend) * self.a * (self.b * color).atan().powf(self.c)
            + blend * self.d * (self.e * color).atan().powf(self.f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both fits are of the same thing; where there is no anisotropy they must nearly agree.
    #[test]
    fn the_two_inversions_agree_on_media_that_scatter_evenly() {
        for color in [0.1, 0.3, 0.5, 0.7, 0.9, 0.99] {
            let (fit, similar) = (Fit::new(0.0).albedo(color), similar(color, 0.0));
            assert!((fit - similar).abs() < 0.012, "{color}: {fit}, {similar}");
        }
    }

    #[test]
    fn little_albedo_becomes_little_weight() {
        let dark = Medium::new(Rgb::new(0.0, 0.01, 0.8), Rgb::splat(0.1), 0.0, Inversion::Cycles);
        assert_eq!((dark.scale.r, dark.albedo.g), (0.0, SMALLEST_ALBEDO));
        let known = Fit::new(0.0).albedo(0.01);
        assert!((dark.scale.g * 0.01 * SMALLEST_ALBEDO - known).abs() < 1e-6);
        assert!((dark.scale.b - 1.25).abs() < 1e-6 && (dark.sigma_t.b - 10.0).abs() < 1e-4);
        let white = Medium::new(Rgb::WHITE, Rgb::splat(0.1), 0.5, Inversion::Cycles);
        assert!(white.albedo.r > 0.999 && (white.sigma_t.r - 20.0).abs() < 1e-4);
    }
}
