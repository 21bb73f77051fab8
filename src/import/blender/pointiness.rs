//! Pointiness: how sharp a mesh is at each of its points, that of Cycles.
//!
//! Of a point it is the angle, as a share of half a turn, between its normal and the mean direction to its neighbors:
//! 0.5 where it is flat, more on ridges, less in grooves. What is shown is the mean of a point's and its neighbors'.
//! Points of the same place count as one.

use crate::math::{Vec3, safe_acos};

/// Points are the same whose squared distance is below this and whose sums of coordinates differ by no more than three
/// times as much: Cycles' limit, in the mesh's units.
const SAME: f32 = f32::EPSILON;

/// For each point of `positions` its pointiness. `normals` are those of the points, three numbers each; `edges` are
/// pairs of points, and those of points that are not there are left out.
pub fn pointiness(positions: &[f32], normals: &[f32], edges: &[i32]) -> Vec<f32> {
    let vectors = |values: &[f32]| values.as_chunks::<3>().0.iter().map(|&v| Vec3::from(v)).collect::<Vec<_>>();
    let (points, normals) = (vectors(positions), vectors(normals));
    if normals.len() != points.len() {
        return vec![0.0; points.len()];
    }
    let same = welded(&points);
    let mut normal = vec![Vec3::ZERO; points.len()];
    for (n, &same) in normals.iter().zip(&same) {
        normal[same] += *n;
    }
    let edges = distinct(edges, &same);
    let (mut towards, mut count) = (vec![Vec3::ZERO; points.len()], vec![0_u32; points.len()]);
    for &[a, b] in &edges {
        let along = (points[b] - points[a]).normalize_or_zero();
        towards[a] += along;
        towards[b] -= along;
        count[a] += 1;
        count[b] += 1;
    }
    let own = |i: usize| match count[i] {
        0 => 0.0,
        n => safe_acos(normal[i].normalize_or_zero().dot(towards[i] / n as f32)) * std::f32::consts::FRAC_1_PI,
    };
    let own: Vec<f32> = (0..points.len()).map(own).collect();
    let mut sum = own.clone();
    for &[a, b] in &edges {
        sum[a] += own[b];
        sum[b] += own[a];
    }
    same.iter().map(|&i| sum[i] / (count[i] + 1) as f32).collect()
}

/// For each point the one that stands for all of its place.
fn welded(points: &[Vec3]) -> Vec<usize> {
    let sum = |i: usize| points[i].x + points[i].y + points[i].z;
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| sum(a).total_cmp(&sum(b)));
    let mut same: Vec<usize> = (0..points.len()).collect();
    // From the last one, so that the point that a point is the same as has its own answer by then.
    for (k, &i) in order.iter().enumerate().rev() {
        let near = order[k + 1..].iter().take_while(|&&other| sum(other) - sum(i) <= 3.0 * SAME);
        let found = near.copied().find(|&other| points[other].distance_squared(points[i]) < SAME);
        same[i] = found.map_or(i, |other| same[other]);
    }
    same
}

/// Each pair of places that an edge joins, once.
fn distinct(edges: &[i32], same: &[usize]) -> Vec<[usize; 2]> {
    let end = |i: i32| usize::try_from(i).ok().and_then(|i| same.get(i)).copied();
    let ends = edges.as_chunks::<2>().0.iter().filter_map(|&[a, b]| Some([end(a)?, end(b)?]));
    let mut ends: Vec<_> = ends.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    ends.sort_unstable();
    ends.dedup();
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of the three edges at a cube's corner is a third of the diagonal, −1/√3 along the normal.
    #[test]
    fn a_cube_is_equally_pointed_at_all_corners_though_its_faces_are_apart() {
        let corner = |i: i32| [i & 1, (i >> 1) & 1, (i >> 2) & 1].map(|x| x as f32 - 0.5);
        // Every corner three times, as if each face had its own, with the face's normal.
        let (mut positions, mut normals, mut edges) = (Vec::new(), Vec::new(), Vec::new());
        for axis in 0..3 {
            for i in 0..8 {
                positions.extend(corner(i));
                normals.extend((0..3).map(|k| if k == axis { corner(i)[k].signum() } else { 0.0 }));
            }
            let first = 8 * axis as i32;
            for i in 0..8 {
                edges.extend(
                    (0..3).filter(|&k| k != axis && i & (1 << k) == 0).flat_map(|k| [first + i, first + i + (1 << k)]),
                );
            }
        }
        let expected = (-(1.0_f32 / 3.0).sqrt()).acos() / std::f32::consts::PI;
        let found = pointiness(&positions, &normals, &edges);
        assert_eq!(found.len(), 24);
        assert!(found.iter().all(|x| (x - expected).abs() < 1e-5), "{found:?} {expected}");
    }

    /// A point of height h amid a square: its own angle, blurred with those of the corners.
    #[test]
    fn a_peak_is_blurred_with_its_neighbors() {
        let height = 0.7_f32;
        let positions = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, height];
        let normals = [0.0, 0.0, 1.0].repeat(5);
        let edges = [0, 4, 1, 4, 2, 4, 4, 3, 3, 4, 9, 4];
        let found = pointiness(&positions, &normals, &edges);
        let slope = height / (1.0 + height * height).sqrt();
        let angle = |cos: f32| cos.acos() / std::f32::consts::PI;
        let (peak, foot) = (angle(-slope), angle(slope));
        assert!((found[4] - (peak + 4.0 * foot) / 5.0).abs() < 1e-5, "{found:?}");
        assert!((found[0] - 0.5 * (peak + foot)).abs() < 1e-5);
    }

    #[test]
    fn points_without_edges_have_none() {
        assert_eq!(pointiness(&[0.0; 3], &[0.0, 0.0, 1.0], &[]), [0.0]);
        assert_eq!(pointiness(&[0.0; 3], &[], &[]), [0.0]);
        assert!(pointiness(&[], &[], &[0, 1]).is_empty());
    }
}
