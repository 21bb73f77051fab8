//! UsdLux lights to `LightDesc`.

use std::collections::HashMap;

use openusd::sdf;
use openusd::usd::Prim;

use super::images::Images;
use super::stage::Reading;
use super::walk::Placed;
use crate::desc::{IesDesc, LightDesc, LightLinks, MaterialDesc, MeshDesc, SceneDesc};
use crate::math::DAffine3;

/// Stand-in.
#[derive(Default)]
pub(super) struct Profiles {
    pub list: Vec<IesDesc>,
}

/// Stand-in.
pub(super) struct ShapeLight {
    pub links: LightLinks,
}

impl ShapeLight {
    pub fn of(_reading: &Reading<'_>, _prim: &Prim, _path: &sdf::Path) -> Option<Self> {
        None
    }
    pub fn material(&self, bound: Option<&MaterialDesc>, _area: impl FnOnce() -> f64) -> MaterialDesc {
        bound.cloned().unwrap_or_default()
    }
}

pub(super) fn geometry_light(_reading: &Reading<'_>, _placed: &Placed) -> Option<(sdf::Path, ShapeLight)> {
    None
}

pub(super) fn area(_reading: &Reading<'_>, _mesh: &MeshDesc, _world: &DAffine3) -> f64 {
    0.0
}

pub(super) fn link(_reading: &Reading<'_>, _scene: &mut SceneDesc) {}

/// True for the schemas of lights with a shape of their own or none; meshes and volumes with LightAPI are
/// shapes that emit.
pub(super) fn is_light(kind: &str) -> bool {
    kind.ends_with("Light")
}

/// The light at `placed`; `None`, with a warning, for one that is not rendered.
pub(super) fn read(
    reading: &Reading<'_>,
    placed: &Placed,
    _images: &mut Images,
    _profiles: &mut Profiles,
) -> Option<LightDesc> {
    let kind = crate::desc::LightKind::Point { intensity: [1.0; 3] };
    let _: HashMap<u8, u8> = HashMap::new();
    Some(LightDesc::new(placed.path.name()?, reading.place_of(&placed.path), placed.world, kind))
}
