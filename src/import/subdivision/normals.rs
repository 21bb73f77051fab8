//! Normals at the limit: cross products of the tangents that the masks give (the sources of `limit.rs`;
//! for creases the masks of OpenSubdiv's `Sdc::Scheme`).

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::Scheme;
use super::masks::TASK;
use super::rules::{Kind, Rules};
use super::topology::{NONE, Topology};
use crate::desc::Attribute;
use crate::math::DVec3;

/// The neighbours of a vertex between two sharp edges, or all of them, counter-clockwise.
#[derive(Default)]
struct Sector {
    /// At the ends of edges. One more than faces, unless the sector is closed.
    edges: Vec<DVec3>,
    /// At the corners across the faces; the same as the next edge's for triangles.
    faces: Vec<DVec3>,
    corners: Vec<usize>,
    is_closed: bool,
}

/// Unit normals of the limit surface at the points, or at the corners where sharp edges part them.
/// Without a `scheme` they are means of those of the faces.
pub(super) fn of(
    topology: &Topology,
    rules: &Rules,
    scheme: Option<Scheme>,
    values: &[[f32; 3]],
) -> Attribute<[f32; 3]> {
    let walk = Walk { topology, rules, values };
    let mut points = vec![[0.0, 0.0, 1.0]; values.len()];
    let parted: Vec<(usize, [f32; 3])> = points
        .par_iter_mut()
        .with_min_len(TASK)
        .enumerate()
        .map_init(Sector::default, |sector, (point, normal)| walk.normals(point, scheme, sector, normal))
        .flatten_iter()
        .collect();
    if parted.is_empty() {
        return Attribute::Point(points);
    }
    let mut corners: Vec<[f32; 3]> = topology.faces.corners.iter().map(|&point| points[point as usize]).collect();
    parted.into_iter().for_each(|(corner, value)| corners[corner] = value);
    Attribute::Corner(corners)
}

fn at(values: &[[f32; 3]], point: usize) -> DVec3 {
    let [x, y, z] = values[point].map(f64::from);
    DVec3::new(x, y, z)
}

struct Walk<'a> {
    topology: &'a Topology,
    rules: &'a Rules,
    values: &'a [[f32; 3]],
}

impl Walk<'_> {
    /// The normal at `point`, and those of the corners that have another.
    fn normals(
        &self,
        point: usize,
        scheme: Option<Scheme>,
        sector: &mut Sector,
        normal: &mut [f32; 3],
    ) -> Vec<(usize, [f32; 3])> {
        let mut parted = Vec::new();
        let center = at(self.values, point);
        let kind = self.rules.points[point].kind;
        // A single sharp edge ends here and parts nothing.
        let is_start = |corner: &usize| kind != Kind::Smooth && self.is_sharp(*corner);
        let mut starts = self.topology.around(point).filter(is_start).peekable();
        if starts.peek().is_none() {
            if let Some(corner) = self.topology.around(point).next() {
                self.gather(corner, false, sector);
                *normal = sector.normal(center, kind, scheme);
            }
            return parted;
        }
        for (i, start) in starts.enumerate() {
            self.gather(start, true, sector);
            let value = sector.normal(center, kind, scheme);
            if i == 0 {
                *normal = value;
            } else {
                parted.extend(sector.corners.iter().map(|&corner| (corner, value)));
            }
        }
        parted
    }

    /// What is less sharp is round at the size of the faces.
    fn is_sharp(&self, half: usize) -> bool {
        self.topology.twins[half] == NONE || self.rules.edges[self.topology.edge_of[half] as usize] >= 1.0
    }

    /// The sector that starts with `start`: once around, or up to a sharp edge where it is to stop there.
    fn gather(&self, start: usize, stops: bool, sector: &mut Sector) {
        let topology = self.topology;
        sector.edges.clear();
        sector.faces.clear();
        sector.corners.clear();
        let mut corner = start;
        loop {
            let next = topology.next(corner);
            sector.corners.push(corner);
            sector.edges.push(at(self.values, topology.point(next)));
            sector.faces.push(at(self.values, topology.point(topology.next(next))));
            let before = topology.previous(corner);
            match topology.turn(corner).filter(|_| !(stops && self.is_sharp(before))) {
                Some(turned) if turned == start => {
                    sector.is_closed = true;
                    return;
                }
                // Never more turns than corners, whatever the faces are.
                Some(turned) if sector.corners.len() <= topology.around(topology.point(start)).len() => {
                    corner = turned;
                }
                _ => {
                    sector.edges.push(at(self.values, topology.point(before)));
                    sector.is_closed = false;
                    return;
                }
            }
        }
    }
}

