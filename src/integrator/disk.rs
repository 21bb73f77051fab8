//! Light beneath a surface by a profile of distances: probes through the neighborhood, from discs along three axes.
//!
//! Alan King, Christopher Kulla, Alejandro Conty, Marcos Fajardo: *BSSRDF Importance Sampling*, SIGGRAPH Talks 2013, as
//! Cycles has it; of the surfaces that a probe meets one is drawn by what it counts for.

use std::f32::consts::TAU;

use smallvec::SmallVec;

use super::subsurface::Entry;
use crate::bsdf::Profile;
use crate::math::{Frame, Ray, Rgb, Vec3, sqr};
use crate::sampling::{Decision, Dimension, Sampler};
use crate::scene::{Inside, Interaction, Scene};

/// Surfaces that one probe may meet.
const MOST: usize = 32;

/// Share of the probes along the normal; those along the two tangents share the rest.
const ALONG_NORMAL: f32 = 0.5;

impl Entry<'_> {
    /// Where light of throughput `beta` comes out, as seen from the side on which it went in, and what is left of it;
    /// `None` where a probe meets nothing.
    pub fn probe(&self, scene: &Scene, sampler: &Sampler, profile: &Profile, beta: Rgb) -> Option<(Interaction, Rgb)> {
        let (inside, start) = scene.inside(self.it)?;
        let draw = |decision| Dimension::at_bounce(self.vertex, decision);
        let [u, v] = sampler.get_2d(draw(Decision::WalkDirection));
        let side = if self.it.front { 1.0 } else { -1.0 };
        let Frame { s, t, n } = Frame::from_z(self.it.ng * side);
        // The axis that the probe goes along comes last.
        let rest = 0.5 * (1.0 - ALONG_NORMAL);
        let (axes, v) = match v {
            v if v < ALONG_NORMAL => ([s, t, n], v / ALONG_NORMAL),
            v if v < ALONG_NORMAL + rest => ([t, n, s], (v - ALONG_NORMAL) / rest),
            v => ([n, s, t], (v - ALONG_NORMAL - rest) / rest),
        };
        let [r, height] = profile.sample(u);
        let (sin, cos) = (TAU * v).sin_cos();
        let from = start.p + axes[2] * height + (axes[0] * cos + axes[1] * sin) * r;
        let mut ray = start.spawn(-axes[2]);
        (ray.o, ray.t_max) = (from, 2.0 * height);
        let share = |along: Vec3, ng: Vec3| if along == n { ALONG_NORMAL } else { rest } * along.dot(ng).abs();
        let pdf = profile.pdf(r);
        let mut found: SmallVec<[(Interaction, Rgb); 4]> = SmallVec::new();
        self.surfaces_along(scene, inside, ray, |there, it| {
            let squares: f32 = [s, t, n].into_iter().map(|along| sqr(share(along, it.ng))).sum();
            // Power heuristic over the axes, over the density along this one.
            let weight = share(axes[2], it.ng) / squares;
            let light = profile.eval(there.p.distance(start.p)) * (weight / pdf);
            if light.is_finite() && !light.is_black() {
                found.push((Interaction { wo: it.ng * side, front: self.it.front, ..it }, light));
            }
        });
        let total: f32 = found.iter().map(|(_, light)| light.mean()).sum();
        let mut rest = sampler.get_1d(draw(Decision::WalkChannel)) * total;
        let last = found.len().checked_sub(1)?;
        let chosen = found.iter().take(last).position(|(_, light)| {
            let chosen = rest < light.mean();
            rest -= light.mean();
            chosen
        });
        let (it, light) = found[chosen.unwrap_or(last)];
        Some((it, beta * light * (total / light.mean())))
    }

    /// Calls `visit` with the surfaces of the object along `ray`, in the space of `inside` and in render space.
    fn surfaces_along(
        &self,
        scene: &Scene,
        inside: &Inside,
        mut ray: Ray,
        mut visit: impl FnMut(&Interaction, Interaction),
    ) {
        for _ in 0..MOST {
            let Some(hit) = inside.way_out(&ray) else { return };
            let there = inside.interaction(scene, &ray, &hit);
            visit(&there, scene.coming_out(&ray, &hit, self.cone));
            ray = there.continued(&ray, hit.t);
        }
    }
}
