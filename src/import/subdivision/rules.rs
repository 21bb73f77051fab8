//! Which mask a vertex or an edge takes, by its sharpness and that of what is around it (OpenSubdiv's
//! `Sdc::Scheme`; T. DeRose, M. Kass, T. Truong, "Subdivision surfaces in character animation", 1998).

use super::topology::{NONE, Topology};
use super::{Boundary, INFINITE, Scheme};

/// Sharpness of the edges and vertices of a level.
pub(super) struct Sharpness {
    edges: Vec<f32>,
    points: Vec<f32>,
}

/// How the masks of a vertex mix: the rest up to 1 is the smooth one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rule {
    /// Weight of staying where it is.
    pub corner: f32,
    /// Weight of the curve through `ends`.
    pub crease: f32,
    /// The neighbours along the crease.
    pub ends: [u32; 2],
    /// What it is by the sharpness of this level, without mixing.
    pub kind: Kind,
    /// True where the masks of the limit don't hold yet: some sharpness runs out further down, or a sharp edge ends
    /// here.
    pub open: bool,
}

/// What a vertex is by the sharp edges around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// No or one sharp edge.
    Smooth,
    /// Two of them.
    Crease,
    /// More, or a sharp vertex.
    Corner,
}

impl Rule {
    pub const SMOOTH: Self = Self { corner: 0.0, crease: 0.0, ends: [0; 2], kind: Kind::Smooth, open: false };
    pub const CORNER: Self = Self { corner: 1.0, kind: Kind::Corner, ..Self::SMOOTH };

    /// A vertex on a curve of infinite sharpness.
    pub fn crease(ends: [u32; 2]) -> Self {
        Self { crease: 1.0, ends, kind: Kind::Crease, ..Self::SMOOTH }
    }
}

/// What is left of a sharpness one level down.
pub(super) fn decrement(sharpness: f32) -> f32 {
    if sharpness >= INFINITE { sharpness } else { (sharpness - 1.0).max(0.0) }
}

impl Sharpness {
    /// Of the cage. Edges at the rim, and those that aren't of two faces, are infinitely sharp.
    pub fn new(topology: &Topology, creases: &[([u32; 2], f32)], corners: &[(u32, f32)], boundary: Boundary) -> Self {
        let mut edges: Vec<f32> = vec![0.0; topology.edges.len()];
        for &([a, b], sharpness) in creases {
            // An edge of the points: looked for around one of them.
            let half = |from: u32, to: u32| {
                let mut around = topology.around(from as usize);
                around.find(|&corner| topology.faces.corners[topology.next(corner)] == to)
            };
            if let Some(half) = half(a, b).or_else(|| half(b, a)) {
                let edge = &mut edges[topology.edge_of[half] as usize];
                *edge = edge.max(sharpness);
            }
        }
        for (half, _) in topology.twins.iter().enumerate().filter(|&(_, &twin)| twin == NONE) {
            edges[topology.edge_of[half] as usize] = INFINITE;
        }
        let mut points = vec![0.0; topology.points];
        for &(point, sharpness) in corners {
            points[point as usize] = sharpness;
        }
        for (point, sharpness) in points.iter_mut().enumerate() {
            let lone = boundary == Boundary::EdgeAndCorner && topology.around(point).len() == 1;
            if lone || topology.is_tangled(point) {
                *sharpness = INFINITE;
            }
        }
        Self { edges, points }
    }

    /// Of the next level, `child`, of `parent`.
    pub fn child(&self, parent: &Topology, child: &Topology, scheme: Scheme) -> Self {
        let faces = if scheme == Scheme::Loop { 0 } else { parent.faces.len() };
        let (first_edge, first_vertex) = (faces, faces + parent.edges.len());
        let mut points = vec![0.0; child.points];
        for (point, sharpness) in self.points.iter().enumerate() {
            points[first_vertex + point] = decrement(*sharpness);
        }
        // Points in the middle of an edge that isn't of two faces are tangled as the edge was.
        for (half, _) in parent.twins.iter().enumerate().filter(|&(_, &twin)| twin == NONE) {
            let point = first_edge + parent.edge_of[half] as usize;
            if child.is_tangled(point) {
                points[point] = INFINITE;
            }
        }
        let inherit = |[a, b]: [u32; 2]| {
            let (a, b) = (a as usize, b as usize);
            let is_half_of_an_edge = (first_edge..first_vertex).contains(&a) && b >= first_vertex;
            if is_half_of_an_edge { decrement(self.edges[a - first_edge]) } else { 0.0 }
        };
        Self { edges: child.edges.iter().map(|edge| inherit(edge.ends)).collect(), points }
    }
}

