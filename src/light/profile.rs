//! How the emission of a local light varies with direction and distance: cone, focus, measured
//! distribution, decay.

mod cone;
mod decay;
mod drawn;
mod ies;
mod quadrature;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use cone::{OffAxis, keeps_angles, stretched_half};

use super::{LightBounds, Receiver};
use crate::math::{Bounds, DMat3, DVec3, Rgb, Vec3};

pub use cone::Cone;
pub use decay::{Decay, Falloff};
pub use drawn::Drawn;
pub use ies::Ies;

/// Cosine of the angle by which the light tree may be off at the rim of a cone: sines that come from
/// the cosines of small angles in `f32` are that far from the truth.
const RIM: f32 = 1.0 - 1e-5;

/// Half angle in radians of the widest cone that tells where a shape shines better than its normals.
const NARROW: f64 = PI / 3.0;

/// Half angle in radians of the cone of normals that a flat shape has at most: its cosine is rounded down.
const FLAT: f64 = 6e-3;

/// Planes through the axis of what is not the same all around, in quadrature.
const AZIMUTHS: usize = 96;

/// How emission varies with direction; the axis is local −z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shaping {
    /// A cone outside of which there is no light.
    pub cone: Option<Cone>,
    /// Light to render space with its scale, for a cone that the scale distorts (Cycles' spot); not
    /// singular, of the order of 1.
    pub stretch: Option<DMat3>,
    /// UsdLux focus: the factor `|cos θ|^focus`; 0 for none.
    pub focus: f64,
    /// UsdLux focus tint: the colour that the factor fades to.
    pub focus_tint: [f64; 3],
    /// A measured distribution.
    pub ies: Option<Ies>,
    /// A factor by direction and distance on top of all that.
    pub drawn: Option<Drawn>,
}

/// Shaping and decay of one light; lights that have neither hold none.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    shaping: Shaping,
    decay: Decay,
    /// Render space to the light's, orthonormal.
    to_local: DMat3,
    /// Render space to the one in which the cone is round.
    to_cone: DMat3,
    /// Unit axis in render space of a cone that holds all the light.
    axis: Vec3,
    /// Half angle of that cone, radians.
    half: f64,
    /// Cosine of a half angle that is more than rounding above it.
    cos_half: f32,
    peak: Rgb,
    mean: Rgb,
}

impl Profile {
    /// The profile of a light whose orthonormal axes in render space are the columns of `axes`.
    pub fn new(axes: DMat3, shaping: Shaping, decay: Decay) -> Self {
        let to_local = axes.transpose();
        let stretch = shaping.stretch.filter(|&m| shaping.cone.is_some() && !keeps_angles(m));
        let shaping = Shaping { stretch, ..shaping };
        let to_cone = stretch.map_or(to_local, |m| m.inverse());
        let mut profile = Self {
            to_local,
            to_cone,
            axis: -axes.z_axis.as_vec3(),
            half: PI,
            cos_half: -1.0,
            peak: shaping.peak(),
            mean: Rgb::WHITE,
            shaping,
            decay,
        };
        profile.find_cone(axes);
        profile.cos_half = (profile.half + 1e-6).min(PI).cos() as f32;
        if let Some(drawn) = &profile.shaping.drawn {
            profile.peak *= drawn.peak(profile.axis, profile.half);
        }
        let uneven = stretch.is_some() || profile.shaping.drawn.is_some();
        profile.mean = profile.mean_over(if uneven { AZIMUTHS } else { 1 }, &|_| 1.0);
        profile
    }

    /// The smallest cone around the light's axis, to either side, that holds what the shaping leaves.
    fn find_cone(&mut self, axes: DMat3) {
        let shaping = &self.shaping;
        let (mut from, mut to) = (0.0_f64, PI);
        if let Some([low, high]) = shaping.ies.as_ref().map(Ies::support) {
            (from, to) = (from.max(low), to.min(high));
        }
        let cone = shaping.cone.as_ref().map_or(PI, Cone::half);
        if shaping.stretch.is_none() {
            to = to.min(cone);
        }
        if from >= to {
            (self.half, self.peak) = (0.0, Rgb::BLACK);
            return;
        }
        (self.axis, self.half) =
            if PI - from < to { (axes.z_axis.as_vec3(), PI - from) } else { (-axes.z_axis.as_vec3(), to) };
        if let Some(stretch) = shaping.stretch {
            let half = stretched_half(stretch, cone);
            if half < self.half {
                (self.axis, self.half) = (-stretch.z_axis.normalize().as_vec3(), half);
            }
        }
    }

