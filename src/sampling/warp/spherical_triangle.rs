//! Directions uniform over the solid angle of a triangle.
//!
//! The map is that of James Arvo, *Stratified Sampling of Spherical Triangles*, SIGGRAPH 1995: the
//! first number cuts a triangle of the wanted area off along the arc AC, the second goes along the
//! arc from B to that cut. Arvo's cosine of the cut loses all digits for small and thin triangles.
//! Here its half angle comes from the area of a triangle of two sides and the angle between them,
//! `tan(E/2) = tan(b/2) tan(c/2) sin α / (1 + tan(b/2) tan(c/2) cos α)` (Isaac Todhunter, *Spherical
//! Trigonometry*, 1886, art. 103), which is solved without any cancellation:
//! `tan(b'/2) = sin(E'/2) / (tan(c/2) sin(α − E'/2))`.

use crate::math::DVec3;

/// A triangle as seen from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalTriangle {
    /// Unit directions to two corners.
    a: DVec3,
    b: DVec3,
    /// Unit tangent at `a` of the arc to the third.
    a_to_c: DVec3,
    /// Angle at `a`.
    alpha: f64,
    /// Tangent of half of the arc from `a` to `b`.
    tan_half_ab: f64,
    solid_angle: f64,
}

/// Solid angle, 0 to 2π, of the triangle with corners in directions `a`, `b` and `c`, which are unit.
///
/// Adriaan van Oosterom and Jan Strackee, *The Solid Angle of a Plane Triangle*, IEEE Transactions on
/// Biomedical Engineering 30(2), 1983.
pub fn solid_angle_of_triangle([a, b, c]: [DVec3; 3]) -> f64 {
    // The triple product of the edges is that of the corners: exact for a small triangle, whose corners
    // cancel, but not for a wide flat one, whose corners do not.
    let (ab, ac) = (b - a, c - a);
    let small = ab.length_squared().max(ac.length_squared()) < 0.25;
    let volume = if small { a.dot(ab.cross(ac)) } else { a.dot(b.cross(c)) };
    // 1 + a·b + b·c + c·a by sums of corners, of which nearly opposite ones cancel exactly.
    let sums = [a + b, b + c, c + a];
    let [s, t, u] = sums.map(DVec3::length_squared);
    let rest = if s.min(u) <= t { sums[2].dot(sums[0]) } else { sums[0].dot(sums[1]) };
    2.0 * volume.abs().atan2(rest)
}

impl SphericalTriangle {
    /// The triangle with corners in the unit directions `corners`; `None` where it has no area that
    /// could be sampled.
    pub fn new(corners: [DVec3; 3]) -> Option<Self> {
        let solid_angle = solid_angle_of_triangle(corners);
        let [a, b, c] = corners;
        let tangent = |to: DVec3| {
            let chord = to - a;
            (chord - a * a.dot(chord)).normalize_or_zero()
        };
        let (to_b, to_c) = (tangent(b), tangent(c));
        let alpha = to_b.cross(to_c).length().atan2(to_b.dot(to_c));
        let tan_half_ab = (b - a).length() / (b + a).length();
        let sound = solid_angle > 0.0 && alpha > 0.0 && tan_half_ab > 0.0 && tan_half_ab.is_finite();
        sound.then_some(Self { a, b, a_to_c: to_c, alpha, tan_half_ab, solid_angle })
    }

    /// Steradians; the density of [`SphericalTriangle::sample`] is one over it.
    pub fn solid_angle(&self) -> f64 {
        self.solid_angle
    }

