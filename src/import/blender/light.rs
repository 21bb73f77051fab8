//! Lamps, with Cycles' meaning of watts (measured with Blender 4.2 to 5.0).
//!
//! `P = energy × 2^exposure × color`, times what the lamp's nodes emit. A normalised lamp has the
//! power P whatever its size: `I = P / 4π` for a point, `L = P / 4π²r²` on a sphere, `L = P / πA` on an
//! area, `E = P` under a sun. One that is not normalised has what a lamp of size 1 would have:
//! `L = P / π`, `L = P` for a sun.

use std::f64::consts::PI;
use std::sync::Arc;

use super::document::{LightData, LinkData, ObjectData};
use super::transform::affine;
use crate::desc::{ConeDesc, DecayDesc, LampShaderDesc, LightDesc, LightKind, LightLinks, LinkSet, ShapingDesc};
use crate::error::{Place, Warnings};
use crate::math::DVec3;

/// What the nodes of a lamp emit.
#[derive(Clone, Debug)]
pub struct LampShader {
    /// Colour times strength.
    pub factor: [f64; 3],
    /// What that is to be multiplied by, where it varies over the lamp.
    pub varying: Option<LampShaderDesc>,
    /// Of a Light Falloff node.
    pub decay: DecayDesc,
}

impl Default for LampShader {
    fn default() -> Self {
        Self { factor: [1.0; 3], varying: None, decay: DecayDesc::default() }
    }
}

/// The light of a lamp; `None` for one that can't emit: an area without size.
pub fn light(data: &LightData, shader: &LampShader, place: &Place, warnings: &mut Warnings) -> Option<LightDesc> {
    let place = place.at(&data.name);
    let scale = data.energy * data.exposure.exp2();
    let power: [f64; 3] = std::array::from_fn(|i| scale * data.color[i] * data.temperature_color[i] * shader.factor[i]);
    let takes = power.iter().all(|&c| c <= 0.0) && power != [0.0; 3];
    let power = if takes { power.map(f64::abs) } else { power };
    let times = |factor: f64| power.map(|c| c * factor);
    let mut transform = affine(&data.matrix);
    let kind = match data.r#type.as_str() {
        "POINT" | "SPOT" if data.radius <= 0.0 => {
            LightKind::Point { intensity: times(if data.normalize { 0.25 / PI } else { 1.0 / PI }) }
        }
        "POINT" | "SPOT" => LightKind::Sphere {
            radius: data.radius,
            radiance: times(if data.normalize { 0.25 / (PI * data.radius).powi(2) } else { 1.0 / PI }),
            facing: data.use_soft_falloff,
        },
        "SUN" => {
            let angle = data.angle.clamp(0.0, PI);
            // The cross section of a disk of radiance 1.
            let disk = PI * (0.5 * angle).sin().powi(2);
            LightKind::Distant { irradiance: times(if data.normalize || angle == 0.0 { 1.0 } else { disk }), angle }
        }
        "AREA" => area(data, &times, [transform.matrix3.x_axis.length(), transform.matrix3.y_axis.length()])?,
        other => {
            warnings.push(&place, format!("a lamp of the unknown type {other}: left out"));
            return None;
        }
    };
    if matches!(kind, LightKind::Rect { .. } | LightKind::Disk { .. } | LightKind::Portal { .. }) {
        // The sizes are those in the world; of the scale only a mirror is left, which turns the side
        // that emits.
        let flip = if transform.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
        let [x, y] = [transform.matrix3.x_axis, transform.matrix3.y_axis].map(|axis| axis.normalize_or(DVec3::X));
        let z = x.cross(y).normalize_or(DVec3::Z);
        transform.matrix3.x_axis = x;
        transform.matrix3.y_axis = y;
        transform.matrix3.z_axis = z * flip;
    }
    let cone = (data.r#type == "SPOT")
        .then(|| ConeDesc::Blend { angle: 0.5 * data.spot_size, blend: data.spot_blend.clamp(0.0, 1.0) });
    Some(LightDesc {
        name: data.name.as_str().into(),
        place,
        transform,
        motion: Vec::new(),
        kind,
        shaping: ShapingDesc { cone, ..ShapingDesc::default() },
        decay: shader.decay,
        visibility: data.visibility.into(),
        links: LightLinks {
            cast_shadow: data.use_shadow,
            max_bounces: data.max_bounces,
            takes,
            ..LightLinks::default()
        },
    })
}

