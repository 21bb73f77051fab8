//! Orthonormal frames.
//!
//! Tom Duff, James Burgess, Per Christensen, Christophe Hery, Andrew Kensler, Max Liani, Ryusuke
//! Villemin: *Building an Orthonormal Basis, Revisited*, JCGT 6(1), 2017.
//!
//! No frame is continuous over all directions. Theirs turns where a coordinate changes its sign: a line
//! across floors and spheres at which the samples of a pixel fall into two halves, so that noise shows
//! it. Here the turn is a small circle around one direction, and frames twist the less, the farther they
//! are from it: straight down for lights, away from the viewer for surfaces.

use super::{DVec3, Vec3};

/// The frames turn where y falls below this.
const DOWN: f64 = -0.9;

/// Two unit vectors that make a right-handed frame with the unit vector `n`: [`Frame::from_z`] in `f64`.
pub fn orthonormal_pair(n: DVec3) -> (DVec3, DVec3) {
    let sign = if n.y < DOWN { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.y);
    let b = n.z * n.x * a;
    let s = DVec3::new(sign * b, -sign * n.z, 1.0 + sign * n.z * n.z * a);
    (s, DVec3::new(sign + n.x * n.x * a, -n.x, b))
}

/// A right-handed orthonormal frame; local z is `n`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Tangent, local x.
    pub s: Vec3,
    /// Bitangent, local y.
    pub t: Vec3,
    /// Normal, local z.
    pub n: Vec3,
}

impl Frame {
    /// A frame around the unit vector `n`, which varies smoothly with it save at one circle around −y.
    pub fn from_z(n: Vec3) -> Self {
        let sign = if n.y < DOWN as f32 { -1.0 } else { 1.0 };
        let a = -1.0 / (sign + n.y);
        let b = n.z * n.x * a;
        Self {
            s: Vec3::new(sign * b, -sign * n.z, 1.0 + sign * n.z * n.z * a),
            t: Vec3::new(sign + n.x * n.x * a, -n.x, b),
            n,
        }
    }

    /// A frame around the unit vector `n`, which varies smoothly with it save at one circle around
    /// `−view.n`, and is `view` itself at `view.n`: normals that face a viewer twist it least, which keeps
    /// the points of a pixel stratified where normals differ within the pixel.
    pub fn from_z_facing(n: Vec3, view: &Self) -> Self {
        let local = view.to_local(n);
        // As `from_z`, with z for its y.
        let sign = if local.z < DOWN as f32 { -1.0 } else { 1.0 };
        let a = -1.0 / (sign + local.z);
        let b = local.x * local.y * a;
        Self {
            s: view.to_world(Vec3::new(1.0 + sign * local.x * local.x * a, sign * b, -sign * local.x)),
            t: view.to_world(Vec3::new(b, sign + local.y * local.y * a, -local.y)),
            n,
        }
    }

    /// A frame around the unit vector `n` whose x axis lies in the plane of `n` and `tangent`;
    /// as [`Frame::from_z`] where the tangent is null, not finite or parallel to `n`.
    pub fn from_z_and_tangent(n: Vec3, tangent: Vec3) -> Self {
        let s = tangent - n * n.dot(tangent);
        let length_squared = s.length_squared();
        if length_squared.is_finite() && length_squared > 1e-12 * tangent.length_squared() {
            let s = s / length_squared.sqrt();
            Self { s, t: n.cross(s), n }
        } else {
            Self::from_z(n)
        }
    }

    /// World to local.
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world.
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_orthonormal_and_right_handed_everywhere() {
        for i in 0..1000 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 1000.0;
            let r = (1.0 - z * z).sqrt();
            let phi = 2.399_963 * i as f32;
            let n = Vec3::new(r * phi.cos(), r * phi.sin(), z).normalize();
            let unit = n.as_dvec3().normalize();
            let (s, t) = orthonormal_pair(unit);
            assert!((s.cross(t) - unit).length() < 1e-14 && (s.length() - 1.0).abs() < 1e-14);
            let view = Frame::from_z(Vec3::new(0.6, 0.0, 0.8));
            for f in [
                Frame::from_z(n),
                Frame::from_z_facing(n, &view),
                Frame::from_z_and_tangent(n, Vec3::new(0.3, -0.2, 0.9)),
            ] {
                assert!((f.s.cross(f.t) - f.n).length() < 1e-5);
                assert!((f.s.length() - 1.0).abs() < 1e-5 && f.s.dot(f.n).abs() < 1e-5);
                let v = Vec3::new(0.1, -0.7, 0.4);
                assert!((f.to_world(f.to_local(v)) - v).length() < 1e-5);
            }
        }
    }

    #[test]
    fn facing_frames_start_from_the_view_and_vary_smoothly() {
        let view = Frame::from_z_and_tangent(Vec3::new(0.6, 0.0, 0.8), Vec3::Y);
        let same = Frame::from_z_facing(view.n, &view);
        assert!((same.s - view.s).length() < 1e-6 && (same.t - view.t).length() < 1e-6);
        // All around the view's horizon and down to 25 degrees from its back, in steps of a degree.
        for polar in [90.0_f32, 120.0, 154.0] {
            let (sin, cos) = polar.to_radians().sin_cos();
            let at = |degrees: i32| {
                let (y, x) = (degrees as f32).to_radians().sin_cos();
                Frame::from_z_facing(view.to_world(Vec3::new(sin * x, sin * y, cos)), &view)
            };
            for degrees in 0..360 {
                let (a, b) = (at(degrees), at(degrees + 1));
                assert!((a.s - b.s).length() < 0.05, "{polar} {degrees}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_useless_tangent_falls_back() {
        let n = Vec3::Z;
        for t in [Vec3::ZERO, Vec3::Z, Vec3::NAN] {
            assert_eq!(Frame::from_z_and_tangent(n, t), Frame::from_z(n));
        }
    }
}
