//! Ribbons along a line of joints.

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

/// The ribbons of one prim.
#[derive(Default)]
pub(super) struct Ribbons {
    pub points: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Curve and place along it of each point.
    pub origins: Vec<(u32, (u32, f32))>,
}

impl Ribbons {
    fn point(&mut self, curve: u32, joint: &Joint, offset: Vec3, normal: Vec3) {
        self.points.push((joint.center + offset).into());
        self.normals.push(normal.into());
        self.origins.push((curve, joint.at));
    }

    /// The ribbon of `curve`, which faces what its joints face.
    pub fn push(&mut self, curve: u32, joints: &[Joint], closed: bool) {
        if joints.len() < 2 {
            return;
        }
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
}
