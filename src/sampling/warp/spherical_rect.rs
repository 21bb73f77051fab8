//! Uniform directions to a rectangle.
//!
//! Carlos Ureña, Marcos Fajardo, Alan King: *An Area-Preserving Parametrization for Spherical
//! Rectangles*, EGSR 2013: first x by the solid angle of the part of the rectangle on one side of it,
//! then y by the sine of its elevation, which is uniform along the arc of constant x.
//!
//! Their angles between planes cancel where the rectangle is small, and cosines near 1 do where it
//! touches the point. Here both steps measure what lies *beyond* an end, out to infinity, on the side
//! on which the sample falls. With `s² = x² + h²`, `r² = s² + y²` and x ≥ 0:
//!
//! - beyond x, between y₀ and y₁: the solid angle
//!   `G(x) = atan2(h (s² (y₁ − y₀) + x (y₁r₀ − y₀r₁)), (s² + x r₀)(s² + x r₁) + h² y₀y₁)`;
//! - beyond y: `1 − y/r = s² / (r (r + y))`, times the angle of the arc.
//!
//! Neither has a difference that cancels, so that rectangles from 1e-12 sr to 2π are right.

/// An axis-aligned rectangle in a plane at a distance, as seen from the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphericalRect {
    x: [f64; 2],
    y: [f64; 2],
    h: f64,
    /// Solid angle of half of the strip of all x: the angle between the planes of the two y.
    half_strip: f64,
    along_x: Span,
}

/// An interval on an axis with a measure that is symmetric about 0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    /// Measure below the lower end and above the upper one; of an end on the far side of 0, that
    /// beyond its mirror image.
    beyond: [f64; 2],
    /// On which side of 0 it lies: −1, 1, or 0 for both.
    side: i8,
    /// Measure of the interval.
    total: f64,
}

impl Span {
    /// The interval from `from` to `to`; `beyond` tells the measure of all above a number of at
    /// least 0, `half` is that above 0.
    fn new([from, to]: [f64; 2], half: f64, beyond: impl Fn(f64) -> f64) -> Self {
        let ends = [beyond(from.abs()), beyond(to.abs())];
        let (side, total) = if from >= 0.0 {
            (1, ends[0] - ends[1])
        } else if to <= 0.0 {
            (-1, ends[1] - ends[0])
        } else {
            (0, 2.0 * half - ends[0] - ends[1])
        };
        Self { beyond: ends, side, total }
    }

    /// Sign of the number at the share `u` of the measure, and the measure beyond it, at most `half`.
    fn at(&self, u: f64, half: f64) -> (f64, f64) {
        let above = self.beyond[1] + (1.0 - u) * self.total;
        if self.side > 0 || (self.side == 0 && above <= half) {
            (1.0, above)
        } else {
            (-1.0, self.beyond[0] + u * self.total)
        }
    }
}

impl SphericalRect {
    /// The rectangle `x` × `y` in the plane at distance `h` above the origin; `None` where it is seen
    /// from its own plane or has no size.
    pub fn new(x: [f64; 2], y: [f64; 2], h: f64) -> Option<Self> {
        let half_strip = (h * (y[1] - y[0])).atan2(y[0] * y[1] + h * h);
        let along_x = Span::new(x, half_strip, |x| beyond_x(x, y, h));
        (h > 0.0 && along_x.total > 0.0).then_some(Self { x, y, h, half_strip, along_x })
    }

    /// Steradians; the density of [`SphericalRect::sample`] is one over it.
    pub fn solid_angle(&self) -> f64 {
        self.along_x.total
    }

    /// A point (x, y) of the rectangle whose direction is uniform.
    pub fn sample(&self, u: [f32; 2]) -> [f64; 2] {
        let [u, v] = u.map(f64::from);
        let (h, y) = (self.h, self.y);
        let (sign, beyond) = self.along_x.at(u, self.half_strip);
        // tan² of the angle to x is sin²a / (m (m + 2 e₀e₁)) where a is the solid angle from 0 to x,
        // m = cos a − cos(half strip), and e the cosines of the angles to y₀ and y₁.
        let m = 2.0 * (0.5 * beyond).sin() * (self.half_strip - 0.5 * beyond).sin();
        let e = h * h / (y[0].hypot(h) * y[1].hypot(h));
        let x = sign * h * (self.half_strip - beyond).sin() / (m * (m + 2.0 * e)).sqrt();
        let x = x.max(self.x[0]).min(self.x[1]);

        let s_squared = x * x + h * h;
        let (sign, beyond) = Span::new(y, 1.0, |y| beyond_y(y, s_squared)).at(v, 1.0);
        let y = sign * (1.0 - beyond) * (s_squared / (beyond * (2.0 - beyond))).sqrt();
        [x, y.max(self.y[0]).min(self.y[1])]
    }
}

/// Solid angle of all beyond `x` ≥ 0 between the two `y` at distance `h`.
fn beyond_x(x: f64, [y0, y1]: [f64; 2], h: f64) -> f64 {
    let s_squared = x * x + h * h;
    let (r0, r1) = ((s_squared + y0 * y0).sqrt(), (s_squared + y1 * y1).sqrt());
    let plain = y1 * r0 - y0 * r1;
    let cross = if y0 * y1 > 0.0 { s_squared * (y1 - y0) * (y1 + y0) / (y1 * r0 + y0 * r1) } else { plain };
    let sin = h * (s_squared * (y1 - y0) + x * cross);
    let cos = (s_squared + x * r0) * (s_squared + x * r1) + h * h * y0 * y1;
    sin.atan2(cos)
}

