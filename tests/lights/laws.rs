//! The laws: each takes a light, a point and the irradiance that is known there.
//!
//! Irradiances, radiances and their estimates are luminances, cosines are clamped at the receiver's
//! horizon. Failures of all cases are gathered, so that one run tells everything.
#![allow(dead_code, reason = "not every light needs all of it")]

use std::f64::consts::{PI, TAU};

use penumbra::light::{AnyEmitter, Emitter, EmitterHit, LightSample, Receiver};
use penumbra::math::{DVec3, Frame, Rgb, Vec3};
use penumbra::sampling::{Decision, Dimension, Pattern, Sampler, power_heuristic, warp};

use crate::chi2::{self, Grid};

/// A light, the point that it lights, and what is known of it there.
#[derive(Clone)]
pub struct Case {
    pub name: String,
    pub light: AnyEmitter,
    pub p: Vec3,
    /// Unit normal of the receiving surface.
    pub n: Vec3,
    /// Irradiance by closed form or f64 quadrature.
    pub irradiance: f64,
    /// Axis and half angle (radians) of a cone of directions from `p` that holds the light; `None` for
    /// the whole sphere. Quadrature needs it to be no more than some ten times as wide as the light.
    pub cone: Option<(Vec3, f64)>,
    /// For mesh lights: what a ray along wi meets. `None`: `Emitter::hit` for lamps, nothing for
    /// background lights.
    pub hit: Option<fn(&Case, Vec3) -> Option<EmitterHit>>,
    /// For mesh lights, whose emission is their surface's: radiance that a ray along wi gets from what it
    /// met. `None`: `Emitter::le`, and no law of rays for meshes.
    pub radiance: Option<fn(&Case, Vec3, &EmitterHit) -> Rgb>,
}

impl Case {
    pub fn new(name: impl Into<String>, light: impl Into<AnyEmitter>, p: Vec3, n: Vec3, irradiance: f64) -> Self {
        let (name, light) = (name.into(), light.into());
        Self { name, light, p, n, irradiance, cone: None, hit: None, radiance: None }
    }

    pub fn within(self, axis: Vec3, half_angle: f64) -> Self {
        Self { cone: Some((axis, half_angle)), ..self }
    }

    fn receiver(&self, n: Option<Vec3>, alone: bool) -> Receiver {
        Receiver { p: self.p, n, class: 0, alone, time: 0.0 }
    }

    /// What a ray along `wi` finds: `None` where it misses the light, `Some(None)` for the background.
    fn meet(&self, wi: Vec3) -> Option<Option<EmitterHit>> {
        match self.hit {
            Some(hit) => hit(self, wi).map(Some),
            None if self.light.in_background() => Some(None),
            None => self.light.hit(self.p, wi).map(Some),
        }
    }

    /// True where the tests know what a ray sees of the light.
    fn is_seen(&self) -> bool {
        self.radiance.is_some() || !matches!(self.light, AnyEmitter::MeshLight(_))
    }

    fn radiance(&self, wi: Vec3, hit: Option<&EmitterHit>) -> f64 {
        let rgb = match (self.radiance, hit) {
            (Some(radiance), Some(hit)) => radiance(self, wi, hit),
            _ => self.light.le(wi, hit),
        };
        f64::from(rgb.luminance())
    }

    /// Density and radiance along `wi`; both 0 where the light isn't met. Where radiance is unknown it
    /// counts as 1.
    fn along(&self, at: &Receiver, wi: Vec3) -> (f64, f64) {
        let Some(hit) = self.meet(wi) else { return (0.0, 0.0) };
        let le = if self.is_seen() { self.radiance(wi, hit.as_ref()) } else { 1.0 };
        (f64::from(self.light.pdf_li(at, wi, hit.as_ref())), le)
    }

    fn cos(&self, wi: Vec3) -> f64 {
        self.n.as_dvec3().dot(wi.as_dvec3()).max(0.0)
    }

