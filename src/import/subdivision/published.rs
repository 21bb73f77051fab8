//! The published masks once more, in `f64`, by edges and neighbours that are looked up by name: what the refinement is
//! held against.
//!
//! C. Loop, *Smooth Subdivision Surfaces Based on Triangles*, 1987; H. Hoppe et al., *Piecewise Smooth Surface
//! Reconstruction*, 1994 (creases, corners, limits); E. Catmull, J. Clark 1978; T. DeRose, M. Kass, T. Truong,
//! *Subdivision Surfaces in Character Animation*, 1998 (sharpness that runs out); OpenSubdiv's weight of smoothed
//! triangles.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use super::*;

type Edge = (usize, usize);

/// A mesh with sharp edges and points; edges with one face are sharp without end.
#[derive(Clone)]
struct Mesh {
    faces: Vec<Vec<usize>>,
    points: Vec<[f64; 3]>,
    edges: BTreeMap<Edge, f64>,
    corners: BTreeMap<usize, f64>,
    smooth_triangles: bool,
}

fn edge(a: usize, b: usize) -> Edge {
    (a.min(b), a.max(b))
}

fn sum(terms: &[([f64; 3], f64)]) -> [f64; 3] {
    std::array::from_fn(|i| terms.iter().map(|(value, weight)| weight * value[i]).sum())
}

fn mean(values: &[[f64; 3]]) -> [f64; 3] {
    let weight = 1.0 / values.len() as f64;
    sum(&values.iter().map(|value| (*value, weight)).collect::<Vec<_>>())
}

fn mix(a: [f64; 3], b: [f64; 3], t: f64) -> [f64; 3] {
    sum(&[(a, 1.0 - t), (b, t)])
}

/// Weight of each neighbour of a point of `n` of them.
fn loops_weight(n: f64) -> f64 {
    (5.0 / 8.0 - (3.0 / 8.0 + (TAU / n).cos() / 4.0).powi(2)) / n
}

impl Mesh {
    /// The faces at each edge.
    fn at_edges(&self) -> BTreeMap<Edge, Vec<usize>> {
        let mut found: BTreeMap<Edge, Vec<usize>> = BTreeMap::new();
        for (i, face) in self.faces.iter().enumerate() {
            for (k, &a) in face.iter().enumerate() {
                found.entry(edge(a, face[(k + 1) % face.len()])).or_default().push(i);
            }
        }
        found
    }

    fn sharpness(&self, at: &BTreeMap<Edge, Vec<usize>>, of: Edge) -> f64 {
        if at[&of].len() == 1 { f64::INFINITY } else { self.edges.get(&of).copied().unwrap_or(0.0) }
    }

    /// Points at the other ends of the edges of `point`, and the sharpness of these.
    fn neighbours(&self, at: &BTreeMap<Edge, Vec<usize>>, point: usize) -> Vec<(usize, f64)> {
        let of_point = at.keys().filter(|(a, b)| *a == point || *b == point);
        of_point.map(|&(a, b)| (if a == point { b } else { a }, self.sharpness(at, (a, b)))).collect()
    }

    /// Where `point` goes, whose smooth mask gives `smooth`; the mask along a crease leaves `on_crease` with itself. What
    /// is sharp at this level and no more at the next has its mean sharpness for a weight.
    fn settled(&self, at: &BTreeMap<Edge, Vec<usize>>, point: usize, smooth: [f64; 3], on_crease: f64) -> [f64; 3] {
        let own = self.points[point];
        let corner = self.corners.get(&point).copied().unwrap_or(0.0);
        let edges = self.neighbours(at, point);
        let by = |least: f64| {
            let ends: Vec<usize> = edges.iter().filter(|(_, s)| *s > least).map(|(end, _)| *end).collect();
            match ends[..] {
                _ if corner > least => own,
                [] | [_] => smooth,
                [a, b] => sum(&[(own, on_crease), (mean(&[self.points[a], self.points[b]]), 1.0 - on_crease)]),
                _ => own,
            }
        };
        let running_out = edges.iter().map(|(_, s)| *s).chain([corner]).filter(|s| *s > 0.0 && *s <= 1.0);
        let running_out: Vec<f64> = running_out.collect();
        if running_out.is_empty() {
            return by(0.0);
        }
        mix(by(1.0), by(0.0), running_out.iter().sum::<f64>() / running_out.len() as f64)
    }

