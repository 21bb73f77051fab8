//! Known values: closed forms, and Blender 5.0.1's subdivision (which is OpenSubdiv) for everything else.

use super::*;
use crate::math::Vec3;

const CUBE: [[f32; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const CUBE_FACES: [&[u32]; 6] =
    [&[0, 4, 6, 2], &[0, 1, 5, 4], &[4, 5, 7, 6], &[3, 7, 5, 1], &[6, 7, 3, 2], &[2, 3, 1, 0]];

fn faces(list: &[&[u32]]) -> Faces {
    Faces::new(list.iter().map(|f| f.len() as u32), list.concat())
}

fn cage<'a>(list: &[&[u32]], points: usize) -> Cage<'a> {
    Cage {
        faces: faces(list),
        points,
        creases: &[],
        corners: &[],
        holes: &[],
        scheme: Scheme::CatmullClark,
        boundary: Boundary::EdgeAndCorner,
        face_varying: FaceVarying::CornersPlus1,
        smooth_triangles: false,
    }
}

fn assert_close(a: [f32; 3], b: [f32; 3]) {
    assert!(Vec3::from(a).distance(b.into()) < 2e-6, "{a:?} is not {b:?}");
}

/// Points of vertices come last.
fn vertex(points: &[[f32; 3]], of: usize, i: usize) -> [f32; 3] {
    points[points.len() - of + i]
}

#[test]
fn a_cube_has_its_closed_form_at_every_level() {
    for depth in 1..4 {
        let refinement = Refinement::new(cage(&CUBE_FACES, 8), depth);
        assert_eq!(refinement.faces().len(), 6 * 4usize.pow(depth));
        let points = refinement.vertex(&CUBE);
        let Some(Attribute::Point(normals)) = refinement.surface(&CUBE).1 else { panic!("no edge is sharp") };
        // Valence 3: (9 v + 4 Σe + Σf) / 24 with Σe = v and Σf = −v.
        for (i, p) in CUBE.iter().enumerate() {
            assert_close(vertex(&points, 8, i), p.map(|v| v / 2.0));
            assert_close(vertex(&normals, 8, i), Vec3::from(*p).normalize().into());
        }
        // The middle of a face: (16·1 + 4·3 + 4·5/9) / 36.
        let top = points.iter().fold(0.0, |top: f32, p| top.max(p[0]));
        assert!((top - 68.0 / 81.0).abs() < 2e-6, "{top}");
        for (p, n) in points.iter().zip(&normals) {
            assert!(Vec3::from(*p).normalize().dot((*n).into()) > 0.8);
        }
    }
}

#[test]
fn a_tetrahedron_has_its_closed_form() {
    let points = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let list: [&[u32]; 4] = [&[0, 1, 2], &[0, 3, 1], &[0, 2, 3], &[1, 3, 2]];
    let refinement = Refinement::new(cage(&list, 4), 2);
    let limit = refinement.vertex(&points);
    for (i, p) in points.iter().enumerate() {
        assert_close(vertex(&limit, 4, i), p.map(|v| 2.0 / 9.0 * v));
    }
}

#[test]
fn a_cube_of_sharp_edges_stays_one() {
    let mut creases = Vec::new();
    for face in CUBE_FACES {
        creases.extend((0..4).map(|i| ([face[i], face[(i + 1) % 4]], INFINITE)));
    }
    let refinement = Refinement::new(Cage { creases: &creases, ..cage(&CUBE_FACES, 8) }, 3);
    let points = refinement.vertex(&CUBE);
    for p in &points {
        assert!((p.iter().fold(0.0f32, |m, v| m.max(v.abs())) - 1.0).abs() < 1e-6, "{p:?}");
    }
    let Some(Attribute::Corner(normals)) = refinement.surface(&CUBE).1 else { panic!("edges are sharp") };
    for (corner, n) in normals.iter().enumerate() {
        assert!((n.iter().fold(0.0f32, |m, v| m.max(v.abs())) - 1.0).abs() < 1e-6, "{n:?}");
        let p = Vec3::from(points[refinement.faces().corners[corner] as usize]);
        assert!((p.dot((*n).into()) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn the_rim_of_a_square_is_a_spline() {
    let points = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let list: [&[u32]; 1] = [&[0, 1, 2, 3]];
    for depth in 1..4 {
        let smooth = Refinement::new(Cage { boundary: Boundary::EdgeOnly, ..cage(&list, 4) }, depth);
        let limit = smooth.vertex(&points);
        // A closed cubic B-spline: (4 v + e0 + e1) / 6.
        assert_close(vertex(&limit, 4, 2), [2.0 / 3.0, 2.0 / 3.0, 0.0]);
        let Some(Attribute::Point(normals)) = smooth.surface(&points).1 else { panic!() };
        normals.iter().for_each(|&n| assert_close(n, [0.0, 0.0, 1.0]));
        let sharp = Refinement::new(cage(&list, 4), depth);
        let limit = sharp.vertex(&points);
        assert_close(vertex(&limit, 4, 2), points[2]);
        assert!(limit.iter().all(|p| p[0].abs() <= 1.0 && p[1].abs() <= 1.0 && p[2] == 0.0));
        assert_eq!(limit.iter().filter(|p| (p[1] - 1.0).abs() < 1e-6).count(), 2usize.pow(depth) + 1);
    }
    let none = Refinement::new(Cage { boundary: Boundary::None, ..cage(&list, 4) }, 1);
    assert!(none.holes().iter().all(|&hole| hole));
}

#[test]
fn an_octahedron_has_loops_closed_form() {
    let points =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let list: [&[u32]; 8] =
        [&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[2, 0, 5], &[1, 2, 5], &[3, 1, 5], &[0, 3, 5]];
    for depth in 0..4 {
        let refinement = Refinement::new(Cage { scheme: Scheme::Loop, ..cage(&list, 6) }, depth);
        assert_eq!(refinement.faces().len(), 8 * 4usize.pow(depth));
        let limit = refinement.vertex(&points);
        let Some(Attribute::Point(normals)) = refinement.surface(&points).1 else { panic!() };
        for (i, p) in points.iter().enumerate() {
            // Valence 4: 1 − 4χ with χ = 1 / (3 / (8β) + 4), β = (5/8 − (3/8)²) / 4.
            let share = if depth == 0 { 1.0 } else { 24.0 / 55.0 };
            assert_close(vertex(&limit, 6, i), p.map(|v| share * v));
            assert_close(vertex(&normals, 6, i), *p);
        }
    }
}

#[test]
fn bilinear_stays_on_the_cage() {
    let refinement = Refinement::new(Cage { scheme: Scheme::Bilinear, ..cage(&CUBE_FACES, 8) }, 2);
    for p in refinement.vertex(&CUBE) {
        assert_eq!(p.iter().fold(0.0f32, |m, v| m.max(v.abs())), 1.0);
    }
}

/// Sums over points that see every coordinate of every point.
fn moments(points: &[[f32; 3]]) -> Vec<f64> {
    let mut sums = vec![0.0; 6];
    for [x, y, z] in points.iter().map(|p| p.map(f64::from)) {
        for (sum, term) in sums.iter_mut().zip([1.0, x, x * x, y * y * z, x * y * z, z.powi(4)]) {
            *sum += term;
        }
    }
    sums
}

fn assert_moments(name: &str, found: &[f64], expected: &[f64]) {
    for (a, b) in found.iter().zip(expected) {
        // Blender's patches are in single precision.
        assert!((a - b).abs() < 2e-5 * b.abs().max(1.0), "{name}: {found:?} is not {expected:?}");
    }
}

fn skew([x, y, z]: [f32; 3]) -> [f32; 3] {
    [x + 0.3 * y * z + 0.1, y - 0.2 * x + 0.05 * z * z, z * 1.3 + 0.15 * x * y]
}

/// An open mesh with triangles, a pentagon, and points of several valences.
fn open() -> (Vec<[f32; 3]>, Vec<&'static [u32]>) {
    let mut points: Vec<_> = CUBE.into_iter().map(skew).collect();
    points.extend([[0.0, 0.0, 1.7], [1.5, 0.2, 0.0]].map(skew));
    let list: Vec<&[u32]> = vec![
        &[0, 4, 6, 2],
        &[0, 1, 5, 4],
        &[4, 5, 8],
        &[5, 7, 8],
        &[7, 6, 8],
        &[6, 4, 8],
        &[3, 7, 5, 9, 1],
        &[6, 7, 3, 2],
    ];
    (points, list)
}

#[test]
fn creases_and_rims_are_as_in_blender() {
    let cube: Vec<_> = CUBE.into_iter().map(skew).collect();
    let plain = Refinement::new(cage(&CUBE_FACES, 8), 2).vertex(&cube);
    assert_moments("plain", &moments(&plain), &[98.0, 9.7999992, 25.1139961, -0.1602295, 1.4420626, 28.2964445]);

    let creases = [([0, 4], 10.0), ([4, 5], 2.0), ([5, 7], 1.6), ([7, 6], 0.7), ([1, 3], 10.0), ([3, 2], 1.2)];
    let corners = [(2, 1.5), (6, 10.0)];
    let creased = Cage { creases: &creases, corners: &corners, ..cage(&CUBE_FACES, 8) };
    let creased = Refinement::new(creased, 2).vertex(&cube);
    assert_moments(
        "creased",
        &moments(&creased),
        // At a quality of 10: the ends of sharp edges are only as near to the limit as OpenSubdiv isolates them.
        &[98.0, 6.6844081, 35.5465434, 3.9982562, 3.9594914, 72.57517],
    );

    let (points, list) = open();
    let creases = [([4, 8], 1.4), ([8, 7], 1.4)];
    let cases = [
        (Boundary::EdgeOnly, [130.0, 29.884527, 68.0138666, 1.8161963, 12.6351091, 310.97648]),
        (Boundary::EdgeAndCorner, [130.0, 30.3010492, 69.2145355, 1.8716628, 12.5094971, 310.9620422]),
    ];
    for (boundary, expected) in cases {
        let cage = Cage { boundary, creases: &creases, ..cage(&list, points.len()) };
        assert_moments("open", &moments(&Refinement::new(cage, 2).vertex(&points)), &expected);
    }
}

/// Sharpness that outlasts the levels, ends of sharp edges, sharp points and rims.
#[test]
fn limits_are_those_of_finer_levels() {
    let (open_points, open_list) = open();
    let cube: Vec<_> = CUBE.into_iter().map(skew).collect();
    let triangles: [&[u32]; 10] = [
        &[0, 4, 6],
        &[0, 6, 2],
        &[0, 1, 5],
        &[0, 5, 4],
        &[4, 5, 7],
        &[4, 7, 6],
        &[3, 7, 5],
        &[3, 5, 1],
        &[6, 7, 3],
        &[6, 3, 2],
    ];
    let creases = [([0, 4], 10.0), ([4, 5], 3.3), ([5, 7], 1.6), ([7, 6], 0.7), ([1, 3], 2.2), ([3, 2], 3.0)];
    let of_open = [([4, 8], 2.4), ([8, 7], 10.0), ([7, 6], 3.1)];
    let corners = [(2, 2.5), (6, 2.0)];
    type Case<'a> = (&'a str, Scheme, &'a [[f32; 3]], &'a [&'a [u32]], &'a [([u32; 2], f32)]);
    let cases: [Case<'_>; 3] = [
        ("cube", Scheme::CatmullClark, &cube, &CUBE_FACES, &creases),
        ("open", Scheme::CatmullClark, &open_points, &open_list, &of_open),
        ("loop", Scheme::Loop, &cube, &triangles, &creases),
    ];
    for (name, scheme, points, list, creases) in cases {
        let cage = || Cage { creases, corners: &corners, scheme, ..cage(list, points.len()) };
        let found = Refinement::new(cage(), 2).vertex(points);
        // Points stay the last ones from level to level. What has not gone to the limit is near it where the faces
        // are small and no sharpness is left.
        let fine = Refinement::new(cage(), 8).smooth(points);
        let finer = Refinement::new(cage(), 5).vertex(points);
        let same = |of: &[[f32; 3]], i: usize| Vec3::from(of[of.len() - found.len() + i]);
        for (i, &at) in found.iter().enumerate() {
            let at = Vec3::from(at);
            assert!(at.distance(same(&finer, i)) < 4e-6, "{name}: {at:?} is {:?} after five levels", same(&finer, i));
            assert!(at.distance(same(&fine, i)) < 1e-3, "{name}: {at:?} is not near {:?}", same(&fine, i));
        }
    }
}

#[test]
fn seams_are_as_in_blender() {
    let (points, list) = open();
    let joined = [1, 2, 3, 4, 5, 7];
    let mut uvs: Vec<[f32; 2]> = Vec::new();
    for (i, face) in list.iter().enumerate() {
        for (k, &v) in face.iter().enumerate() {
            let ([x, y, z], [i_, k_, v_]) = (points[v as usize], [i, k, v as usize].map(|n| n as f32));
            uvs.push(match joined.contains(&i) {
                true => [x * (0.6 - 0.2 * z) + if i > 3 { 3.0 } else { 0.0 }, y * (0.6 - 0.2 * z)],
                false => [0.1 * i_ + 0.05 * k_ + 0.01 * v_, 0.3 * x - 0.02 * i_ * k_],
            });
        }
    }
    let indices: Vec<u32> = (0..uvs.len() as u32).collect();
    let cases = [
        (FaceVarying::All, [464.0, 1463.56756, 103.1953539, 93.0874097, 0.9130822]),
        (FaceVarying::CornersOnly, [464.0, 1448.142509, 104.19885, 94.4691055, 1.0300763]),
        (FaceVarying::CornersPlus1, [464.0, 1450.1048705, 103.5728751, 94.7750562, 0.9745279]),
        (FaceVarying::CornersPlus2, [464.0, 1460.4906672, 103.8687165, 92.621159, 0.9577064]),
        (FaceVarying::Boundaries, [464.0, 1460.2194522, 103.8777018, 92.6119471, 0.9614979]),
        (FaceVarying::None, [464.0, 1449.6526783, 101.5349817, 92.0646572, 2.4874823]),
    ];
    let mut failed = Vec::new();
    for (face_varying, expected) in cases {
        let cage = Cage { boundary: Boundary::EdgeOnly, face_varying, ..cage(&list, points.len()) };
        let refinement = Refinement::new(cage, 2);
        let limit = refinement.vertex(&points);
        let (values, at) = refinement.face_varying(&uvs, &indices);
        let mut sums = [0.0; 5];
        for (corner, &value) in at.iter().enumerate() {
            let [u, v] = values[value as usize].map(f64::from);
            let [x, y, z] = limit[refinement.faces().corners[corner] as usize].map(f64::from);
            for (sum, term) in sums.iter_mut().zip([1.0, u * u, u * v * v, u * x, v * v * y * z]) {
                *sum += term;
            }
        }
        let close = sums.iter().zip(&expected).all(|(a, b): (&f64, &f64)| (a - b).abs() < 1e-4 * b.abs().max(1.5));
        if !close {
            failed.push(format!("{face_varying:?}: {sums:?} is not {expected:?}"));
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

#[test]
fn broken_topology_is_survived() {
    // Three faces at an edge, a face turned over, a corner twice in a face, two fans at a point, a lone point.
    let list: [&[u32]; 6] = [&[0, 1, 2], &[1, 0, 3], &[0, 1, 4, 5], &[2, 1, 6], &[7, 7, 8], &[8, 9, 10, 11]];
    let points: Vec<[f32; 3]> = (0..13).map(|i| [i as f32, (i * i % 7) as f32, (i * 3 % 5) as f32]).collect();
    let uvs: Vec<[f32; 2]> = (0..20).map(|i| [i as f32, 0.0]).collect();
    for scheme in [Scheme::CatmullClark, Scheme::Bilinear] {
        for depth in 0..3 {
            let refinement = Refinement::new(Cage { scheme, ..cage(&list, 13) }, depth);
            assert!(refinement.vertex(&points).as_flattened().iter().all(|v| v.is_finite()));
            let indices: Vec<u32> = (0..20).collect();
            let (values, at) = refinement.face_varying(&uvs, &indices);
            assert!(at.iter().all(|&i| (i as usize) < values.len()));
            refinement.surface(&points);
        }
    }
}
