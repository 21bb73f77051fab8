//! How the faces of a mesh join: edges, twins of half-edges, faces around vertices.

use super::Scheme;

/// No half-edge.
pub(super) const NONE: u32 = u32::MAX;

/// Polygons by the indices of their corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Faces {
    /// Where the corners of each face start, and the end of the last.
    pub starts: Vec<u32>,
    /// Point of each corner.
    pub corners: Vec<u32>,
}

impl Faces {
    /// Faces of `counts` corners each, which follow one another in `corners`.
    pub fn new(counts: impl IntoIterator<Item = u32>, corners: Vec<u32>) -> Self {
        let mut end = 0;
        let starts = std::iter::once(0).chain(counts.into_iter().map(|count| {
            end += count;
            end
        }));
        Self { starts: starts.collect(), corners }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The range of the corners of `face`.
    pub fn range(&self, face: usize) -> std::ops::Range<usize> {
        self.starts[face] as usize..self.starts[face + 1] as usize
    }

    /// The points of `face`.
    pub fn points(&self, face: usize) -> &[u32] {
        &self.corners[self.range(face)]
    }
}

/// An undirected edge.
#[derive(Clone, Copy)]
pub(super) struct Edge {
    /// Its points, the smaller index first.
    pub ends: [u32; 2],
    /// A half-edge of it.
    pub half: u32,
}

/// Faces and their neighbourhood. A half-edge goes by the index of the corner at which it starts; it ends
/// at the next corner of the face.
pub(super) struct Topology {
    pub faces: Faces,
    /// How many points there are.
    pub points: usize,
    /// Face of each corner.
    pub face_of: Vec<u32>,
    /// Edge of each half-edge.
    pub edge_of: Vec<u32>,
    /// The half-edge that runs the other way; `NONE` at the rim and at edges that more than two faces use,
    /// or two that disagree in their winding.
    pub twins: Vec<u32>,
    pub edges: Vec<Edge>,
    starts: Vec<u32>,
    around: Vec<u32>,
}

/// The faces that a split makes.
pub(super) struct Children {
    pub faces: Faces,
    pub points: usize,
    /// Parent of each face.
    pub parents: Vec<u32>,
}

impl Topology {
    /// Finds the neighbours of `faces`.
    pub fn new(faces: Faces, points: usize) -> Self {
        let corners = faces.corners.len();
        let mut face_of = vec![0; corners];
        for face in 0..faces.len() {
            face_of[faces.range(face)].fill(face as u32);
        }
        let (starts, around) = bucket(points, faces.corners.iter().copied());
        let mut topology = Self {
            faces,
            points,
            face_of,
            edge_of: vec![0; corners],
            twins: vec![NONE; corners],
            edges: Vec::with_capacity(corners / 2),
            starts,
            around,
        };
        topology.join();
        topology
    }

    /// Finds edges and twins: half-edges by their smaller point, then those of one bucket by the larger.
    fn join(&mut self) {
        let ends: Vec<[u32; 2]> = (0..self.twins.len())
            .map(|half| {
                let (a, b) = (self.faces.corners[half], self.faces.corners[self.next(half)]);
                [a.min(b), a.max(b)]
            })
            .collect();
        let (starts, halves) = bucket(self.points, ends.iter().map(|ends| ends[0]));
        let mut bucket: Vec<(u32, u32)> = Vec::new();
        for window in starts.windows(2) {
            bucket.clear();
            let halves = &halves[window[0] as usize..window[1] as usize];
            bucket.extend(halves.iter().map(|&half| (ends[half as usize][1], half)));
            bucket.sort_unstable();
            for same in bucket.chunk_by(|a, b| a.0 == b.0) {
                let half = same[0].1;
                for &(_, half) in same {
                    self.edge_of[half as usize] = self.edges.len() as u32;
                }
                self.edges.push(Edge { ends: ends[half as usize], half });
                if let &[(_, a), (_, b)] = same
                    && self.faces.corners[a as usize] != self.faces.corners[b as usize]
                {
                    self.twins[a as usize] = b;
                    self.twins[b as usize] = a;
                }
            }
        }
    }

    /// The next corner of the face.
    pub fn next(&self, corner: usize) -> usize {
        let range = self.faces.range(self.face_of[corner] as usize);
        if corner + 1 == range.end { range.start } else { corner + 1 }
    }