    /// The factor of what leaves the light along the unit direction `w` and arrives after `dist` metres.
    pub fn factor(&self, w: Vec3, dist: f32) -> Rgb {
        let decay = Rgb::splat(self.decay.factor(f64::from(dist)) as f32);
        if self.shaping.is_even() { decay } else { decay * self.shape_at(w.as_dvec3(), dist, false) }
    }

    /// The factor of direction `w`, unit or not, without decay, a metre away; `averaged` takes the mean of a measured
    /// distribution over all azimuths.
    pub(super) fn shape(&self, w: DVec3, averaged: bool) -> Rgb {
        self.shape_at(w, 1.0, averaged)
    }

    fn shape_at(&self, w: DVec3, dist: f32, averaged: bool) -> Rgb {
        let shape = self.round_shape(w, averaged);
        match &self.shaping.drawn {
            Some(drawn) if !shape.is_black() => shape * drawn.factor(w, dist),
            _ => shape,
        }
    }

    /// All but what is drawn.
    fn round_shape(&self, w: DVec3, averaged: bool) -> Rgb {
        let shaping = &self.shaping;
        let mut factor = 1.0;
        if let Some(cone) = &shaping.cone {
            factor *= cone.factor(OffAxis::new(self.to_cone * w));
            if factor == 0.0 {
                return Rgb::BLACK;
            }
        }
        if shaping.ies.is_none() && shaping.focus == 0.0 {
            return Rgb::splat(factor as f32);
        }
        let local = self.to_local * w;
        let off_axis = OffAxis::new(local);
        if let Some(ies) = &shaping.ies {
            let theta = off_axis.theta();
            factor *= if averaged { ies.mean_factor(theta) } else { ies.factor(theta, local.y.atan2(local.x)) };
        }
        if shaping.focus == 0.0 {
            return Rgb::splat(factor as f32);
        }
        let focus = off_axis.cos.abs().powf(shaping.focus);
        Rgb::from(shaping.focus_tint.map(|tint| factor * (tint + (1.0 - tint) * focus)))
    }

    /// Largest factor of any direction, without decay.
    pub fn peak(&self) -> Rgb {
        self.peak
    }

    /// Mean factor over all directions, without decay.
    pub fn mean(&self) -> Rgb {
        self.mean
    }

    /// Mean over all directions `w` of the factor times `weight(w)`, without decay: for lights that do
    /// not shine the same all around.
    pub fn mean_weighted(&self, weight: &dyn Fn(Vec3) -> f64) -> Rgb {
        self.mean_over(AZIMUTHS, weight)
    }

    /// Unit axis and half angle in radians of a cone outside of which there is no light.
    pub fn cone(&self) -> (Vec3, f64) {
        (self.axis, self.half)
    }

    /// A bound from above of the decay at distances of `near` to `far` metres.
    pub fn decay_at_most(&self, near: f32, far: f32) -> f32 {
        self.decay.at_most(f64::from(near), f64::from(far)).min(f64::from(f32::MAX)) as f32
    }

    /// The bounds of a light that has this profile, given those that it has without.
    pub fn bound(&self, of: LightBounds) -> LightBounds {
        let mut bounds = LightBounds { intensity: (of.intensity * self.peak.max_component()).min(f32::MAX), ..of };
        if of.cos_normals <= -1.0 && self.half < PI {
            // What shines everywhere alike shines into the cone alike.
            (bounds.axis, bounds.cos_normals, bounds.cos_emission) = (self.axis, self.cos_half, RIM);
            bounds.two_sided = false;
        } else if of.cos_normals >= 1.0 && !of.two_sided && of.axis.dot(self.axis) > RIM {
            bounds.cos_emission = of.cos_emission.max(self.cos_half - 1e-5);
        }
        bounds
    }

    /// False where none of what leaves a shape within `bounds` can arrive at `p`.
    pub fn reaches(&self, bounds: Bounds, p: Vec3) -> bool {
        let from_center = (p - bounds.center()).as_dvec3();
        let (dist, radius) = (from_center.length(), f64::from(bounds.radius()));
        if dist <= radius {
            return true;
        }
        // Directions to the point from all of the ball around the shape.
        let off_axis = (from_center.dot(self.axis.as_dvec3()) / dist).clamp(-1.0, 1.0).acos();
        off_axis - (radius / dist).asin() <= self.half + 1e-3
    }