    fn sample(&self, at: &Receiver, sampler: &Sampler) -> Option<LightSample> {
        let uc = sampler.get_1d(Dimension::at_bounce(0, Decision::LightChoice));
        self.light.sample_li(at, uc, sampler.get_2d(Dimension::at_bounce(0, Decision::LightPoint)))
    }

    /// True for lights that only their own samples find.
    fn is_delta(&self) -> bool {
        let at = self.receiver(Some(self.n), true);
        samples(self, &at, Pattern::Sobol, 64).flatten().next().is_some_and(|s| s.delta)
    }
}

/// Light-only irradiance at 2^16 Sobol samples within 0.1 %; pdf of a sample equals pdf_li of its
/// direction; what is sampled is what a ray sees (li = le); pdf integrates to 1 (quadrature);
/// chi-square of samples against pdf; light-only, cosine-only and MIS estimates agree within their
/// error. Of delta lights the irradiance, and that rays never find them.
pub fn hold(cases: &[Case]) {
    report(cases, |case| {
        irradiance(case)?;
        if case.is_delta() {
            return delta(case);
        }
        samples_are_what_rays_find(case)?;
        for (n, alone) in receivers(case) {
            density(case, &case.receiver(n, alone), 3 * cases.len())?;
        }
        if case.is_seen() { estimators(case) } else { Ok(()) }
    });
}

/// Only the irradiance law (for extreme scales where quadrature of the pdf is not meaningful).
pub fn irradiance_holds(cases: &[Case]) {
    report(cases, irradiance);
}

fn report(cases: &[Case], law: impl Fn(&Case) -> Result<(), String>) {
    let wrong: Vec<String> =
        cases.iter().filter_map(|case| law(case).err().map(|e| format!("{}: {e}", case.name))).collect();
    assert!(wrong.is_empty(), "{} of {} cases:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

fn samples<'a>(
    case: &'a Case,
    at: &'a Receiver,
    pattern: Pattern,
    n: u64,
) -> impl Iterator<Item = Option<LightSample>> + 'a {
    let sampler = Sampler::new(pattern, 7);
    (0..n).map(move |i| case.sample(at, &sampler.for_sample(0, 0, i)))
}

/// Σ li cos / pdf with and without the receiver's normal; every sample is a possible one.
fn irradiance(case: &Case) -> Result<(), String> {
    let n = 1 << 16;
    for normal in [Some(case.n), None] {
        let at = case.receiver(normal, true);
        let (mut sum, mut reaches) = (0.0, false);
        for s in samples(case, &at, Pattern::Sobol, n).flatten() {
            let li = f64::from(s.li.luminance());
            let sane = s.li.is_finite() && li >= 0.0 && s.pdf.is_finite() && s.pdf > 0.0;
            if !sane || (s.wi.as_dvec3().length() - 1.0).abs() > 1e-5 {
                return Err(format!("impossible sample {s:?}"));
            }
            reaches |= li * case.cos(s.wi) > 0.0;
            sum += li * case.cos(s.wi) / f64::from(s.pdf);
        }
        let found = sum / n as f64;
        if (found - case.irradiance).abs() > 1e-3 * case.irradiance {
            let error = 100.0 * (found / case.irradiance - 1.0);
            return Err(format!("irradiance {found:e}, not {:e}: {error:+.4} %, {at:?}", case.irradiance));
        }
        let importance = case.light.importance(&at);
        if !importance.is_finite() || importance < 0.0 || (reaches && importance == 0.0) {
            return Err(format!("importance {importance} of a light that brings {found:e}, {at:?}"));
        }
    }
    Ok(())
}

fn delta(case: &Case) -> Result<(), String> {
    for (n, alone) in [(Some(case.n), true), (None, true), (Some(case.n), false)] {
        let at = case.receiver(n, alone);
        for s in samples(case, &at, Pattern::Sobol, 64).flatten() {
            let (asked, _) = case.along(&at, s.wi);
            if !s.delta || s.pdf != 1.0 || asked != 0.0 {
                return Err(format!("a delta with densities {} and {asked}", s.pdf));
            }
        }
    }
    Ok(())
}