    /// The corner before in the face.
    pub fn previous(&self, corner: usize) -> usize {
        let range = self.faces.range(self.face_of[corner] as usize);
        if corner == range.start { range.end - 1 } else { corner - 1 }
    }

    /// Point of a corner.
    pub fn point(&self, corner: usize) -> usize {
        self.faces.corners[corner] as usize
    }

    /// Corners at a point, in no order.
    pub fn around(&self, point: usize) -> impl ExactSizeIterator<Item = usize> + Clone + '_ {
        let range = self.starts[point] as usize..self.starts[point + 1] as usize;
        self.around[range].iter().map(|&corner| corner as usize)
    }

    /// The corner at the same point that follows counter-clockwise: that of the face beyond the edge by
    /// which this one is reached.
    pub fn turn(&self, corner: usize) -> Option<usize> {
        let twin = self.twins[self.previous(corner)];
        (twin != NONE).then_some(twin as usize)
    }

    /// True where the faces at `point` form no single fan.
    pub fn is_tangled(&self, point: usize) -> bool {
        let around = self.around(point);
        let count = around.len();
        let mut starts = around.clone().filter(|&corner| self.twins[corner] == NONE);
        let Some(first) = starts.next().or_else(|| around.clone().next()) else { return false };
        if starts.next().is_some() {
            return true;
        }
        let (mut corner, mut seen) = (first, 1);
        while let Some(next) = self.turn(corner).filter(|&next| next != first && seen <= count) {
            (corner, seen) = (next, seen + 1);
        }
        seen != count
    }

    /// Faces with a point on the rim.
    pub fn faces_at_the_rim(&self) -> impl Iterator<Item = usize> + '_ {
        let mut rim = vec![false; self.points];
        for half in (0..self.twins.len()).filter(|&half| self.twins[half] == NONE) {
            rim[self.point(half)] = true;
            rim[self.point(self.next(half))] = true;
        }
        (0..self.faces.len()).filter(move |&face| self.faces.points(face).iter().any(|&p| rim[p as usize]))
    }

    /// The faces of the next level. Its points are those of faces (not for Loop), of edges and of
    /// vertices, in this order.
    pub fn split(&self, scheme: Scheme) -> Children {
        match scheme {
            Scheme::CatmullClark | Scheme::Bilinear => self.split_to_quads(),
            Scheme::Loop => self.split_to_triangles(),
        }
    }

    /// A quad for each corner: vertex, edge, face, edge before.
    fn split_to_quads(&self) -> Children {
        let (faces, edges) = (self.faces.len() as u32, self.edges.len() as u32);
        let mut corners = Vec::with_capacity(4 * self.twins.len());
        for corner in 0..self.twins.len() {
            let before = self.previous(corner);
            corners.extend([
                faces + edges + self.faces.corners[corner],
                faces + self.edge_of[corner],
                self.face_of[corner],
                faces + self.edge_of[before],
            ]);
        }
        let points = self.faces.len() + self.edges.len() + self.points;
        Children { faces: Faces::new(self.twins.iter().map(|_| 4), corners), points, parents: self.face_of.clone() }
    }

    /// Four triangles for each, the middle one last.
    fn split_to_triangles(&self) -> Children {
        let edges = self.edges.len() as u32;
        let mut corners = Vec::with_capacity(12 * self.faces.len());
        let mut parents = Vec::with_capacity(4 * self.faces.len());
        for face in 0..self.faces.len() {
            let range = self.faces.range(face);
            for corner in range.clone() {
                let (vertex, before) = (edges + self.faces.corners[corner], self.previous(corner));
                corners.extend([vertex, self.edge_of[corner], self.edge_of[before]]);
                parents.push(face as u32);
            }
            corners.extend_from_slice(&self.edge_of[range]);
            parents.push(face as u32);
        }
        let points = self.edges.len() + self.points;
        Children { faces: Faces::new(parents.iter().map(|_| 3), corners), points, parents }
    }
}

/// Positions in `keys` in the order of the keys (counting sort), and where those of each key start.
fn bucket(count: usize, keys: impl Iterator<Item = u32> + Clone) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; count + 1];
    let mut total = 0;
    for key in keys.clone() {
        starts[key as usize + 1] += 1;
        total += 1;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    let mut next = starts.clone();
    let mut sorted = vec![0; total];
    for (position, key) in keys.enumerate() {
        let slot = &mut next[key as usize];
        sorted[*slot as usize] = position as u32;
        *slot += 1;
    }
    (starts, sorted)
}
