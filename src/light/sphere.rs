//! A sphere that emits everywhere, or Cycles' soft falloff: a disk that faces whoever looks.
//!
//! From outside either fills exactly a cone of directions, which is sampled uniformly: of
//! `sin θ_max = r/d` for a sphere, `tan θ_max = r/d` for the disk. Everything is in `f64`: `1 − cos`
//! of the cone of a far sphere, the root of a near one and the point on it cancel in `f32`.
//! From inside the light is all around.

use std::f32::consts::PI;
use std::f64::consts::TAU;
use std::sync::Arc;

use super::{Decay, Emitter, EmitterHit, LightBounds, LightSample, Profile, Receiver, end_before, profile};
use crate::math::{Bounds, DVec3, Frame, Rgb, Vec3, orthonormal_pair};
use crate::sampling::warp;

/// A sphere of constant radiance.
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    /// Render space.
    pub center: Vec3,
    /// Metres, above 0.
    pub radius: f32,
    /// Radiance of its surface, on both sides.
    pub radiance: Rgb,
    /// True for Cycles' soft falloff: a disk of this radius that faces whoever looks.
    pub facing: bool,
    /// Shaping and decay.
    pub profile: Option<Arc<Profile>>,
}

/// The light as seen from a point outside.
struct View {
    /// Unit direction to the centre.
    axis: DVec3,
    /// Distance of the centre.
    d: f64,
    /// `1 − cos` of the half angle of the cone that the light fills.
    height: f64,
}

impl Sphere {
    /// The way from `p` to the centre, and the radius.
    fn seen_from(&self, p: Vec3) -> (DVec3, f64) {
        (self.center.as_dvec3() - p.as_dvec3(), f64::from(self.radius))
    }

    /// `None` from inside of a sphere, or at the very centre of a disk.
    fn view(&self, p: Vec3) -> Option<View> {
        let (to_center, r) = self.seen_from(p);
        let d = to_center.length();
        if d == 0.0 || (!self.facing && d <= r) {
            return None;
        }
        let (sin_squared, cos) = if self.facing {
            let slant = (d * d + r * r).sqrt();
            ((r / slant).powi(2), d / slant)
        } else {
            ((r / d).powi(2), ((d - r) * (d + r)).sqrt() / d)
        };
        Some(View { axis: to_center / d, d, height: sin_squared / (1.0 + cos) })
    }

    /// Distance from `p` along the unit direction `wi` to the near side of the sphere from outside, to
    /// the far side from inside.
    fn distance(&self, p: Vec3, wi: DVec3) -> Option<f64> {
        let (to_center, r) = self.seen_from(p);
        let along = to_center.dot(wi);
        let rest = r * r - (to_center - wi * along).length_squared();
        if rest < 0.0 {
            return None;
        }
        let half_chord = rest.sqrt();
        let d = to_center.length();
        let outside = (d - r) * (d + r);
        // Of the two roots, whose product is `outside`, none by a difference.
        let t = match (outside > 0.0, along > 0.0) {
            (true, true) => outside / (along + half_chord),
            (true, false) => return None,
            (false, true) => along + half_chord,
            (false, false) => outside / (along - half_chord),
        };
        (t > 0.0 && t.is_finite()).then_some(t)
    }

    /// The sample of direction `wi`, whose density is `pdf`, that meets the light after `dist` where
    /// the normal is `ng`.
    fn sample(&self, p: Vec3, wi: DVec3, pdf: f64, dist: f64, ng: DVec3) -> Option<LightSample> {
        let on_light =
            if self.facing { p.as_dvec3() + wi * dist } else { self.center.as_dvec3() + ng * f64::from(self.radius) };
        let (wi, on_light, ng, pdf) = (wi.as_vec3(), on_light.as_vec3(), ng.as_vec3(), pdf as f32);
        let li = self.emitted(wi, dist as f32);
        let possible = pdf.is_finite() && pdf > 0.0 && !li.is_black();
        possible.then(|| LightSample { li, wi, end: Some(end_before(on_light, p, ng, wi, dist)), pdf, delta: false })
    }

    /// Radiance that arrives along `wi` from the distance `dist`.
    fn emitted(&self, wi: Vec3, dist: f32) -> Rgb {
        self.profile.as_ref().map_or(self.radiance, |profile| self.radiance * profile.factor(-wi, dist))
    }

