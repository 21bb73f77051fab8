//! Subdivision surfaces: Catmull-Clark, Loop and bilinear, with creases, boundaries and face-varying
//! values, by the rules of OpenSubdiv (<https://graphics.pixar.com/opensubdiv/docs/subdivision_surfaces.html>).
//!
//! A [`Cage`] is refined some times; then any number of channels of values go through the same masks,
//! the points among them, and end on the limit surface.
//!
//! ```text
//! Cage ─► Refinement (topology and rules of each level) ─► vertex, linear, face-varying values; normals
//! ```

mod limit;
mod masks;
mod normals;
mod rules;
mod seams;
mod settle;
mod topology;

use masks::{linear, smooth};
use rules::{Rules, Sharpness};
use topology::Topology;

use crate::desc::Attribute;
pub(super) use topology::Faces;

/// Sharpness from which on an edge or a vertex is infinitely sharp (OpenSubdiv's and USD's number).
pub(super) const INFINITE: f32 = 10.0;

/// How faces are split and smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scheme {
    /// E. Catmull, J. Clark, "Recursively generated B-spline surfaces on arbitrary topological meshes",
    /// 1978.
    CatmullClark,
    /// C. Loop, "Smooth subdivision surfaces based on triangles", 1987. For triangles alone.
    Loop,
    /// Split as Catmull-Clark does, without smoothing.
    Bilinear,
}

/// What happens at the rim of an open mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Boundary {
    /// Faces at the rim only guide their neighbours and are left out.
    None,
    /// The rim is a smooth curve.
    EdgeOnly,
    /// The same, and vertices with one face are corners.
    EdgeAndCorner,
}

/// Where face-varying values are linear along their seams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum FaceVarying {
    /// Nowhere.
    None,
    /// At values with one face.
    CornersOnly,
    /// And where more than two regions meet.
    CornersPlus1,
    /// And at the ends of seams and at concave corners.
    CornersPlus2,
    /// Along all seams.
    Boundaries,
    /// Everywhere.
    All,
}

/// A control mesh.
pub(super) struct Cage<'a> {
    /// Faces of three corners and more (three exactly for Loop); indices below `points`.
    pub faces: Faces,
    /// How many points there are.
    pub points: usize,
    /// Edges that are sharp, and how much.
    pub creases: &'a [([u32; 2], f32)],
    /// Points that are sharp, and how much.
    pub corners: &'a [(u32, f32)],
    /// Faces that are refined with the others and then left out; empty for none.
    pub holes: &'a [bool],
    pub scheme: Scheme,
    pub boundary: Boundary,
    pub face_varying: FaceVarying,
    /// Triangles of a Catmull-Clark mesh are smoothed by OpenSubdiv's weights for them (`TRI_SUB_SMOOTH`).
    pub smooth_triangles: bool,
}

/// One level of the mesh: how faces join, and the rule of each vertex.
struct Level {
    topology: Topology,
    rules: Rules,
}

/// A cage refined to some depth.
pub(super) struct Refinement {
    scheme: Scheme,
    face_varying: FaceVarying,
    smooth_triangles: bool,
    /// The cage first.
    levels: Vec<Level>,
    /// Face of the cage for each face of the last level.
    sources: Vec<u32>,
    /// Faces of the last level that are left out.
    holes: Vec<bool>,
}

impl Refinement {
    /// Refines `cage` `depth` times; 0 leaves it as it is.
    pub fn new(cage: Cage<'_>, depth: u32) -> Self {
        let mut topology = Topology::new(cage.faces, cage.points);
        let mut sharpness = Sharpness::new(&topology, cage.creases, cage.corners, cage.boundary);
        let mut sources: Vec<u32> = (0..topology.faces.len() as u32).collect();
        let mut holes = cage.holes.to_vec();
        holes.resize(topology.faces.len(), false);
        if cage.boundary == Boundary::None && cage.scheme != Scheme::Bilinear {
            topology.faces_at_the_rim().for_each(|face| holes[face] = true);
        }
        let mut levels = Vec::new();
        for _ in 0..depth {
            let children = topology.split(cage.scheme);
            sources = children.parents.iter().map(|&face| sources[face as usize]).collect();
            holes = children.parents.iter().map(|&face| holes[face as usize]).collect();
            let child = Topology::new(children.faces, children.points);
            let next = sharpness.child(&topology, &child, cage.scheme);
            let rules = rules::of(&topology, std::mem::replace(&mut sharpness, next));
            levels.push(Level { topology: std::mem::replace(&mut topology, child), rules });
        }
        let rules = rules::of(&topology, sharpness);
        levels.push(Level { topology, rules });
        let Cage { scheme, face_varying, smooth_triangles, .. } = cage;
        Self { scheme, face_varying, smooth_triangles, levels, sources, holes }
    }

