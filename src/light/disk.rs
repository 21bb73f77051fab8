//! An ellipse that shines along its local −z.
//!
//! Points of it are chosen nearly uniformly in solid angle, or by area from afar; of a light with a
//! spread only those in the rectangle around what the receiver may see, or within the receiver's
//! footprint. Texture coordinates are those of the rectangle around it.

use super::aim::{Aim, area_of};
use super::flat::{Flat, View};
use super::{Decay, Emitter, EmitterHit, LightBounds, LightSample, Receiver, profile};
use crate::math::{Bounds, DVec2, Rgb, Vec3};

/// An ellipse.
#[derive(Clone, Debug)]
pub struct Disk {
    flat: Flat,
    /// Half axes along local x and y, metres, above 0.
    half: [f64; 2],
    bounds: LightBounds,
}

impl Disk {
    /// An ellipse with the half axes `half` along local x and y, metres, both above 0.
    pub fn new(flat: Flat, half: [f64; 2]) -> Self {
        let reach = |i: usize| (flat.axes.x_axis[i] * half[0]).hypot(flat.axes.y_axis[i] * half[1]);
        let bounds = flat.light_bounds(area_of(half), [reach(0), reach(1), reach(2)].into());
        Self { flat, half, bounds }
    }

    fn aim(&self, view: &View) -> Option<Aim> {
        Aim::ellipse(view.center, self.half, view.h, &self.flat.spread)
    }

    /// A point of the light's plane in units of the half axes.
    fn scaled(&self, q: DVec2) -> DVec2 {
        q / DVec2::from(self.half)
    }
}

impl Emitter for Disk {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let view = self.flat.view(at.p)?;
        let aim = self.aim(&view)?;
        let (q, density) = aim.sample(u, view.h);
        // A rectangle around the ellipse has corners.
        let window = matches!(aim, Aim::Area { .. } | Aim::SolidAngle { .. });
        if window && self.scaled(q - view.center).length_squared() > 1.0 {
            return None;
        }
        self.flat.send(at.p, &view, q, density, self.flat.radiance)
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
        let q = self.scaled(q);
        (q.length_squared() <= 1.0).then(|| self.flat.hit(dist, 0.5 - 0.5 * q))
    }

    fn le(&self, wi: Vec3, hit: Option<&EmitterHit>) -> Rgb {
        hit.map_or(Rgb::BLACK, |hit| self.flat.le(wi, hit, self.flat.radiance))
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
        self.flat.power(area_of(self.half))
    }
}
