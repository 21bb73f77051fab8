//! Sheen of cloth: a layer of microfibers, as a linearly transformed cosine.
//!
//! Tizian Zeltner, Brent Burley and Matt Jen-Yuan Chiang, *Practical Multiple-Scattering Sheen Using Linearly
//! Transformed Cosines*, SIGGRAPH 2022. The table holds the entries A and B of the transform and the
//! albedo, by roughness and cosine; its values are those that Cycles shows, measured by
//! `benches/cycles/sheen_table.py`.

use std::f32::consts::FRAC_1_PI;

use super::lobe::{Drawn, Scatter, Sides, Value};
use crate::math::{Rgb, Vec3, sqr};
use crate::sampling::warp::sample_cosine_hemisphere;

const NODES: usize = 32;

/// A, B and the albedo, each by roughness and cosine from 0 to 1, `f32` in little-endian order.
static TABLE: &[u8; 4 * 3 * NODES * NODES] = include_bytes!("sheen.bin");

/// White sheen, seen from a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct SheenLobe {
    a: f32,
    b: f32,
    albedo: f32,
    /// Unit, the way from the normal to `wo` along the surface.
    along: [f32; 2],
}

impl SheenLobe {
    /// `None` where nothing is scattered.
    pub fn new(roughness: f32, wo: Vec3) -> Option<Self> {
        let [a, b, albedo] = look_up(roughness.clamp(1e-3, 1.0), wo.z.clamp(0.0, 1.0));
        let length = (wo.x * wo.x + wo.y * wo.y).sqrt();
        let along = if length > 0.0 { [wo.x / length, wo.y / length] } else { [1.0, 0.0] };
        (a.abs() > 1e-5 && albedo > 1e-5).then_some(Self { a, b, albedo, along })
    }

    /// Into the frame in which `wo` is in the plane of x and z.
    fn turned(&self, w: Vec3) -> Vec3 {
        let [x, y] = self.along;
        Vec3::new(x * w.x + y * w.y, x * w.y - y * w.x, w.z)
    }

    fn turned_back(&self, w: Vec3) -> Vec3 {
        let [x, y] = self.along;
        Vec3::new(x * w.x - y * w.y, x * w.y + y * w.x, w.z)
    }
}

fn look_up(roughness: f32, cos: f32) -> [f32; 3] {
    let place = |x: f32| {
        let scaled = x * (NODES - 1) as f32;
        let node = (scaled as usize).min(NODES - 2);
        (node, scaled - node as f32)
    };
    let ((j, v), (i, u)) = (place(roughness), place(cos));
    std::array::from_fn(|part| {
        let value = |j: usize, i: usize| {
            let at = 4 * ((part * NODES + j) * NODES + i);
            f32::from_le_bytes([TABLE[at], TABLE[at + 1], TABLE[at + 2], TABLE[at + 3]])
        };
        let row = |j: usize| value(j, i) + u * (value(j, i + 1) - value(j, i));
        row(j) + v * (row(j + 1) - row(j))
    })
}

impl Scatter for SheenLobe {
    fn albedo(&self) -> Sides {
        Sides::above(Rgb::splat(self.albedo))
    }

    fn eval(&self, _wo: Vec3, wi: Vec3) -> Value {
        if wi.z <= 0.0 {
            return Value::default();
        }
        let w = self.turned(wi);
        let length_squared = sqr(self.a * w.x + self.b * w.z) + sqr(self.a * w.y) + sqr(w.z);
        let pdf = FRAC_1_PI * w.z * sqr(self.a / length_squared);
        Value { f_cos: Rgb::splat(self.albedo * pdf), pdf }
    }

    fn sample(&self, _wo: Vec3, _uc: f32, u: [f32; 2]) -> Option<Drawn> {
        let cosine = sample_cosine_hemisphere(u);
        let w = Vec3::new(cosine.x - cosine.z * self.b, cosine.y, cosine.z * self.a).normalize();
        (w.z > 0.0).then(|| Drawn::plain(self.turned_back(w)))
    }
}
