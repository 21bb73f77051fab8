//! From joints to points: linear blend skinning, and dual quaternions with stretch (UsdSkelSkinPoints,
//! UsdSkelSkinNormals; Kavan et al., Geometric Skinning with Approximate Dual Quaternion Blending, 2008).

use crate::math::{DAffine3, DMat3, DQuat, DVec3};

/// How the transforms of joints are blended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    Linear,
    DualQuaternion,
}

/// Joints at a time, ready for points.
pub(super) struct Skin {
    method: Method,
    /// Points as modelled to where they were bound.
    bind: DAffine3,
    bind_normal: DMat3,
    joints: Vec<Joint>,
    /// True where one of them stretches.
    stretches: bool,
}

/// What a joint does to points in the space in which they were bound.
struct Joint {
    matrix: DAffine3,
    /// The same for normals.
    normal: DMat3,
    motion: Motion,
}

/// A joint's matrix in factors: first the stretch, then the turn and shift.
struct Motion {
    stretch: DMat3,
    stretch_normal: DMat3,
    real: DQuat,
    dual: DQuat,
}

impl Skin {
    /// `joints` move points that `bind` takes to where they were bound.
    pub fn new(method: Method, bind: DAffine3, joints: &[DAffine3]) -> Self {
        let joints: Vec<Joint> = joints.iter().map(|&matrix| Joint::new(method, matrix)).collect();
        let stretches = joints.iter().any(|joint| !joint.motion.stretch.abs_diff_eq(DMat3::IDENTITY, 1e-6));
        Self { method, bind, bind_normal: cofactor(bind.matrix3), joints, stretches }
    }

    /// Where a point goes that follows `influences`. As in OpenUSD, weights count as they are, whatever their
    /// sum.
    pub fn point(&self, influences: impl Iterator<Item = (usize, f64)> + Clone, p: DVec3) -> DVec3 {
        let p = self.bind.transform_point3(p);
        let sum = |f: &dyn Fn(&Joint) -> DVec3| influences.clone().map(|(joint, w)| w * f(&self.joints[joint])).sum();
        match self.method {
            Method::Linear => sum(&|joint| joint.matrix.transform_point3(p)),
            Method::DualQuaternion => {
                let p = if self.stretches { sum(&|joint| joint.motion.stretch * p) } else { p };
                let (turn, shift) = self.blend(influences.clone());
                turn * p + shift
            }
        }
    }

    /// The direction that a normal gets; not of unit length.
    pub fn normal(&self, influences: impl Iterator<Item = (usize, f64)> + Clone, n: DVec3) -> DVec3 {
        let n = self.bind_normal * n;
        let sum = |f: &dyn Fn(&Joint) -> DVec3| influences.clone().map(|(joint, w)| w * f(&self.joints[joint])).sum();
        match self.method {
            Method::Linear => sum(&|joint| joint.normal * n),
            Method::DualQuaternion => {
                let n = if self.stretches { sum(&|joint| joint.motion.stretch_normal * n) } else { n };
                self.blend(influences.clone()).0 * n
            }
        }
    }

    /// What all points do that follow the same `influences`.
    pub fn rigid(&self, influences: impl Iterator<Item = (usize, f64)> + Clone) -> DAffine3 {
        let at = |p| self.point(influences.clone(), p);
        let origin = at(DVec3::ZERO);
        let axis = |axis| at(axis) - origin;
        let matrix3 = DMat3::from_cols(axis(DVec3::X), axis(DVec3::Y), axis(DVec3::Z));
        DAffine3 { matrix3, translation: origin }
    }

    /// Turn and shift of the sum of dual quaternions.
    fn blend(&self, influences: impl Iterator<Item = (usize, f64)> + Clone) -> (DMat3, DVec3) {
        let heaviest = influences.clone().fold((0, -1.0), |best, one| if one.1 > best.1 { one } else { best });
        let pivot = self.joints[heaviest.0].motion.real;
        let (mut real, mut dual) = (DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        for (joint, w) in influences {
            let motion = &self.joints[joint].motion;
            // The shorter way round.
            let w = if motion.real.dot(pivot) < 0.0 { -w } else { w };
            real += motion.real * w;
            dual += motion.dual * w;
        }
        let length = real.length();
        if length < 1e-10 {
            return (DMat3::IDENTITY, DVec3::ZERO);
        }
        let (real, dual) = (real / length, dual / length);
        let dual = dual + real * -real.dot(dual);
        let shift = dual * real.conjugate();
        (DMat3::from_quat(real), 2.0 * DVec3::new(shift.x, shift.y, shift.z))
    }
}

impl Joint {
    fn new(method: Method, matrix: DAffine3) -> Self {
        let motion = match method {
            Method::Linear => Motion::of(DAffine3::IDENTITY),
            Method::DualQuaternion => Motion::of(matrix),
        };
        Self { matrix, normal: cofactor(matrix.matrix3), motion }
    }
}

impl Motion {
    fn of(matrix: DAffine3) -> Self {
        let (turn, stretch) = polar(matrix.matrix3);
        let real = DQuat::from_mat3(&turn).normalize();
        let t = matrix.translation;
        let dual = (DQuat::from_xyzw(t.x, t.y, t.z, 0.0) * real) * 0.5;
        Self { stretch, stretch_normal: cofactor(stretch), real, dual }
    }
}

/// What normals need where points need `m`: its inverse transposed, but for singular ones, whose cofactors point
/// the same way.
pub(super) fn cofactor(m: DMat3) -> DMat3 {
    let inverse = m.inverse();
    if inverse.is_finite() {
        return inverse.transpose();
    }
    let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis];
    DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b))
}

