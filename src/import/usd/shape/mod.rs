//! Gprims to triangles, strands and balls. Reading is done on one thread, since a stage is bound to its
//! own; the work on what was read is done on all.
//!
//! ```text
//! mesh ─► polygons ─► [subdivide] ─► triangulate ─► finish: attributes at points and corners
//! ribbons, primitives ────────────────────────────┘
//! curves, points ─► rounds: strands and balls, attributes at points
//! ```

mod curves;
mod finish;
mod mesh;
mod motion;
mod points;
mod polygons;
mod primitive;
pub(super) mod primvar;
mod profile;
mod ribbon;
mod rounds;
mod segments;
mod stand_in;
mod subdivide;
mod subsets;
pub(super) mod tint;
mod triangulate;
pub(super) mod values;

pub(super) use primitive::Likeness;
pub(super) use stand_in::{CARDS_UV, Quad, StandIn, StandInShape};

use std::sync::Arc;

use openusd::sdf;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::skel;
use super::stage::Reading;
use crate::desc::{MeshDesc, RoundsDesc};
use crate::error::{Place, Warnings};

/// A gprim as authored.
pub(super) enum Source {
    Mesh(Box<mesh::Mesh>),
    Curves(Box<curves::Curves>),
    Points(Box<points::Points>),
    Primitive(Box<primitive::Primitive>),
    StandIn(Box<StandIn>),
}

/// What the materials of a shape need of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Wants {
    /// UV set `i` is the primvar of this name; empty for one that nothing looks at.
    pub uv_sets: Vec<Arc<str>>,
    /// True where no material looks at the first set; the UV pass shows it if it is there.
    pub spare_first_set: bool,
    /// The UV set that tangents go by.
    pub tangents: Option<u32>,
    /// displayColor and displayOpacity as colours of the mesh.
    pub display_color: bool,
    /// Which slots show those, where not all do.
    pub colored_slots: Vec<bool>,
    /// Primvars that graphs ask for by name.
    pub named: Vec<Arc<str>>,
    /// True where instances have colours, which take the place of those that the shape lacks.
    pub instance_color: bool,
}

/// A gprim as it is traced, in object space and stage units. Slot 0 of the materials is that of the gprim
/// itself, slot `i + 1` that of subset `i`.
pub(super) enum Built {
    Mesh(MeshDesc),
    Rounds(RoundsDesc),
}

impl Source {
    /// What makes two of them the same shape, where that is cheaper to tell than to build both.
    pub fn likeness(&self) -> Option<Likeness> {
        match self {
            Self::Primitive(primitive) => primitive.likeness(),
            _ => None,
        }
    }

    /// The same for meshes that may be equal; `None` for what is no mesh.
    pub fn digest(&self) -> Option<u64> {
        match self {
            Self::Mesh(mesh) => Some(mesh.digest()),
            _ => None,
        }
    }

    /// True for meshes that are equal.
    pub fn is_same_mesh(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Mesh(a), Self::Mesh(b)) => a == b,
            _ => false,
        }
    }

    /// Reads the primvars that graphs ask for by `names`, and keeps them with the shape of `prim`, which inherits
    /// `inherited`.
    pub fn read_named(&mut self, reading: &Reading<'_>, prim: &Prim, inherited: &[Primvar], names: &[Arc<str>]) {
        let (primvars, joined) = match self {
            Self::Mesh(mesh) => (&mut mesh.primvars, false),
            Self::Curves(curves) => (&mut curves.primvars, curves.from_hermite),
            Self::Points(points) => (&mut points.primvars, false),
            Self::Primitive(primitive) => (&mut primitive.primvars, false),
            Self::StandIn(_) => return,
        };
        primvars.named = primvar::named(reading, prim, inherited, names);
        if joined {
            primvars.named.iter_mut().for_each(primvar::Data::at_joints);
        }
    }

    /// Paths of the GeomSubsets that a material may be bound to, and of what stands for them.
    pub fn subsets(&self) -> &[sdf::Path] {
        match self {
            Self::Mesh(mesh) => &mesh.subsets.paths,
            Self::StandIn(stand_in) => &stand_in.textures,
            _ => &[],
        }
    }
}

/// Reads the gprim `prim`, which inherits `primvars` and follows the skeleton of `skin`. `None` for a kind that is no shape, or one that is
/// broken, which is told.
pub(super) fn read(
    reading: &Reading<'_>,
    prim: &Prim,
    primvars: &[Primvar],
    skin: Option<&skel::Bound>,
) -> Option<Source> {
    let kind = reading.type_name(prim);
    match kind.as_str() {
        "Mesh" => {
            mesh::read(reading, prim, primvars, skin, reading.shutter.get()).map(|mesh| Source::Mesh(Box::new(mesh)))
        }
        "TetMesh" => mesh::read_tetrahedra(reading, prim, primvars, skin, reading.shutter.get())
            .map(|mesh| Source::Mesh(Box::new(mesh))),
        "BasisCurves" | "HermiteCurves" | "NurbsCurves" => {
            curves::read(reading, prim, primvars, skin, kind.as_str()).map(|curves| Source::Curves(Box::new(curves)))
        }
        "Points" => points::read(reading, prim, primvars, skin).map(|points| Source::Points(Box::new(points))),
        "NurbsPatch" => {
            reading.warn(prim.path(), "NURBS patches are not supported; the patch is left out");
            None
        }
        "Volume" => {
            reading.warn(prim.path(), "volumes are not supported; the volume is left out");
            None
        }
        kind => primitive::read(reading, prim, primvars, kind).map(|p| Source::Primitive(Box::new(p))),
    }
}

/// Makes a shape of it; `None`, with a warning, where nothing is left.
pub(super) fn build(
    source: Source,
    wants: &Wants,
    subdivision: u32,
    place: &Place,
    warnings: &mut Warnings,
) -> Option<Built> {
    match source {
        Source::Mesh(mesh) => mesh.build(wants, subdivision, place, warnings),
        Source::Curves(curves) => curves.build(wants, place, warnings),
        Source::Points(points) => points.build(wants, place, warnings),
        Source::Primitive(primitive) => primitive.build(wants, place, warnings),
        Source::StandIn(stand_in) => stand_in.build(wants, place, warnings),
    }
}

#[cfg(test)]
mod assets;
#[cfg(test)]
mod testing;
