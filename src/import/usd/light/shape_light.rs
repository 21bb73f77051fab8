//! Shapes that are lights: MeshLightAPI, LightAPI on any gprim, and the target of a GeometryLight.

use openusd::sdf;
use openusd::usd::Prim;

use super::super::stage::Reading;
use super::super::values::Values;
use super::super::walk::Placed;
use super::{Profiles, color, rules, shaping};
use crate::desc::{
    ColorInput, LightLinks, MaterialDesc, MeshDesc, RoundsDesc, ScalarInput, SceneDesc, ShapeRef, ShapedDesc,
    ShapingDesc,
};
use crate::error::Place;
use crate::math::{DAffine3, DVec3, RoundCone};

/// How a light's emission and its material's go together (`light:materialSyncMode`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sync {
    /// Glow times light.
    GlowTintsLight,
    /// The light in place of the glow; the rest of the material stays.
    Independent,
    /// The light alone.
    NoResponse,
}

/// The light that a shape is.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct ShapeLight {
    /// Emission before `normalize`.
    emission: [f64; 3],
    /// True where it is divided by the area.
    normalize: bool,
    sync: Sync,
    /// True where ShapingAPI says something.
    is_shaped: bool,
    /// Where it was authored.
    place: Place,
    /// Its rules, but for the links that [`link`](super::link) fills.
    pub links: LightLinks,
}

impl ShapeLight {
    /// The light that the shape at `path` is; `None` for one that is none.
    pub fn of(reading: &Reading<'_>, prim: &Prim, path: &sdf::Path) -> Option<Self> {
        let values = Values { reading, prim, path };
        // No shape has the schema of lights but where it is applied.
        if reading.is_plain(prim) || !values.has_api("LightAPI") {
            return None;
        }
        if values.has_api("VolumeLightAPI") {
            values.warn("volumes that are lights are not rendered: it does not shine");
            return None;
        }
        let sync = match values.token("light:materialSyncMode").as_deref() {
            Some("materialGlowTintsLight") => Sync::GlowTintsLight,
            Some("independent") => Sync::Independent,
            None | Some("noMaterialResponse") => Sync::NoResponse,
            Some(other) => {
                values.warn(format!("light:materialSyncMode \"{other}\" is not known: taken as noMaterialResponse"));
                Sync::NoResponse
            }
        };
        Some(Self::new(&values, sync))
    }

    fn new(values: &Values<'_>, sync: Sync) -> Self {
        Self {
            emission: color::emission(values),
            normalize: values.flag("inputs:normalize").unwrap_or(false),
            sync,
            is_shaped: values.has_api("ShapingAPI"),
            place: values.reading.place_of(values.path),
            links: rules::links(values),
        }
    }

    /// How the light is shaped whose properties are those of `prim`, told as that of `path`.
    pub fn shaping(
        &self,
        reading: &Reading<'_>,
        prim: &sdf::Path,
        path: &sdf::Path,
        profiles: &mut Profiles,
    ) -> Option<Shaped> {
        if !self.is_shaped {
            return None;
        }
        let prim = reading.stage.prim(prim).ok()?;
        Shaped::of(&Values { reading, prim: &prim, path }, profiles)
    }

