//! UsdLux lights to `LightDesc`: <https://openusd.org/release/api/usd_lux_page_front.html>.
//!
//! A light's emission in nits is taken for radiance in W·sr⁻¹·m⁻², as every renderer of RGB does:
//! intensity 1 is a pixel value of 1. What Blender writes means a little else; see [`blender`].

mod blender;
mod color;
mod dome;
mod ies;
mod kind;
mod layout;
mod links;
mod rules;
mod shape_light;
mod shaping;
mod stamped;

pub(super) use blender::lost;
pub(super) use ies::Profiles;
pub(super) use links::link;
pub(super) use shape_light::{GeometryLight, ShapeLight, Shaped, area, geometry_light};
pub(super) use stamped::worlds;

use super::images::Images;
use super::stage::Reading;
use super::values::Values;
use super::walk::Placed;
use crate::desc::{LightDesc, LightKind, Motion};

/// True for the schemas of lights with a shape of their own or none; meshes and volumes with LightAPI are
/// shapes that emit.
pub(super) fn is_light(kind: &str) -> bool {
    matches!(
        kind,
        "SphereLight"
            | "DiskLight"
            | "RectLight"
            | "CylinderLight"
            | "DistantLight"
            | "DomeLight"
            | "DomeLight_1"
            | "PortalLight"
            | "GeometryLight"
            | "PluginLight"
    )
}

/// A light that is being read.
#[derive(Clone, Copy)]
struct Light<'a> {
    values: Values<'a>,
    placed: &'a Placed,
}

impl std::ops::Deref for Light<'_> {
    type Target = Placed;

    fn deref(&self) -> &Placed {
        self.placed
    }
}

/// The light at `placed`, with its motion; `None`, with a warning, for one that is not rendered.
pub(super) fn read(
    reading: &Reading<'_>,
    placed: &Placed,
    images: &mut Images,
    profiles: &mut Profiles,
) -> Option<LightDesc> {
    let light = still(reading, placed, images, profiles)?;
    // What turns the prim's space into the light's own.
    let own = placed.world.inverse() * light.transform;
    let motion = placed.motion.iter().map(|&Motion { time, value }| Motion { time, value: value * own });
    Some(LightDesc { motion: motion.filter(|moved| moved.value.is_finite()).collect(), ..light })
}

/// The light at `placed` as it is at the frame.
fn still(reading: &Reading<'_>, placed: &Placed, images: &mut Images, profiles: &mut Profiles) -> Option<LightDesc> {
    if !placed.visible {
        return None;
    }
    let light = Light { values: Values { reading, prim: &placed.prim, path: &placed.path }, placed };
    if let Some(stamped) = stamped::lamp(&light, images, profiles) {
        return stamped;
    }
    let (kind, transform) = match &*placed.kind {
        "DomeLight" | "DomeLight_1" => dome::read(&light, images),
        // Its target shines: `geometry_light`.
        "GeometryLight" => return None,
        "PluginLight" => {
            light.values.warn("lights that need a plugin are not rendered: it is left out");
            return None;
        }
        _ => (kind::read(&light, images)?, placed.world),
    };
    let (shaping, factor) = shaping::read(&light, &kind, profiles);
    let name = placed.path.name().unwrap_or_default();
    Some(LightDesc {
        shaping,
        visibility: rules::visibility(&light.values, matches!(kind, LightKind::Dome { .. })),
        links: rules::links(&light.values),
        ..LightDesc::new(name, reading.place_of(&placed.path), transform, kind::scaled(kind, factor))
    })
}

#[cfg(test)]
pub(super) mod testing;
