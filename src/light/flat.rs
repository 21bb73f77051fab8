//! What flat lights share: place and sides, the spread of their emission, the way to and from them.

use std::f64::consts::PI;
use std::sync::Arc;

use super::aim::Density;
use super::{EmitterHit, LightBounds, LightSample, Profile, Receiver, Spread, profile};
use crate::math::{Bounds, DMat3, DVec2, DVec3, Rgb, Vec3, gamma, offset_ray_origin};

/// A plane that shines along its local −z. Everything is in `f64`: to a point that a light touches
/// its distance is a difference of nearly equal numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// Middle of the light, render space.
    pub center: DVec3,
    /// Its orthonormal axes in render space; mirrored ones are fine.
    pub axes: DMat3,
    /// Radiance of the surface before spread and profile, W·sr⁻¹·m⁻²; of a textured light the mean.
    pub radiance: Rgb,
    /// The cone into which each point emits.
    pub spread: Spread,
    /// True for a light that emits along local +z, too.
    pub two_sided: bool,
    /// Shaping and decay.
    pub profile: Option<Arc<Profile>>,
}

/// A point before a flat light.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Middle of the light relative to the foot of the point in the light's plane.
    pub center: DVec2,
    /// Distance of the plane, above 0.
    pub h: f64,
    /// Sign of the way to the plane along local z.
    side: f64,
}

impl Flat {
    /// A light of constant `radiance` from one side, without spread or profile.
    pub fn new(center: DVec3, axes: DMat3, radiance: Rgb) -> Self {
        Self { center, axes, radiance, spread: Spread::FULL, two_sided: false, profile: None }
    }

    /// `p` as the light sees it; `None` on a dark side.
    pub(super) fn view(&self, p: Vec3) -> Option<View> {
        let local = self.axes.transpose() * (p.as_dvec3() - self.center);
        let (h, side) = (local.z.abs(), -local.z.signum());
        let lit = h > 0.0 && (side > 0.0 || self.two_sided);
        lit.then(|| View { center: -DVec2::new(local.x, local.y), h, side })
    }

    /// What the point `at` of the plane, relative to the foot of `p`, sends to `p`; `emitted` is the
    /// radiance there.
    pub(super) fn send(&self, p: Vec3, view: &View, at: DVec2, density: Density, emitted: Rgb) -> Option<LightSample> {
        let pdf = density.in_solid_angle(at, view.h) as f32;
        let way = DVec3::new(at.x, at.y, view.side * view.h);
        let dist = way.length();
        let wi = (self.axes * (way / dist)).as_vec3();
        let li = emitted * self.factor(wi, at.length() / view.h, dist as f32);
        if !(pdf.is_finite() && pdf > 0.0) || li.is_black() {
            return None;
        }
        let on_light = self.center + self.axes * (at - view.center).extend(0.0);
        Some(LightSample { li, wi, end: Some(self.end(on_light.as_vec3(), p, view)), pdf, delta: false })
    }

    /// Where a shadow ray to `on_light` ends: before the light by more than rounding has moved
    /// either, and still before the point that asks where the light touches it.
    fn end(&self, on_light: Vec3, p: Vec3, view: &View) -> Vec3 {
        let rounding = gamma(8) * on_light.abs().max_element().max(p.abs().max_element());
        let p_err = Vec3::splat(rounding.min(0.25 * view.h as f32));
        let to_point = (self.axes.z_axis * -view.side).as_vec3();
        offset_ray_origin(on_light, p_err, to_point, to_point)
    }

    /// What the unit direction `wi` to the light, whose angle to the axis has the tangent `tan`, and
    /// the distance make of radiance.
    fn factor(&self, wi: Vec3, tan: f64, dist: f32) -> Rgb {
        let spread = Rgb::splat(self.spread.factor(tan) as f32);
        self.profile.as_ref().map_or(spread, |profile| profile.factor(-wi, dist) * spread)
    }

