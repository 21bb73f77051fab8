//! Next-event estimation: one light, one point on it, one shadow ray.

use super::scattering::seen;
use crate::bsdf::{Bsdf, ByLobe};
use crate::light::{Choice, Emitter, LightSample, Receiver, Rules};
use crate::math::{Frame, Rgb, Vec3};
use crate::sampling::{Decision, Dimension, Sampler, power_heuristic};
use crate::scene::{Interaction, Media, Scene};

/// A surface that asks for light.
pub struct Shading<'a> {
    /// Where.
    pub it: &'a Interaction,
    /// Shading frame on the side of `it.wo`.
    pub frame: &'a Frame,
    /// What scatters, in that frame.
    pub bsdf: &'a Bsdf,
    /// Index of random decisions.
    pub vertex: u32,
    /// What is around it on the side of `it.wo`.
    pub media: &'a Media,
}

/// Light of one sample.
pub struct DirectLight<'a, T> {
    /// What would arrive if nothing stood between.
    pub unoccluded: T,
    /// Share of it that arrives.
    pub visibility: Rgb,
    /// Rules of the light.
    pub rules: &'a Rules,
}

impl Shading<'_> {
    /// The point as lights see it: what is lit from one side only asks for light from that side.
    pub fn receiver(&self, scene: &Scene) -> Receiver {
        let n = (!self.bsdf.transmits()).then_some(self.frame.n);
        let class = scene.instance(self.it.instance).receiver_class;
        Receiver { p: self.it.p, n, class, alone: false, time: self.it.time }
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
        let choice = scene.lights.choose(&at, sampler.get_1d(self.decision(Decision::LightChoice)))?;
        let u = sampler.get_2d(self.decision(Decision::LightPoint));
        let (LightSample { li, wi, end, pdf, delta }, rules) = sample(scene, &at, choice, u)?;
        let eval = self.bsdf.eval(self.frame.to_local(wi));
        let weight = if delta { 1.0 } else { power_heuristic(samples * pdf, eval.pdf) };
        let unoccluded = seen(eval.f_cos, rules) * (li * (weight / pdf));
        if unoccluded.sum().is_black() {
            return None;
        }
        Some(DirectLight { unoccluded, visibility: self.visibility(scene, wi, end, rules), rules })
    }

    /// Diffuse light of one sample of one light, of `group` if one is given, by light sampling alone.
    /// Of a surface without diffuse reflection it is the irradiance on the side of the viewer: what is
    /// in shadow where nothing is diffuse.
    pub fn sample_diffuse<'s>(
        &self,
        scene: &'s Scene,
        sampler: &Sampler,
        group: Option<usize>,
    ) -> Option<DirectLight<'s, Rgb>> {
        let bare = self.bsdf.lacks_diffuse();
        let at = self.receiver(scene);
        let at = Receiver { n: if bare { Some(self.frame.n) } else { at.n }, alone: true, ..at };
        let u = sampler.get_1d(self.decision(Decision::ShadowChoice));
        let choice = match group {
            Some(group) => scene.lights.choose_of_group(group, &at, u)?,
            None => scene.lights.choose(&at, u)?,
        };
        let u = sampler.get_2d(self.decision(Decision::ShadowPoint));
        let (LightSample { li, wi, end, pdf, .. }, rules) = sample(scene, &at, choice, u)?;
        let local_wi = self.frame.to_local(wi);
        if !rules.seen.diffuse || (bare && (local_wi.z <= 0.0 || leaks(self.it, wi, local_wi.z))) {
            return None;
        }
        let response = if bare { Rgb::splat(local_wi.z) } else { self.bsdf.eval(local_wi).f_cos.diffuse };
        let response = rules.response.map_or(response, |[diffuse, _]| response * diffuse);
        if response.is_black() {
            return None;
        }
        let visibility = self.visibility(scene, wi, end, rules);
        Some(DirectLight { unoccluded: response * (li * (1.0 / pdf)), visibility, rules })
    }

    /// Irradiance of one sample of one light on the side of the viewer: what arrives, and what would if only shadow
    /// catchers stood in the way.
    pub fn sample_catcher(&self, scene: &Scene, sampler: &Sampler) -> Option<[Rgb; 2]> {
        let at = Receiver { n: Some(self.frame.n), alone: true, ..self.receiver(scene) };
        let choice = scene.lights.choose(&at, sampler.get_1d(self.decision(Decision::ShadowChoice)))?;
        let u = sampler.get_2d(self.decision(Decision::ShadowPoint));
        let (LightSample { li, wi, end, pdf, .. }, rules) = sample(scene, &at, choice, u)?;
        let cos = self.frame.n.dot(wi);
        if !rules.seen.diffuse || cos <= 0.0 || leaks(self.it, wi, cos) {
            return None;
        }
        let irradiance = li * (cos / pdf);
        let ray = scene.shadow_ray(self.it, wi, end);
        if scene.is_caught(&ray) {
            return None;
        }
        Some([irradiance * scene.arriving(&ray, rules, self.media, self.it.path.transparent), irradiance])
    }

    fn decision(&self, decision: Decision) -> Dimension {
        Dimension::at_bounce(self.vertex, decision)
    }

    fn visibility(&self, scene: &Scene, wi: Vec3, end: Option<Vec3>, rules: &Rules) -> Rgb {
        let (ray, passed) = (scene.shadow_ray(self.it, wi, end), self.it.path.transparent);
        if !scene.effects.absorption {
            return scene.arriving(&ray, rules, self.media, passed);
        }
        let mut media = *self.media;
        scene.pass_boundary(&mut media, self.it, wi);
        scene.arriving(&ray, rules, &media, passed)
    }
}

/// The point of the chosen light that `u` means; the density is that of light and point.
fn sample<'s>(scene: &'s Scene, at: &Receiver, choice: Choice, u: [f32; 2]) -> Option<(LightSample, &'s Rules)> {
    let light = scene.lights.get(choice.light);
    let sample = light.emitter.sample_li(at, choice.u, u)?;
    Some((LightSample { pdf: sample.pdf * choice.pmf, ..sample }, &light.rules))
}

/// True where the normal of a map and the one that it bends disagree on which side `wi` is.
fn leaks(it: &Interaction, wi: Vec3, local_z: f32) -> bool {
    let smooth = it.ns.dot(wi) * if it.front { 1.0 } else { -1.0 };
    smooth * local_z <= 0.0
}
