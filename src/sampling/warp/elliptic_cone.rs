//! Directions to an ellipse, nearly uniform in solid angle.
//!
//! From a point an ellipse is an elliptic cone. Around the cone's own axis, with `α ≥ β` the half
//! angles in its two planes of symmetry, the azimuth is that of the point `(a cos t, b sin t)` of an
//! ellipse with `a² = 1 − cos α`, `b² = 1 − cos β` and uniform t, and `1 − cos θ` is uniform up to the
//! cone's edge at that azimuth. That is a bijection with the density
//! `ab / (2π (a² sin²φ + b² cos²φ) (1 − cos θ_max(φ)))`, which is constant for round and for small
//! cones and varies by less than 10% for all. The edge comes from the ellipse itself, so that density and
//! domain are exact even where rounding has turned the axes a little.
//!
//! (Ibón Guillén et al., *Area-Preserving Parameterizations for Spherical Ellipses*, CGF 36(4), 2017,
//! make it constant by tables of elliptic integrals.)
//!
//! The axes diagonalise `g₁g₁ᵀ + g₂g₂ᵀ − g₃g₃ᵀ`, the quadratic form that is negative inside of the
//! cone, by rotations of the vectors g, circular and hyperbolic: Krešimir Veselić, *A Jacobi
//! eigenreduction algorithm for definite matrix pairs*, Numerische Mathematik 64, 1993. It keeps the
//! relative accuracy of small eigenvalues, which plain Jacobi loses for flat cones.

use std::f64::consts::TAU;

use super::sample_disk;
use crate::math::{DMat3, DVec3};

/// Sweeps of rotations; three or four reach rounding.
const MAX_SWEEPS: usize = 12;

/// Cosine between two vectors that count as orthogonal.
const ORTHOGONAL: f64 = 1e-14;

/// The cone of directions from the origin to an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EllipticCone {
    /// Wide, narrow and central axis in the ellipse's space; orthonormal.
    axes: DMat3,
    /// The quadratic form between the axes: 11, 12, 22, 13, 23, 33.
    form: [f64; 6],
    /// `1 − cos α` and `1 − cos β`, squares of a and b.
    squares: [f64; 2],
}

impl EllipticCone {
    /// The cone over the ellipse with the half axes `half` along x and y about `center`, whose z is
    /// above 0. `None` where rounding leaves no cone.
    pub fn new(center: DVec3, half: [f64; 2]) -> Option<Self> {
        // The point where direction d meets the plane, in units of the half axes from the centre, times
        // d.z: the first two of these dotted with d. It is inside where its square is below d.z².
        let [rx, ry] = half;
        let g = [
            DVec3::new(center.z, 0.0, -center.x) / rx,
            DVec3::new(0.0, center.z, -center.y) / ry,
            DVec3::new(0.0, 0.0, 1.0),
        ];
        let axes = principal_axes(g)?;
        let [a, b, c] = [axes.x_axis, axes.y_axis, axes.z_axis];
        let product = |v: DVec3, w: DVec3| g[0].dot(v) * g[0].dot(w) + g[1].dot(v) * g[1].dot(w) - v.z * w.z;
        let form = [product(a, a), product(a, b), product(b, b), product(a, c), product(b, c), product(c, c)];
        let squares = [-form[5] / form[0], -form[5] / form[2]].map(one_minus_cos);
        let sound = form[5] < 0.0 && squares.iter().all(|s| *s > 0.0 && s.is_finite());
        sound.then_some(Self { axes, form, squares })
    }

    /// `1 − cos θ` of the edge at the azimuth of cosine and sine `c`, `s`.
    fn edge(&self, c: f64, s: f64) -> f64 {
        let [q11, q12, q22, q13, q23, q33] = self.form;
        let square = q11 * c * c + 2.0 * q12 * c * s + q22 * s * s;
        let linear = q13 * c + q23 * s;
        let tan = -q33 / (linear + (linear * linear - square * q33).max(0.0).sqrt());
        one_minus_cos(tan * tan)
    }

    /// Density of the azimuth of cosine and sine `c`, `s`.
    fn pdf_azimuth(&self, c: f64, s: f64) -> f64 {
        let [a, b] = self.squares;
        (a * b).sqrt() / (TAU * (a * s * s + b * c * c))
    }