    fn last(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    /// The faces of the last level, holes included.
    pub fn faces(&self) -> &Faces {
        &self.last().topology.faces
    }

    /// Face of the cage for each face of the last level.
    pub fn sources(&self) -> &[u32] {
        &self.sources
    }

    /// Faces of the last level that are to be left out.
    pub fn holes(&self) -> &[bool] {
        &self.holes
    }

    /// Values that move with the points: on the limit surface, one for each point of the last level.
    /// Without refinement they stay as they are.
    pub fn vertex<const N: usize>(&self, values: &[[f32; N]]) -> Vec<[f32; N]> {
        self.push(self.smooth(values))
    }

    /// The points of the last level on the limit surface, and its unit normals there: one for each point
    /// or, where creases part them, for each corner. `None` for surfaces that are flat in pieces.
    pub fn surface(&self, points: &[[f32; 3]]) -> (Vec<[f32; 3]>, Option<Attribute<[f32; 3]>>) {
        let points = self.smooth(points);
        // The masks of the limit are those of quads and triangles; a cage may have other faces.
        let regular = self.levels.len() > 1 || self.scheme == Scheme::Loop;
        let Level { topology, rules } = self.last();
        let normals = (self.scheme != Scheme::Bilinear)
            .then(|| normals::of(topology, rules, regular.then_some(self.scheme), &points));
        (self.push(points), normals)
    }

    /// Down to the last level.
    fn smooth<const N: usize>(&self, values: &[[f32; N]]) -> Vec<[f32; N]> {
        let mut values = values.to_vec();
        for pair in self.levels.windows(2) {
            let Level { topology, rules } = &pair[0];
            values = smooth(topology, rules, self.scheme, self.smooth_triangles, &values);
        }
        values
    }

    /// From the last level to the limit.
    fn push<const N: usize>(&self, values: Vec<[f32; N]>) -> Vec<[f32; N]> {
        if self.levels.len() == 1 || self.scheme == Scheme::Bilinear {
            return values;
        }
        let Level { topology, rules } = self.last();
        limit::positions(topology, rules, self.scheme, &values)
    }

    /// Values of points that are linear along edges, one for each point of the last level.
    pub fn linear<const N: usize>(&self, values: &[[f32; N]]) -> Vec<[f32; N]> {
        let mut values = values.to_vec();
        for pair in self.levels.windows(2) {
            values = linear(&pair[0].topology, self.scheme, &values);
        }
        values
    }

    /// Values of corners, which may differ from face to face at a point: the refined values, and the
    /// index of one for each corner of the last level. `indices` has one for each corner of the cage.
    pub fn face_varying<const N: usize>(&self, values: &[[f32; N]], indices: &[u32]) -> (Vec<[f32; N]>, Vec<u32>) {
        let cage = &self.levels[0].topology;
        let (mut faces, mut values) = seams::split(cage, values, indices);
        if self.scheme == Scheme::Bilinear || self.face_varying == FaceVarying::All {
            for _ in 1..self.levels.len() {
                let topology = Topology::new(faces, values.len());
                values = linear(&topology, self.scheme, &values);
                faces = topology.split(self.scheme).faces;
            }
            return (values, faces.corners);
        }
        for (depth, level) in self.levels.iter().enumerate() {
            let topology = Topology::new(faces, values.len());
            let rules = seams::rules(&topology, &level.topology, &level.rules, self.face_varying);
            if depth + 1 == self.levels.len() {
                if depth > 0 {
                    values = limit::positions(&topology, &rules, self.scheme, &values);
                }
                return (values, topology.faces.corners);
            }
            values = smooth(&topology, &rules, self.scheme, self.smooth_triangles, &values);
            faces = topology.split(self.scheme).faces;
        }
        (values, Vec::new())
    }
}

#[cfg(test)]
mod published;
#[cfg(test)]
mod tests;
