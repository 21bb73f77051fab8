//! A rectangle that shines along its local −z.
//!
//! Points of it are chosen uniformly in solid angle, or by area from afar; of a light with a spread
//! only those from which the receiver is within the cone.
//!
//! Texture coordinates are those of a viewer whom the light shines at, local +y up: u grows to the
//! viewer's right, along local −x; v grows downwards, from 0 at the top, along local −y.

use std::sync::Arc;

use super::aim::Aim;
use super::flat::{Flat, View};
use super::{Decay, Emission, Emitter, EmitterHit, LightBounds, LightSample, Receiver, profile};
use crate::math::{Bounds, DVec2, Rgb, Vec3};

/// A rectangle.
#[derive(Clone, Debug)]
pub struct Rect {
    flat: Flat,
    /// Half of its size along local x and y, metres, above 0.
    half: [f64; 2],
    /// Radiance where it varies.
    texture: Option<Arc<dyn Emission>>,
    bounds: LightBounds,
}

impl Rect {
    /// A rectangle with half the sizes `half` along local x and y, metres, both above 0.
    pub fn new(flat: Flat, half: [f64; 2]) -> Self {
        let reach = flat.axes.x_axis.abs() * half[0] + flat.axes.y_axis.abs() * half[1];
        let bounds = flat.light_bounds(4.0 * half[0] * half[1], reach);
        Self { flat, half, texture: None, bounds }
    }

    /// With radiance that varies, instead of that of `flat`.
    pub fn textured(self, texture: Arc<dyn Emission>) -> Self {
        let flat = Flat { radiance: texture.mean(0), ..self.flat };
        Self { texture: Some(texture), ..Self::new(flat, self.half) }
    }

    fn aim(&self, view: &View) -> Option<Aim> {
        Aim::rect(view.center, self.half, view.h, &self.flat.spread)
    }

    /// Texture coordinates of the point `q` of the light's plane.
    fn uv(&self, q: DVec2) -> DVec2 {
        0.5 - 0.5 * q / DVec2::from(self.half)
    }

    fn emitted(&self, uv: [f32; 2]) -> Rgb {
        self.texture.as_ref().map_or(self.flat.radiance, |texture| texture.radiance(0, uv))
    }
}

impl Emitter for Rect {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let view = self.flat.view(at.p)?;
        let (q, density) = self.aim(&view)?.sample(u, view.h);
        let uv = self.uv(q - view.center);
        self.flat.send(at.p, &view, q, density, self.emitted(uv.as_vec2().to_array()))
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let pdf = || {
            let view = hit.and(self.flat.view(at.p))?;
            Some(self.aim(&view)?.pdf(self.flat.along(&view, wi)?, view.h) as f32)
        };
        pdf().filter(|pdf| pdf.is_finite()).unwrap_or(0.0)
    }

    fn hit(&self, p: Vec3, wi: Vec3) -> Option<EmitterHit> {
        let (dist, q) = self.flat.meet(p, wi)?;
        let inside = q.x.abs() <= self.half[0] && q.y.abs() <= self.half[1];
        inside.then(|| self.flat.hit(dist, self.uv(q)))
    }

    fn le(&self, wi: Vec3, hit: Option<&EmitterHit>) -> Rgb {
        hit.map_or(Rgb::BLACK, |hit| self.flat.le(wi, hit, self.emitted(hit.uv)))
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.bounds)
    }

    fn decay(&self) -> Decay {
        profile::decay(self.flat.profile.as_deref())
    }

    fn importance(&self, at: &Receiver) -> f32 {
        self.flat.importance(&self.bounds, at)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        self.flat.power(4.0 * self.half[0] * self.half[1])
    }
}
