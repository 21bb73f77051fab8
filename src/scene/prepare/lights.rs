//! Lamps, domes and emissive shapes as lights in render space, with the rules of each.

use std::sync::Arc;

use super::cache::Cache;
use super::emissive::{Emissive, Shared};
use super::geometry::Geometry;
use super::lamp_shader::LampShader;
use super::links::Links;
use super::mend::Mended;
use super::{dome, lamp, portals, shadow_look, shaping, suns};
use crate::desc::{LightDesc, LightKind, LightLinks, SceneDesc, Visibility};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Light, Rules, Seen, ShadowLook};

/// Factors of a light's light; what is no factor counts as 0.
fn response(of: &LightLinks) -> Option<[f32; 2]> {
    let sign = if of.takes { -1.0 } else { 1.0 };
    let usable = |x: f64| if x.is_finite() && x > 0.0 { sign * x as f32 } else { 0.0 };
    (of.takes || of.response != [1.0; 2]).then(|| of.response.map(usable))
}

/// Every light of the scene, `extra` included; instances learn which light they are. `groups` are
/// the light groups that passes ask for.
pub fn prepare(
    desc: &SceneDesc,
    extra: Option<&LightDesc>,
    links: &Links,
    groups: &[Arc<str>],
    geometry: &mut Geometry,
    shared: &Shared<'_>,
    cache: &mut Cache,
    warnings: &mut Warnings,
) -> Vec<Light> {
    let rules = |of: &LightLinks, look: Option<ShadowLook>, visibility: Visibility| Rules {
        group: group(of, groups),
        seen: Seen {
            camera: visibility.camera,
            diffuse: visibility.diffuse,
            glossy: visibility.glossy,
            transmission: visibility.transmission,
        },
        shadow: links.shadow(of),
        look,
        receivers: links.receivers(of),
        response: response(of),
        max_bounces: of.max_bounces.unwrap_or(u32::MAX),
    };
    let portals = portals::prepare(desc, shared.origin, warnings);
    let mut lights = Vec::new();
    for light in desc.lights.iter().chain(extra).filter(|light| !light.kind.is_portal()) {
        let mut emitter = match light.kind {
            LightKind::ShadedDome { shader } => dome::shaded(desc, light, shader, shared, cache).map(Into::into),
            _ => {
                let shader = LampShader::of(desc, light, shared);
                lamp::prepare(desc, light, shared.origin, shader.as_ref(), warnings)
            }
        };
        if let (Some(AnyEmitter::Dome(dome)), Some(portals)) = (&mut emitter, &portals) {
            dome.guide(portals.clone());
        }
        let mut mended = Mended::default();
        let look = shadow_look::prepare(&light.links, &mut mended);
        if light.motion.iter().any(|moved| moved.value != light.transform) {
            mended
                .note("it moves while the shutter is open; as in Cycles, it shines from where it stands at the frame");
        }
        mended.tell(light, false, warnings);
        let rules = rules(&light.links, look, light.visibility);
        if let LightKind::ShadedDome { shader } = light.kind {
            let suns = suns::prepare(&desc.dome_shaders[shader as usize], light, warnings);
            lights.extend(suns.into_iter().map(|sun| Light { emitter: sun.into(), rules: rules.clone() }));
        }
        if let Some(emitter) = emitter {
            lights.push(Light { emitter, rules });
        }
    }
    let materials = shared.materials;
    let mut emissive = Emissive::new(shared);
    for (index, (instance, &placed)) in geometry.instances.iter_mut().zip(&geometry.placed).enumerate() {
        let of = &desc.instances[placed as usize];
        if cache.stop.is_wished() {
            break;
        }
        if !instance.materials.iter().any(|&m| materials[m as usize].emits()) {
            continue;
        }
        let mut mended = Mended::default();
        let look = shadow_look::prepare(&of.links, &mut mended);
        mended.tell_at(&of.place, warnings);
        let rules = rules(&of.links, look, of.visibility);
        instance.rules = Some(Box::new(rules.clone()));
        let shape = &geometry.shapes[instance.shape as usize];
        let (profile, shines) = shaping::of_instance(desc, of, warnings);
        instance.profile = profile;
        if !shines {
            continue;
        }
        if let Some(emitter) = emissive.light(instance, index as u32, shape) {
            instance.light = Some(lights.len() as u32);
            lights.push(Light { emitter, rules });
        }
    }
    lights
}

fn group(links: &LightLinks, groups: &[Arc<str>]) -> Option<u16> {
    let name = links.group.as_ref()?;
    groups.iter().position(|group| group == name).map(|i| i as u16)
}