    /// The points stay in their places of the list; those of edges and of faces come after them.
    fn refined(&self, scheme: Scheme) -> Self {
        let at = self.at_edges();
        let middles: Vec<[f64; 3]> =
            self.faces.iter().map(|face| mean(&face.iter().map(|&p| self.points[p]).collect::<Vec<_>>())).collect();
        let mut points: Vec<[f64; 3]> = (0..self.points.len())
            .map(|point| {
                let own = self.points[point];
                let around: Vec<[f64; 3]> =
                    self.neighbours(&at, point).iter().map(|(other, _)| self.points[*other]).collect();
                let n = around.len() as f64;
                let smooth = match scheme {
                    Scheme::Loop => sum(&[(own, 1.0 - n * loops_weight(n)), (mean(&around), n * loops_weight(n))]),
                    _ => {
                        let faces = self.faces.iter().zip(&middles).filter(|(face, _)| face.contains(&point));
                        let faces: Vec<[f64; 3]> = faces.map(|(_, middle)| *middle).collect();
                        sum(&[(own, 1.0 - 2.0 / n), (mean(&around), 1.0 / n), (mean(&faces), 1.0 / n)])
                    }
                };
                self.settled(&at, point, smooth, 0.75)
            })
            .collect();
        let (mut names, mut edges) = (BTreeMap::new(), BTreeMap::new());
        for (&(a, b), faces) in &at {
            let sharp = mean(&[self.points[a], self.points[b]]);
            let smooth = match (scheme, &faces[..]) {
                (Scheme::Loop, [one, other]) => {
                    let across = |face: &usize| self.faces[*face].iter().find(|&&p| p != a && p != b).unwrap();
                    let across = mean(&[one, other].map(|face| self.points[*across(face)]));
                    sum(&[(sharp, 0.75), (across, 0.25)])
                }
                (_, [one, other]) => {
                    let weight = |face: &usize| {
                        if self.smooth_triangles && self.faces[*face].len() == 3 { 0.470 } else { 0.25 }
                    };
                    let weight = weight(one) + weight(other);
                    sum(&[(sharp, 1.0 - weight), (mean(&[middles[*one], middles[*other]]), weight)])
                }
                _ => sharp,
            };
            let sharpness = self.sharpness(&at, (a, b));
            let name = points.len();
            points.push(mix(smooth, sharp, sharpness.min(1.0)));
            names.insert((a, b), name);
            for end in [a, b] {
                edges.insert(edge(end, name), (sharpness - 1.0).max(0.0));
            }
        }
        let mut faces = Vec::new();
        for (face, middle) in self.faces.iter().zip(middles) {
            let n = face.len();
            let of_edge = |k: usize| names[&edge(face[k % n], face[(k + 1) % n])];
            if scheme == Scheme::Loop {
                faces.extend((0..3).map(|k| vec![face[k], of_edge(k), of_edge(k + 2)]));
                faces.push((0..3).map(of_edge).collect());
            } else {
                let name = points.len();
                points.push(middle);
                faces.extend((0..n).map(|k| vec![face[k], of_edge(k), name, of_edge(k + n - 1)]));
            }
        }
        let corners = self.corners.iter().map(|(&point, &sharpness)| (point, (sharpness - 1.0).max(0.0))).collect();
        Self { faces, points, edges, corners, smooth_triangles: false }
    }

    /// The limit of a point once all that is sharp is so without end.
    fn limit(&self, at: &BTreeMap<Edge, Vec<usize>>, point: usize, scheme: Scheme) -> [f64; 3] {
        let own = self.points[point];
        let around: Vec<[f64; 3]> = self.neighbours(at, point).iter().map(|(other, _)| self.points[*other]).collect();
        let n = around.len() as f64;
        let smooth = match scheme {
            // ω = 3 / (8 β), Hoppe 1994.
            Scheme::Loop => {
                let omega = 3.0 / (8.0 * loops_weight(n));
                sum(&[(own, omega / (omega + n)), (mean(&around), n / (omega + n))])
            }
            // (n² v + 4 Σe + Σf) / (n (n + 5)), Halstead 1993.
            _ => {
                let across = self.faces.iter().filter_map(|face| {
                    let k = face.iter().position(|&p| p == point)?;
                    Some(self.points[face[(k + 2) % 4]])
                });
                let across: Vec<[f64; 3]> = across.collect();
                let whole = n + 5.0;
                sum(&[(own, n / whole), (mean(&around), 4.0 / whole), (mean(&across), 1.0 / whole)])
            }
        };
        self.settled(at, point, smooth, 2.0 / 3.0)
    }
}

/// Levels that are compared, and those that all sharpness runs out in.
const DEPTH: u32 = 1;
const MORE: u32 = 3;

/// Every point of the first level on the limit surface.
fn published(mesh: &Mesh, scheme: Scheme) -> Vec<[f64; 3]> {
    let mut fine = mesh.clone();
    let mut count = 0;
    for level in 0..DEPTH + MORE {
        fine = fine.refined(scheme);
        if level + 1 == DEPTH {
            count = fine.points.len();
        }
    }
    assert!(fine.edges.values().all(|s| *s == 0.0 || s.is_infinite()), "some sharpness is left");
    // Only what is around them matters.
    let wanted: Vec<usize> = (0..count).collect();
    let at = fine.at_edges();
    wanted.into_iter().map(|point| fine.limit(&at, point, scheme)).collect()
}