/// An area lamp whose axes the object scales by `scale`.
fn area(data: &LightData, times: &dyn Fn(f64) -> [f64; 3], scale: [f64; 2]) -> Option<LightKind> {
    let round = matches!(data.shape.as_str(), "DISK" | "ELLIPSE");
    let size_y = if matches!(data.shape.as_str(), "SQUARE" | "DISK") { data.size } else { data.size_y };
    let (width, height) = (data.size * scale[0], size_y * scale[1]);
    let area = width * height * if round { 0.25 * PI } else { 1.0 };
    if !(area > 0.0 && area.is_finite()) {
        return None;
    }
    if data.is_portal {
        // Of a round one the box around it: it need but hold the opening.
        return Some(LightKind::Portal { width, height });
    }
    let radiance = times(if data.normalize { 1.0 / (PI * area) } else { 1.0 / PI });
    let spread = data.spread.clamp(0.0, PI);
    Some(if round {
        LightKind::Disk { width, height, radiance, spread, two_sided: false }
    } else {
        LightKind::Rect { width, height, radiance, spread, two_sided: false, image: None }
    })
}

/// The rules of an emitter in `group`; `instances` are those of each object.
pub fn links(
    group: &str,
    receivers: Option<&LinkData>,
    blockers: Option<&LinkData>,
    instances: &[Vec<u32>],
) -> LightLinks {
    let set = |link: &LinkData| {
        let of = |object: &u32| instances.get(*object as usize).into_iter().flatten().copied();
        let mut set: Vec<u32> = link.objects.iter().flat_map(of).collect();
        set.sort_unstable();
        set.dedup();
        LinkSet { instances: set, exclude: link.exclude }
    };
    LightLinks {
        group: (!group.is_empty()).then(|| Arc::from(group)),
        receivers: receivers.map(set),
        blockers: blockers.map(set),
        ..LightLinks::default()
    }
}

/// The rules of what `object` emits.
pub fn links_of_object(object: &ObjectData, instances: &[Vec<u32>]) -> LightLinks {
    links(&object.lightgroup, object.receivers.as_ref(), object.blockers.as_ref(), instances)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lamp(data: LightData) -> LightDesc {
        light(&data, &LampShader::default(), &Place::default(), &mut Warnings::new()).unwrap()
    }

    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} is not {expected}");
    }

    #[test]
    fn watts_become_what_cycles_makes_of_them() {
        let watts = || LightData { energy: 100.0, ..LightData::default() };
        near(lamp(watts()).kind.color()[0], 100.0 / (4.0 * PI));
        near(lamp(LightData { normalize: false, ..watts() }).kind.color()[0], 100.0 / PI);
        let sphere = lamp(LightData { radius: 0.5, exposure: 1.0, ..watts() });
        near(sphere.kind.color()[0], 200.0 / (PI * PI));
        assert!(matches!(sphere.kind, LightKind::Sphere { facing: true, .. }));
        let sun = LightData { r#type: "SUN".into(), energy: 3.0, angle: 0.2, ..LightData::default() };
        near(lamp(sun.clone()).kind.color()[0], 3.0);
        near(lamp(LightData { normalize: false, ..sun.clone() }).kind.color()[0], 3.0 * PI * 0.1_f64.sin().powi(2));
        near(lamp(LightData { normalize: false, angle: 0.0, ..sun }).kind.color()[0], 3.0);
    }

    #[test]
    fn areas_have_the_size_of_their_object() {
        let area = LightData { r#type: "AREA".into(), energy: 100.0, shape: "ELLIPSE".into(), ..LightData::default() };
        let matrix = [[2.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        let light = lamp(LightData { size: 0.5, size_y: 0.25, spread: 1.0, matrix, ..area.clone() });
        let LightKind::Disk { width, height, radiance, spread, .. } = light.kind else { panic!() };
        near(width, 1.0);
        near(height, 0.75);
        near(radiance[0], 100.0 / (PI * 0.25 * PI * 0.75));
        assert_eq!(spread, 1.0);
        // Mirrored: it shines upwards.
        assert_eq!(light.transform.matrix3.z_axis, DVec3::NEG_Z);
        let none = LightData { size: 0.0, ..area };
        assert!(light_of(&none).is_none());
        let portal = LightData { is_portal: true, size: 2.0, ..none };
        assert_eq!(lamp(portal).kind, LightKind::Portal { width: 2.0, height: 0.25 });
    }

    fn light_of(data: &LightData) -> Option<LightDesc> {
        light(data, &LampShader::default(), &Place::default(), &mut Warnings::new())
    }

    #[test]
    fn links_name_the_instances_of_objects() {
        let instances = [vec![0, 2], vec![1], vec![3]];
        let link = LinkData { objects: vec![0, 2, 9], exclude: true };
        let links = links("key", Some(&link), None, &instances);
        assert_eq!(links.receivers, Some(LinkSet { instances: vec![0, 2, 3], exclude: true }));
        assert_eq!((links.group.as_deref(), links.blockers), (Some("key"), None));
    }
}
