//! What traversal keeps of a ray: constants of the slab test and of the watertight triangle test.
//!
//! Sven Woop, Carsten Benthin, Ingo Wald: *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013.

use super::node::WIDTH;
use crate::math::{Ray, Vec3};

/// Widening of the slab test, relative in `t`: more than the rounding of two differences, two
/// reciprocals and two products, and of the `t` that the triangle test returns.
const SLACK: f32 = 1.0 / (1 << 20) as f32;

/// Bytes from one row of [`super::node::Node::planes`] to the next; opposite planes lie at offsets
/// that differ by an exclusive or with it.
pub(super) const ROW: usize = size_of::<[f32; WIDTH]>();

/// A ray in the space of the boxes and triangles that it is tested against.
#[derive(Clone, Copy)]
pub(super) struct RaySetup {
    /// Origin.
    pub o: [f32; 3],
    /// Direction.
    pub d: [f32; 3],
    /// `1 / d`, rounded toward a smaller entry distance; infinite where `d` is 0.
    pub rcp_near: [f32; 3],
    /// `1 / d`, rounded toward a larger exit distance.
    pub rcp_far: [f32; 3],
    /// Where in [`super::node::Node::planes`] the planes begin that the ray enters through, by axis, in bytes.
    pub near_planes: [usize; 3],
    /// The axes in the order x', y', z', where z' is the one along which the ray goes fastest.
    pub axes: [usize; 3],
    /// The origin in that order.
    pub permuted_o: [f32; 3],
    /// `d.x' / d.z'`, `d.y' / d.z'` and `1 / d.z'`.
    pub shear: [f32; 3],
}

impl RaySetup {
    /// Constants of the ray `o + t d`; `d` is finite and not null.
    #[inline(always)]
    pub fn new(o: [f32; 3], d: [f32; 3]) -> Self {
        let rcp = [1.0 / d[0], 1.0 / d[1], 1.0 / d[2]];
        let size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let z = if size[0] > size[1] {
            if size[0] > size[2] { 0 } else { 2 }
        } else if size[1] > size[2] {
            1
        } else {
            2
        };
        const NEXT: [usize; 4] = [1, 2, 0, 1];
        let (x, y) = (NEXT[z], NEXT[z + 1]);
        Self {
            o,
            d,
            rcp_near: rcp.map(|r| r * (1.0 - SLACK)),
            rcp_far: rcp.map(|r| r * (1.0 + SLACK)),
            near_planes: [
                usize::from(rcp[0].is_sign_negative()) * ROW,
                (2 + usize::from(rcp[1].is_sign_negative())) * ROW,
                (4 + usize::from(rcp[2].is_sign_negative())) * ROW,
            ],
            axes: [x, y, z],
            permuted_o: [o[x], o[y], o[z]],
            shear: [d[x] * rcp[z], d[y] * rcp[z], rcp[z]],
        }
    }
}

/// True for nearly all rays: finite, and with a direction that traversal can take as it is. The
/// others go through [`rescaled`].
#[inline(always)]
pub(super) fn is_plain(ray: &Ray) -> bool {
    let (o, d) = (ray.o.abs(), ray.d.abs());
    let longest = d.x.max(d.y).max(d.z);
    // NaN and infinity make the sum fail.
    let sum = (o.x + o.y + o.z) + (d.x + d.y + d.z);
    (sum < f32::MAX) & (longest > 1e-6) & (longest < 1e6) & (ray.t_max > 0.0)
}

/// The ray with its direction brought near length 1 by a power of two, which changes no digit of
/// any product, and that power: `t` of the result times the power is `t` of the ray. `None` for a
/// ray that can hit nothing: not finite, without direction, without length, or so far away that it stays no plain one.
#[cold]
#[inline(never)]
pub(super) fn rescaled(ray: &Ray) -> Option<(Ray, f32)> {
    let longest = ray.d.abs().max_element();
    if !(ray.o.is_finite() && ray.d.is_finite() && longest > 0.0 && ray.t_max > 0.0) {
        return None;
    }
    // In two halves, for 2^149, which a denormal direction needs, is not an f32.
    let exponent = f64::from(longest).log2().round() as i32;
    let (a, b) = (exponent / 2, exponent - exponent / 2);
    let scale = |v: Vec3| v * 2.0_f32.powi(-a) * 2.0_f32.powi(-b);
    let t_max = ray.t_max * 2.0_f32.powi(a) * 2.0_f32.powi(b);
    let power = f64::powi(2.0, -exponent) as f32;
    let scaled = Ray { o: ray.o, d: scale(ray.d), t_max, time: ray.time };
    is_plain(&scaled).then_some((scaled, power))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fastest_axis_comes_last() {
        for (d, z) in [([3.0, 1.0, -2.0], 0), ([0.0, -4.0, 2.0], 1), ([1.0, 1.0, 1.0], 2), ([0.0, 0.0, -1.0], 2)] {
            let setup = RaySetup::new([0.0; 3], d);
            assert_eq!(setup.axes[2], z);
            assert_eq!(setup.axes.iter().sum::<usize>(), 3);
            assert!(setup.shear[0].abs() <= 1.0 && setup.shear[1].abs() <= 1.0);
        }
    }

    #[test]
    fn extreme_directions_are_scaled_exactly() {
        for length in [1e-44_f32, 1e-30, 1e-10, 1.0, 1e10, 1e38] {
            let ray = Ray { o: Vec3::ONE, d: Vec3::new(0.0, -length, 0.25 * length), t_max: 3.0, time: 0.0 };
            let (scaled, power) = rescaled(&ray).unwrap();
            assert!(is_plain(&scaled));
            let longest = scaled.d.abs().max_element();
            assert!((1e-6..=1e6).contains(&longest), "{length}: {longest}");
            let back = f64::from(scaled.d.y) / f64::from(power);
            if power.is_finite() {
                assert_eq!(back as f32, ray.d.y);
                assert_eq!(f64::from(scaled.t_max), 3.0 / f64::from(power), "{length}");
            }
        }
        // The sum of its coordinates is no number, and its length is none either.
        assert!(rescaled(&Ray::new(Vec3::splat(2e38), Vec3::X)).is_none());
        assert!(rescaled(&Ray { t_max: 1e-44, ..Ray::new(Vec3::ZERO, Vec3::X * 1e-10) }).is_none());
        for bad in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            let (no_direction, nowhere) = (Ray::new(Vec3::ZERO, bad), Ray::new(bad, Vec3::X));
            assert!(!is_plain(&no_direction) && rescaled(&no_direction).is_none());
            assert!(bad == Vec3::ZERO || !is_plain(&nowhere) && rescaled(&nowhere).is_none());
        }
        let no_end = Ray { o: Vec3::ZERO, d: Vec3::X, t_max: f32::NAN, time: 0.0 };
        assert!(!is_plain(&no_end) && rescaled(&no_end).is_none());
    }
}
