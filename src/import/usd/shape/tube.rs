//! Tubes and ribbons along a line of joints.

use std::f32::consts::TAU;

use crate::math::Vec3;

/// Where a curve passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Joint {
    pub center: Vec3,
    /// Direction, of any length.
    pub tangent: Vec3,
    pub radius: f32,
    /// What a ribbon faces.
    pub facing: Option<Vec3>,
    /// Where along the curve: a segment, and how far into it.
    pub at: (u32, f32),
}

/// Tubes and ribbons of one prim.
#[derive(Default)]
pub(super) struct Tubes {
    pub points: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Curve and place along it of each point.
    pub origins: Vec<(u32, (u32, f32))>,
}

impl Tubes {
    /// A ribbon where the joints face somewhere, otherwise a tube of `sides` sides.
    pub fn push(&mut self, curve: u32, joints: &[Joint], closed: bool, sides: u32) {
        if joints.len() < 2 {
            return;
        }
        if joints[0].facing.is_some() {
            self.ribbon(curve, joints, closed)
        } else {
            self.tube(curve, joints, closed, sides)
        }
    }

    fn point(&mut self, curve: u32, joint: &Joint, offset: Vec3, normal: Vec3) {
        self.points.push((joint.center + offset).into());
        self.normals.push(normal.into());
        self.origins.push((curve, joint.at));
    }

    fn ribbon(&mut self, curve: u32, joints: &[Joint], closed: bool) {
        let first = self.points.len() as u32;
        for joint in joints {
            let normal = joint.facing.unwrap_or(Vec3::Z).normalize_or(Vec3::Z);
            let side = normal.cross(joint.tangent).normalize_or(Vec3::X) * joint.radius;
            self.point(curve, joint, -side, normal);
            self.point(curve, joint, side, normal);
        }
        let count = joints.len() as u32;
        for i in 0..count - u32::from(!closed) {
            let (a, b) = (first + 2 * i, first + 2 * ((i + 1) % count));
            self.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
        }
    }

    fn tube(&mut self, curve: u32, joints: &[Joint], closed: bool, sides: u32) {
        let first = self.points.len() as u32;
        let count = joints.len() as u32;
        let mut frame = Vec3::ZERO;
        for (i, joint) in joints.iter().enumerate() {
            let tangent = joint.tangent.normalize_or(Vec3::Z);
            frame = match i.checked_sub(1).and_then(|i| joints.get(i)) {
                Some(before) => turn_on(before, joint, frame),
                None => tangent.any_orthonormal_vector(),
            };
            // Turned into the plane of the ring again: rounding adds up along a curve.
            frame = (frame - tangent * tangent.dot(frame))
                .try_normalize()
                .unwrap_or_else(|| tangent.any_orthonormal_vector());
            let side = tangent.cross(frame);
            let slope = slope(joints, i, closed);
            for k in 0..sides {
                let (sin, cos) = (TAU * k as f32 / sides as f32).sin_cos();
                let out = frame * cos + side * sin;
                self.point(curve, joint, out * joint.radius, (out - tangent * slope).normalize());
            }
        }
        let ring = |i: u32, k: u32| first + (i % count) * sides + k % sides;
        for i in 0..count - u32::from(!closed) {
            for k in 0..sides {
                let [a, b, c, d] = [ring(i, k), ring(i, k + 1), ring(i + 1, k + 1), ring(i + 1, k)];
                self.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        if !closed {
            self.cap(curve, &joints[0], first, sides, true);
            self.cap(curve, &joints[joints.len() - 1], ring(count - 1, 0), sides, false);
        }
    }

    /// Closes the end whose ring starts at point `ring`.
    fn cap(&mut self, curve: u32, joint: &Joint, ring: u32, sides: u32, is_start: bool) {
        if joint.radius <= 0.0 {
            return;
        }
        let out = joint.tangent.normalize_or(Vec3::Z) * if is_start { -1.0 } else { 1.0 };
        let first = self.points.len() as u32;
        for k in ring..ring + sides {
            self.points.push(self.points[k as usize]);
            self.normals.push(out.into());
            self.origins.push((curve, joint.at));
        }
        for k in 1..sides - 1 {
            let (a, b) = (first + k, first + k + 1);
            self.triangles.push(if is_start { [first, b, a] } else { [first, a, b] });
        }
    }
}

/// How fast the radius grows along the curve.
fn slope(joints: &[Joint], i: usize, closed: bool) -> f32 {
    let n = joints.len();
    let (a, b) = match closed {
        true => ((i + n - 1) % n, (i + 1) % n),
        false => (i.saturating_sub(1), (i + 1).min(n - 1)),
    };
    let length = joints[a].center.distance(joints[i].center) + joints[i].center.distance(joints[b].center);
    if length > 0.0 { (joints[b].radius - joints[a].radius) / length } else { 0.0 }
}

/// Carries a frame from joint to joint without twist (W. Wang et al., "Computation of rotation minimizing
/// frames", 2008: two reflections).
fn turn_on(from: &Joint, to: &Joint, frame: Vec3) -> Vec3 {
    let reflect = |v: Vec3, along: Vec3| {
        let square = along.length_squared();
        if square > 0.0 { v - along * (2.0 * along.dot(v) / square) } else { v }
    };
    let step = to.center - from.center;
    let before = reflect(from.tangent.normalize_or(Vec3::Z), step);
    reflect(reflect(frame, step), to.tangent.normalize_or(Vec3::Z) - before)
}
