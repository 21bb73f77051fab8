//! Faces of any size to triangles: a fan where that covers the face (as Hydra does), else by clipping ears
//! in the plane that fits best.

use std::cell::Cell;

use crate::math::{DVec2, DVec3};

/// Corners that are looked at before a face is taken for hopeless: seconds, for outlines of very many corners.
const MOST_WORK: u64 = 1 << 30;

/// Appends the triangles of the polygon with `corners`, as positions in it; `point` tells where a corner
/// is. A polygon of n corners always has n − 2.
pub(super) fn triangulate(
    corners: usize,
    point: impl Fn(usize) -> [f32; 3],
    triangles: &mut Vec<[u32; 3]>,
    scratch: &mut Scratch,
) {
    match corners {
        0..3 => return,
        3 => return triangles.push([0, 1, 2]),
        _ => {}
    }
    scratch.flatten(corners, point);
    if corners == 4 {
        let p = &scratch.plane;
        // A quad that bends inwards at 1 or 3 can only be cut between those.
        let bends = |i: usize| area(p[(i + 3) % 4], p[i], p[(i + 1) % 4]) < 0.0;
        let cut = if bends(1) || bends(3) { [[0, 1, 3], [1, 2, 3]] } else { [[0, 1, 2], [0, 2, 3]] };
        return triangles.extend(cut);
    }
    if scratch.is_convex() {
        triangles.extend((1..corners as u32 - 1).map(|i| [0, i, i + 1]));
    } else {
        scratch.clip_ears(triangles);
    }
}

/// Memory that is used again from face to face.
#[derive(Default)]
pub(super) struct Scratch {
    /// The corners in the plane, counter-clockwise.
    plane: Vec<DVec2>,
    left: Vec<u32>,
}

/// Twice the area of a triangle; positive where it is counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

impl Scratch {
    /// Projects along Newell's normal, the one of the plane that fits best.
    fn flatten(&mut self, corners: usize, point: impl Fn(usize) -> [f32; 3]) {
        let at = |i: usize| DVec3::from(point(i).map(f64::from));
        let origin = at(0);
        let normal: DVec3 = (0..corners).map(|i| (at(i) - origin).cross(at((i + 1) % corners) - origin)).sum();
        let normal = normal.try_normalize().unwrap_or(DVec3::Z);
        let (u, v) = normal.any_orthonormal_pair();
        // Turned so that (u, v, normal) is right-handed and the face runs counter-clockwise.
        let v = if u.cross(v).dot(normal) < 0.0 { -v } else { v };
        self.plane.clear();
        self.plane.extend((0..corners).map(|i| {
            let p = at(i) - origin;
            DVec2::new(p.dot(u), p.dot(v))
        }));
    }

    /// True where no corner bends inwards and the outline goes round once.
    fn is_convex(&self) -> bool {
        let p = &self.plane;
        let n = p.len();
        let turns_left = (0..n).all(|i| area(p[i], p[(i + 1) % n], p[(i + 2) % n]) >= 0.0);
        turns_left && (1..n - 1).all(|i| area(p[0], p[i], p[i + 1]) >= 0.0)
    }

    fn clip_ears(&mut self, triangles: &mut Vec<[u32; 3]>) {
        let p = &self.plane;
        let left = &mut self.left;
        let work = Cell::new(0);
        left.clear();
        left.extend(0..p.len() as u32);
        let mut at = 0;
        while left.len() > 3 {
            let n = left.len();
            if work.get() > MOST_WORK {
                let fan = left[1..].windows(2).map(|pair| [left[0], pair[0], pair[1]]);
                triangles.extend(fan);
                return;
            }
            let corner = |i: usize| left[i % n];
            let turn = |i: usize| {
                let [a, b, c] = [i + n - 1, i, i + 1].map(|i| p[corner(i) as usize]);
                area(a, b, c)
            };
            let is_ear = |i: usize| {
                let ear = [i + n - 1, i, i + 1].map(|i| p[corner(i) as usize]);
                work.set(work.get() + 1);
                turn(i) > 0.0
                    && (i + 2..i + n - 1).all(|j| {
                        let q = p[corner(j) as usize];
                        work.set(work.get() + 1);
                        // A corner at the same place as one of the ear's is a bridge to a hole.
                        ear.contains(&q) || !(0..3).all(|k| area(ear[k], ear[(k + 1) % 3], q) >= 0.0)
                    })
            };
            // Outlines that cross themselves may have no ear; the sharpest turn to the left is cut then.
            let widest = || (0..n).max_by(|&a, &b| turn(a).total_cmp(&turn(b))).unwrap_or(0);
            let ear = (at..at + n).find(|&i| is_ear(i)).map_or_else(widest, |i| i % n);
            triangles.push([corner(ear + n - 1), corner(ear), corner(ear + 1)]);
            left.remove(ear);
            // Not the same corner again and again: that makes slivers.
            at = ear % left.len();
        }
        if let [a, b, c] = left[..] {
            triangles.push([a, b, c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[[f32; 3]]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        triangulate(points.len(), |i| points[i], &mut triangles, &mut Scratch::default());
        assert_eq!(triangles.len(), points.len().saturating_sub(2));
        triangles
    }

    fn signed_area(points: &[[f32; 3]], triangles: &[[u32; 3]]) -> Vec<f32> {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2.0
        };
        triangles.iter().map(area).collect()
    }

    #[test]
    fn convex_faces_are_fans() {
        let hexagon: Vec<[f32; 3]> =
            (0..6).map(|i| (i as f32 * std::f32::consts::FRAC_PI_3).sin_cos()).map(|(s, c)| [c, s, 2.0]).collect();
        assert_eq!(cut(&hexagon), [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
        assert_eq!(cut(&hexagon[..4]), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_faces_are_covered_once() {
        // A comb and an arrow head: the areas of the triangles are positive and sum to that of the face.
        let comb = [[0, 0], [5, 0], [5, 3], [4, 3], [4, 1], [3, 1], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]];
        let arrow = [[0, 0], [4, 2], [0, 4], [1, 2]];
        for (outline, area) in [(&comb[..], 5.0 + 3.0 * 2.0), (&arrow[..], 6.0)] {
            for turn in 0..outline.len() {
                let mut points: Vec<[f32; 3]> = outline.iter().map(|p| [p[0] as f32, p[1] as f32, 0.0]).collect();
                points.rotate_left(turn);
                let areas = signed_area(&points, &cut(&points));
                assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
                assert!((areas.iter().sum::<f32>() - area).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn any_outline_ends() {
        cut(&[[0.0; 3]; 7]);
        cut(&[[f32::NAN; 3]; 5]);
        let star: Vec<[f32; 3]> = (0..9).map(|i| (i as f32 * 2.8).sin_cos()).map(|(s, c)| [c, s, s * c]).collect();
        cut(&star);
        cut(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    }
}