/// A proper rotation and the symmetric matrix before it whose product is `m`, by Newton's iteration (Higham,
/// Computing the Polar Decomposition, 1986). A mirrored `m` has a stretch that mirrors.
fn polar(m: DMat3) -> (DMat3, DMat3) {
    let size = m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
    if size == 0.0 || !m.is_finite() {
        return (DMat3::IDENTITY, m);
    }
    // What has no volume has none of the turns about it either: any is right.
    let mut turn = m * (1.0 / size);
    if turn.determinant().abs() < 1e-12 {
        turn += DMat3::from_diagonal(DVec3::splat(1e-6));
    }
    for _ in 0..64 {
        let next = 0.5 * (turn + turn.inverse().transpose());
        if !next.is_finite() {
            return (DMat3::IDENTITY, m);
        }
        let done = next.abs_diff_eq(turn, 1e-15);
        turn = next;
        if done {
            break;
        }
    }
    if turn.determinant() < 0.0 {
        turn = -turn;
    }
    (turn, turn.transpose() * m)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(turn: f64, stretch: DVec3, shift: DVec3) -> DAffine3 {
        let linear = DMat3::from_rotation_z(turn) * DMat3::from_rotation_x(0.4) * DMat3::from_diagonal(stretch);
        DAffine3::from_mat3_translation(linear, shift)
    }

    #[test]
    fn factors_multiply_to_the_matrix() {
        for m in [
            joint(0.7, DVec3::new(1.0, 2.0, 0.5), DVec3::ZERO).matrix3,
            joint(0.7, DVec3::new(-1.0, 2.0, 0.5), DVec3::ZERO).matrix3,
            DMat3::from_cols_array(&[1.0, 0.2, 0.0, 3.0, 1.0, -0.4, 0.1, 0.0, 2.0]),
            DMat3::ZERO,
            joint(0.7, DVec3::new(1.0, 0.0, 0.5), DVec3::ZERO).matrix3,
        ] {
            let (turn, stretch) = polar(m);
            assert!((turn * stretch).abs_diff_eq(m, 1e-12), "{m}");
            assert!((turn.determinant() - 1.0).abs() < 1e-9 && stretch.abs_diff_eq(stretch.transpose(), 1e-5), "{m}");
        }
    }

    /// A joint alone does the same by both methods.
    #[test]
    fn a_joint_alone_is_its_matrix() {
        let matrix = joint(2.0, DVec3::new(1.0, 2.0, 0.5), DVec3::new(3.0, -4.0, 5.0));
        let bind = joint(0.3, DVec3::ONE, DVec3::new(1.0, 0.0, 0.0));
        let p = DVec3::new(0.3, -0.2, 7.0);
        for method in [Method::Linear, Method::DualQuaternion] {
            let skin = Skin::new(method, bind, &[DAffine3::IDENTITY, matrix]);
            let own = || [(1, 1.0)].into_iter();
            assert!(skin.point(own(), p).abs_diff_eq((matrix * bind).transform_point3(p), 1e-12));
            assert!(skin.rigid(own()).abs_diff_eq(matrix * bind, 1e-11));
            let tangent = (matrix * bind).transform_vector3(DVec3::X);
            assert!(skin.normal(own(), DVec3::Y).dot(tangent).abs() < 1e-12);
        }
    }

    /// Half of a half turn is a quarter turn, where the linear blend shrinks to a line.
    #[test]
    fn dual_quaternions_keep_the_volume() {
        let half = DAffine3::from_mat3(DMat3::from_rotation_x(std::f64::consts::PI));
        let both = || [(0, 0.5), (1, 0.5)].into_iter();
        let at = |method| Skin::new(method, DAffine3::IDENTITY, &[DAffine3::IDENTITY, half]).point(both(), DVec3::Y);
        assert!(at(Method::Linear).length() < 1e-12);
        let turned = at(Method::DualQuaternion);
        assert!((turned.length() - 1.0).abs() < 1e-12 && turned.y.abs() < 1e-12, "{turned}");
    }
}
