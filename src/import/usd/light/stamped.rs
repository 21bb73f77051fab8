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
        let links = rules::links(values);
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
                cast_shadow: own.links.cast_shadow && links.cast_shadow,
                shadow: links.shadow,
                response: links.response,
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
        let dome = stamp.dome(world, turn(placed), &place, &mut images.images, warnings);
        worlds.domes.extend(dome.map(|dome| LightDesc { place, ..dome }));
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

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use crate::desc::{LightKind, ProjectionDesc, SceneDesc};
    use crate::error::Warnings;
    use crate::import::ImportOptions;
    use crate::math::DVec3;

    /// A scene as Blender 5.0.1 writes it, with `prims` in its root, and what was said of it.
    fn load(prims: &str) -> (SceneDesc, String) {
        let (scene, warnings) = load_warned(prims);
        (scene, warnings.iter().map(|warning| format!("{warning}\n")).collect())
    }

    fn load_warned(prims: &str) -> (SceneDesc, Warnings) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stage.usda");
        let root = "customData = { dictionary Blender = { bool generated = 1 } }";
        let head = "doc = \"Blender v5.0.1\"\nmetersPerUnit = 1\nupAxis = \"Z\"";
        std::fs::write(&path, format!("#usda 1.0\n(\n{head}\n)\ndef Xform \"root\" ({root}) {{\n{prims}\n}}")).unwrap();
        let mut warnings = Warnings::new();
        let scene = crate::import::scene(&path, &ImportOptions::default(), &mut warnings).unwrap();
        (scene, warnings)
    }

    /// An area lamp of 100 W that `data` and `edits` say more of, 3 above the floor.
    fn area(data: &str, edits: &str) -> String {
        format!(
            r#"def Xform "Area" {{
                custom string userProperties:penumbra:light = '{{"version": 1, "light": {{"type": "AREA", "energy": 100,
 "shape": "ELLIPSE", "size": 1, "size_y": 0.5, "spread": 1, "temperature_color": [1, 0.5, 0.25]{data}}}}}'
                double3 xformOp:translate = (0, 0, 3)
                uniform token[] xformOpOrder = ["xformOp:translate"]
                def DiskLight "Area" {{
                    bool inputs:enableColorTemperature = 1
                    float inputs:colorTemperature = 3000
                    float inputs:intensity = 31.830988
                    bool inputs:normalize = 1
                    float inputs:radius = 0.375
                    {edits}
                }}
            }}"#
        )
        .replace("\n ", " ")
    }

    fn near(found: f64, expected: f64) {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} is not {expected}");
    }

    #[test]
    fn the_stamp_says_what_usdlux_has_no_place_for() {
        let (scene, said) = load(&area(r#", "use_shadow": false, "lightgroup": "key""#, ""));
        let light = &scene.lights[0];
        let LightKind::Disk { width, height, radiance, spread, .. } = light.kind else { panic!("{light:?}") };
        near(width, 1.0);
        near(height, 0.5);
        near(radiance[1], 0.5 * 100.0 / (PI * 0.25 * PI * 0.5));
        assert_eq!((spread, light.links.cast_shadow, light.links.group.as_deref()), (1.0, false, Some("key")));
        // z up becomes y up.
        assert!((light.transform.translation - DVec3::new(0.0, 3.0, 0.0)).length() < 1e-9);
        assert!((light.transform.matrix3.z_axis - DVec3::Y).length() < 1e-9);
        assert_eq!((light.place.node.as_deref(), &*light.name, &*said), (Some("/root/Area/Area"), "Area", ""));
    }

    #[test]
    fn edits_of_usdlux_count() {
        let edit = "float inputs:exposure = 1\ncolor3f inputs:color = (0, 1, 0)\nbool inputs:shadow:enable = 0
            float inputs:shadow:distance = 2
            token visibility = \"inherited\"";
        let (scene, said) = load(&area("", edit));
        let light = &scene.lights[0];
        near(light.kind.color()[1], 2.0 * 0.5 * 100.0 / (PI * 0.25 * PI * 0.5));
        assert_eq!((light.kind.color()[0], light.links.cast_shadow, &*said), (0.0, false, ""));
        assert_eq!(light.links.shadow.distance, 2.0);
        let (scene, _) = load(&area("", "token visibility = \"invisible\""));
        assert!(scene.lights.is_empty());
        let (scene, _) = load(&area("", "").replace("radius = 0.375", "radius = 0.75"));
        let LightKind::Disk { width, height, .. } = scene.lights[0].kind else { panic!() };
        near(width, 2.0);
        near(height, 1.0);
    }

    #[test]
    fn broken_stamps_leave_usdlux() {
        for broken in ["nothing", "3", "{}", r#"{"version": 1, "light": {"energy": "much"}}"#] {
            let stage = area("", "");
            let from = stage.find("'{").unwrap();
            let to = stage.rfind("}'").unwrap() + 2;
            let (scene, said) = load(&format!("{}'{broken}'{}", &stage[..from], &stage[to..]));
            assert!(matches!(scene.lights[0].kind, LightKind::Disk { spread, .. } if spread == PI));
            assert!(said.contains("/root/Area/Area: userProperties:penumbra:light is left out"), "{said}");
            assert_eq!(said.lines().count(), 1, "{said}");
        }
    }

    /// Without any stamp the losses are told once; not as a fault, as nothing need be lost.
    #[test]
    fn plain_files_are_told_of() {
        let (_, warnings) = load_warned(&area("", "").replace("userProperties:penumbra", "userProperties:other"));
        assert_eq!((warnings.len(), warnings.faults()), (1, 0));
        let said = warnings.iter().next().unwrap().to_string();
        assert!(said.contains("exported by Blender alone") && said.contains("spread"), "{said}");
        assert!(!said.contains("soft falloff"), "{said}");
    }

    const WORLD: &str = r#"def Xform "penumbra_world" {
            custom string userProperties:penumbra:world = '{"version": 1, "world": {"name": "W", "color": [1, 2, 3]}}'
        }
        def DomeLight "env_light" { float inputs:intensity = 7 }"#;

    #[test]
    fn worlds_stand_for_the_dome_of_the_exporter() {
        let (scene, said) = load(WORLD);
        assert_eq!((scene.lights.len(), &*said), (1, ""));
        let LightKind::Dome { radiance, image: None } = scene.lights[0].kind else { panic!() };
        assert_eq!((radiance, scene.lights[0].place.node.as_deref()), ([1.0, 2.0, 3.0], Some("/root/penumbra_world")));
        assert!((scene.lights[0].transform.matrix3.y_axis - DVec3::Y).length() < 1e-9);
        // Whoever hides the dome wants none.
        for hidden in [
            WORLD.replace("intensity = 7", "intensity = 7\ntoken visibility = \"invisible\""),
            WORLD.replace("\"env_light\" {", "\"env_light\" (active = false) {"),
        ] {
            assert!(load(&hidden).0.lights.is_empty(), "{hidden}");
        }
        let (scene, said) = load(&WORLD.replace("version\": 1", "version\": 9"));
        assert!(matches!(scene.lights[0].kind, LightKind::Dome { radiance: [7.0, ..], .. }));
        assert!(said.contains("version 9"), "{said}");
    }

    /// The exporter writes no prim for cameras that UsdGeom does not know.
    #[test]
    fn panoramas_are_cameras_of_their_xform() {
        let camera = |kind: &str| {
            format!(
                r#"def Xform "Cam" {{
                    custom string userProperties:penumbra:camera = '{{"version": 1, "active": true, "render":
                     {{"size": [200, 100]}}, "camera": {{"type": "{kind}", "ortho_scale": 5}}}}'
                    double3 xformOp:translate = (0, 0, 3)
                    uniform token[] xformOpOrder = ["xformOp:translate"]
                }}"#
            )
            .replace("\n                     ", " ")
        };
        let (scene, said) = load(&camera("PANO"));
        assert!(matches!(scene.cameras[0].projection, ProjectionDesc::Equirectangular { .. }), "{said}");
        assert_eq!(
            (scene.render.framing.camera.as_deref(), scene.render.framing.resolution),
            (Some("/root/Cam"), Some([200, 100]))
        );
        let (scene, _) = load(&camera("ORTHO"));
        let ProjectionDesc::Orthographic { half_width, half_height } = scene.cameras[0].projection else { panic!() };
        assert_eq!([half_width, half_height], [2.5, 1.25]);
        // A perspective one was taken out by somebody.
        assert!(load(&camera("PERSP")).0.cameras.is_empty());
    }
}