/// Directions within what rounding does to a direction and to the point that it came from.
fn nearby(wi: Vec3) -> impl Iterator<Item = Vec3> {
    let frame = Frame::from_z(wi);
    let (s, t) = (frame.s.as_dvec3(), frame.t.as_dvec3());
    let around = (0..8).map(move |i| {
        let (sin, cos) = (TAU * f64::from(i) / 8.0).sin_cos();
        (wi.as_dvec3() + (s * cos + t * sin) * 5e-7).normalize().as_vec3()
    });
    std::iter::once(wi).chain(around)
}

/// A ray along a sampled direction meets the light with the sample's density and radiance, and the
/// sample's end lies just before it. Density and radiance may be those of any direction as near as
/// rounding: at an edge some of them miss.
fn samples_are_what_rays_find(case: &Case) -> Result<(), String> {
    for (n, alone) in [(Some(case.n), true), (None, true), (Some(case.n), false)] {
        let at = case.receiver(n, alone);
        for s in samples(case, &at, Pattern::Sobol, 1 << 10).flatten() {
            let (mut pdfs, mut radiances) = (Vec::new(), Vec::new());
            for wi in nearby(s.wi) {
                if let Some(hit) = case.meet(wi) {
                    pdfs.push(f64::from(case.light.pdf_li(&at, wi, hit.as_ref())));
                    radiances.push(case.radiance(wi, hit.as_ref()));
                }
            }
            if let Some((axis, half)) = case.cone {
                let angle = s.wi.as_dvec3().cross(axis.as_dvec3()).length().asin();
                if s.wi.dot(axis) > 0.0 && half < 0.5 * PI && angle > half * 1.001 + 1e-6 {
                    return Err(format!("a sample {angle} rad from the axis of a cone of {half} rad"));
                }
            }
            if !within(f64::from(s.pdf), &pdfs, 1e-3) {
                return Err(format!("sampled with density {}, asked {pdfs:?} along {}, {at:?}", s.pdf, s.wi));
            }
            if case.is_seen() && !within(f64::from(s.li.luminance()), &radiances, 1e-3) {
                return Err(format!("sampled {:?}, a ray along {} sees {radiances:?}", s.li, s.wi));
            }
            if let (Some(end), Some(Some(hit))) = (s.end, case.meet(s.wi)) {
                let to_end = f64::from((end - case.p).length());
                let dist = f64::from(hit.dist);
                let scale = f64::from(end.abs().max_element().max(case.p.abs().max_element()));
                if to_end > dist * (1.0 + 2e-6) || to_end < 0.99 * dist - 1e-5 * scale {
                    return Err(format!("a shadow ray ends after {to_end}, the light is at {dist}"));
                }
            }
        }
    }
    Ok(())
}

fn within(value: f64, others: &[f64], relative: f64) -> bool {
    let low = others.iter().copied().fold(f64::INFINITY, f64::min);
    let high = others.iter().copied().fold(0.0, f64::max);
    value >= low * (1.0 - relative) && value <= high * (1.0 + relative)
}

/// The kinds of receivers to which the light has different densities.
fn receivers(case: &Case) -> Vec<(Option<Vec3>, bool)> {
    let first = (Some(case.n), true);
    let mut all = vec![first];
    for other in [(None, true), (Some(case.n), false)] {
        let (a, b) = (case.receiver(first.0, first.1), case.receiver(other.0, other.1));
        let seen = samples(case, &b, Pattern::Sobol, 64);
        if seen.flatten().any(|s| case.along(&a, s.wi).0 != case.along(&b, s.wi).0) {
            all.push(other);
        }
    }
    all
}

/// Directions as points of the unit square, in proportion to solid angle: azimuth around the axis of a
/// cone and `(1 − cos θ) / (1 − cos θ_max)`, which keep their digits in cones of 1e-6 radians.
struct Square {
    s: DVec3,
    t: DVec3,
    axis: DVec3,
    one_minus_cos: f64,
}

