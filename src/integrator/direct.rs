//! Next-event estimation: one light, one point on it, one shadow ray.

use super::scattering::seen;
use crate::bsdf::{ByLobe, View};
use crate::light::{Emitter, LightSample, Receiver, Rules};
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::{Decision, Dimension, Sampler, power_heuristic};
use crate::scene::{Interaction, Scene};

/// A surface that asks for light.
pub struct Shading<'a> {
    /// Where.
    pub it: &'a Interaction,
    /// Shading frame on the side of `it.wo`.
    pub frame: &'a Frame,
    /// What scatters.
    pub bsdf: &'a View<'a>,
    /// Index of random decisions.
    pub vertex: u32,
}

/// Light of one sample.
pub struct DirectLight<'a, T> {
    /// What would arrive if nothing stood between.
    pub unoccluded: T,
    /// Share of it that arrives.
    pub visibility: f32,
    /// Rules of the light.
    pub rules: &'a Rules,
}

impl Shading<'_> {
    /// The point as lights see it: what is lit from one side only asks for light from that side.
    pub fn receiver(&self, scene: &Scene) -> Receiver {
        let n = (!self.bsdf.transmits()).then_some(self.frame.n);
        Receiver { p: self.it.p, n, class: scene.instance(self.it.instance).receiver_class, alone: false }
    }

    /// What is scattered of one sample of one light, MIS-weighted against the directions that the
    /// surface samples; `samples` is how many are taken. `None` where nothing would be.
    pub fn sample_light<'s>(
        &self,
        scene: &'s Scene,
        sampler: &Sampler,
        samples: f32,
    ) -> Option<DirectLight<'s, ByLobe>> {
        let at = self.receiver(scene);
        let (LightSample { li, wi, end, pdf, delta }, rules) =
            sample(scene, sampler, &at, self.vertex, Decision::LightPoint)?;
        let local_wi = self.frame.to_local(wi);
        if leaks(self.it, wi, local_wi.z) {
            return None;
        }
        let eval = self.bsdf.eval(local_wi);
        let weight = if delta { 1.0 } else { power_heuristic(samples * pdf, eval.pdf) };
        let unoccluded = seen(eval.f_cos, rules.seen) * (li * (weight / pdf));
        if unoccluded.sum().is_black() {
            return None;
        }
        Some(DirectLight { unoccluded, visibility: visibility(scene, self.it, wi, end, rules), rules })
    }

    /// Irradiance of one sample of one light, on the side of the viewer and whatever the surface makes
    /// of it: what is in shadow where nothing is diffuse.
    pub fn sample_irradiance<'s>(&self, scene: &'s Scene, sampler: &Sampler) -> Option<DirectLight<'s, Rgb>> {
        let at = Receiver { n: Some(self.frame.n), alone: true, ..self.receiver(scene) };
        let (LightSample { li, wi, end, pdf, .. }, rules) =
            sample(scene, sampler, &at, self.vertex, Decision::ShadowPoint)?;
        let cos = self.frame.n.dot(wi);
        let lit_side = self.it.ng.dot(wi) * self.it.ng.dot(self.it.wo) > 0.0;
        if !(lit_side && cos > 0.0 && rules.seen.diffuse) {
            return None;
        }
        let visibility = visibility(scene, self.it, wi, end, rules);
        Some(DirectLight { unoccluded: li * (cos / pdf), visibility, rules })
    }
}

/// A light chosen for `at` and a point on it; the density is that of both. The choice is drawn by the
/// decision after `point`'s name.
fn sample<'s>(
    scene: &'s Scene,
    sampler: &Sampler,
    at: &Receiver,
    vertex: u32,
    point: Decision,
) -> Option<(LightSample, &'s Rules)> {
    let choice = if point == Decision::ShadowPoint { Decision::ShadowChoice } else { Decision::LightChoice };
    let choice = scene.lights.choose(at, sampler.get_1d(Dimension::at_bounce(vertex, choice)))?;
    let light = scene.lights.get(choice.light);
    let u = sampler.get_2d(Dimension::at_bounce(vertex, point));
    let sample = light.emitter.sample_li(at, choice.u, u)?;
    Some((LightSample { pdf: sample.pdf * choice.pmf, ..sample }, &light.rules))
}

fn visibility(scene: &Scene, it: &Interaction, wi: Vec3, end: Option<Vec3>, rules: &Rules) -> f32 {
    let ray = end.map_or_else(|| it.spawn(wi), |end| it.spawn_to(end));
    scene.transmittance(&ray, rules.shadow)
}

/// True where shading and geometric normal disagree on which side `wi` is: light would leak
/// through the surface, or a reflection go into it.
pub fn leaks(it: &Interaction, wi: Vec3, local_z: f32) -> bool {
    let geometric = it.ng.dot(wi) * if it.front { 1.0 } else { -1.0 };
    geometric * local_z <= 0.0
}