    /// The material that makes a shape with the material `bound` this light. `area` is that of the shape in
    /// the world in square units of the stage (see [`area`]); it is asked for only where it matters. The
    /// emission is `factor` times that of the light (see [`Shaped`]).
    ///
    /// All rays see what lights: UsdLux would show the glow of the material alone to the camera.
    pub fn material(&self, bound: Option<&MaterialDesc>, factor: f64, area: impl FnOnce() -> f64) -> MaterialDesc {
        let per_area = factor * if self.normalize { 1.0 / area() } else { 1.0 };
        let radiance = self.emission.map(|e| e * per_area).map(|e| if e.is_finite() { e } else { 0.0 });
        let light = ColorInput::constant(radiance);
        let glows = |m: &&MaterialDesc| m.emission_strength != 0.0 && m.emission.factor != [0.0; 3];
        match (self.sync, bound) {
            (Sync::GlowTintsLight, Some(bound)) if glows(&bound) => {
                let glow = bound.emission;
                let factor = std::array::from_fn(|i| glow.factor[i] * radiance[i]);
                MaterialDesc { emission: ColorInput { factor, ..glow }, ..bound.clone() }
            }
            // What does not glow has no glow to tint the light with.
            (Sync::GlowTintsLight | Sync::Independent, Some(bound)) => {
                MaterialDesc { emission: light, emission_strength: 1.0, ..bound.clone() }
            }
            (_, None) | (Sync::NoResponse, _) => MaterialDesc {
                name: "light".into(),
                place: self.place.clone(),
                base_color: ColorInput::constant([0.0; 3]),
                specular: ScalarInput::constant(0.0),
                roughness: ScalarInput::constant(1.0),
                emission: light,
                ..MaterialDesc::default()
            },
        }
    }
}

/// How the emission of a shape varies with direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Shaped {
    shaping: ShapingDesc,
    /// What its measured distribution multiplies emission by.
    pub factor: f64,
    /// Where the light stands; `None` for where the shape does.
    world: Option<DAffine3>,
}

impl Shaped {
    fn of(values: &Values<'_>, profiles: &mut Profiles) -> Option<Self> {
        let (shaping, factor) = shaping::of(values, false, profiles);
        let shaped = shaping != ShapingDesc::default() || factor != 1.0;
        shaped.then_some(Self { shaping, factor, world: None })
    }

    /// Of a shape placed by `world`.
    pub fn placed(&self, world: &DAffine3) -> ShapedDesc {
        ShapedDesc { shaping: self.shaping, transform: self.world.unwrap_or(*world) }
    }
}

/// The shape that a GeometryLight makes shine, and how.
#[derive(Debug)]
pub(in super::super) struct GeometryLight {
    /// Of the light itself.
    pub path: sdf::Path,
    /// The shape.
    pub target: sdf::Path,
    /// What it is then.
    pub light: ShapeLight,
    /// Along the axis of the light, not of the shape.
    pub shaped: Option<Shaped>,
}

/// The GeometryLight at `placed`.
pub(in super::super) fn geometry_light(
    reading: &Reading<'_>,
    placed: &Placed,
    profiles: &mut Profiles,
) -> Option<GeometryLight> {
    let values = Values { reading, prim: &placed.prim, path: &placed.path };
    let Some(target) = values.targets("geometry").into_iter().next() else {
        values.warn("a GeometryLight without geometry: it is left out");
        return None;
    };
    let light = ShapeLight::new(&values, Sync::NoResponse);
    let shaped = if light.is_shaped { Shaped::of(&values, profiles) } else { None };
    let shaped = shaped.map(|shaped| Shaped { world: Some(placed.world), ..shaped });
    Some(GeometryLight { path: placed.path.clone(), target, light, shaped })
}

/// Surface of `shape` where `world` puts it, in square units of the stage.
pub(in super::super) fn area(reading: &Reading<'_>, shape: ShapeRef, scene: &SceneDesc, world: &DAffine3) -> f64 {
    let unit = if reading.blender { 1.0 } else { reading.meters };
    let area = match shape {
        ShapeRef::Mesh(i) => scene.meshes.get(i as usize).map_or(0.0, |mesh| area_of_mesh(mesh, world)),
        ShapeRef::Rounds(i) => scene.rounds.get(i as usize).map_or(0.0, |rounds| area_of_rounds(rounds, world)),
    };
    area / (unit * unit)
}