    fn sample_outside(&self, p: Vec3, view: &View, u: [f32; 2]) -> Option<LightSample> {
        let [x, y] = warp::sample_disk(u).map(f64::from);
        let h = (x * x + y * y).min(1.0) * view.height;
        let stretch = (view.height * (2.0 - h)).sqrt();
        let (s, t) = orthonormal_pair(view.axis);
        let wi = (s * x + t * y) * stretch + view.axis * (1.0 - h);
        let pdf = 1.0 / (TAU * view.height);
        if self.facing {
            return self.sample(p, wi, pdf, view.d / (1.0 - h), -view.axis);
        }
        let (along, r) = (view.d * (1.0 - h), f64::from(self.radius));
        let half_chord = (r * r - view.d * view.d * h * (2.0 - h)).max(0.0).sqrt();
        let dist = (view.d - r) * (view.d + r) / (along + half_chord);
        self.sample(p, wi, pdf, dist, self.normal(p, wi, dist))
    }

    /// From inside, by the cosine where the receiver has a side.
    fn sample_inside(&self, at: &Receiver, u: [f32; 2]) -> Option<LightSample> {
        let local = match at.n {
            Some(n) => Frame::from_z(n).to_world(warp::sample_cosine_hemisphere(u)),
            None => warp::sample_uniform_sphere(u),
        };
        let wi = local.as_dvec3().normalize();
        let pdf = pdf_inside(at, wi.as_vec3());
        let dist = self.distance(at.p, wi)?;
        self.sample(at.p, wi, f64::from(pdf), dist, self.normal(at.p, wi, dist))
    }

    /// The normal where a ray along `wi` meets the sphere after `dist`. Times the radius it is the point,
    /// projected onto the sphere.
    fn normal(&self, p: Vec3, wi: DVec3, dist: f64) -> DVec3 {
        (wi * dist - self.seen_from(p).0).normalize()
    }

    fn light_bounds(&self) -> LightBounds {
        let radius = Vec3::splat(self.radius);
        let bounds = LightBounds {
            bounds: Bounds { min: self.center - radius, max: self.center + radius },
            axis: Vec3::Z,
            cos_normals: -1.0,
            cos_emission: 0.0,
            intensity: PI * self.radius * self.radius * self.radiance.luminance(),
            two_sided: false,
        };
        self.profile.as_ref().map_or(bounds, |profile| profile.bound(bounds))
    }
}

fn pdf_inside(at: &Receiver, wi: Vec3) -> f32 {
    at.n.map_or(warp::PDF_UNIFORM_SPHERE, |n| warp::pdf_cosine_hemisphere(n.dot(wi)))
}

impl Emitter for Sphere {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        match self.view(at.p) {
            Some(view) => self.sample_outside(at.p, &view, u),
            None if self.facing => None,
            None => self.sample_inside(at, u),
        }
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        if hit.is_none() {
            return 0.0;
        }
        match self.view(at.p) {
            Some(view) => (1.0 / (TAU * view.height)) as f32,
            None if self.facing => 0.0,
            None => pdf_inside(at, wi),
        }
    }

    fn hit(&self, p: Vec3, wi: Vec3) -> Option<EmitterHit> {
        let wi = wi.as_dvec3().normalize();
        let (t, ng) = if self.facing {
            let (to_center, r) = self.seen_from(p);
            let axis = to_center.try_normalize()?;
            let t = to_center.length() / axis.dot(wi);
            if !(t > 0.0 && (wi * t - to_center).length() <= r) {
                return None;
            }
            (t, -axis)
        } else {
            let t = self.distance(p, wi)?;
            (t, self.normal(p, wi, t))
        };
        Some(EmitterHit { dist: t as f32, ng: ng.as_vec3(), triangle: 0, uv: [0.0; 2] })
    }

    fn le(&self, wi: Vec3, hit: Option<&EmitterHit>) -> Rgb {
        hit.map_or(Rgb::BLACK, |hit| self.emitted(wi, hit.dist))
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.light_bounds())
    }

    fn decay(&self) -> Decay {
        profile::decay(self.profile.as_deref())
    }

    fn importance(&self, at: &Receiver) -> f32 {
        profile::importance(&self.light_bounds(), self.profile.as_deref(), at)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        let mean = self.profile.as_ref().map_or(Rgb::WHITE, |profile| profile.mean());
        4.0 * (PI * self.radius) * (PI * self.radius) * (self.radiance * mean).luminance()
    }
}