impl Square {
    fn new(case: &Case) -> Self {
        let (axis, half) = case.cone.unwrap_or((Vec3::Y, PI));
        let axis = axis.as_dvec3().normalize();
        let s = axis.any_orthonormal_vector();
        Self { s, t: axis.cross(s), axis, one_minus_cos: 2.0 * (0.5 * half).sin().powi(2) }
    }

    fn solid_angle(&self) -> f64 {
        TAU * self.one_minus_cos
    }

    fn direction(&self, x: f64, y: f64) -> Vec3 {
        let h = y * self.one_minus_cos;
        let r = (h * (2.0 - h)).sqrt();
        let (sin, cos) = (TAU * x).sin_cos();
        (self.axis * (1.0 - h) + (self.s * cos + self.t * sin) * r).as_vec3()
    }

    fn of(&self, wi: Vec3) -> [f64; 2] {
        let wi = wi.as_dvec3();
        let (x, y, cos) = (wi.dot(self.s), wi.dot(self.t), wi.dot(self.axis));
        let h = if cos > 0.0 { (x * x + y * y) / (1.0 + cos) } else { 1.0 - cos };
        [y.atan2(x).rem_euclid(TAU) / TAU, (h / self.one_minus_cos).clamp(0.0, 1.0)]
    }
}

/// The density where the light shines integrates to the share of samples that find light (all of them
/// save for lights that are black in parts), and samples spread as it says.
///
/// Each of the 256 cells is integrated until halving changes it by less than 2e-5, which at worst adds
/// up to 5e-3; most edges cut cells at random, so that errors add up as their root: 3e-4. Those of a sun
/// about the axis run along a row of cells, which err alike: 1.1e-3. The law is held to 1.2e-3, in narrow
/// cones plus the part of the light's edge that `f32` directions (steps of 6e-8) can not tell from the
/// outside.
fn density(case: &Case, at: &Receiver, tests: usize) -> Result<(), String> {
    let grid = Grid { nx: 16, ny: 16 };
    let square = Square::new(case);
    let density = |x: f64, y: f64| {
        let (pdf, le) = case.along(at, square.direction(x, y));
        if le > 0.0 { pdf * square.solid_angle() } else { 0.0 }
    };
    let mass = grid.integrals(&density, 2e-5);
    let total: f64 = mass.iter().sum();

    let n = 1 << 16;
    let found = samples(case, at, Pattern::Sobol, n).flatten().count() as f64 / n as f64;
    let tolerance = 1.2e-3 + 6e-8 / case.cone.map_or(PI, |(_, half)| half);
    if (total - found).abs() > tolerance {
        return Err(format!("density integrates to {total}, {found} of the samples find light, {at:?}"));
    }

    let n = 1 << 14;
    let mut observed = vec![0.0; mass.len()];
    for s in samples(case, at, Pattern::Independent, n).flatten() {
        observed[grid.cell(square.of(s.wi))] += 1.0;
    }
    let mut expected: Vec<f64> = mass.iter().map(|m| m * n as f64).collect();
    // Samples that found no light are a cell of their own.
    observed.push(n as f64 - observed.iter().sum::<f64>());
    expected.push((1.0 - found) * n as f64);
    chi2::check(&observed, &expected, tests).map_err(|e| format!("{e}, {at:?}"))
}

/// Sums of one estimator over scrambles that are independent of each other.
#[derive(Default)]
struct Estimate {
    means: Vec<f64>,
    sum: f64,
    squares: f64,
}

