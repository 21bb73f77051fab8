//! Morph targets and skins (glTF 2.0, sections 3.7.2.2 and 3.7.3), evaluated into plain points.
//!
//! Morph: `p = p₀ + Σ wₖ Δₖ`. Skin: `p = Σ wⱼ Jⱼ Bⱼ p` with joint `J` to world and inverse bind
//! matrix `B`; normals go by the cofactor matrix, which needs no inverse.

use crate::math::{DAffine3, DMat3, DVec3};

/// Matrices from the mesh to the world, one for each joint.
#[derive(Clone, Debug)]
pub(super) struct SkinPose {
    /// Joint to world times inverse bind matrix, moved by −`origin`.
    pub joints: Vec<DAffine3>,
    /// Where the deformed points are measured from, so that they stay small far from the world's origin.
    pub origin: DVec3,
}

/// Joints and weights of each point, four for each set.
pub(super) struct Influences {
    /// `joints[set][point]`.
    pub joints: Vec<Vec<[u32; 4]>>,
    /// `weights[set][point]`.
    pub weights: Vec<Vec<[f32; 4]>>,
}

/// Adds `weight · delta` to `values`; of unequal lengths the common part.
pub(super) fn add_target<const N: usize>(values: &mut [[f32; N]], delta: &[[f32; 3]], weight: f32) {
    for (value, delta) in values.iter_mut().zip(delta) {
        for (v, d) in value.iter_mut().zip(delta) {
            *v += weight * d;
        }
    }
}

/// Moves points, normals and tangents (whose w is kept) by `pose`. Returns for each point whether
/// it was mirrored, and how many influences named a joint that does not exist.
pub(super) fn skin(
    pose: &SkinPose,
    influences: &Influences,
    points: &mut [[f32; 3]],
    mut normals: Option<&mut [[f32; 3]]>,
    mut tangents: Option<&mut [[f32; 4]]>,
) -> (Vec<bool>, usize) {
    let mut unknown = 0;
    let mut mirrored = vec![false; points.len()];
    for i in 0..points.len() {
        let (blend, bad) = blend(pose, influences, i);
        unknown += bad;
        points[i] = blend.transform_point3(to_f64(points[i])).as_vec3().into();
        mirrored[i] = blend.matrix3.determinant() < 0.0;
        if let Some(normals) = normals.as_deref_mut() {
            let sign = if mirrored[i] { -1.0 } else { 1.0 };
            let n = sign * (cofactor(blend.matrix3) * to_f64(normals[i]));
            normals[i] = n.normalize_or_zero().as_vec3().into();
        }
        if let Some(tangents) = tangents.as_deref_mut() {
            let [x, y, z, w] = tangents[i];
            let t = (blend.matrix3 * to_f64([x, y, z])).normalize_or_zero().as_vec3();
            tangents[i] = [t.x, t.y, t.z, w];
        }
    }
    (mirrored, unknown)
}

/// The weighted sum of a point's joint matrices, weights scaled to a sum of 1; a point without
/// weight follows its first joint.
fn blend(pose: &SkinPose, influences: &Influences, point: usize) -> (DAffine3, usize) {
    let mut sum = DAffine3::from_mat3_translation(DMat3::ZERO, DVec3::ZERO);
    let (mut total, mut unknown) = (0.0, 0);
    let mut first = None;
    for (joints, weights) in influences.joints.iter().zip(&influences.weights) {
        let (Some(joints), Some(weights)) = (joints.get(point), weights.get(point)) else { continue };
        for (&joint, &weight) in joints.iter().zip(weights) {
            let Some(matrix) = pose.joints.get(joint as usize) else {
                unknown += usize::from(weight != 0.0);
                continue;
            };
            first = first.or(Some(*matrix));
            let weight = f64::from(weight);
            if weight > 0.0 && weight.is_finite() {
                sum.matrix3 += weight * matrix.matrix3;
                sum.translation += weight * matrix.translation;
                total += weight;
            }
        }
    }
    if total > 0.0 {
        let scale = 1.0 / total;
        return (DAffine3 { matrix3: scale * sum.matrix3, translation: scale * sum.translation }, unknown);
    }
    (first.unwrap_or(DAffine3::from_translation(-pose.origin)), unknown)
}

/// `det(m) · m⁻ᵀ`.
pub(super) fn cofactor(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn to_f64(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn influences(joints: [u32; 4], weights: [f32; 4]) -> Influences {
        Influences { joints: vec![vec![joints]], weights: vec![vec![weights]] }
    }

    #[test]
    fn half_and_half_is_the_mean_of_the_joints() {
        let joints = vec![DAffine3::IDENTITY, DAffine3::from_translation(DVec3::new(0.0, 2.0, 0.0))];
        let pose = SkinPose { joints, origin: DVec3::ZERO };
        let mut points = [[1.0, 0.0, 0.0]];
        // Weights that sum to 2 mean the same as those that sum to 1.
        let (mirrored, unknown) = skin(&pose, &influences([0, 1, 0, 0], [1.0, 1.0, 0.0, 0.0]), &mut points, None, None);
        assert_eq!((points[0], mirrored[0], unknown), ([1.0, 1.0, 0.0], false, 0));
    }

    #[test]
    fn normals_stay_perpendicular_under_uneven_scale_and_mirrors() {
        let joints = vec![DAffine3::from_scale(DVec3::new(-4.0, 1.0, 1.0))];
        let pose = SkinPose { joints, origin: DVec3::ZERO };
        let mut points = [[0.0; 3]];
        let s = 0.5_f32.sqrt();
        let (mut normals, mut tangents) = ([[s, s, 0.0]], [[s, -s, 0.0, 1.0]]);
        let one = influences([0; 4], [1.0, 0.0, 0.0, 0.0]);
        let (mirrored, _) = skin(&pose, &one, &mut points, Some(&mut normals), Some(&mut tangents));
        assert!(mirrored[0]);
        let (n, t) = (normals[0], tangents[0]);
        assert!((n[0] * t[0] + n[1] * t[1] + n[2] * t[2]).abs() < 1e-6);
        // The normal of the plane x = −y, moved by (−4, 1, 1), is (−1, 4, 0)/√17.
        assert!((n[0] + 1.0 / 17_f32.sqrt()).abs() < 1e-6 && (n[1] - 4.0 / 17_f32.sqrt()).abs() < 1e-6, "{n:?}");
    }

    #[test]
    fn unknown_joints_are_counted_and_have_no_weight() {
        let pose = SkinPose { joints: vec![DAffine3::IDENTITY], origin: DVec3::ZERO };
        let mut points = [[1.0, 2.0, 3.0]];
        let (_, unknown) = skin(&pose, &influences([0, 9, 0, 0], [0.5, 0.5, 0.0, 0.0]), &mut points, None, None);
        assert_eq!((points[0], unknown), ([1.0, 2.0, 3.0], 1));
    }
}