/// The sharp edges at a vertex.
#[derive(Clone, Copy, Default)]
struct Sharp {
    count: u32,
    ends: [u32; 2],
}

impl Sharp {
    fn kind(self, vertex: f32) -> Kind {
        match self.count {
            _ if vertex > 0.0 => Kind::Corner,
            0 | 1 => Kind::Smooth,
            2 => Kind::Crease,
            _ => Kind::Corner,
        }
    }
}

/// The rules of a level.
pub(super) struct Rules {
    /// Of each vertex.
    pub points: Vec<Rule>,
    /// Sharpness of each edge.
    pub edges: Vec<f32>,
    /// Sharpness of each vertex itself.
    pub corners: Vec<f32>,
}

/// The rules of `topology`. Where sharpness runs out within the level, those of both sides mix.
pub(super) fn of(topology: &Topology, sharpness: Sharpness) -> Rules {
    let points = (0..topology.points).map(|point| rule(topology, &sharpness, point)).collect();
    Rules { points, edges: sharpness.edges, corners: sharpness.points }
}

fn rule(topology: &Topology, sharpness: &Sharpness, point: usize) -> Rule {
    let edge =
        |half: usize, end: usize| (sharpness.edges[topology.edge_of[half] as usize], topology.faces.corners[end]);
    let edges = topology.around(point).flat_map(|corner| {
        // The edge that closes the face at the point is another's first edge, save at the rim.
        let before = topology.previous(corner);
        let closing = (topology.twins[before] == NONE).then(|| edge(before, before));
        std::iter::once(edge(corner, topology.next(corner))).chain(closing)
    });
    ring(sharpness.points[point], edges)
}

/// The rule of a vertex of sharpness `vertex`, by the sharpness and the other end of each of its edges.
pub(super) fn ring(vertex: f32, edges: impl Iterator<Item = (f32, u32)>) -> Rule {
    let (mut now, mut then) = (Sharp::default(), Sharp::default());
    let (mut transitions, mut sum) = (0, 0.0);
    let (mut endless, mut runs_out) = (0, 0.0 < vertex && vertex < INFINITE);
    for (edge, end) in edges {
        for (sharp, edge) in [(&mut now, edge), (&mut then, decrement(edge))] {
            if edge > 0.0 {
                if let Some(slot) = sharp.ends.get_mut(sharp.count as usize) {
                    *slot = end;
                }
                sharp.count += 1;
            }
        }
        endless += u32::from(edge >= INFINITE);
        runs_out |= 0.0 < edge && edge < INFINITE;
        if edge > 0.0 && decrement(edge) == 0.0 {
            (transitions, sum) = (transitions + 1, sum + edge);
        }
    }
    if vertex > 0.0 && decrement(vertex) == 0.0 {
        (transitions, sum) = (transitions + 1, sum + vertex);
    }
    let (kind, next) = (now.kind(vertex), then.kind(decrement(vertex)));
    let mut rule = match kind {
        Kind::Smooth => Rule::SMOOTH,
        Kind::Crease => Rule::crease(now.ends),
        Kind::Corner => Rule::CORNER,
    };
    if next != kind && transitions > 0 {
        let weight = (sum / transitions as f32).min(1.0);
        match kind {
            Kind::Smooth => {}
            Kind::Crease => rule.crease = weight,
            Kind::Corner => rule.corner = weight,
        }
        if next == Kind::Crease {
            (rule.crease, rule.ends) = (1.0 - weight, then.ends);
        }
    }
    let stays = vertex >= INFINITE || endless > 2;
    Rule { open: !stays && (runs_out || endless == 1), ..rule }
}