impl Estimate {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
        if let Some(last) = self.means.last_mut() {
            *last += value;
        }
    }

    /// Mean and standard error of the mean, `n` samples a scramble.
    fn result(&self, n: f64) -> (f64, f64) {
        let count = self.means.len() as f64;
        let mean = self.means.iter().sum::<f64>() / (n * count);
        let variance: f64 = self.means.iter().map(|m| (m / n - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (mean, (variance / count).sqrt())
    }

    /// How many equal samples would vary as much: few of them say nothing of their error.
    fn effective_samples(&self) -> f64 {
        self.sum * self.sum / self.squares.max(f64::MIN_POSITIVE)
    }
}

/// Light samples alone, directions of the surface alone, and both with the power heuristic find the
/// irradiance that is known, each within four of its standard errors.
fn estimators(case: &Case) -> Result<(), String> {
    let (scrambles, n) = (64, 1 << 10);
    let (alone, shared) = (case.receiver(Some(case.n), true), case.receiver(Some(case.n), false));
    let frame = Frame::from_z(case.n);
    let mut estimates = [Estimate::default(), Estimate::default(), Estimate::default()];
    for seed in 0..scrambles {
        let sampler = Sampler::new(Pattern::Sobol, 1000 + seed);
        estimates.iter_mut().for_each(|e| e.means.push(0.0));
        for i in 0..n {
            let sampler = sampler.for_sample(0, 0, i);
            let contribution = |s: &LightSample| f64::from(s.li.luminance()) * case.cos(s.wi) / f64::from(s.pdf);
            let light_only = case.sample(&alone, &sampler).map_or(0.0, |s| contribution(&s));
            let mut mis = case.sample(&shared, &sampler).map_or(0.0, |s| {
                let other = warp::pdf_cosine_hemisphere(case.n.dot(s.wi));
                contribution(&s) * f64::from(power_heuristic(s.pdf, other))
            });

            let u = sampler.get_2d(Dimension::at_bounce(0, Decision::BsdfDirection));
            let wi = frame.to_world(warp::sample_cosine_hemisphere(u));
            let (pdf_light, le) = case.along(&shared, wi);
            let pdf = warp::pdf_cosine_hemisphere(case.n.dot(wi));
            mis += PI * le * f64::from(power_heuristic(pdf, pdf_light as f32));
            for (estimate, value) in estimates.iter_mut().zip([light_only, PI * le, mis]) {
                estimate.add(value);
            }
        }
    }
    for (name, estimate) in ["light-only", "cosine-only", "MIS"].iter().zip(&estimates) {
        if *name == "cosine-only" && estimate.effective_samples() < 500.0 {
            continue;
        }
        let (mean, error) = estimate.result(n as f64);
        // The floor is for the rounding of f32, of which there is no scatter.
        if (mean - case.irradiance).abs() > 4.0 * error + 1e-4 * case.irradiance {
            let standard = (mean - case.irradiance) / error;
            return Err(format!("{name} {mean:e} ± {error:e}, not {:e}: {standard:+.1} errors", case.irradiance));
        }
    }
    Ok(())
}

mod tests {
    use super::*;
    use penumbra::light::{Distant, Point};

    const TILTED: Vec3 = Vec3::new(0.6, 0.8, 0.0);

    fn sun(irradiance: f64) -> Case {
        let sun = Distant::new(TILTED, 0.2, Rgb::splat(2.0));
        Case::new("sun", sun, Vec3::ZERO, Vec3::Y, irradiance).within(TILTED, 0.11)
    }

    #[test]
    fn a_right_light_holds() {
        let point = Point { p: Vec3::Y * 2.0, intensity: Rgb::WHITE, profile: None };
        hold(&[sun(1.6), Case::new("point", point, Vec3::ZERO, Vec3::Y, 0.25)]);
    }

    #[test]
    #[should_panic(expected = "irradiance")]
    fn a_wrong_irradiance_is_found() {
        hold(&[sun(1.602)]);
    }

    #[test]
    #[should_panic(expected = "density integrates")]
    fn a_wrong_density_is_found() {
        // Rays that find but a half of the light: the density there doesn't make up for it.
        let half = |_: &Case, wi: Vec3| {
            let hit = EmitterHit { dist: 1.0, ng: -wi, triangle: 0, uv: [0.0; 2] };
            (wi.z > 0.0).then_some(hit)
        };
        let case = Case { hit: Some(half), ..sun(1.6) };
        density(&case, &case.receiver(None, true), 1).unwrap();
    }
}