/// `1 − sin` of the elevation of `y` ≥ 0 above the arc whose distance is the root of `s_squared`.
fn beyond_y(y: f64, s_squared: f64) -> f64 {
    let r = (s_squared + y * y).sqrt();
    s_squared / (r * (r + y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;
    use std::f64::consts::{PI, TAU};

    /// A. Van Oosterom, J. Strackee: *The Solid Angle of a Plane Triangle*, IEEE Transactions on
    /// Biomedical Engineering 30(2), 1983: the two triangles of a rectangle.
    fn van_oosterom([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], h: f64) -> f64 {
        let triangle = |a: DVec3, b: DVec3, c: DVec3| {
            let (la, lb, lc) = (a.length(), b.length(), c.length());
            // Edges first: the determinant of three nearly parallel vectors cancels.
            let det = a.dot((b - a).cross(c - a)).abs();
            2.0 * det.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
        };
        let at = |x, y| DVec3::new(x, y, h);
        triangle(at(x0, y0), at(x1, y0), at(x1, y1)) + triangle(at(x0, y0), at(x1, y1), at(x0, y1))
    }

    type Case = ([f64; 2], [f64; 2], f64);

    fn cases() -> Vec<Case> {
        let mut cases: Vec<Case> = vec![
            ([-1.0, 1.0], [-1.0, 1.0], 1.0),
            ([-0.3, 2.0], [0.5, 0.7], 0.2),
            ([-3.0, -2.0], [-0.5, 0.7], 0.4),
            ([2.0, 3.0], [1.0, 7.0], 0.5),
            ([0.0, 1.0], [0.0, 1.0], 1e-3),
            ([-0.5, 0.5], [-0.5, 0.5], 1e6),
            ([5.0, 5.001], [-3.001, -3.0], 2.0),
            ([-1e3, 1e3], [-1e-6, 1e-6], 1.0),
            ([-1e-6, 1e-6], [-1e3, 1e3], 1.0),
        ];
        for k in 1..9 {
            let h = 10.0_f64.powi(-k);
            // Touching; beside it along x, along y and across a corner; tiny and far.
            cases.push(([-0.6237, 0.3763], [-0.5412, 0.4588], h));
            cases.push(([0.2, 1.0], [-0.3, 0.4], h));
            cases.push(([-0.2, 1.0], [0.3, 0.4], h));
            cases.push(([-2.0, -1.0], [0.3, 0.4], h));
            cases.push(([0.7 * h, 2.7 * h], [-1.0 * h, 0.5 * h], 1.0));
            cases.push(([1.0, 1.0 + h], [2.0, 2.0 + h], 0.5));
            cases.push(([-1.0, -1.0 + h], [-0.5 * h, 0.5 * h], 0.1));
        }
        cases
    }

    #[test]
    fn solid_angles_are_those_of_two_triangles() {
        let mut worst: f64 = 0.0;
        for (x, y, h) in cases() {
            let solid_angle = SphericalRect::new(x, y, h).unwrap().solid_angle();
            let exact = van_oosterom(x, y, h);
            // The reference cancels, too, where the rectangle is thin and the plane near.
            let error = (solid_angle - exact).abs();
            assert!(error <= 1e-8 * exact, "{x:?} {y:?} {h}: {solid_angle} and {exact}");
            worst = worst.max(error / exact);
        }
        assert!(worst < 1e-8);
        let touching = SphericalRect::new([-0.5, 0.5], [-0.5, 0.5], 1e-12).unwrap();
        assert!((touching.solid_angle() - (TAU - 8.0 * 2.0_f64.sqrt() * 1e-12)).abs() < 1e-14);
    }

    #[test]
    fn each_side_of_a_sample_has_its_share() {
        let steps = [0.0, 0.001, 0.1, 0.37, 0.5, 0.77, 0.999, 1.0 - f32::EPSILON / 2.0];
        for (x, y, h) in cases() {
            let rect = SphericalRect::new(x, y, h).unwrap();
            for (u, v) in steps.into_iter().flat_map(|u| steps.map(|v| (u, v))) {
                let [sx, sy] = rect.sample([u, v]);
                assert!((x[0]..=x[1]).contains(&sx) && (y[0]..=y[1]).contains(&sy), "{x:?} {y:?} {h}: {sx} {sy}");
                let measure = |x, y| SphericalRect::new(x, y, h).map_or(0.0, |r| r.solid_angle());
                let left = measure([x[0], sx], y) / rect.solid_angle();
                let (u, v) = (f64::from(u), f64::from(v));
                assert!((left - u).abs() < 1e-6, "{x:?} {y:?} {h}: {left} left of {u}");
                // Of the arc at sx, by the sine of elevation.
                let sine = |y: f64| y / (sx * sx + h * h + y * y).sqrt();
                let below = (sine(sy) - sine(y[0])) / (sine(y[1]) - sine(y[0]));
                // The sines of the test cancel; what is tested is not the test.
                let noise = 1e-15 / (sine(y[1]) - sine(y[0])).abs();
                assert!((below - v).abs() < 1e-6 + noise, "{x:?} {y:?} {h}: {below} below {v}");
            }
        }
    }

    #[test]
    fn nothing_is_seen_from_its_own_plane_or_without_size() {
        assert_eq!(SphericalRect::new([1.0, 2.0], [1.0, 2.0], 0.0), None);
        assert_eq!(SphericalRect::new([1.0, 1.0], [1.0, 2.0], 1.0), None);
        assert_eq!(SphericalRect::new([1.0, 2.0], [2.0, 2.0], 1.0), None);
        assert!(
            (SphericalRect::new([-1.0, 1.0], [-1.0, 1.0], 1.0).unwrap().solid_angle() - 4.0 * PI / 6.0).abs() < 1e-15
        );
    }
}