fn ours(mesh: &Mesh, scheme: Scheme, boundary: Boundary) -> Vec<[f32; 3]> {
    let index = |i: usize| i as u32;
    let creases: Vec<_> = mesh.edges.iter().map(|(&(a, b), &s)| ([index(a), index(b)], s.min(10.0) as f32)).collect();
    let corners: Vec<_> = mesh.corners.iter().map(|(&point, &s)| (index(point), s.min(10.0) as f32)).collect();
    let faces = mesh.faces.iter().flatten().map(|&p| index(p)).collect();
    let cage = Cage {
        faces: Faces::new(mesh.faces.iter().map(|face| face.len() as u32), faces),
        points: mesh.points.len(),
        creases: &creases,
        corners: &corners,
        holes: &[],
        scheme,
        boundary,
        face_varying: FaceVarying::CornersPlus1,
        smooth_triangles: mesh.smooth_triangles,
    };
    let points: Vec<[f32; 3]> = mesh.points.iter().map(|p| p.map(|x| x as f32)).collect();
    Refinement::new(cage, DEPTH).vertex(&points)
}

/// The same points in any order.
fn assert_same(name: &str, found: &[[f32; 3]], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len(), "{name}");
    let apart = |a: &[f32; 3], b: &[f64; 3]| (0..3).map(|i| (f64::from(a[i]) - b[i]).powi(2)).sum::<f64>().sqrt();
    let mut left: Vec<&[f64; 3]> = expected.iter().collect();
    for point in found {
        let nearest = (0..left.len()).min_by(|&a, &b| apart(point, left[a]).total_cmp(&apart(point, left[b]))).unwrap();
        let off = apart(point, left[nearest]);
        assert!(off < 3e-6, "{name}: {point:?} is {off:.2e} off {:?}", left[nearest]);
        left.swap_remove(nearest);
    }
}

/// A grid of `n` by `n` bent squares, each cut to two triangles where `cut` says so.
fn sheet(n: usize, cut: impl Fn(usize, usize) -> bool) -> Mesh {
    let at = |i: usize, k: usize| i * (n + 1) + k;
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for i in 0..=n {
        for k in 0..=n {
            let (x, y) = (i as f64, k as f64);
            points.push([x + 0.2 * (y * 1.3).sin(), y - 0.15 * x, 0.5 * (x * 1.7 + y).sin() + 0.1 * x * y]);
            if i < n && k < n {
                let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
                match cut(i, k) {
                    true => faces.extend([vec![a, b, c], vec![a, c, d]]),
                    false => faces.push(vec![a, b, c, d]),
                }
            }
        }
    }
    Mesh { faces, points, edges: BTreeMap::new(), corners: BTreeMap::new(), smooth_triangles: false }
}

/// Eight triangles around the axes, with points of their own lengths.
fn octahedron() -> Mesh {
    let points =
        [[1.0, 0.1, 0.0], [0.2, 1.3, 0.1], [-0.8, 0.0, 0.3], [0.0, -1.1, 0.2], [0.1, 0.0, 1.4], [0.3, 0.2, -0.9]];
    let faces = (0..4).flat_map(|k| [vec![k, (k + 1) % 4, 4], vec![(k + 1) % 4, k, 5]]).collect();
    Mesh { faces, points: points.into(), edges: BTreeMap::new(), corners: BTreeMap::new(), smooth_triangles: false }
}

fn creased(mut mesh: Mesh, along: &[usize], sharpness: f64) -> Mesh {
    mesh.edges.extend(along.windows(2).map(|pair| (edge(pair[0], pair[1]), sharpness)));
    mesh
}

#[test]
fn loops_surfaces_have_the_published_masks_creases_and_limits() {
    let ring = [0, 1, 2, 3, 0];
    for sharpness in [0.0, 0.4, 1.0, 1.7, 2.25, f64::INFINITY] {
        let mesh = creased(octahedron(), &ring, sharpness);
        let found = ours(&mesh, Scheme::Loop, Boundary::EdgeAndCorner);
        assert_same(&format!("ring of {sharpness}"), &found, &published(&mesh, Scheme::Loop));
    }
    // Four sharp edges meet at two points, which are corners as long as they last.
    for sharpness in [0.6, 1.5, f64::INFINITY] {
        let mesh = creased(creased(octahedron(), &ring, sharpness), &[0, 4, 2, 5, 0], sharpness);
        let found = ours(&mesh, Scheme::Loop, Boundary::EdgeAndCorner);
        assert_same(&format!("rings of {sharpness}"), &found, &published(&mesh, Scheme::Loop));
    }
    // Points that are sharp by themselves.
    for sharpness in [0.3, 1.6, f64::INFINITY] {
        let mut mesh = octahedron();
        mesh.corners.insert(4, sharpness);
        let found = ours(&mesh, Scheme::Loop, Boundary::EdgeAndCorner);
        assert_same(&format!("point of {sharpness}"), &found, &published(&mesh, Scheme::Loop));
    }
}

