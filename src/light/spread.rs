//! The cone into which each point of a flat light emits, as in Cycles.
//!
//! Radiance at the angle t from the axis is that of the light times
//! `max((tan a − tan t) / (tan a − a), 0)` with a the half angle: the emitted power stays `π A L`
//! whatever a is.

use std::f64::consts::{FRAC_PI_2, PI};

/// Half angles below this, radians, are this: 0.2 mm of blur at a metre, and a fortieth of the Sun's.
/// The rounding of a direction in `f32`, 6e-8, is then below a thousandth of the cone. A truly parallel
/// light would be a delta that no other sampling strategy could find.
const LEAST_HALF_ANGLE: f64 = 1e-4;

/// How a flat light's radiance varies with direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    half: f64,
    /// Tangent of the half angle; infinite for none.
    tan: f64,
    /// Factor on the axis.
    peak: f64,
}

impl Spread {
    /// Radiance is the same in all directions.
    pub const FULL: Self = Self { half: FRAC_PI_2, tan: f64::INFINITY, peak: 1.0 };

    /// The cone of the full angle `angle`, radians: π for none, 0 for parallel light.
    pub fn new(angle: f64) -> Self {
        let half = (0.5 * angle).max(LEAST_HALF_ANGLE);
        // As little short of π as this is not seen, and its tangent is mostly rounding.
        if half > FRAC_PI_2 - 1e-9 || half.is_nan() {
            return Self::FULL;
        }
        let tan = half.tan();
        Self { half, tan, peak: tan / tan_minus_angle(half) }
    }

    /// True where radiance is the same in all directions.
    pub fn is_full(&self) -> bool {
        self.tan == f64::INFINITY
    }

    /// Half of its angle, radians.
    pub fn half_angle(&self) -> f64 {
        self.half
    }

    /// Tangent of the half angle: the radius of the part of an endless light that a point at distance
    /// 1 sees.
    pub fn tan(&self) -> f64 {
        self.tan
    }

    /// The factor on the axis, the largest.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The factor of radiance at the angle from the axis whose tangent is given.
    pub fn factor(&self, tan: f64) -> f64 {
        if self.is_full() { 1.0 } else { self.peak * (1.0 - tan / self.tan).max(0.0) }
    }

    /// Where a point sees an endless light by distance from its foot point, with density proportional
    /// to the factor: radius as a share of that of the footprint.
    pub fn sample_radius(u: f64) -> f64 {
        // The root in 0 to 1 of 3 r² − 2 r³ = u.
        (0.5 - ((1.0 - 2.0 * u).clamp(-1.0, 1.0).asin() / 3.0).sin()).clamp(0.0, 1.0)
    }

    /// Density in area of [`Spread::sample_radius`] with a uniform azimuth, on a disk of radius 1.
    pub fn pdf_radius(r: f64) -> f64 {
        3.0 / PI * (1.0 - r).max(0.0)
    }
}

/// `tan a − a` without cancellation.
fn tan_minus_angle(a: f64) -> f64 {
    if a > 0.05 {
        return a.tan() - a;
    }
    let s = a * a;
    a * s * (1.0 / 3.0 + s * (2.0 / 15.0 + s * (17.0 / 315.0 + s * (62.0 / 2835.0 + s * 1382.0 / 155_925.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_stays() {
        for angle in [0.0, 1e-4, 1e-3, 0.09999, 0.10001, 1.0, 2.0, 3.0, 3.14, PI] {
            let spread = Spread::new(angle);
            // ∫ factor cos sin over the half-space is 1/2; in w = sin² of the angle.
            let n = 200_000;
            let top = spread.half_angle().sin().powi(2);
            let mean: f64 = (0..n)
                .map(|i| {
                    let w = top * (f64::from(i) + 0.5) / f64::from(n);
                    spread.factor((w / (1.0 - w)).sqrt())
                })
                .sum::<f64>()
                / f64::from(n);
            assert!((mean * top - 1.0).abs() < 1e-5, "{angle}: {}", mean * top);
        }
    }

    #[test]
    fn the_series_meets_the_tangent() {
        for a in [0.0499_f64, 0.0501] {
            let exact = a.tan() - a;
            assert!((tan_minus_angle(a) / exact - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn radii_follow_their_density() {
        for i in 0..=1000 {
            let u = f64::from(i) / 1000.0;
            let r = Spread::sample_radius(u);
            assert!((r * r * (3.0 - 2.0 * r) - u).abs() < 1e-12);
        }
        let step = 1e-3;
        let total: f64 =
            (0..1000).map(|i| (f64::from(i) + 0.5) * step).map(|r| 2.0 * PI * r * Spread::pdf_radius(r)).sum();
        assert!((total * step - 1.0).abs() < 1e-6);
    }
}