    /// The bounds of a shape whose primitives have this profile, given those that it has without.
    pub fn bound_shape(&self, of: LightBounds) -> LightBounds {
        if self.half < NARROW {
            // Tells more than the normals do.
            return self.bound(LightBounds { cos_normals: -1.0, ..of });
        }
        let off = f64::from(of.axis.dot(self.axis).abs().min(1.0)).acos();
        let normals = f64::from(of.cos_normals.clamp(-1.0, 1.0)).acos();
        let back_is_dark = self.half + off + normals < FRAC_PI_2 + FLAT;
        let axis = if of.axis.dot(self.axis) < 0.0 && back_is_dark { -of.axis } else { of.axis };
        self.bound(LightBounds { axis, two_sided: of.two_sided && !back_is_dark, ..of })
    }

    /// Mean over the sphere of directions, over `azimuths` planes through the axis; one is for a light
    /// that is the same all around.
    fn mean_over(&self, azimuths: usize, weight: &dyn Fn(Vec3) -> f64) -> Rgb {
        // Directions v around the cone's own axis, so that its edge lies between steps. They become
        // those of render space, w = M v, whose solid angle is |det M| / |w|³ of theirs.
        let to_render = self.to_cone.inverse();
        let volume = to_render.determinant().abs();
        let edges = self.edges();
        let mut sum = DVec3::ZERO;
        for (theta, step) in edges.windows(2).flat_map(|step| quadrature::nodes(step[0], step[1])) {
            let (sin, cos) = theta.sin_cos();
            for azimuth in 0..azimuths {
                let (sin_phi, cos_phi) = (TAU * (azimuth as f64 + 0.5) / azimuths as f64).sin_cos();
                let w = to_render * DVec3::new(sin * cos_phi, sin * sin_phi, -cos);
                let length = w.length();
                let w = w / length;
                let density = 0.5 * sin * step * volume / (length * length * length);
                let factor = self.shape(w, azimuths == 1).to_array().map(f64::from);
                sum += DVec3::from(factor) * (weight(w.as_vec3()) * density);
            }
        }
        Rgb::from((sum / azimuths as f64).to_array())
    }

    /// Angles off the axis, growing from 0 to π, between which the factor is smooth.
    fn edges(&self) -> Vec<f64> {
        // A focus can be sharp: steps that halve towards the axis see it, on both sides.
        let near = (0..12).map(|k| FRAC_PI_2 / f64::from(1 << k)).chain([0.0]);
        let mut edges: Vec<f64> = near.flat_map(|edge| [edge, PI - edge]).collect();
        edges.extend(self.shaping.cone.iter().flat_map(Cone::edges));
        edges.extend(self.shaping.ies.iter().flat_map(Ies::edges));
        edges.retain(|edge| (0.0..=PI).contains(edge));
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }
}

impl Shaping {
    /// True where emission does not vary with direction.
    fn is_even(&self) -> bool {
        self.cone.is_none() && self.focus == 0.0 && self.ies.is_none() && self.drawn.is_none()
    }

    fn peak(&self) -> Rgb {
        let ies = self.ies.as_ref().map_or(1.0, Ies::peak);
        let tint = if self.focus > 0.0 { self.focus_tint } else { [0.0; 3] };
        Rgb::from(tint.map(|tint| ies * tint.max(1.0)))
    }
}

/// The decay of a light with `profile`.
pub(super) fn decay(profile: Option<&Profile>) -> Decay {
    profile.map_or(Decay::PHYSICAL, |profile| profile.decay)
}

/// What a light with `bounds` and `profile` may bring to `at`, decay included.
pub(super) fn importance(bounds: &LightBounds, profile: Option<&Profile>, at: &Receiver) -> f32 {
    let importance = bounds.importance(at);
    let Some(profile) = profile else { return importance };
    let dist = (bounds.bounds.center() - at.p).length();
    let radius = bounds.bounds.radius();
    let decay = profile.decay_at_most((dist - radius).max(0.0), dist + radius);
    (importance * decay).min(f32::MAX)
}