    /// Where the ray from `p` along the unit direction `wi` meets the plane from a bright side:
    /// distance, and the point in the light's own coordinates.
    pub(super) fn meet(&self, p: Vec3, wi: Vec3) -> Option<(f64, DVec2)> {
        let to_local = self.axes.transpose();
        let (o, d) = (to_local * (p.as_dvec3() - self.center), to_local * wi.as_dvec3());
        let dist = -o.z / d.z;
        let meets = dist > 0.0 && dist.is_finite() && (d.z > 0.0 || self.two_sided);
        meets.then(|| (dist, DVec2::new(o.x + dist * d.x, o.y + dist * d.y)))
    }

    /// A hit at distance `dist`, `uv` in texture coordinates.
    pub(super) fn hit(&self, dist: f64, uv: DVec2) -> EmitterHit {
        let ng = -self.axes.z_axis.as_vec3();
        EmitterHit { dist: dist as f32, ng, triangle: 0, uv: uv.as_vec2().to_array() }
    }

    /// Radiance along `wi` of a light met at `hit`, where it emits `emitted`.
    pub(super) fn le(&self, wi: Vec3, hit: &EmitterHit, emitted: Rgb) -> Rgb {
        let d = self.axes.transpose() * wi.as_dvec3();
        if !(d.z > 0.0 || (self.two_sided && d.z < 0.0)) {
            return Rgb::BLACK;
        }
        emitted * self.factor(wi, d.x.hypot(d.y) / d.z.abs(), hit.dist)
    }

    /// The point in which the direction `wi` from `view` meets the plane, relative to the foot;
    /// `None` where it leads away.
    pub(super) fn along(&self, view: &View, wi: Vec3) -> Option<DVec2> {
        let d = self.axes.transpose() * wi.as_dvec3();
        (d.z * view.side > 0.0).then(|| DVec2::new(d.x, d.y) * (view.h / d.z.abs()))
    }

    /// Bounds of a light of this area whose box reaches `reach` from the middle.
    pub(super) fn light_bounds(&self, area: f64, reach: DVec3) -> LightBounds {
        let (min, max) = ((self.center - reach).as_vec3(), (self.center + reach).as_vec3());
        // Below the true cosine by more than the rounding of cosines near 1 in f32.
        let cos_spread = (self.spread.half_angle().cos() - 1e-5).max(0.0) as f32;
        let bounds = LightBounds {
            bounds: Bounds { min, max },
            axis: -self.axes.z_axis.as_vec3(),
            cos_normals: 1.0,
            cos_emission: cos_spread,
            intensity: (area * self.spread.peak()) as f32 * self.radiance.luminance(),
            two_sided: self.two_sided,
        };
        self.profile.as_ref().map_or(bounds, |profile| profile.bound(bounds))
    }

    /// What a light with `bounds` may bring to `at`.
    pub(super) fn importance(&self, bounds: &LightBounds, at: &Receiver) -> f32 {
        let importance = profile::importance(bounds, self.profile.as_deref(), at);
        if self.profile.is_some() {
            return importance;
        }
        // No surface gets more than π L, however narrow the spread.
        importance.min(PI as f32 * self.radiance.luminance())
    }

    /// Power of a light of this area, W, luminance: `π A L` from each side whatever the spread.
    pub(super) fn power(&self, area: f64) -> f32 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        let Some(profile) = &self.profile else {
            return (sides * PI * area) as f32 * self.radiance.luminance();
        };
        let axis = self.axes.z_axis;
        let mean = profile.mean_weighted(&|w| {
            let cos = -axis.dot(w.as_dvec3());
            let cos = if self.two_sided { cos.abs() } else { cos.max(0.0) };
            let tan = (1.0 - cos * cos).max(0.0).sqrt() / cos;
            if cos > 0.0 { cos * self.spread.factor(tan) } else { 0.0 }
        });
        (4.0 * PI * area) as f32 * (self.radiance * mean).luminance()
    }
}
