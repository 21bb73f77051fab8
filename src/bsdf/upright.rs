//! Normals under which a mirror shows what is above the geometry.
//!
//! A normal that a map or an interpolation bends far from the geometry mirrors grazing views into the surface, which
//! shades black. It is leant back towards the geometric normal just so far that the mirror image rises above it: the
//! bent normal n' is in the plane of both, and 2 (n'·wo) (n'·ng) − wo·ng = t, which is quadratic in (n'·ng)². Cycles has
//! the same rule and the same t.

use crate::math::{Vec3, safe_sqrt, sqr};

/// `n` leant so that the mirror image of `wo` is above the surface of normal `ng`; `None` where it is. All are unit, `wo`
/// above `ng`.
pub(super) fn raised(n: Vec3, ng: Vec3, wo: Vec3) -> Option<Vec3> {
    let up = wo.dot(ng);
    // What is seen at a grazing angle may be mirrored at one.
    let t = (0.9 * up).min(0.01);
    let mirrored = n * (2.0 * n.dot(wo)) - wo;
    if up <= 0.0 || mirrored.dot(ng) >= t {
        return None;
    }
    let x = (n - ng * n.dot(ng)).try_normalize()?;
    let along = wo.dot(x);
    let (a, b, c) = (sqr(along) + sqr(up), 2.0 * (sqr(along) + sqr(up) + up * t), sqr(t + up));
    let root = safe_sqrt(sqr(b) - 4.0 * a * c);
    let squared = (0.25 * (if along < 0.0 { b + root } else { b - root }) / a).clamp(0.0, 1.0);
    Some((x * safe_sqrt(1.0 - squared) + ng * squared.sqrt()).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirror_images_rise_as_little_as_need_be() {
        for degrees in [5.0_f32, 30.0, 60.0, 80.0, 89.0] {
            let (sin, up) = degrees.to_radians().sin_cos();
            let wo = Vec3::new(sin, 0.0, up);
            for tilt in [-80.0_f32, -50.0, -20.0, 0.0, 20.0, 50.0, 80.0] {
                for azimuth in [0.0_f32, 0.7, 1.5] {
                    let (s, z) = tilt.to_radians().sin_cos();
                    let n = Vec3::new(s * azimuth.cos(), s * azimuth.sin(), z);
                    let of = |n: Vec3| 2.0 * n.dot(wo) * n.z - up;
                    let t = (0.9 * up).min(0.01);
                    match raised(n, Vec3::Z, wo) {
                        None => assert!(of(n) >= t, "{wo} {n}"),
                        Some(raised) => {
                            assert!(of(n) < t && (of(raised) - t).abs() < 1e-4, "{wo} {n} {raised}: {}", of(raised));
                            // In the plane of both, on the side of the given one.
                            assert!(
                                raised.cross(n).dot(Vec3::Z).abs() < 1e-5 && raised.dot(n) > 0.0,
                                "{wo} {n} {raised}"
                            );
                        }
                    }
                }
            }
        }
    }
}
