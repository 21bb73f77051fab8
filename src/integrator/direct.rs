//! Next-event estimation: one light, one point on it, one shadow ray.

use crate::bsdf::{ByLobe, View};
use crate::light::{Emitter, LightSample, Receiver};
use crate::math::{Frame, Rgb};
use crate::sampling::{Decision, Dimension, Sampler, power_heuristic};
use crate::scene::{Interaction, Scene};

/// Direct light at a point by light sampling, weighted against sampling the surface.
pub struct DirectLight {
    /// What would be scattered to `wo` if nothing stood between.
    pub unoccluded: ByLobe,
    /// Irradiance of the sample without any surface's albedo, and without MIS weight.
    pub irradiance: Rgb,
    /// Share of it that arrives.
    pub visibility: f32,
}

/// Samples one light for `it`. `None` where the sample can't arrive or nothing would be scattered,
/// or, if `want_irradiance`, where there is no irradiance either.
pub fn sample_light(
    scene: &Scene,
    sampler: &Sampler,
    vertex: u32,
    it: &Interaction,
    frame: &Frame,
    bsdf: &View<'_>,
    want_irradiance: bool,
) -> Option<DirectLight> {
    let at = receiver(scene, it, frame, bsdf);
    let choice = scene.lights.choose(&at, sampler.get_1d(Dimension::at_bounce(vertex, Decision::LightChoice)))?;
    let light = scene.lights.get(choice.light);
    let u = sampler.get_2d(Dimension::at_bounce(vertex, Decision::LightPoint));
    let LightSample { li, wi, end, pdf, delta } = light.emitter.sample_li(&at, choice.u, u)?;
    let pdf = pdf * choice.pmf;
    let local_wi = frame.to_local(wi);
    let eval = if leaks(it, wi, local_wi.z) { None } else { Some(bsdf.eval(local_wi)) };
    let unoccluded = eval.map_or(ByLobe::BLACK, |eval| {
        let weight = if delta { 1.0 } else { power_heuristic(pdf, eval.pdf) };
        eval.f_cos * (li * (weight / pdf))
    });
    let lit_side = it.ng.dot(wi) * it.ng.dot(it.wo) > 0.0;
    let irradiance = if want_irradiance && lit_side { li * (local_wi.z.max(0.0) / pdf) } else { Rgb::BLACK };
    if unoccluded.sum().is_black() && irradiance.is_black() {
        return None;
    }
    let ray = end.map_or_else(|| it.spawn(wi), |end| it.spawn_to(end));
    Some(DirectLight { unoccluded, irradiance, visibility: scene.transmittance(&ray, light.rules.shadow) })
}

/// `it` as lights see it: what is lit from one side only asks for light from that side.
pub fn receiver(scene: &Scene, it: &Interaction, frame: &Frame, bsdf: &View<'_>) -> Receiver {
    let n = (!bsdf.transmits()).then_some(frame.n);
    Receiver { p: it.p, n, class: scene.instance(it.instance).receiver_class, alone: false }
}

/// True where shading and geometric normal disagree on which side `wi` is: light would leak
/// through the surface, or a reflection go into it.
pub fn leaks(it: &Interaction, wi: crate::math::Vec3, local_z: f32) -> bool {
    let geometric = it.ng.dot(wi) * if it.front { 1.0 } else { -1.0 };
    geometric * local_z <= 0.0
}
