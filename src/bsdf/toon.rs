//! Toon shading: light within a cone about the normal, or about the mirror direction, with an edge.

use std::f32::consts::FRAC_PI_2;

use super::lobe::{Drawn, Scatter, Sides, Value};
use super::reflection::mirrored;
use crate::math::{Frame, Rgb, Vec3, safe_acos};
use crate::sampling::warp::{pdf_cone, sample_cone};

/// White within, with the cone's energy spread over it: not more is reflected the wider it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Toon {
    /// Angle up to which it is full, and the width of the edge.
    size: f32,
    smooth: f32,
    /// 1 − cos of the whole cone.
    one_minus_cos: f32,
    /// About the mirror direction instead of the normal.
    glossy: bool,
}

impl Toon {
    /// With `size` and `smooth` as shares of a right angle.
    pub fn new(size: f32, smooth: f32, glossy: bool) -> Self {
        let size = size.clamp(1e-5, 1.0) * FRAC_PI_2;
        let smooth = smooth.clamp(0.0, 1.0) * FRAC_PI_2;
        let half = 0.5 * (size + smooth).min(FRAC_PI_2);
        Self { size, smooth, one_minus_cos: 2.0 * half.sin() * half.sin(), glossy }
    }

    fn axis(&self, wo: Vec3) -> Vec3 {
        if self.glossy { mirrored(wo) } else { Vec3::Z }
    }
}

impl Scatter for Toon {
    fn albedo(&self) -> Sides {
        // Full, less half of the edge.
        let edge = (self.size + self.smooth).min(FRAC_PI_2) - self.size;
        let share = |angle: f32| (1.0 - angle.cos()) / self.one_minus_cos;
        let full = share(self.size.min(FRAC_PI_2));
        Sides::above(Rgb::splat((full + 0.5 * if edge > 0.0 { 1.0 - full } else { 0.0 }).clamp(0.05, 1.0)))
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> Value {
        let cos = self.axis(wo).dot(wi);
        if wi.z <= 0.0 || 1.0 - cos >= self.one_minus_cos {
            return Value::default();
        }
        let angle = safe_acos(cos);
        let pdf = pdf_cone(self.one_minus_cos);
        let edge = if angle < self.size { 1.0 } else { (1.0 - (angle - self.size) / self.smooth).max(0.0) };
        Value { f_cos: Rgb::splat(pdf * edge), pdf }
    }

    fn sample(&self, wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        let wi = Frame::from_z(self.axis(wo)).to_world(sample_cone(u, self.one_minus_cos));
        (wi.z > 0.0).then(|| Drawn::plain(wi))
    }
}