/// Of a strand its sides and the caps of its ends: at a joint what shows of the ball makes up, to first order
/// in the bend, for what the sides cover of each other. A scale that is not even counts by its mean.
fn area_of_rounds(rounds: &RoundsDesc, world: &DAffine3) -> f64 {
    let ball = |i: u32| {
        let ([x, y, z], radius) = (rounds.points[i as usize], rounds.radii[i as usize]);
        [x, y, z, radius]
    };
    let area = |&[before, first, last, after]: &[u32; 4]| {
        let [start, side, end] = RoundCone::new(ball(first), ball(last)).areas();
        side + if before == first { start } else { 0.0 } + if after == last { end } else { 0.0 }
    };
    let sum: f64 = match rounds.segments() {
        Some(segments) => segments.iter().map(area).sum(),
        None => (0..rounds.points.len() as u32).map(|i| area(&[i; 4])).sum(),
    };
    sum * world.matrix3.determinant().abs().powf(2.0 / 3.0)
}

fn area_of_mesh(mesh: &MeshDesc, world: &DAffine3) -> f64 {
    let point = |i: u32| mesh.points.get(i as usize).map_or(DVec3::ZERO, |p| DVec3::from(p.map(f64::from)));
    let triangle = |&[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| world.transform_vector3(point(i)));
        0.5 * (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(triangle).sum()
}

#[cfg(test)]
mod tests {
    use crate::desc::Strand;

    use super::super::testing::Stage;
    use super::*;
    use crate::desc::{LinkSet, SceneDesc};

    fn glowing(factor: [f64; 3]) -> MaterialDesc {
        MaterialDesc { name: "bound".into(), emission: ColorInput::constant(factor), ..MaterialDesc::default() }
    }

    #[test]
    fn a_mesh_light_is_its_glow_times_the_light() {
        let stage = Stage::new(
            "metersPerUnit = 0.01",
            r#"def Mesh "Glow" (prepend apiSchemas = ["MeshLightAPI"]) {
                float inputs:intensity = 3
                color3f inputs:color = (1, 0.5, 1)
                bool inputs:normalize = 1
            }
            def Mesh "Alone" (prepend apiSchemas = ["MeshLightAPI"]) {
                uniform token light:materialSyncMode = "noMaterialResponse"
                float inputs:intensity = 3
                bool inputs:shadow:enable = 0
            }
            def Mesh "Own" (prepend apiSchemas = ["MeshLightAPI"]) {
                uniform token light:materialSyncMode = "independent"
                float inputs:intensity = 5
            }
            def Sphere "Ball" (prepend apiSchemas = ["LightAPI"]) {}
            def Mesh "Dark" {}
            def GeometryLight "Old" { rel geometry = </Dark> float inputs:intensity = 2 }"#,
        );
        let light =
            |path: &str| stage.with(path, |reading, placed| ShapeLight::of(reading, &placed.prim, &placed.path));
        let glow = light("/Glow").unwrap().material(Some(&glowing([1.0, 1.0, 0.5])), 1.0, || 6.0);
        assert_eq!((&*glow.name, glow.emission.factor), ("bound", [0.5, 0.25, 0.25]));
        // Nothing glows: the light's own colour.
        let glow = light("/Glow").unwrap().material(Some(&glowing([0.0; 3])), 1.0, || 6.0);
        assert_eq!((&*glow.name, glow.emission.factor), ("bound", [0.5, 0.25, 0.5]));
        let alone = light("/Alone").unwrap();
        let material = alone.material(Some(&glowing([1.0; 3])), 1.0, || 0.0);
        assert_eq!((material.base_color.factor, material.emission.factor), ([0.0; 3], [3.0; 3]));
        assert!(!alone.links.cast_shadow);
        let own = light("/Own").unwrap().material(Some(&glowing([0.5; 3])), 1.0, || 0.0);
        assert_eq!((&*own.name, own.emission.factor), ("bound", [5.0; 3]));
        // The fallback of LightAPI itself.
        let ball = light("/Ball").unwrap().material(Some(&glowing([0.5; 3])), 1.0, || 0.0);
        assert_eq!((&*ball.name, ball.emission.factor), ("light", [1.0; 3]));
        assert_eq!(light("/Dark"), None);
        let profiles = &mut Profiles::default();
        let old = stage.with("/Old", |reading, placed| geometry_light(reading, placed, profiles)).unwrap();
        assert_eq!(old.shaped, None);
        assert_eq!((old.target.as_str(), old.light.material(None, 1.0, || 0.0).emission.factor), ("/Dark", [2.0; 3]));
        assert_eq!(stage.said(), "");
    }

    /// A square of 100 units in a stage of centimetres, scaled by 2 and 3, is one of 60 000 square units.
    #[test]
    fn areas_are_in_the_units_of_the_stage() {
        let stage = Stage::new(
            "metersPerUnit = 0.01",
            r#"def Mesh "A" { float3 xformOp:scale = (2, 1, 3); uniform token[] xformOpOrder = ["xformOp:scale"] }"#,
        );
        let mesh = MeshDesc {
            points: vec![[0.0; 3], [100.0, 0.0, 0.0], [100.0, 0.0, 100.0], [0.0, 0.0, 100.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3], [9, 9, 9]],
            ..MeshDesc::default()
        };
        // A ball, and a rod of three joints: sides, and half a ball at each end.
        let rounds = |strands| RoundsDesc {
            points: vec![[0.0; 3], [0.0, 300.0, 0.0], [0.0, 400.0, 0.0]],
            radii: vec![100.0; 3],
            strands,
            ..RoundsDesc::default()
        };
        let rod = vec![Strand { end: 3, closed: false }];
        let scene = SceneDesc {
            meshes: vec![mesh.into()],
            rounds: vec![rounds(Vec::new()).into(), rounds(rod).into()],
            ..SceneDesc::default()
        };
        let shapes = [ShapeRef::Mesh(0), ShapeRef::Rounds(0), ShapeRef::Rounds(1)];
        let [square, balls, rod] =
            stage.with("/A", |reading, placed| shapes.map(|shape| area(reading, shape, &scene, &placed.world)));
        assert!((square / 60_000.0 - 1.0).abs() < 1e-12, "{square}");
        let scale = 6.0_f64.powf(2.0 / 3.0) * std::f64::consts::PI * 1e4;
        assert!((balls / (12.0 * scale) - 1.0).abs() < 1e-12, "{balls}");
        assert!((rod / (12.0 * scale) - 1.0).abs() < 1e-12, "{rod}");
    }

    #[test]
    fn collections_become_sets_of_instances() {
        let stage = Stage::new(
            "",
            r#"def Xform "World" { def Mesh "A" {} def Mesh "B" {} def Mesh "C" {} }
            def SphereLight "All" {}
            def SphereLight "Some" {
                uniform bool collection:lightLink:includeRoot = 0
                rel collection:lightLink:includes = [</World/A>]
                rel collection:shadowLink:excludes = [</World/C>]
            }"#,
        );
        stage.with("/World", |reading, _| {
            let mut scene = SceneDesc::default();
            for path in ["/World/A", "/World/B", "/World/C"] {
                scene.instances.push(crate::desc::InstanceDesc {
                    name: path.into(),
                    place: reading.place.at(path),
                    asset: path.into(),
                    shape: ShapeRef::Mesh(0),
                    transform: DAffine3::IDENTITY,
                    motion: Vec::new(),
                    materials: Vec::new(),
                    color: None,
                    object_index: 0,
                    info: crate::desc::ObjectInfo::default(),
                    visibility: crate::desc::Visibility::ALL,
                    links: LightLinks::default(),
                    shaped: None,
                    holdout: false,
                    catcher: false,
                    terminator: None,
                });
            }
            let kind = crate::desc::LightKind::Dome { radiance: [1.0; 3], image: None };
            for path in ["/All", "/Some"] {
                let light = crate::desc::LightDesc::new(path, reading.place.at(path), DAffine3::IDENTITY, kind);
                scene.lights.push(light);
            }
            super::super::link(reading, |_| None, &mut scene);
            let links: Vec<_> =
                scene.lights.iter().map(|l| (l.links.receivers.clone(), l.links.blockers.clone())).collect();
            assert_eq!(links[0], (None, None));
            let some = LinkSet { instances: vec![0], exclude: false };
            let without = LinkSet { instances: vec![2], exclude: true };
            assert_eq!(links[1], (Some(some), Some(without)));
        });
    }
}
