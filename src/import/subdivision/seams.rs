//! Face-varying values as a mesh of their own, which is cut where values differ at a point.

use super::FaceVarying;
use super::INFINITE;
use super::rules::{Kind, Rule, Rules};
use super::topology::{Faces, NONE, Topology};

/// Parts `values` so that each belongs to one point, and joins equal ones at a point (as Cycles does:
/// most files don't index them). `indices` has one for each corner of `cage`.
pub(super) fn split<const N: usize>(cage: &Topology, values: &[[f32; N]], indices: &[u32]) -> (Faces, Vec<[f32; N]>) {
    let mut corners = vec![0; indices.len()];
    let mut parted: Vec<[f32; N]> = Vec::with_capacity(cage.points);
    for point in 0..cage.points {
        let first = parted.len();
        for corner in cage.around(point) {
            let value = values[indices[corner] as usize];
            let known = parted[first..].iter().position(|known| *known == value);
            corners[corner] = (first + known.unwrap_or(parted.len() - first)) as u32;
            if known.is_none() {
                parted.push(value);
            }
        }
    }
    (Faces { starts: cage.faces.starts.clone(), corners }, parted)
}

/// The rules of the values of a level, whose faces are those of `mesh` corner by corner.
pub(super) fn rules(values: &Topology, mesh: &Topology, mesh_rules: &Rules, option: FaceVarying) -> Rules {
    let mut siblings = vec![0u32; mesh.points];
    let mut with_lone_face = vec![false; mesh.points];
    for value in 0..values.points {
        let mut around = values.around(value);
        let count = around.len();
        if let Some(corner) = around.next() {
            siblings[mesh.point(corner)] += 1;
            with_lone_face[mesh.point(corner)] |= count == 1;
        }
    }
    let seams = Seams { values, mesh, mesh_rules, option };
    let rule = |value: usize| {
        let Some(corner) = values.around(value).next() else { return Rule::CORNER };
        let point = mesh.point(corner);
        if siblings[point] == 1 {
            seams.whole(value, point)
        } else {
            seams.part(value, point, siblings[point], with_lone_face[point])
        }
    };
    let edge = |half: usize| match values.twins[half] {
        NONE => INFINITE,
        _ => mesh_rules.edges[mesh.edge_of[half] as usize],
    };
    let corner = |value: usize| values.around(value).next().map_or(0.0, |c| mesh_rules.corners[mesh.point(c)]);
    Rules {
        points: (0..values.points).map(rule).collect(),
        corners: (0..values.points).map(corner).collect(),
        edges: values.edges.iter().map(|e| edge(e.half as usize)).collect(),
    }
}

struct Seams<'a> {
    values: &'a Topology,
    mesh: &'a Topology,
    mesh_rules: &'a Rules,
    option: FaceVarying,
}

impl Seams<'_> {
    /// A value that all faces at `point` share: it goes as the point goes, unless the option sharpens it.
    fn whole(&self, value: usize, point: usize) -> Rule {
        let around = || self.values.around(value);
        let is_cut = |half: usize| self.values.twins[half] == NONE;
        let is_rim = |half: usize| self.mesh.twins[half] == NONE;
        let halves = || around().flat_map(|corner| [corner, self.values.previous(corner)]);
        let is_end_of_seam = halves().any(|half| is_cut(half) && !is_rim(half));
        let is_at_rim = halves().any(is_rim);
        if self.option >= FaceVarying::CornersOnly && around().len() == 1
            || self.option >= FaceVarying::CornersPlus2 && is_end_of_seam
            || self.option >= FaceVarying::Boundaries && is_at_rim
        {
            return Rule::CORNER;
        }
        let rule = self.mesh_rules.points[point];
        // Around the end of a seam there is no closed ring of values, as there is of faces.
        let open = rule.open && !is_end_of_seam;
        Rule { open, ends: rule.ends.map(|end| self.neighbour(value, end).unwrap_or(value as u32)), ..rule }
    }

    /// The value at the other end of an edge from the point of `value` to point `end`.
    fn neighbour(&self, value: usize, end: u32) -> Option<u32> {
        let beside = |corner| [self.values.next(corner), self.values.previous(corner)];
        let mut near = self.values.around(value).flat_map(beside);
        near.find(|&corner| self.mesh.faces.corners[corner] == end).map(|corner| self.values.faces.corners[corner])
    }

    /// One of several values at `point`: a corner, or on the curve along the seam.
    fn part(&self, value: usize, point: usize, siblings: u32, with_lone_face: bool) -> Rule {
        let values = self.values;
        let faces = values.around(value).len();
        let is_junction = siblings > 2;
        if self.option >= FaceVarying::Boundaries
            || self.mesh_rules.points[point].kind == Kind::Corner
            || self.option >= FaceVarying::CornersOnly && faces == 1
            || self.option >= FaceVarying::CornersPlus1 && is_junction
            || self.option >= FaceVarying::CornersPlus2 && with_lone_face
        {
            return Rule::CORNER;
        }
        let mut ends = [0; 2];
        let mut count = 0;
        for corner in values.around(value) {
            let before = values.previous(corner);
            for (half, end) in [(corner, values.next(corner)), (before, before)] {
                if values.twins[half] == NONE {
                    if let Some(slot) = ends.get_mut(count) {
                        *slot = values.faces.corners[end];
                    }
                    count += 1;
                }
            }
        }
        if count == 2 { Rule::crease(ends) } else { Rule::CORNER }
    }
}