    /// A unit direction into the triangle.
    pub fn sample(&self, u: [f32; 2]) -> DVec3 {
        let half_area = 0.5 * self.solid_angle * f64::from(u[0]);
        let sin = (self.alpha - half_area).sin().max(f64::MIN_POSITIVE);
        let tan = half_area.sin() / (self.tan_half_ab * sin);
        // Cosine and sine of an angle by the tangent of its half, which may be huge.
        let (cos, sin) = if tan < 1e8 {
            let scale = 1.0 / (1.0 + tan * tan);
            ((1.0 - tan * tan) * scale, 2.0 * tan * scale)
        } else {
            (-1.0, 0.0)
        };
        let cut = self.a * cos + self.a_to_c * sin;
        // 1 − cos of the arc from B, by the chord.
        let chord = cut - self.b;
        let height = 0.5 * chord.length_squared() * f64::from(u[1]);
        let along = (chord - self.b * self.b.dot(chord)).normalize_or_zero();
        (self.b * (1.0 - height) + along * (height * (2.0 - height)).max(0.0).sqrt()).normalize_or(self.b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Dimension, Pattern, Sampler};

    const OCTANT: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

    fn points(n: u64) -> impl Iterator<Item = [f32; 2]> {
        let sampler = Sampler::new(Pattern::Sobol, 5);
        (0..n).map(move |i| sampler.for_sample(0, 0, i).get_2d(Dimension::FREE))
    }

    /// Triangles of all shapes, corners not unit.
    fn triangles() -> Vec<[DVec3; 3]> {
        let v = DVec3::new;
        vec![
            OCTANT,
            [v(1.0, 0.1, 0.0), v(-0.6, 0.8, 0.01), v(-0.5, -0.9, 0.02)],
            [v(-0.05, 0.0, 1.0), v(0.05, 0.0, 1.0), v(0.0, 0.1, 1.0)],
            [v(0.0, 0.0, 1.0), v(1e-3, 0.0, 1.0), v(0.0, 1e-3, 1.0)],
            [v(-0.5, 0.0, 1.0), v(0.5, 0.0, 1.0), v(0.0, 1e-4, 1.0)],
            [v(0.0, 1e-4, 1.0), v(-0.5, 0.0, 1.0), v(0.5, 0.0, 1.0)],
            [v(-5.0, -4.0, 1e-3), v(6.0, -5.0, 1e-3), v(0.3, 7.0, 1e-3)],
        ]
    }

    fn unit(corners: [DVec3; 3]) -> [DVec3; 3] {
        corners.map(DVec3::normalize)
    }

    #[test]
    fn solid_angles_are_known_ones() {
        assert!((solid_angle_of_triangle(OCTANT) - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        // From a point above the middle of an edge of length 2 at height h, far corner at distance 1:
        // twice the right triangle with legs 1 and 1, 2 atan(1 / (h √(2 + h²))) less the part beyond.
        for h in [1.0, 1e-2, 1e-5] {
            let square = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, h));
            let sum: f64 =
                [[0, 1, 2], [0, 2, 3]].map(|t| solid_angle_of_triangle(unit(t.map(|i| square[i])))).iter().sum();
            let exact = 4.0 * (1.0 / (h * (2.0 + h * h).sqrt())).atan();
            assert!((sum / exact - 1.0).abs() < 1e-12, "{h}: {sum} {exact}");
        }
        // A small one is its area, seen head on.
        let small = unit([DVec3::new(0.0, 0.0, 1.0), DVec3::new(1e-6, 0.0, 1.0), DVec3::new(0.0, 1e-6, 1.0)]);
        assert!((solid_angle_of_triangle(small) / 5e-13 - 1.0).abs() < 1e-9);
    }

    /// The integral of cos(w, axis) over the triangle is half of Lambert's sum of edges.
    #[test]
    fn means_over_the_solid_angle_are_those_of_lamberts_formula() {
        for corners in triangles() {
            let [a, b, c] = unit(corners);
            let triangle = SphericalTriangle::new([a, b, c]).unwrap();
            let edge = |p: DVec3, q: DVec3| {
                let cross = p.cross(q);
                cross.normalize_or_zero() * cross.length().atan2(p.dot(q))
            };
            let sum = 0.5 * (edge(a, b) + edge(b, c) + edge(c, a));
            let sum = if sum.dot(a + b + c) < 0.0 { -sum } else { sum };
            let n = 1 << 14;
            let mean = points(n).map(|u| triangle.sample(u)).sum::<DVec3>() / n as f64;
            let error = (mean * triangle.solid_angle() - sum).length() / sum.length();
            assert!(error < 1e-4, "{corners:?}: {error}");
        }
    }

    #[test]
    fn samples_are_inside_and_split_by_area() {
        for corners in triangles() {
            let corners = unit(corners);
            let triangle = SphericalTriangle::new(corners).unwrap();
            let [a, b, c] = corners;
            let facing = a.dot(b.cross(c)).signum();
            // The middle of each edge and the corner opposite of it halve nothing in general: the share
            // of samples on the side of A of the arc from B to the middle of AC is a ratio of areas.
            let middle = (a + c).normalize();
            let share = solid_angle_of_triangle([a, b, middle]) / triangle.solid_angle();
            let n = 1 << 14;
            let mut on_side = 0;
            for u in points(n) {
                let w = triangle.sample(u);
                for (p, q) in [(a, b), (b, c), (c, a)] {
                    let normal = p.cross(q);
                    assert!(facing * w.dot(normal) >= -1e-12, "{corners:?}: {u:?}");
                }
                on_side += u64::from(facing * w.dot(b.cross(middle)) >= 0.0);
            }
            let found = on_side as f64 / n as f64;
            assert!((found - share).abs() < 2e-3, "{corners:?}: {found} instead of {share}");
        }
    }

    #[test]
    fn corners_of_the_square_are_corners_or_edges() {
        let triangle = SphericalTriangle::new(OCTANT).unwrap();
        let near = |u, w: DVec3| assert!((triangle.sample(u) - w).length() < 1e-6, "{u:?}");
        near([0.0, 0.0], DVec3::Y);
        near([0.0, 1.0], DVec3::X);
        near([1.0, 1.0], DVec3::Z);
    }

    #[test]
    fn what_has_no_solid_angle_is_no_triangle() {
        assert!(SphericalTriangle::new([DVec3::X; 3]).is_none());
        assert!(SphericalTriangle::new([DVec3::X, DVec3::X, DVec3::Y]).is_none());
    }
}
