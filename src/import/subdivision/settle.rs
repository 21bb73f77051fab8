//! Limits of what is not settled at the last level: vertices at semi-sharp edges, or at the end of a sharp one. The
//! next levels of a vertex and the faces around it depend on nothing else, so the ring is refined alone, until
//! the rules no longer change and the masks of `limit.rs` hold.

use super::masks::loop_weight;
use super::rules::{self, Kind, decrement, ring};
use super::topology::{NONE, Topology};
use super::{INFINITE, Scheme};

/// Levels after which the end of a sharp edge, whose rules have no closed form, stands where it stays: what is off
/// halves with each.
const LEVELS: usize = 40;

/// A vertex, its neighbours counter-clockwise, and the corners across the faces between them. Triangles have none.
struct Ring<const N: usize> {
    center: [f64; N],
    edges: Vec<[f64; N]>,
    faces: Vec<[f64; N]>,
    /// How many faces there are: as many as edges, or one less at a rim.
    count: usize,
    sharpness: Vec<f32>,
    center_sharpness: f32,
}

/// Where `point` goes; `None` where the faces around it form no fan.
pub(super) fn limit<const N: usize>(
    topology: &Topology,
    rules: &rules::Rules,
    scheme: Scheme,
    values: &[[f32; N]],
    point: usize,
) -> Option<[f64; N]> {
    let mut ring = Ring::of(topology, rules, scheme, values, point)?;
    for _ in 0..LEVELS {
        if !ring.rule().open {
            break;
        }
        ring.refine(scheme);
    }
    Some(ring.limit(scheme))
}

fn sum<const N: usize>(terms: impl IntoIterator<Item = (f64, [f64; N])>) -> [f64; N] {
    let mut sum = [0.0; N];
    for (weight, value) in terms {
        sum.iter_mut().zip(value).for_each(|(sum, x)| *sum += weight * x);
    }
    sum
}

impl<const N: usize> Ring<N> {
    fn of(
        topology: &Topology,
        rules: &rules::Rules,
        scheme: Scheme,
        values: &[[f32; N]],
        point: usize,
    ) -> Option<Self> {
        let around = topology.around(point);
        let count = around.len();
        let start = around.clone().find(|&corner| topology.twins[corner] == NONE).or_else(|| around.clone().next())?;
        let at = |corner: usize| values[topology.point(corner)].map(f64::from);
        let (mut edges, mut faces, mut sharpness) = (Vec::new(), Vec::new(), Vec::new());
        let mut corner = start;
        let is_closed = loop {
            let next = topology.next(corner);
            edges.push(at(next));
            sharpness.push(rules.sharpness(topology, corner));
            if scheme != Scheme::Loop {
                faces.push(at(topology.next(next)));
            }
            match topology.turn(corner) {
                Some(turned) if turned == start => break true,
                Some(turned) if edges.len() < count => corner = turned,
                Some(_) => return None,
                None => {
                    let before = topology.previous(corner);
                    edges.push(at(before));
                    sharpness.push(rules.sharpness(topology, before));
                    break false;
                }
            }
        };
        let fans = edges.len() == count + usize::from(!is_closed);
        let (center, center_sharpness) = (values[point].map(f64::from), rules.corners[point]);
        fans.then_some(Self { center, edges, faces, count, sharpness, center_sharpness })
    }

    fn rule(&self) -> rules::Rule {
        ring(self.center_sharpness, self.sharpness.iter().zip(0..).map(|(&edge, i)| (edge, i)))
    }

    fn is_closed(&self) -> bool {
        self.edges.len() == self.count
    }

    /// One level down.
    fn refine(&mut self, scheme: Scheme) {
        let rule = self.rule();
        let (c, n) = (self.center, self.edges.len());
        let middle = |i: usize| sum([c, self.edges[i], self.faces[i], self.edges[(i + 1) % n]].map(|p| (0.25, p)));
        let faces: Vec<[f64; N]> = (0..self.faces.len()).map(middle).collect();
        let edge = |i: usize| {
            let at_rim = !self.is_closed() && (i == 0 || i + 1 == n);
            let crease = if at_rim { 1.0 } else { f64::from(self.sharpness[i].clamp(0.0, 1.0)) };
            let (end, smooth, before) = (self.edges[i], 1.0 - crease, (i + n - 1) % n);
            let straight = [(0.5 * crease, c), (0.5 * crease, end)];
            if crease == 1.0 {
                return sum(straight);
            }
            let (near, sides) = match scheme {
                Scheme::Loop => (3.0 / 8.0, [(1.0 / 8.0, self.edges[before]), (1.0 / 8.0, self.edges[(i + 1) % n])]),
                _ => (0.25, [(0.25, faces[before]), (0.25, faces[i])]),
            };
            let round = [(near, c), (near, end)].into_iter().chain(sides).map(|(weight, p)| (smooth * weight, p));
            sum(straight.into_iter().chain(round))
        };
        let edges: Vec<[f64; N]> = (0..n).map(edge).collect();
        let (corner, crease) = (f64::from(rule.corner), f64::from(rule.crease));
        let [a, b] = rule.ends.map(|end| self.edges[end as usize]);
        let smooth = 1.0 - corner - crease;
        let own = [(corner + 0.75 * crease, c), (crease / 8.0, a), (crease / 8.0, b)];
        let count = self.count as f64;
        let around = self.edges.iter().take(self.count).copied();
        self.center = match scheme {
            Scheme::Loop => {
                let beta = loop_weight(count);
                let round = around.map(|p| (smooth * beta, p));
                sum(own.into_iter().chain([(smooth * (1.0 - count * beta), c)]).chain(round))
            }
            _ => {
                let round = around.chain(faces.iter().copied()).map(|p| (smooth / (count * count), p));
                sum(own.into_iter().chain([(smooth * (count - 2.0) / count, c)]).chain(round))
            }
        };
        (self.edges, self.faces) = (edges, faces);
        self.sharpness.iter_mut().for_each(|edge| *edge = decrement(*edge));
        self.center_sharpness = decrement(self.center_sharpness);
    }

    /// By the rules that now stay.
    fn limit(&self, scheme: Scheme) -> [f64; N] {
        let rule = self.rule();
        let n = self.count as f64;
        match rule.kind {
            Kind::Corner => self.center,
            Kind::Crease => {
                let [a, b] = rule.ends.map(|end| self.edges[end as usize]);
                sum([(4.0 / 6.0, self.center), (1.0 / 6.0, a), (1.0 / 6.0, b)])
            }
            Kind::Smooth => {
                let (edge, face) = smooth(scheme, n);
                let own = [(1.0 - n * (edge + face), self.center)];
                let edges = self.edges.iter().take(self.count).map(|&p| (edge, p));
                sum(own.into_iter().chain(edges).chain(self.faces.iter().map(|&p| (face, p))))
            }
        }
    }
}

/// Weights of the limit mask of a smooth vertex with `n` faces: of each neighbour, and of each corner across a face.
pub(super) fn smooth(scheme: Scheme, n: f64) -> (f64, f64) {
    match scheme {
        Scheme::Loop => (1.0 / (3.0 / (8.0 * loop_weight(n)) + n), 0.0),
        _ => (4.0 / (n * (n + 5.0)), 1.0 / (n * (n + 5.0))),
    }
}

impl rules::Rules {
    /// How sharp the edge of a half-edge is.
    fn sharpness(&self, topology: &Topology, half: usize) -> f32 {
        if topology.twins[half] == NONE { INFINITE } else { self.edges[topology.edge_of[half] as usize] }
    }
}
