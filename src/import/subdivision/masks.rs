//! Values one level down: at faces, edges and vertices, in the order of [`Topology::split`].

use std::f64::consts::TAU;

use rayon::prelude::*;

use super::Scheme;
use super::rules::Rules;
use super::topology::{NONE, Topology};

/// Weight of a triangle's middle at the edge of a mesh whose triangles are smoothed, in place of 1/4
/// (OpenSubdiv's `CATMARK_TRI_SUB_SMOOTH_WEIGHT`).
const SMOOTH_TRIANGLE: f64 = 0.470;

/// Values that a thread takes at once.
pub(super) const TASK: usize = 4096;

/// Adds `weight` times `value`.
pub(super) fn add<const N: usize>(sum: &mut [f64; N], value: &[f32; N], weight: f64) {
    for (sum, value) in sum.iter_mut().zip(value) {
        *sum += weight * f64::from(*value);
    }
}

/// In the precision in which values are kept.
pub(super) fn narrow<const N: usize>(sum: [f64; N]) -> [f32; N] {
    sum.map(|v| v as f32)
}

/// The mean of the values at the corners of each face.
fn middles<const N: usize>(topology: &Topology, values: &[[f32; N]]) -> impl Iterator<Item = [f32; N]> {
    (0..topology.faces.len()).map(|face| {
        let points = topology.faces.points(face);
        let mut sum = [0.0; N];
        points.iter().for_each(|&p| add(&mut sum, &values[p as usize], 1.0));
        narrow(sum.map(|v| v / points.len().max(1) as f64))
    })
}

/// Values that change linearly along edges.
pub(super) fn linear<const N: usize>(topology: &Topology, scheme: Scheme, values: &[[f32; N]]) -> Vec<[f32; N]> {
    let mut next = Vec::with_capacity(topology.faces.len() + topology.edges.len() + values.len());
    if scheme != Scheme::Loop {
        next.extend(middles(topology, values));
    }
    for edge in &topology.edges {
        let mut sum = [0.0; N];
        edge.ends.iter().for_each(|&end| add(&mut sum, &values[end as usize], 0.5));
        next.push(narrow(sum));
    }
    next.extend_from_slice(values);
    next
}

/// Values that the scheme smooths.
pub(super) fn smooth<const N: usize>(
    topology: &Topology,
    rules: &Rules,
    scheme: Scheme,
    smooth_triangles: bool,
    values: &[[f32; N]],
) -> Vec<[f32; N]> {
    if scheme == Scheme::Bilinear {
        return linear(topology, scheme, values);
    }
    let faces = if scheme == Scheme::CatmullClark { topology.faces.len() } else { 0 };
    let edges = topology.edges.len();
    let mut next = vec![[0.0; N]; faces + edges + topology.points];
    let (middles_of_faces, rest) = next.split_at_mut(faces);
    middles_of_faces.iter_mut().zip(middles(topology, values)).for_each(|(slot, value)| *slot = value);
    let masks = Masks { topology, rules, scheme, smooth_triangles };
    rest.par_iter_mut().with_min_len(TASK).enumerate().for_each(|(i, slot)| {
        *slot = match i.checked_sub(edges) {
            None => masks.edge(i, values, middles_of_faces),
            Some(point) => masks.vertex(point, values, middles_of_faces),
        };
    });
    next
}

struct Masks<'a> {
    topology: &'a Topology,
    rules: &'a Rules,
    scheme: Scheme,
    smooth_triangles: bool,
}

impl Masks<'_> {
    /// `middles` are the values of faces (Catmull-Clark).
    fn edge<const N: usize>(&self, edge: usize, values: &[[f32; N]], middles: &[[f32; N]]) -> [f32; N] {
        let topology = self.topology;
        let half = topology.edges[edge].half as usize;
        let ends = [topology.point(half), topology.point(topology.next(half))];
        let twin = topology.twins[half];
        let crease = if twin == NONE { 1.0 } else { f64::from(self.rules.edges[edge].clamp(0.0, 1.0)) };
        let mut sum = [0.0; N];
        ends.iter().for_each(|&end| add(&mut sum, &values[end], 0.5 * crease));
        if crease == 1.0 {
            return narrow(sum);
        }
        let smooth = 1.0 - crease;
        let halves = [half, twin as usize];
        match self.scheme {
            Scheme::Loop => {
                ends.iter().for_each(|&end| add(&mut sum, &values[end], smooth * 3.0 / 8.0));
                for half in halves {
                    add(&mut sum, &values[topology.point(topology.previous(half))], smooth / 8.0);
                }
            }
            _ => {
                let weights = halves.map(|half| self.weight_of_face(topology.face_of[half] as usize));
                let face = 0.5 * (weights[0] + weights[1]);
                let end = 0.5 * (1.0 - 2.0 * face);
                ends.iter().for_each(|&point| add(&mut sum, &values[point], smooth * end));
                for half in halves {
                    add(&mut sum, &middles[topology.face_of[half] as usize], smooth * face);
                }
            }
        }
        narrow(sum)
    }

    fn weight_of_face(&self, face: usize) -> f64 {
        let is_triangle = self.topology.faces.range(face).len() == 3;
        if self.smooth_triangles && is_triangle { SMOOTH_TRIANGLE } else { 0.25 }
    }

    fn vertex<const N: usize>(&self, point: usize, values: &[[f32; N]], middles: &[[f32; N]]) -> [f32; N] {
        let rule = &self.rules.points[point];
        let (corner, crease) = (f64::from(rule.corner), f64::from(rule.crease));
        let mut sum = [0.0; N];
        add(&mut sum, &values[point], corner + 0.75 * crease);
        if crease > 0.0 {
            rule.ends.iter().for_each(|&end| add(&mut sum, &values[end as usize], crease / 8.0));
        }
        let smooth = 1.0 - corner - crease;
        if smooth <= 0.0 {
            return narrow(sum);
        }
        let topology = self.topology;
        let around = topology.around(point);
        if around.len() == 0 {
            return values[point];
        }
        let n = around.len() as f64;
        match self.scheme {
            Scheme::Loop => {
                let beta = loop_weight(n);
                add(&mut sum, &values[point], smooth * (1.0 - n * beta));
                for corner in around {
                    add(&mut sum, &values[topology.point(topology.next(corner))], smooth * beta);
                }
            }
            _ => {
                add(&mut sum, &values[point], smooth * (n - 2.0) / n);
                for corner in around {
                    add(&mut sum, &values[topology.point(topology.next(corner))], smooth / (n * n));
                    add(&mut sum, &middles[topology.face_of[corner] as usize], smooth / (n * n));
                }
            }
        }
        narrow(sum)
    }
}

/// Loop's weight of each of `n` neighbours of a vertex.
pub(super) fn loop_weight(n: f64) -> f64 {
    let c = 3.0 / 8.0 + (TAU / n).cos() / 4.0;
    (5.0 / 8.0 - c * c) / n
}