impl Sector {
    fn normal(&self, center: DVec3, kind: Kind, scheme: Option<Scheme>) -> [f32; 3] {
        let mean = self.mean(center);
        let exact = match (scheme, kind) {
            (Some(Scheme::CatmullClark), Kind::Smooth) if self.is_closed => self.catmull_clark(),
            (Some(Scheme::Loop), Kind::Smooth) if self.is_closed => self.loops(),
            (Some(Scheme::CatmullClark), Kind::Crease) if !self.is_closed => self.catmull_clark_crease(center),
            (Some(Scheme::Loop), Kind::Crease) if !self.is_closed => self.loop_crease(center),
            (Some(_), Kind::Corner) if !self.is_closed => {
                let normal = (self.edges[0] - center).cross(self.last() - center);
                // Across a reflex angle the product points inwards.
                if normal.dot(mean) < 0.0 { -normal } else { normal }
            }
            _ => mean,
        };
        // Tangents in one line, as at a corner in the middle of a straight edge, say nothing.
        let size = mean.length().max(1e-300);
        let normal = if exact.length() > 1e-9 * size { exact } else { mean };
        normal.try_normalize().unwrap_or(DVec3::Z).as_vec3().into()
    }

    fn last(&self) -> DVec3 {
        self.edges[self.edges.len() - 1]
    }

    /// The sum of the normals of the faces, each by its area.
    fn mean(&self, center: DVec3) -> DVec3 {
        let count = self.edges.len();
        let cross = |i: usize| (self.edges[i] - center).cross(self.edges[(i + 1) % count] - center);
        (0..self.faces.len()).map(cross).sum()
    }

    fn catmull_clark(&self) -> DVec3 {
        let n = self.faces.len() as f64;
        let step = TAU / n;
        let a = 1.0 + step.cos() + (step / 2.0).cos() * (2.0 * (9.0 + step.cos())).sqrt();
        let tangent = |turn: f64| -> DVec3 {
            let cos = |i: usize| ((i as f64 + turn) * step).cos();
            (0..self.faces.len()).map(|i| a * cos(i) * self.edges[i] + (cos(i) + cos(i + 1)) * self.faces[i]).sum()
        };
        // A quarter of a turn apart: the second is that of the sine.
        tangent(0.0).cross(tangent(-n / 4.0))
    }

    fn loops(&self) -> DVec3 {
        let step = TAU / self.faces.len() as f64;
        let sum = |weight: fn(f64) -> f64| -> DVec3 {
            self.edges.iter().enumerate().map(|(i, &edge)| weight(i as f64 * step) * edge).sum()
        };
        sum(f64::cos).cross(sum(f64::sin))
    }

    fn along(&self) -> DVec3 {
        self.edges[0] - self.last()
    }

    fn catmull_clark_crease(&self, center: DVec3) -> DVec3 {
        let (first, last) = (self.edges[0], self.last());
        let k = self.faces.len();
        if k == 1 {
            return self.along().cross(first + last - 2.0 * center);
        }
        let theta = PI / k as f64;
        let sin = |i: usize| (i as f64 * theta).sin();
        let r = (theta.cos() + 1.0) / theta.sin();
        let mut across = 4.0 * r * (theta.cos() - 1.0) * center - r * (1.0 + 2.0 * theta.cos()) * (first + last);
        for (i, &face) in self.faces.iter().enumerate() {
            across += (sin(i) + sin(i + 1)) * face;
        }
        for (i, &edge) in self.edges.iter().enumerate().take(k).skip(1) {
            across += 4.0 * sin(i) * edge;
        }
        self.along().cross(across)
    }

    fn loop_crease(&self, center: DVec3) -> DVec3 {
        let (first, last) = (self.edges[0], self.last());
        let across = match self.faces.len() {
            1 => first + last - 2.0 * center,
            2 => self.edges[1] - center,
            k => {
                let theta = PI / k as f64;
                let inner = self.edges.iter().enumerate().take(k).skip(1);
                let sum: DVec3 = inner.map(|(i, &edge)| (i as f64 * theta).sin() * edge).sum();
                // Into the sector, which Hoppe's mask points away from.
                -(theta.sin() * (first + last) + (2.0 * theta.cos() - 2.0) * sum)
            }
        };
        self.along().cross(across)
    }
}