#[test]
fn rims_of_loops_surfaces_are_splines_and_lone_faces_corners() {
    for along in [vec![], vec![4, 5, 6, 7], vec![8, 9, 10, 11]] {
        let mut mesh = creased(sheet(3, |_, _| true), &along, 1.4);
        let found = ours(&mesh, Scheme::Loop, Boundary::EdgeOnly);
        assert_same("edge only", &found, &published(&mesh, Scheme::Loop));
        // One triangle at two of the corners of the sheet.
        mesh.corners.extend([(3, f64::INFINITY), (12, f64::INFINITY)]);
        let expected = published(&mesh, Scheme::Loop);
        mesh.corners.clear();
        assert_same("edge and corner", &ours(&mesh, Scheme::Loop, Boundary::EdgeAndCorner), &expected);
    }
}

#[test]
fn smoothed_triangles_have_their_weight_and_others_do_not() {
    for (name, cut) in [("all", [true, true]), ("some", [true, false]), ("none", [false, false])] {
        for smooth_triangles in [true, false] {
            for sharpness in [0.0, 0.7] {
                let mesh = creased(sheet(3, |i, k| cut[(i + k) % 2]), &[4, 5, 6, 7], sharpness);
                let mesh = Mesh { smooth_triangles, ..mesh };
                let found = ours(&mesh, Scheme::CatmullClark, Boundary::EdgeOnly);
                let expected = published(&mesh, Scheme::CatmullClark);
                assert_same(&format!("{name}, {smooth_triangles}, {sharpness}"), &found, &expected);
            }
        }
    }
}

/// Values of corners are those of a mesh of their own, which is cut open along the seams.
#[test]
fn seams_of_loops_surfaces_are_rims_of_the_values() {
    let mesh = sheet(4, |_, _| true);
    // The seam runs along the middle, from rim to rim.
    let side = |face: &[usize]| face.iter().map(|&p| p / 5).max().unwrap() > 2;
    let split = |point: usize, far: bool| if far && point / 5 == 2 { mesh.points.len() + point % 5 } else { point };
    let value = |point: usize, far: bool| {
        let [x, y, z] = mesh.points[point];
        if far { [x + 0.4 * z, y * 1.2 + 0.3 * x, x * y] } else { [x, y + 0.2 * z, z] }
    };
    let mut points: Vec<[f64; 3]> = (0..mesh.points.len()).map(|point| value(point, point / 5 > 2)).collect();
    points.extend((10..15).map(|point| value(point, true)));
    let faces: Vec<Vec<usize>> =
        mesh.faces.iter().map(|face| face.iter().map(|&p| split(p, side(face))).collect()).collect();
    let indices: Vec<u32> = faces.iter().flatten().map(|&p| p as u32).collect();
    let values: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let apart = Mesh { faces, points, ..mesh.clone() };
    let refine = |face_varying: FaceVarying| {
        let corners = mesh.faces.iter().flatten().map(|&p| p as u32).collect();
        let cage = Cage {
            faces: Faces::new(mesh.faces.iter().map(|_| 3), corners),
            points: mesh.points.len(),
            creases: &[],
            corners: &[],
            holes: &[],
            scheme: Scheme::Loop,
            boundary: Boundary::EdgeOnly,
            face_varying,
            smooth_triangles: false,
        };
        Refinement::new(cage, DEPTH).face_varying(&values, &indices).0
    };
    // Smooth rims; rims with corners where there is one face; rims that stay.
    assert_same("none", &refine(FaceVarying::None), &published(&apart, Scheme::Loop));
    let at = apart.at_edges();
    let faces_of = |point: usize| apart.faces.iter().filter(|face| face.contains(&point)).count();
    let sharp = |which: &dyn Fn(usize) -> bool| {
        let corners = (0..apart.points.len()).filter(|&point| which(point)).map(|point| (point, f64::INFINITY));
        Mesh { corners: corners.collect(), ..apart.clone() }
    };
    let lone = sharp(&|point| faces_of(point) == 1);
    assert!(lone.corners.len() > 2);
    assert_same("corners only", &refine(FaceVarying::CornersOnly), &published(&lone, Scheme::Loop));
    let all_linear: Vec<[f64; 3]> = {
        let middles = at.keys().map(|&(a, b)| mean(&[apart.points[a], apart.points[b]]));
        apart.points.iter().copied().chain(middles).collect()
    };
    assert_same("all", &refine(FaceVarying::All), &all_linear);
}