    /// A unit direction and its density in solid angle.
    pub fn sample(&self, u: [f32; 2]) -> (DVec3, f64) {
        let [x, y] = sample_disk(u).map(f64::from);
        let share = (x * x + y * y).min(1.0);
        let (c, s) = ((self.squares[0]).sqrt() * x, (self.squares[1]).sqrt() * y);
        let length = c.hypot(s);
        let (c, s) = if length > 0.0 { (c / length, s / length) } else { (1.0, 0.0) };
        let edge = self.edge(c, s);
        let height = share * edge;
        let sin = (height * (2.0 - height)).sqrt();
        let w = self.axes * DVec3::new(sin * c, sin * s, 1.0 - height);
        (w, self.pdf_azimuth(c, s) / edge)
    }

    /// Density of [`EllipticCone::sample`] at a direction, unit or not, within the cone.
    pub fn pdf(&self, w: DVec3) -> f64 {
        let (c, s) = (self.axes.x_axis.dot(w), self.axes.y_axis.dot(w));
        let length = c.hypot(s);
        let (c, s) = if length > 0.0 { (c / length, s / length) } else { (1.0, 0.0) };
        self.pdf_azimuth(c, s) / self.edge(c, s)
    }
}

/// `1 − cos` of the angle whose squared tangent is given.
fn one_minus_cos(tan_squared: f64) -> f64 {
    if tan_squared > 1e300 {
        return 1.0;
    }
    let sec = (1.0 + tan_squared).sqrt();
    tan_squared / (sec * (1.0 + sec))
}

