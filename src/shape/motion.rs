//! Meshes whose points move.

use super::Attribute;
use crate::math::{DQuat, DVec3, Times, Vec3};

/// Points of a mesh at keys of time; between two each goes straight on.
#[derive(Clone, Debug)]
pub struct MeshMotion {
    times: Times,
    /// For each key those of all points, and in the same space.
    points: Vec<Vec<Vec3>>,
    /// For each key unit shading normals; empty for a faceted mesh.
    normals: Vec<Attribute<Vec3>>,
}

impl MeshMotion {
    /// Points that are `keys` at `times`. `normals` are those of a mesh of `triangles` over `modelled`; they turn
    /// as the surface around each corner does.
    pub fn new(
        times: Times,
        keys: Vec<Vec<Vec3>>,
        modelled: &[Vec3],
        triangles: &[[u32; 3]],
        normals: Option<&Attribute<Vec3>>,
    ) -> Self {
        let turned = |normals| {
            let around = Around::of(normals, triangles);
            let before = around.normals(modelled, triangles);
            keys.iter().map(|points| around.turned(&before, &around.normals(points, triangles), normals)).collect()
        };
        Self { times, normals: normals.map_or(Vec::new(), turned), points: keys }
    }

    /// The points `indices` at `time`, moved by the same products and sums as in the acceleration structure.
    pub fn corners(&self, indices: [u32; 3], time: f32) -> [Vec3; 3] {
        let (stretch, share) = self.times.at(time);
        let (from, to) = (&self.points[stretch], &self.points[stretch + 1]);
        indices.map(|i| lerp(from[i as usize], to[i as usize], share))
    }

    /// Shading normals of the corners of `triangle` at `time`, not unit.
    pub(super) fn normals(&self, triangle: u32, indices: [u32; 3], time: f32) -> Option<[Vec3; 3]> {
        let (stretch, share) = self.times.at(time);
        let from = self.normals.get(stretch)?.at(triangle, indices);
        let to = self.normals.get(stretch + 1)?.at(triangle, indices);
        Some([0, 1, 2].map(|k| lerp(from[k], to[k], share)))
    }

    /// The points `indices` at each key.
    pub fn keys(&self, indices: [u32; 3]) -> impl Iterator<Item = [Vec3; 3]> {
        self.points.iter().map(move |points| indices.map(|i| points[i as usize]))
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let of = |values: &Attribute<Vec3>| match values {
            Attribute::Point(values) | Attribute::Corner(values) => size_of_val(values.as_slice()),
        };
        self.points.iter().map(|points| size_of_val(points.as_slice())).sum::<usize>()
            + self.normals.iter().map(of).sum::<usize>()
    }
}

fn lerp(from: Vec3, to: Vec3, share: f32) -> Vec3 {
    from + (to - from) * share
}

/// Which corners share a normal: those at the same point to which it was given alike.
struct Around {
    /// Group of each corner.
    groups: Vec<u32>,
    count: usize,
}

impl Around {
    fn of(normals: &Attribute<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let points = triangles.iter().flatten();
        match normals {
            Attribute::Point(values) => Self { groups: points.copied().collect(), count: values.len() },
            Attribute::Corner(values) => {
                let mut known = std::collections::HashMap::new();
                let bits = |n: &Vec3| n.to_array().map(f32::to_bits);
                let mut group = |key| {
                    let next = known.len() as u32;
                    *known.entry(key).or_insert(next)
                };
                let groups = points.zip(values).map(|(&point, n)| group((point, bits(n)))).collect();
                Self { groups, count: known.len() }
            }
        }
    }

    /// Mean of the facets around each group, by the angle that each has there; not unit.
    fn normals(&self, points: &[Vec3], triangles: &[[u32; 3]]) -> Vec<DVec3> {
        let mut sums = vec![DVec3::ZERO; self.count];
        for (triangle, groups) in triangles.iter().zip(self.groups.chunks_exact(3)) {
            let p = triangle.map(|i| points[i as usize].as_dvec3());
            let n = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
            for k in 0..3 {
                let [a, b] = [1, 2].map(|next| (p[(k + next) % 3] - p[k]).normalize_or_zero());
                sums[groups[k] as usize] += n * a.dot(b).clamp(-1.0, 1.0).acos();
            }
        }
        sums
    }

