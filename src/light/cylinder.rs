//! A tube that emits from its lateral surface, outward (UsdLux CylinderLight).
//!
//! From a point at distance `ρ > r` from the axis, choose the azimuth `φ` in the plane across the axis
//! between the two tangents, `sin φ_max = r/ρ`: it meets the tube at distance `s(φ)`. Along the line of
//! the surface that stands there, choose the sine of the elevation uniformly between those of its ends:
//! since `dω = cos ψ dψ dφ = d(sin ψ) dφ`, the density in solid angle is `q(φ) / W(φ)` with
//! `W = sin ψ₁ − sin ψ₀`. Every direction that sees the tube is chosen, no other, and where `W` does not
//! vary, as far from the tube or close to its middle, the density is constant.

mod azimuth;

use std::f32::consts::PI;
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

use azimuth::Azimuth;

use super::{Decay, Emitter, EmitterHit, LightBounds, LightSample, Profile, Receiver, end_before, profile};
use crate::math::{Bounds, DVec3, Rgb, Vec3};

/// A tube of constant radiance, open at both ends and black inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Cylinder {
    center: DVec3,
    /// Unit.
    axis: DVec3,
    radius: f64,
    half_length: f64,
    radiance: Rgb,
    profile: Option<Arc<Profile>>,
    bounds: LightBounds,
    power: f32,
}

/// The tube as seen from a point outside.
struct View {
    /// Unit vector across the axis, towards it.
    e: DVec3,
    /// Across both.
    f: DVec3,
    /// Distance from the axis.
    rho: f64,
    /// `ρ² − r²`.
    power: f64,
    /// Where the ends are along the axis, from the point.
    ends: [f64; 2],
    r: f64,
}

