//! UsdGeomMesh, and the surface of UsdGeomTetMesh.

use std::hash::{DefaultHasher, Hash, Hasher};

use openusd::sdf::Value;
use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::{Interpolation, Primvar};

use super::super::skel::{Bound, Deformer};
use super::super::stage::Reading;
use super::super::values::pick;
use super::finish::{Channels, Surface};
use super::polygons::{Authored, mend_points};
use super::primvar::{self, Counts, Primvars};
use super::subdivide::{self, Rules};
use super::subsets::{self, Subsets};
use super::values::triples;
use super::{Built, Wants, motion};
use crate::desc::Motion;
use crate::error::{Place, Warnings};

/// A mesh as authored.
#[derive(PartialEq)]
pub(in super::super) struct Mesh {
    points: Vec<[f32; 3]>,
    counts: Vec<i32>,
    indices: Vec<i32>,
    holes: Vec<i32>,
    flipped: bool,
    /// `None` for a mesh of flat faces.
    rules: Option<Rules>,
    pub(super) primvars: Primvars,
    pub(super) subsets: Subsets,
    motion: Vec<Motion<Vec<[f32; 3]>>>,
}

/// Reads a mesh that follows the skeleton of `skin`; its motion within the frames `shutter`, where that is given.
/// `None`, with a warning, for one without points or faces.
pub(super) fn read(
    reading: &Reading<'_>,
    prim: &Prim,
    inherited: &[Primvar],
    skin: Option<&Bound>,
    shutter: Option<[f64; 2]>,
) -> Option<Mesh> {
    let points = points(reading, prim, skin)?;
    let deformer = skin.and_then(|bound| Deformer::of(reading, prim, bound, points.len()));
    let indices: Vec<i32> = reading.value(prim, "faceVertexIndices").unwrap_or_default();
    let counts: Vec<i32> = reading.value(prim, "faceVertexCounts").unwrap_or_default();
    if counts.is_empty() || indices.is_empty() {
        reading.warn(prim.path(), "the mesh has no faces; it is left out");
        return None;
    }
    let rules = subdivide::read(reading, prim);
    let mut primvars = primvar::read(reading, prim, inherited);
    // Surfaces that are smooth have the normals of their limit.
    if rules.is_some() {
        primvars.normals = None;
    } else if primvars.normals.is_none() {
        let normals = prim.attribute("normals");
        primvars.normals = primvar::array(reading, &normals, triples, Interpolation::Vertex);
    }
    if let Some(deformer) = &deformer {
        primvars.normals = deformer.of_surface(primvars.normals, &indices);
    }
    let moved = |shutter| motion::read(reading, prim, shutter, points.len(), deformer.as_ref(), None);
    let motion = shutter.map_or_else(Vec::new, moved);
    Some(Mesh {
        counts,
        indices,
        holes: reading.value(prim, "holeIndices").unwrap_or_default(),
        flipped: is_left_handed(reading, prim),
        rules,
        primvars,
        subsets: subsets::read(reading, prim),
        motion,
        points: match &deformer {
            Some(deformer) => deformer.points(points, reading.time),
            None => points,
        },
    })
}

/// Reads the authored surface of tetrahedra.
pub(super) fn read_tetrahedra(
    reading: &Reading<'_>,
    prim: &Prim,
    inherited: &[Primvar],
    skin: Option<&Bound>,
    shutter: Option<[f64; 2]>,
) -> Option<Mesh> {
    let mut points = points(reading, prim, skin)?;
    let indices: Vec<i32> = match reading.value::<Value>(prim, "surfaceFaceVertexIndices") {
        Some(Value::Vec3iVec(faces)) => faces.iter().flat_map(|f| [f.x, f.y, f.z]).collect(),
        _ => Vec::new(),
    };
    if indices.is_empty() {
        reading.warn(prim.path(), "the tetrahedra have no surfaceFaceVertexIndices; they are left out");
        return None;
    }
    let mut primvars = primvar::read(reading, prim, inherited);
    if primvars.normals.is_none() {
        primvars.normals = primvar::array(reading, &prim.attribute("normals"), triples, Interpolation::Vertex);
    }
    let deformer = skin.and_then(|bound| Deformer::of(reading, prim, bound, points.len()));
    let moved = |shutter| motion::read(reading, prim, shutter, points.len(), deformer.as_ref(), None);
    let motion = shutter.map_or_else(Vec::new, moved);
    if let Some(deformer) = &deformer {
        primvars.normals = deformer.of_surface(primvars.normals, &indices);
        points = deformer.points(points, reading.time);
    }
    subsets::tell_of_those(reading, prim);
    Some(Mesh {
        points,
        counts: vec![3; indices.len() / 3],
        indices,
        holes: Vec::new(),
        flipped: is_left_handed(reading, prim),
        rules: None,
        primvars,
        subsets: Subsets::default(),
        motion,
    })
}

/// The points of any point-based prim, moved on by velocities unless it follows the skeleton of `skin`; `None`, with a
/// warning, where there are none.
pub(super) fn points(reading: &Reading<'_>, prim: &Prim, skin: Option<&Bound>) -> Option<Vec<[f32; 3]>> {
    let attribute = prim.attribute("points");
    let points = primvar::array(reading, &attribute, triples, Interpolation::Vertex).map(|data| data.values);
    if points.as_ref().is_none_or(Vec::is_empty) {
        reading.warn(prim.path(), "it has no points; it is left out");
        return None;
    }
    let points = points?;
    // Few prims have any, and others are not to be searched.
    if skin.is_none()
        && reading.names(prim).iter().any(|name| name.as_str() == "velocities")
        && let Some(flowing) = motion::flowing(reading, prim, points.len())
    {
        return Some(flowing.at(reading.time));
    }
    Some(points)
}

pub(super) fn is_left_handed(reading: &Reading<'_>, prim: &Prim) -> bool {
    let token = reading.value::<Token>(prim, "orientation");
    pick(reading, prim, "orientation", token, &[("rightHanded", false), ("leftHanded", true)])
}

impl Mesh {
    /// The same for meshes that are equal, and cheap: for others seldom.
    pub fn digest(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.counts.len(), self.indices.len(), self.flipped).hash(&mut hasher);
        primvar::digest(&self.points, &mut hasher);
        self.primvars.digest(&mut hasher);
        hasher.finish()
    }

    pub fn build(self, wants: &Wants, depth: u32, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let Self { mut points, counts, indices, holes, flipped, rules, primvars, subsets, motion } = self;
        let corners = counts.iter().map(|&count| usize::try_from(count).unwrap_or(0)).sum();
        let sizes = Counts { faces: counts.len(), joints: points.len(), points: points.len(), corners };
        let channels = Channels::new(primvars, &sizes, wants, place, warnings);
        let (slots, told) = subsets.slots(counts.len());
        told.into_iter().for_each(|what| warnings.push(place, what));
        let bad = mend_points(&mut points);
        let authored = Authored { counts, indices, holes: &holes, points: points.len(), bad, flipped };
        let mut surface = match rules {
            Some(rules) => {
                let (polygons, holes) = authored.polygons(true, place, warnings);
                rules.refine(polygons, &holes, points, channels, motion, depth, place, warnings)
            }
            None => {
                let triangles = authored
                    .into_triangles()
                    .unwrap_or_else(|authored| authored.polygons(false, place, warnings).0.triangles(&points, &[]));
                Surface { points, triangles, channels, slots: None, motion }
            }
        };
        surface.slots = slots;
        let mesh = surface.finish(wants, place, warnings)?;
        Some(Built::Mesh(mesh))
    }
}

#[cfg(test)]
mod tests;
