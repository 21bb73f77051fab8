//! Walks of light beneath a surface, from where it goes in to where it comes out.
//!
//! As Cycles 5.0 does it: Matt Jen-Yuan Chiang, Peter Kutz, Brent Burley: *Practical and Controllable Subsurface
//! Scattering for Production Path Tracing*, SIGGRAPH Talks 2016. Steps are drawn for one of the channels and, from the
//! second on, in part by `guide.rs`; all that might have drawn one are weighed by the balance heuristic.

use super::guide::Guide;
use crate::bsdf::Medium;
use crate::math::{Rgb, Vec3, sqr};
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{Interaction, RayCone, Scene};

/// Steps after which a walk is given up, as in Cycles. A half space of color 1 loses by it what has not come out: some
/// 7 %.
const MAX_STEPS: u32 = 256;

/// Steps after which a medium that scatters evenly stands for one that doesn't.
const SIMILAR_AFTER: u32 = 9;

/// Throughput below which a walk is given up.
const LEAST: f32 = 1e-6;

/// How far the first step looks for the opposite side, in mean free paths.
const FAR: f32 = 10.0;

/// Where a walk begins.
pub struct Entry<'a> {
    /// The point.
    pub it: &'a Interaction,
    /// Shading normal there, towards the viewer.
    pub n: Vec3,
    /// Unit direction into the object.
    pub wi: Vec3,
    /// Index of random decisions.
    pub vertex: u32,
    /// Of the ray that has found the point.
    pub cone: RayCone,
}

/// What scatters during a step.
struct Stage {
    sigma_t: Rgb,
    sigma_s: Rgb,
    g: f32,
    /// Share of guided steps.
    guided: f32,
}

impl Stage {
    fn first(medium: &Medium) -> Self {
        let g = medium.anisotropy;
        let sigma_s = medium.sigma_t * medium.albedo;
        Self { sigma_t: medium.sigma_t, sigma_s, g, guided: 1.0 - g.abs().powf(0.125).max(0.5) }
    }

    /// The medium that is similar in the long run.
    fn later(&self) -> Self {
        let sigma_s = self.sigma_s * (1.0 - self.g);
        Self { sigma_t: self.sigma_t - self.sigma_s + sigma_s, sigma_s, g: 0.0, guided: 0.75 }
    }
}

impl Entry<'_> {
    /// Where light of throughput `beta` comes out, as seen from outside, and what is left of it; `None` where it does
    /// not come out.
    pub fn walk(&self, scene: &Scene, sampler: &Sampler, medium: &Medium, beta: Rgb) -> Option<(Interaction, Rgb)> {
        let first = Stage::first(medium);
        let later = first.later();
        let (inside, start) = scene.inside(self.it)?;
        let mut guide = Guide::new(medium, start.p, self.n);
        let mut throughput = beta * medium.scale;
        let mut ray = start.spawn(self.wi);
        // A scattering so near the surface that rounding may have it beyond would be lost: it comes out.
        let slack = 0.5 * start.p_err.max_element();
        for step in 0..MAX_STEPS {
            let draw = |decision| sampler.get_1d(Dimension::at_bounce(self.vertex, decision).nth(step));
            let stage = if step <= SIMILAR_AFTER { &first } else { &later };
            let odds = channel_odds(throughput * medium.albedo);
            let channel = choose(odds, draw(Decision::WalkChannel));
            let mut sigma = stage.sigma_t[channel];
            let turn = (step > 0).then(|| {
                let u = sampler.get_2d(Dimension::at_bounce(self.vertex, Decision::WalkDirection).nth(step));
                let guided = draw(Decision::WalkGuide) < stage.guided;
                let turn = match guided {
                    true => guide.turn(&ray, stage.g, draw(Decision::WalkSide), u),
                    false => guide.follow(&ray, stage.g, scatter(ray.d, stage.g, u)),
                };
                sigma *= turn.stretch;
                ray.d = turn.d;
                turn
            });
            let free = -(1.0 - draw(Decision::WalkDistance)).ln() / sigma;
            let reach = free + slack;
            ray.t_max = if step == 0 { reach.max(FAR / least(stage.sigma_t)) } else { reach };
            let hit = inside.way_out(&ray);
            if step == 0 {
                guide.opposite = hit.map(|hit| -self.n.dot(ray.d) * hit.t);
            }
            let hit = hit.filter(|hit| hit.t < reach);
            let t = hit.map_or(free, |hit| hit.t);
            let transmittance = stage.sigma_t.map(|sigma| (-sigma * t).exp());
            let of_step = |stretch: f32| {
                let of_channel = |sigma: f32| if hit.is_some() { 1.0 } else { sigma } * (-sigma * t).exp();
                dot(odds, stage.sigma_t.map(|sigma| of_channel(sigma * stretch)))
            };
            let pdf = match &turn {
                None => of_step(1.0),
                Some(turn) => {
                    let guided = turn.forward * of_step(turn.stretches[0]) + turn.backward * of_step(turn.stretches[1]);
                    of_step(1.0) * (1.0 - stage.guided) + guided * stage.guided
                }
            };
            if !(pdf > 0.0 && pdf.is_finite()) {
                return None;
            }
            throughput *= if hit.is_some() { transmittance } else { stage.sigma_s * transmittance } * (1.0 / pdf);
            if let Some(hit) = hit {
                return Some((scene.coming_out(&ray, &hit, self.cone), throughput));
            }
            if throughput.max_component() < LEAST {
                return None;
            }
            ray.o = ray.at(t);
        }
        None
    }
}