/// Eigenvectors of `g₁g₁ᵀ + g₂g₂ᵀ − g₃g₃ᵀ`: that of the smaller positive eigenvalue, that of the
/// larger, and that of the negative one, turned to the side of +z.
fn principal_axes(mut g: [DVec3; 3]) -> Option<DMat3> {
    for _ in 0..MAX_SWEEPS {
        let mut steady = true;
        for (i, j) in [(0, 2), (1, 2), (0, 1)] {
            let (n, m, dot) = (g[i].length_squared(), g[j].length_squared(), g[i].dot(g[j]));
            if dot.abs() <= ORTHOGONAL * (n * m).sqrt() {
                continue;
            }
            steady = false;
            let [v, w] = [g[i], g[j]];
            if j == 2 {
                // tanh of half the argument of tanh 2x = −2 dot / (n + m).
                let tanh = -2.0 * dot / (n + m + (v - w).length() * (v + w).length());
                let cosh = 1.0 / ((1.0 - tanh) * (1.0 + tanh)).sqrt();
                (g[i], g[j]) = ((v + w * tanh) * cosh, (w + v * tanh) * cosh);
            } else {
                let cot = 0.5 * (m - n) / dot;
                let tan = cot.signum() / (cot.abs() + cot.hypot(1.0));
                let cos = 1.0 / tan.hypot(1.0);
                (g[i], g[j]) = ((v - w * tan) * cos, (w + v * tan) * cos);
            }
        }
        if steady {
            break;
        }
    }
    let axis = g[2].try_normalize()?;
    let axis = if axis.z < 0.0 { -axis } else { axis };
    // The longer of the other two is the better known.
    let narrow = if g[0].length_squared() > g[1].length_squared() { g[0] } else { g[1] };
    let narrow = (narrow - axis * narrow.dot(axis)).try_normalize()?;
    Some(DMat3::from_cols(narrow.cross(axis), narrow, axis))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    type Case = (DVec3, [f64; 2]);

    /// Below, beside, touching; round and not; small and far.
    fn cases() -> Vec<Case> {
        let mut cases = vec![
            (DVec3::new(0.0, 0.0, 1.0), [1.0, 1.0]),
            (DVec3::new(0.3, -0.2, 1.0), [1.0, 1.0]),
            (DVec3::new(2.0, 0.5, 0.7), [1.0, 0.3]),
            (DVec3::new(0.5, 2.5, 0.3), [0.2, 2.0]),
            (DVec3::new(1.0, 0.0, 0.1), [1.0, 1.0]),
            (DVec3::new(1.0, 1.0, 1.0), [1e-3, 1e-3]),
            (DVec3::new(-3.0, 1.0, 2.0), [1.0, 1e-4]),
        ];
        for k in 1..7 {
            let h = 10.0_f64.powi(-k);
            cases.push((DVec3::new(0.0, 0.0, h), [1.0, 1.0]));
            cases.push((DVec3::new(0.4, -0.3, h), [1.0, 0.7]));
            cases.push((DVec3::new(1.5, -0.3, h), [1.0, 0.7]));
            cases.push((DVec3::new(0.0, 1.0 - h, h), [1.0, 1.0]));
            cases.push((DVec3::new(3.0, 4.0, h), [2.0, 2.0]));
            cases.push((DVec3::new(0.1, 0.2, 1.0), [h, 2.0 * h]));
        }
        cases
    }

    /// Squared distance from the centre in units of the half axes where `w` meets the plane.
    fn reach(&(center, half): &Case, w: DVec3) -> f64 {
        let at = w * (center.z / w.z);
        ((at.x - center.x) / half[0]).powi(2) + ((at.y - center.y) / half[1]).powi(2)
    }

    /// Solid angle of the ellipse by its edge: ∮ (1 − cos θ) dφ about the line to a point of it, in the
    /// variables of the plane: Σ over the edge of the triangles with that point.
    fn solid_angle(&(center, half): &Case) -> f64 {
        let n = 200_000;
        let edge = |i: u32| {
            let (s, c) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
            center + DVec3::new(half[0] * c, half[1] * s, 0.0)
        };
        // The point of the ellipse nearest to the origin's foot keeps triangles from being slivers.
        let off = (center.x / half[0]).hypot(center.y / half[1]);
        let middle = if off < 0.99 { DVec3::new(0.0, 0.0, center.z) } else { center };
        (0..n)
            .map(|i| {
                let (a, b, c) = (middle, edge(i), edge(i + 1));
                let (la, lb, lc) = (a.length(), b.length(), c.length());
                let det = a.dot((b - a).cross(c - a));
                2.0 * det.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
            })
            .sum()
    }

    #[test]
    fn the_density_fills_the_ellipse_and_nothing_else() {
        for case in cases() {
            let cone = EllipticCone::new(case.0, case.1).unwrap();
            // 1/pdf averages to the solid angle. A lattice in both numbers: the integrand is periodic in
            // the azimuth and the density does not depend on the other.
            let (mut sum, mut n) = (0.0, 0);
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for i in 0..64 {
                for j in 0..64 {
                    let u = [(i as f32 + 0.5) / 64.0, (j as f32 + 0.5) / 64.0];
                    let (w, pdf) = cone.sample(u);
                    assert!((w.length() - 1.0).abs() < 1e-12 && w.z > 0.0, "{case:?} {u:?}: {w}");
                    assert!(reach(&case, w) < 1.0 + 1e-6, "{case:?} {u:?}: {} outside", reach(&case, w));
                    assert!((cone.pdf(w) / pdf - 1.0).abs() < 1e-3, "{case:?} {u:?}: {pdf} and {}", cone.pdf(w));
                    sum += 1.0 / pdf;
                    (least, most) = (least.min(pdf), most.max(pdf));
                    n += 1;
                }
            }
            let exact = solid_angle(&case);
            assert!((sum / f64::from(n) / exact - 1.0).abs() < 2e-3, "{case:?}: {} and {exact}", sum / f64::from(n));
            assert!(most / least < 1.1, "{case:?}: density from {least} to {most}");
        }
    }

    #[test]
    fn the_edge_is_reached() {
        for case in cases() {
            let cone = EllipticCone::new(case.0, case.1).unwrap();
            for i in 0..32 {
                let (s, c) = (TAU * f64::from(i) / 32.0).sin_cos();
                let height = cone.edge(c, s);
                let sin = (height * (2.0 - height)).sqrt();
                let w = cone.axes * DVec3::new(sin * c, sin * s, 1.0 - height);
                let reach = reach(&case, w).sqrt();
                assert!((reach - 1.0).abs() < 1e-5, "{case:?} {i}: {reach}");
            }
        }
    }

    #[test]
    fn round_cones_are_uniform() {
        let cone = EllipticCone::new(DVec3::new(0.0, 0.0, 1.0), [0.75, 0.75]).unwrap();
        let exact = 1.0 / (TAU * 0.2);
        for u in [[0.1, 0.2], [0.5, 0.5], [0.99, 0.3]] {
            let (w, pdf) = cone.sample(u);
            assert!((pdf / exact - 1.0).abs() < 1e-12 && (cone.pdf(w) / exact - 1.0).abs() < 1e-12);
        }
        // Touching, all of the hemisphere.
        let touching = EllipticCone::new(DVec3::new(0.0, 0.0, 1e-9), [1.0, 1.0]).unwrap();
        assert!((touching.sample([0.3, 0.4]).1 * 2.0 * PI - 1.0).abs() < 1e-8);
    }
}