/// Squares of what comes from `f32` stay within the range of `f64`.
fn hypotenuse(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

impl View {
    /// Distance in the plane across the axis at which azimuth `φ` with these sine and cosine meets the tube.
    fn reach(&self, sin: f64, cos: f64) -> f64 {
        let across = self.rho * sin;
        self.power / (self.rho * cos + ((self.r - across) * (self.r + across)).max(0.0).sqrt())
    }

    /// Differences of 1 and the sine of the elevation of each end, `[1 + sin ψ₀, 1 − sin ψ₁]`, at distance `s`.
    fn beyond(&self, s: f64) -> [f64; 2] {
        let one_minus_sin = |x: f64| {
            let h = hypotenuse(x, s);
            if x > 0.0 { s * s / (h * (h + x)) } else { 1.0 - x / h }
        };
        [one_minus_sin(-self.ends[0]), one_minus_sin(self.ends[1])]
    }

    /// `W`, the difference of the sines of the elevations of the ends, at distance `s`.
    fn width(&self, s: f64) -> f64 {
        let [x0, x1] = self.ends;
        let [h0, h1] = self.ends.map(|x| hypotenuse(x, s));
        if x0 * x1 > 0.0 {
            // Both above or both below: their difference, rationalised.
            s * s * (x1 - x0) * (x1 + x0) / (h0 * h1 * (x1 * h0 + x0 * h1))
        } else {
            x1 / h1 - x0 / h0
        }
    }

    fn azimuth(&self) -> Azimuth {
        let phi_max = self.r.atan2(self.power.sqrt());
        Azimuth::new(phi_max, |phi| {
            let (sin, cos) = phi.sin_cos();
            self.width(self.reach(sin, cos))
        })
    }

    /// Position along the axis, from the point, whose elevation at distance `s` has a sine at the share
    /// `u` of the way between those of the ends.
    fn along(&self, s: f64, u: f64) -> f64 {
        let [below, above] = self.beyond(s);
        let width = self.width(s);
        let (from_below, from_above) = (below + u * width, above + (1.0 - u) * width);
        // From the end of the axis that is nearer, so that steep directions keep their digits.
        let (rest, sign) = if from_below < from_above { (from_below, -1.0) } else { (from_above, 1.0) };
        let x = sign * s * (1.0 - rest) / (rest * (2.0 - rest)).sqrt();
        if x.is_finite() { x.clamp(self.ends[0], self.ends[1]) } else { 0.5 * (self.ends[0] + self.ends[1]) }
    }
}

impl Cylinder {
    /// A tube around the unit vector `axis`, render space and metres; `radius` and `length` above 0.
    pub fn new(
        center: Vec3,
        axis: Vec3,
        radius: f32,
        length: f32,
        radiance: Rgb,
        profile: Option<Arc<Profile>>,
    ) -> Self {
        let axis = axis.as_dvec3().normalize();
        let across = axis.to_array().map(|a| f64::from(radius) * (1.0 - a * a).max(0.0).sqrt());
        let reach = (axis.abs() * 0.5 * f64::from(length) + DVec3::from(across)).as_vec3();
        let luminance = radiance.luminance();
        let bounds = LightBounds {
            bounds: Bounds { min: center - reach, max: center + reach },
            axis: Vec3::Z,
            cos_normals: -1.0,
            cos_emission: 0.0,
            intensity: 2.0 * radius * length * luminance,
            two_sided: false,
        };
        // Seen at an angle to the axis it is as large as the sine of it, in the mean π/4.
        let weight = |w: Vec3| 4.0 * FRAC_1_PI * axis.cross(w.as_dvec3()).length();
        let mean = profile.as_ref().map_or(Rgb::WHITE, |profile| profile.mean_weighted(&weight));
        Self {
            center: center.as_dvec3(),
            axis,
            radius: f64::from(radius),
            half_length: 0.5 * f64::from(length),
            radiance,
            bounds: profile.as_ref().map_or(bounds, |profile| profile.bound(bounds)),
            power: 2.0 * PI * radius * length * PI * (radiance * mean).luminance(),
            profile,
        }
    }

    /// `None` from within the tube or its extension, where only its black inside could be seen.
    fn view(&self, p: Vec3) -> Option<View> {
        let from_center = p.as_dvec3() - self.center;
        let x = from_center.dot(self.axis);
        let out = from_center - self.axis * x;
        let (rho, r) = (out.length(), self.radius);
        if rho <= r {
            return None;
        }
        let e = -out / rho;
        let ends = [-self.half_length - x, self.half_length - x];
        Some(View { e, f: self.axis.cross(e), rho, power: (rho - r) * (rho + r), ends, r })
    }

    /// Radiance that arrives along `wi` from the distance `dist`.
    fn emitted(&self, wi: Vec3, dist: f32) -> Rgb {
        self.profile.as_ref().map_or(self.radiance, |profile| self.radiance * profile.factor(-wi, dist))
    }
}

impl Emitter for Cylinder {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let view = self.view(at.p)?;
        let (phi, q) = view.azimuth().sample(f64::from(u[0]));
        let (sin, cos) = phi.sin_cos();
        let s = view.reach(sin, cos);
        let x = view.along(s, f64::from(u[1]));
        let pdf = (q / view.width(s)) as f32;
        let across = (view.e * cos + view.f * sin) * s;
        let to_light = self.axis * x + across;
        let dist = to_light.length();
        let wi = (to_light / dist).as_vec3();
        let li = self.emitted(wi, dist as f32);
        if !(pdf.is_finite() && pdf > 0.0) || li.is_black() {
            return None;
        }
        let ng = (across - view.e * view.rho).normalize();
        let on_light = self.center + self.axis * (x + self.half_length - view.ends[1]) + ng * self.radius;
        let end = Some(end_before(on_light.as_vec3(), at.p, ng.as_vec3(), wi, dist));
        Some(LightSample { li, wi, end, pdf, delta: false })
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let (Some(view), Some(_)) = (self.view(at.p), hit) else { return 0.0 };
        let wi = wi.as_dvec3();
        let phi = wi.dot(view.f).atan2(wi.dot(view.e));
        let (phi, q) = view.azimuth().pdf(phi);
        let (sin, cos) = phi.sin_cos();
        let pdf = (q / view.width(view.reach(sin, cos))) as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn hit(&self, p: Vec3, wi: Vec3) -> Option<EmitterHit> {
        let view = self.view(p)?;
        let wi = wi.as_dvec3().normalize();
        let (towards, sideways) = (wi.dot(view.e), wi.dot(view.f));
        // In the plane across: the unit direction's distance from the axis, and the near root.
        let length = hypotenuse(towards, sideways);
        if towards <= 0.0 {
            return None;
        }
        let (sin, cos) = (sideways / length, towards / length);
        if view.rho * sin.abs() > view.r {
            return None;
        }
        let s = view.reach(sin, cos);
        let t = s / length;
        let x = wi.dot(self.axis) * t;
        if !(t.is_finite() && (view.ends[0]..=view.ends[1]).contains(&x)) {
            return None;
        }
        let ng = ((view.e * cos + view.f * sin) * s - view.e * view.rho).normalize();
        Some(EmitterHit { dist: t as f32, ng: ng.as_vec3(), triangle: 0, uv: [0.0; 2] })
    }

    fn le(&self, wi: Vec3, hit: Option<&EmitterHit>) -> Rgb {
        hit.map_or(Rgb::BLACK, |hit| self.emitted(wi, hit.dist))
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.bounds)
    }

    fn decay(&self) -> Decay {
        profile::decay(self.profile.as_deref())
    }

    fn importance(&self, at: &Receiver) -> f32 {
        profile::importance(&self.bounds, self.profile.as_deref(), at)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        self.power
    }
}