/// Probabilities of the channels, in proportion to `weight`.
fn channel_odds(weight: Rgb) -> Rgb {
    let sum = weight.r + weight.g + weight.b;
    if sum > f32::MIN_POSITIVE { weight * (1.0 / sum) } else { Rgb::splat(1.0 / 3.0) }
}

fn choose(odds: Rgb, u: f32) -> usize {
    match u {
        u if u < odds.r => 0,
        u if u < odds.r + odds.g => 1,
        // Rounding may leave a little beyond the last.
        _ if odds.b > 0.0 => 2,
        _ if odds.g > 0.0 => 1,
        _ => 0,
    }
}

fn dot(a: Rgb, b: Rgb) -> f32 {
    a.r * b.r + a.g * b.g + a.b * b.b
}

fn least(color: Rgb) -> f32 {
    color.r.min(color.g).min(color.b)
}

/// A direction that light along `d` is scattered to, by Henyey and Greenstein's phase function.
fn scatter(d: Vec3, g: f32, [u, v]: [f32; 2]) -> Vec3 {
    let cos = if g.abs() < 1e-3 {
        1.0 - 2.0 * u
    } else {
        let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        ((1.0 + g * g - sqr(root)) / (2.0 * g)).clamp(-1.0, 1.0)
    };
    super::guide::about(d, cos, v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scattering_has_the_mean_cosine_that_it_is_asked_for() {
        let n = 256;
        for g in [-0.8_f32, -0.3, 0.0, 0.4, 0.9] {
            let cos = |i: i32| scatter(Vec3::Y, g, [(i as f32 + 0.5) / n as f32, 0.3]).y;
            let mean = (0..n).map(cos).sum::<f32>() / n as f32;
            assert!((mean - g).abs() < 1e-3, "{g}: {mean}");
        }
    }

    #[test]
    fn channels_are_chosen_by_their_odds() {
        let odds = channel_odds(Rgb::new(1.0, 0.0, 3.0));
        assert_eq!((choose(odds, 0.24), choose(odds, 0.26), choose(odds, 0.999)), (0, 2, 2));
        assert_eq!(choose(Rgb::new(0.4, 0.6, 0.0), 1.0), 1);
        assert_eq!(channel_odds(Rgb::BLACK), Rgb::splat(1.0 / 3.0));
    }
}
