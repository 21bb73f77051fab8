//! Where a light is and where it shines: what the choice among lights goes by.
//!
//! Alejandro Conty Estevez and Christopher Kulla, *Importance Sampling of Many Lights with Adaptive
//! Tree Splitting*, HPG 2018, section 4. Their geometric term bounds cosines from above by the cone
//! of directions to the box; here cosines are means over the box, of positive parts, which tell
//! irradiance better and are 0 under the same condition: that all of the box is behind the plane.

use super::Receiver;
use crate::math::{Bounds, Vec3, gamma};

/// A box of emitters, a cone of their normals, and how far around those each of them shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Box, render space.
    pub bounds: Bounds,
    /// Unit axis of the cone of normals.
    pub axis: Vec3,
    /// Cosine of the half angle of the cone of normals; −1 for emitters that face everywhere.
    pub cos_normals: f32,
    /// Cosine of the angle around each normal into which light is emitted: 0 for a surface.
    pub cos_emission: f32,
    /// Largest radiant intensity, W·sr⁻¹, luminance: for a surface radiance times area.
    pub intensity: f32,
    /// True where the other side emits as well.
    pub two_sided: bool,
}

/// [`LightBounds`] as the importance needs it. Bounds of many lights are kept as arrays of these
/// numbers, so that the loop over them is compiled to vector instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lobe {
    /// Middle of the box.
    pub center: [f32; 3],
    /// Half of its edges, rounded up.
    pub half: [f32; 3],
    /// As in the bounds.
    pub axis: [f32; 3],
    /// Cosine of the half angle of the cone of normals.
    pub cos_normals: f32,
    /// Cosine of the half angle of the cone of all directions of emission.
    pub cos_cone: f32,
    /// Sum of the intensities of all emitters, each along its normal; negative where both sides emit.
    pub intensity: f32,
    /// Length of the mean normal, weighted by intensity.
    pub mean_normal: f32,
    /// Share of the intensity that is the same in all directions.
    pub isotropic: f32,
}

/// A receiver as the importance needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    p: [f32; 3],
    /// 0 where light is welcome from any side.
    n: [f32; 3],
    any_side: bool,
    /// What rounding may have moved `p` by.
    slack: f32,
}

/// Share of a box's squared radius by which the squared distance to its middle is lengthened: the
/// mean of 1/d² over the box stays finite from inside of it.
const INSIDE: f32 = 0.1;

/// Weights are between these: neither underflow nor a light at zero distance hides any other.
const LEAST: f32 = 1e-36;
const MOST: f32 = 1e30;

impl LightBounds {
    /// Roughly the unoccluded irradiance at `at`; 0 only where no light can arrive.
    pub fn importance(&self, at: &Receiver) -> f32 {
        self.lobe().importance(&Asked::new(at.p, at.n, Vec3::ZERO))
    }

    pub(super) fn lobe(&self) -> Lobe {
        let isotropic = if self.is_even() { 1.0 } else { 0.0 };
        self.lobe_of(self.intensity, 1.0 - isotropic, isotropic)
    }

    /// True for what shines the same into all directions in which it shines: points and spots.
    pub(super) fn is_even(&self) -> bool {
        self.cos_normals <= -1.0 || self.cos_emission > 0.999
    }

    /// The lobe of many lights with these bounds, whose intensities sum to `intensity`.
    pub(super) fn lobe_of(&self, intensity: f32, mean_normal: f32, isotropic: f32) -> Lobe {
        let center = self.bounds.center();
        let half = (self.bounds.max - center).max(center - self.bounds.min).max(Vec3::ZERO);
        let (cos_n, cos_e) = (f64::from(self.cos_normals), f64::from(self.cos_emission));
        let cone = cos_n.clamp(-1.0, 1.0).acos() + cos_e.clamp(-1.0, 1.0).acos();
        let intensity = if intensity > 0.0 { intensity } else { 0.0 };
        Lobe {
            center: center.to_array(),
            half: (half + center.abs() * gamma(2)).to_array(),
            axis: self.axis.to_array(),
            cos_normals: self.cos_normals,
            cos_cone: round_down(if cone < std::f64::consts::PI { cone.cos() } else { -1.0 }),
            intensity: if self.two_sided { -intensity } else { intensity },
            mean_normal,
            isotropic,
        }
    }
}

/// The largest `f32` not above `x`: a cone that is no narrower.
pub(super) fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

impl Asked {
    /// A point that light can reach from the side of `n`, or from any; rounding may have moved it by
    /// `p_err`.
    pub fn new(p: Vec3, n: Option<Vec3>, p_err: Vec3) -> Self {
        let slack = p_err.max_element() + gamma(4) * p.abs().max_element();
        Self { p: p.to_array(), n: n.unwrap_or(Vec3::ZERO).to_array(), any_side: n.is_none(), slack }
    }