    /// `normals`, turned the shortest way that brings the facets' normals from `before` to `after`.
    fn turned(&self, before: &[DVec3], after: &[DVec3], normals: &Attribute<Vec3>) -> Attribute<Vec3> {
        let turns: Vec<DQuat> = before
            .iter()
            .zip(after)
            .map(|(a, b)| match (a.try_normalize(), b.try_normalize()) {
                (Some(a), Some(b)) => DQuat::from_rotation_arc(a, b),
                _ => DQuat::IDENTITY,
            })
            .collect();
        let turn = |group: usize, n: &Vec3| (turns[group] * n.as_dvec3()).as_vec3();
        match normals {
            Attribute::Point(values) => Attribute::Point(values.iter().enumerate().map(|(i, n)| turn(i, n)).collect()),
            Attribute::Corner(values) => {
                let turned = values.iter().zip(&self.groups).map(|(n, &group)| turn(group as usize, n));
                Attribute::Corner(turned.collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Mesh;

    /// Two triangles that form a roof over the x axis, and the same turned by a quarter about it.
    fn roof(normals: Option<Attribute<Vec3>>) -> Mesh {
        let points = vec![Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, -1.0), Vec3::new(0.0, -1.0, -1.0)];
        let triangles = vec![[0, 1, 2], [1, 0, 3]];
        let turned = points.iter().map(|p| Vec3::new(p.x, -p.z, p.y)).collect();
        let times = Times::new(vec![0.0, 1.0]).unwrap();
        let motion = MeshMotion::new(times, vec![points.clone(), turned], &points, &triangles, normals.as_ref());
        Mesh { points, triangles, normals, motion: Some(motion.into()), ..Mesh::default() }
    }

    #[test]
    fn normals_turn_with_the_surface_whoever_gave_them() {
        let up = Vec3::new(0.1, 0.0, 1.0).normalize();
        let along = |n: Vec3| Vec3::new(n.x, -n.z, n.y);
        let sharp = |k: usize| if k < 3 { Vec3::new(0.0, 1.0, 1.0) } else { Vec3::new(0.0, -1.0, 1.0) }.normalize();
        let smooth = roof(Some(Attribute::Point(vec![up; 4])));
        let edged = roof(Some(Attribute::Corner((0..6).map(sharp).collect())));
        for (triangle, first) in [(0, 0), (1, 3)] {
            let close = |a: [Vec3; 3], b: [Vec3; 3]| a.iter().zip(b).all(|(a, b)| a.distance(b) < 1e-6);
            assert_eq!(smooth.corner_normals(triangle, 0.0).unwrap()[0], up);
            // Those of the ridge, where both facets meet.
            let ridge = smooth.corner_normals(triangle, 1.0).unwrap();
            assert!(ridge[0].distance(along(up)) < 1e-6 && ridge[1].distance(along(up)) < 1e-6, "{ridge:?}");
            let normals = [0, 1, 2].map(|k| sharp(first + k));
            assert!(close(edged.corner_normals(triangle, 0.0).unwrap(), normals));
            assert!(close(edged.corner_normals(triangle, 1.0).unwrap(), normals.map(along)));
        }
        assert_eq!(roof(None).corner_normals(0, 0.5), None);
    }

    #[test]
    fn points_go_straight_on_and_tangents_follow_their_triangle() {
        let tangent = Attribute::Point(vec![[0.0, 1.0, -1.0, -1.0]; 4]);
        let mesh = Mesh { tangents: Some(tangent), ..roof(None) };
        let [a, b, c] = mesh.corners_at(0, 0.5);
        assert_eq!((a, b, c), (Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 0.0)));
        assert_eq!(mesh.point(0, [0.0, 0.5], 0.5).p, Vec3::new(0.0, 0.5, 0.0));
        assert_eq!(mesh.corners(0)[2], Vec3::new(0.0, 1.0, -1.0));
        for (time, expected) in [(0.0, [0.0, 1.0, -1.0]), (1.0, [0.0, 1.0, 1.0])] {
            let (tangent, sign) = mesh.tangent(0, [0.2, 0.3], time).unwrap();
            assert!(tangent.distance(Vec3::from(expected)) < 1e-6 && sign == -1.0, "{tangent}");
        }
    }
}
