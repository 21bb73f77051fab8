//! Lamps and worlds as *Export for Penumbra* stamped them.
//!
//! What UsdLux has a place for is read from there, so that edits of it count; the rest is the stamp's:
//! spread, soft falloff, ellipses, temperature, nodes, light groups, which rays see the lamp.

use std::collections::HashSet;
use std::f64::consts::PI;

use openusd::sdf::Path;

use super::super::super::blender::LightData;
use super::super::images::Images;
use super::super::stage::Reading;
use super::super::stamp;
use super::super::values::Values;
use super::super::walk::Placed;
use super::{Light, Profiles, kind, rules, shaping};
use crate::desc::{LightDesc, LightLinks, ShapingDesc, Visibility};
use crate::math::{DMat3, DVec3};

/// The light of a stamped lamp: `Some(None)` for one that emits nothing, `None` where there is no stamp.
pub(super) fn lamp(light: &Light<'_>, images: &mut Images, profiles: &mut Profiles) -> Option<Option<LightDesc>> {
    let (values, reading) = (&light.values, light.values.reading);
    let stamp = stamp::read(values, stamp::LIGHT)?;
    let mut data = stamp.light.clone()?;
    data.name = light.path.as_str().to_owned();
    amend(&mut data, light);
    let (place, warnings) = (&reading.place, &reading.warnings);
    let desc = stamp.light(&data, &light.world, place, &mut images.images, &mut warnings.borrow_mut());
    Some(desc.map(|own| {
        let (usd, factor) = shaping::read(light, &own.kind, profiles);
        let seen = rules::visibility(values, false);
        LightDesc {
            name: light.path.name().unwrap_or_default().into(),
            kind: kind::scaled(own.kind, factor),
            shaping: ShapingDesc { cone: own.shaping.cone, ..usd },
            visibility: Visibility {
                diffuse: own.visibility.diffuse && seen.diffuse,
                glossy: own.visibility.glossy && seen.glossy,
                transmission: own.visibility.transmission && seen.transmission,
                ..own.visibility
            },
            links: LightLinks {
                cast_shadow: own.links.cast_shadow && rules::links(values).cast_shadow,
                ..own.links.clone()
            },
            ..own
        }
    }))
}

/// What the lamp is in UsdLux, back in Blender's terms: the exporter's intensity is P / π, a sun's S / 4, its
/// angles are half of Blender's, ellipses have their mean radius.
fn amend(lamp: &mut LightData, light: &Light<'_>) {
    let values = &light.values;
    let number = |name: &str| values.number(name);
    let strength = match (lamp.r#type.as_str(), &*light.kind) {
        ("POINT" | "SPOT", "SphereLight") => {
            lamp.radius = number("inputs:radius").unwrap_or(lamp.radius);
            lamp.spot_size = number("inputs:shaping:cone:angle").map_or(lamp.spot_size, |a| 2.0 * a.to_radians());
            lamp.spot_blend = number("inputs:shaping:cone:softness").unwrap_or(lamp.spot_blend);
            PI
        }
        ("SUN", "DistantLight") => {
            lamp.angle = number("inputs:angle").map_or(lamp.angle, |half| 2.0 * half.to_radians());
            4.0
        }
        ("AREA", "RectLight") => {
            lamp.shape = "RECTANGLE".into();
            lamp.size = number("inputs:width").unwrap_or(lamp.size);
            lamp.size_y = number("inputs:height").unwrap_or(lamp.size_y);
            PI
        }
        ("AREA", "DiskLight") => {
            if lamp.shape == "DISK" {
                lamp.size_y = lamp.size;
            }
            let mean = 0.25 * (lamp.size + lamp.size_y);
            let factor = number("inputs:radius").map_or(1.0, |radius| radius / mean);
            if factor.is_finite() {
                lamp.size *= factor;
                lamp.size_y *= factor;
            }
            PI
        }
        // Another program made another light of it.
        _ => return,
    };
    lamp.energy = number("inputs:intensity").map_or(lamp.energy, |intensity| intensity * strength);
    lamp.exposure = number("inputs:exposure").unwrap_or(lamp.exposure);
    lamp.color = values.color("inputs:color").unwrap_or(lamp.color);
    lamp.normalize = values.flag("inputs:normalize").unwrap_or(lamp.normalize);
}

/// Name of the dome that Blender's exporter makes of the world.
const EXPORTED: &str = "env_light";

/// The worlds that stamps describe.
pub(in super::super) struct Worlds {
    /// What they shine like.
    pub domes: Vec<LightDesc>,
    /// The exporter's own domes, in whose place they stand.
    replaced: HashSet<Path>,
}

impl Worlds {
    /// True for the dome of the exporter that a stamp knows better.
    pub fn replace(&self, path: &Path) -> bool {
        self.replaced.contains(path)
    }
}

/// All worlds of the stamps in `all`. One whose exported dome was hidden or switched off is dark.
pub(in super::super) fn worlds(reading: &Reading<'_>, all: &[Placed], images: &mut Images) -> Worlds {
    let mut worlds = Worlds { domes: Vec::new(), replaced: HashSet::new() };
    for placed in all.iter().filter(|placed| &*placed.kind == stamp::KIND && placed.visible) {
        let values = Values { reading, prim: &placed.prim, path: &placed.path };
        let Some(stamp) = stamp::read(&values, stamp::WORLD) else { continue };
        let Some(world) = &stamp.world else { continue };
        let beside = |path: &Path| path.parent().and_then(|parent| parent.append_path(EXPORTED).ok());
        let is_off = beside(placed.prim.path()).and_then(|path| reading.stage.prim(path).ok()).is_some_and(|prim| {
            let is_dome = prim.type_name().ok().flatten().is_some_and(|name| name.as_str() == "DomeLight");
            is_dome && !all.iter().any(|other| other.visible && other.prim.path() == prim.path())
        });
        worlds.replaced.extend(beside(&placed.path));
        if is_off {
            continue;
        }
        let place = reading.place_of(&placed.path);
        let warnings = &mut reading.warnings.borrow_mut();
        worlds.domes.extend(stamp.dome(world, turn(placed), &place, &mut images.images, warnings));
    }
    worlds
}

/// The way from Blender's space to ours, but for scale.
fn turn(placed: &Placed) -> DMat3 {
    let m = placed.world.matrix3;
    let x = m.x_axis.normalize_or(DVec3::X);
    let y = m.y_axis.reject_from(x).normalize_or(DVec3::Y);
    DMat3::from_cols(x, y, x.cross(y))
}