    /// Bits of the place, to tell receivers apart.
    pub fn bits(&self) -> u64 {
        let [x, y, z] = self.p.map(|v| u64::from(v.to_bits()));
        x ^ y << 21 ^ z << 42 ^ z >> 22
    }
}

impl Lobe {
    /// See [`LightBounds::importance`]. Without branches, for the sake of vector code.
    #[inline(always)]
    pub fn importance(&self, at: &Asked) -> f32 {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let extent = |a: [f32; 3]| a[0].abs() * self.half[0] + a[1].abs() * self.half[1] + a[2].abs() * self.half[2];
        let d = [self.center[0] - at.p[0], self.center[1] - at.p[1], self.center[2] - at.p[2]];
        let (dist_squared, radius_squared) = (dot(d, d), dot(self.half, self.half));
        let (dist, radius) = (dist_squared.sqrt(), radius_squared.sqrt());
        let scale = 1.0 / larger(dist_squared + INSIDE * radius_squared, LEAST);
        let per_dist = scale.sqrt();
        let slack = at.slack + 1e-6 * dist + LEAST;

        let above = dot(at.n, d);
        let received = mean_positive(above, extent(at.n) + slack) * per_dist;
        let received = if at.any_side { 1.0 } else { received };

        // Cosines at emitters: the mean, and those of the normals that are nearest to the receiver's
        // direction and farthest off, the box's extent along them included.
        let along = -dot(self.axis, d);
        let two_sided = self.intensity < 0.0;
        let along = if two_sided { along.abs() } else { along };
        let off = larger(dist_squared - along * along, 0.0).sqrt();
        let sin_normals = larger(1.0 - self.cos_normals * self.cos_normals, 0.0).sqrt();
        let (middle, tilt) = (along * self.cos_normals, off * sin_normals);
        let nearest = if along >= dist * self.cos_normals { dist } else { middle + tilt };
        let farthest = if along <= -dist * self.cos_normals { -dist } else { middle - tilt };
        let reach = smaller(extent(self.axis) + radius * sin_normals, radius);
        let reach = if self.cos_normals < 0.0 { radius } else { reach } + slack;
        let top = larger((nearest + reach) * per_dist, 0.0);
        let bottom = smaller((farthest - reach) * per_dist, 0.0);
        let mean = smaller(larger(along * self.mean_normal * per_dist, bottom), top);
        // The mean of the positive part is exact for even spread from bottom to top, and where all is at
        // one end or none below 0; that of the negative part then follows.
        let (front, back) = (top * (mean - bottom), -bottom * (top - mean));
        let both = front * front + if two_sided { back * back } else { 0.0 };
        let directed = both / larger((top - bottom) * (front + back), LEAST);
        let emits = (top > 0.0) | (two_sided & (bottom < 0.0)) | (self.isotropic > 0.0);
        let emitted = directed + self.isotropic;

        // Distance to the cone of emission: from its mantle, or its apex.
        let sin_cone = larger(1.0 - self.cos_cone * self.cos_cone, 0.0).sqrt();
        let outside = off * self.cos_cone - along * sin_cone;
        let outside = if along * self.cos_cone + off * sin_cone > 0.0 { outside } else { dist };
        let outside = if along + slack >= dist * self.cos_cone { 0.0 } else { outside };

        let lit = (received > 0.0) & emits & (outside <= radius + slack) & (self.intensity != 0.0);
        let weight = self.intensity.abs() * scale * received * emitted;
        if lit { bounded(weight) } else { 0.0 }
    }

    /// Distance of the box from `at` that goes into its importance, and its least one, rounded down.
    #[inline(always)]
    pub fn distances(&self, at: &Asked) -> [f32; 2] {
        let d = [self.center[0] - at.p[0], self.center[1] - at.p[1], self.center[2] - at.p[2]];
        let squared = |v: [f32; 3]| v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        let (dist_squared, radius_squared) = (squared(d), squared(self.half));
        let dist = dist_squared.sqrt();
        let slack = at.slack + 1e-6 * dist + LEAST;
        let mean = larger(dist_squared + INSIDE * radius_squared, LEAST).sqrt();
        [mean, dist - radius_squared.sqrt() - slack]
    }
}

/// A weight that is above 0, made to neither vanish nor hide all others.
#[inline(always)]
pub(super) fn bounded(weight: f32) -> f32 {
    larger(smaller(weight, MOST), LEAST)
}

/// Mean of the positive part of a height that is uniform in `middle ± half`, roughly, at most
/// `middle + half`: 0 only where all of that is below.
#[inline(always)]
fn mean_positive(middle: f32, half: f32) -> f32 {
    let top = smaller(larger(middle + half, 0.0), 2.0 * half);
    top * (top / (4.0 * half)) + larger(middle - half, 0.0)
}

/// Maximum in one instruction: `f32::max` takes care of NaN.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
