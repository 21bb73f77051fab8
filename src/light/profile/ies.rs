//! Measured distributions of intensity (IES LM-63, type C), bilinear between their angles.

use std::f64::consts::PI;

use super::quadrature;

/// A measured distribution, ready to look up: vertical angle 0 is the light's local −z, horizontal
/// angle 0 its local +x and 90 degrees +y.
#[derive(Clone, Debug, PartialEq)]
pub struct Ies {
    /// Vertical angles in radians as seen on the light, growing; beyond them there is no light.
    vertical: Vec<f64>,
    /// Horizontal angles in degrees, growing from 0.
    horizontal: Vec<f64>,
    /// Factors, one row of vertical angles for each horizontal angle.
    factors: Vec<f64>,
    /// One row more: the mean over all horizontal angles.
    mean: Vec<f64>,
}

/// Growing.
fn grows(angles: &[f64]) -> bool {
    angles.windows(2).all(|pair| pair[0] < pair[1])
}

impl Ies {
    /// The profile of `candela`, `horizontal.len()` rows of `vertical.len()`, at angles in degrees: the
    /// first horizontal one is 0 and the last 0 (symmetric around the axis), 90 (in quadrants), 180
    /// (to a plane) or 360. `angle_scale` is UsdLux' one, 0 for none. The factors are scaled to keep
    /// the power of a light that shines evenly all around, or else to 1 at the brightest. `None` where
    /// the numbers are no such profile, or black.
    pub fn new(
        vertical: &[f64],
        horizontal: &[f64],
        candela: &[f64],
        angle_scale: f64,
        keep_power: bool,
    ) -> Option<Self> {
        let last = *horizontal.last()?;
        let spans = horizontal[0] == 0.0 && [0.0, 90.0, 180.0, 360.0].contains(&last);
        let fits = vertical.len() >= 2 && candela.len() == vertical.len() * horizontal.len();
        let brightest = candela.iter().copied().fold(0.0, f64::max);
        let sane = candela.iter().all(|c| c.is_finite() && *c >= 0.0) && brightest > 0.0;
        if !(spans && fits && sane && grows(vertical) && grows(horizontal)) {
            return None;
        }
        // From the profile's angle to the light's: the inverse of UsdLux' applyAngleScale.
        let scaled = |degrees: &f64| match degrees.to_radians() {
            theta if angle_scale > 0.0 => theta * angle_scale,
            theta if angle_scale < 0.0 => PI + (theta - PI) * -angle_scale,
            theta => theta,
        };
        let mut ies = Self {
            vertical: vertical.iter().map(scaled).collect(),
            horizontal: horizontal.to_vec(),
            factors: candela.iter().map(|c| c / brightest).collect(),
            mean: Vec::new(),
        };
        ies.mean = ies.mean_row();
        if keep_power {
            let power = ies.power();
            // Scaled to angles that do not exist there may be nothing left.
            if power <= 0.0 {
                return None;
            }
            ies.factors.iter_mut().chain(&mut ies.mean).for_each(|factor| *factor /= power);
        }
        Some(ies)
    }

    /// The mean over horizontal angles, exact for what is linear between them.
    fn mean_row(&self) -> Vec<f64> {
        let n = self.vertical.len();
        if self.horizontal.len() == 1 {
            return self.factors.clone();
        }
        let span = self.horizontal[self.horizontal.len() - 1];
        let mut mean = vec![0.0; n];
        for (j, pair) in self.horizontal.windows(2).enumerate() {
            let share = 0.5 * (pair[1] - pair[0]) / span;
            for (i, mean) in mean.iter_mut().enumerate() {
                *mean += share * (self.factors[j * n + i] + self.factors[(j + 1) * n + i]);
            }
        }
        mean
    }

    /// Mean factor over the sphere.
    fn power(&self) -> f64 {
        let steps = self.vertical.windows(2).map(|pair| [pair[0].max(0.0), pair[1].min(PI)]);
        steps
            .filter(|[from, to]| from < to)
            .map(|[from, to]| quadrature::gauss(from, to, |theta| self.mean_factor(theta) * 0.5 * theta.sin()))
            .sum()
    }

    /// The factor at `theta` radians off the axis and the azimuth `phi`, radians.
    pub(super) fn factor(&self, theta: f64, phi: f64) -> f64 {
        let Some((i, s)) = self.between_vertical(theta) else { return 0.0 };
        let n = self.vertical.len();
        let at = |row: usize| {
            let row = &self.factors[row * n..][..n];
            row[i] + (row[i + 1] - row[i]) * s
        };
        if self.horizontal.len() == 1 {
            return at(0);
        }
        let phi = self.folded(phi.to_degrees());
        let j = self.horizontal.partition_point(|&h| h <= phi).clamp(1, self.horizontal.len() - 1) - 1;
        let (from, to) = (self.horizontal[j], self.horizontal[j + 1]);
        let t = ((phi - from) / (to - from)).clamp(0.0, 1.0);
        at(j) + (at(j + 1) - at(j)) * t
    }

    /// The mean of [`Ies::factor`] over all azimuths.
    pub(super) fn mean_factor(&self, theta: f64) -> f64 {
        self.between_vertical(theta).map_or(0.0, |(i, s)| self.mean[i] + (self.mean[i + 1] - self.mean[i]) * s)
    }

    fn between_vertical(&self, theta: f64) -> Option<(usize, f64)> {
        let n = self.vertical.len();
        if !(self.vertical[0]..=self.vertical[n - 1]).contains(&theta) {
            return None;
        }
        let i = self.vertical.partition_point(|&v| v <= theta).clamp(1, n - 1) - 1;
        let (from, to) = (self.vertical[i], self.vertical[i + 1]);
        Some((i, ((theta - from) / (to - from)).clamp(0.0, 1.0)))
    }

    /// An azimuth in degrees as one between the first and the last that were measured.
    fn folded(&self, phi: f64) -> f64 {
        let span = self.horizontal[self.horizontal.len() - 1];
        let mirrored = |phi: f64, period: f64| {
            let phi = phi.rem_euclid(period);
            phi.min(period - phi)
        };
        match span {
            s if s <= 90.0 => mirrored(phi, 180.0),
            s if s <= 180.0 => mirrored(phi, 360.0),
            _ => phi.rem_euclid(360.0),
        }
    }

    /// Largest factor.
    pub(super) fn peak(&self) -> f64 {
        self.factors.iter().copied().fold(0.0, f64::max)
    }

    /// The angles off the axis between which there is light, radians.
    pub(super) fn support(&self) -> [f64; 2] {
        let n = self.vertical.len();
        let lit = |i: &usize| self.factors.iter().skip(*i).step_by(n).any(|&factor| factor > 0.0);
        let first = (0..n).find(lit).map_or(0, |i| i.saturating_sub(1));
        let last = (0..n).rev().find(lit).map_or(0, |i| (i + 1).min(n - 1));
        [self.vertical[first].max(0.0), self.vertical[last].min(PI)]
    }

    /// The angles off the axis at which the factor is not smooth, radians.
    pub(super) fn edges(&self) -> &[f64] {
        &self.vertical
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VERTICAL: [f64; 3] = [0.0, 45.0, 90.0];

    #[test]
    fn is_bilinear_and_black_outside() {
        let ies = Ies::new(&VERTICAL, &[0.0, 90.0], &[4.0, 2.0, 0.0, 8.0, 6.0, 4.0], 0.0, false).unwrap();
        let at = |theta: f64, phi: f64| 8.0 * ies.factor(theta.to_radians(), phi.to_radians());
        for (theta, phi, candela) in
            [(0.0, 0.0, 4.0), (22.5, 0.0, 3.0), (45.0, 45.0, 4.0), (67.5, 90.0, 5.0), (90.0, 30.0, 4.0 / 3.0)]
        {
            assert!((at(theta, phi) - candela).abs() < 1e-12, "{theta} {phi}: {}", at(theta, phi));
            // The same in each quadrant.
            for mirrored in [180.0 - phi, 180.0 + phi, -phi, 360.0 - phi] {
                assert!((at(theta, mirrored) - candela).abs() < 1e-12, "{theta} {mirrored}");
            }
        }
        assert_eq!((at(90.001, 0.0), at(180.0, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn each_span_is_mirrored_as_it_should() {
        let rows = |n: usize| (0..n).flat_map(|j| [1.0 + j as f64; 3]).collect::<Vec<_>>();
        let plane = Ies::new(&VERTICAL, &[0.0, 90.0, 180.0], &rows(3), 0.0, false).unwrap();
        let full = Ies::new(&VERTICAL, &[0.0, 90.0, 180.0, 270.0, 360.0], &rows(5), 0.0, false).unwrap();
        let round = Ies::new(&VERTICAL, &[0.0], &rows(1), 0.0, false).unwrap();
        for (phi, of_plane, of_full) in [(0.0, 1.0, 1.0), (45.0, 1.5, 1.5), (200.0, 3.0 - 2.0 / 9.0, 3.0 + 2.0 / 9.0)] {
            let phi = f64::to_radians(phi);
            assert!((3.0 * plane.factor(0.3, phi) - of_plane).abs() < 1e-12);
            assert!((5.0 * full.factor(0.3, phi - 2.0 * PI) - of_full).abs() < 1e-12);
            assert_eq!(round.factor(0.3, phi), 1.0);
        }
    }

    #[test]
    fn angle_scale_is_that_of_usd() {
        let at = |scale: f64, theta: f64| {
            Ies::new(&[0.0, 90.0, 180.0], &[0.0], &[1.0, 0.0, 0.5], scale, false).unwrap().factor(theta, 0.0)
        };
        let plain = |theta: f64| if (0.0..=PI).contains(&theta) { at(0.0, theta) } else { 0.0 };
        for i in 1..18 {
            let theta = f64::from(i) * 0.17;
            for scale in [0.5, 2.0, 1.0] {
                assert!((at(scale, theta) - plain(theta / scale)).abs() < 1e-12, "{scale} {theta}");
                assert!((at(-scale, theta) - plain((theta - PI) / scale + PI)).abs() < 1e-12, "{scale} {theta}");
            }
        }
    }

    #[test]
    fn power_is_kept() {
        let mean = |ies: &Ies| {
            // Midpoints of both angles.
            let n = 400;
            let cell = |i: usize, j: usize| {
                let (theta, phi) = (PI * (i as f64 + 0.5) / n as f64, 2.0 * PI * (j as f64 + 0.5) / n as f64);
                ies.factor(theta, phi) * theta.sin() * 0.5 * PI / (n * n) as f64
            };
            (0..n * n).map(|k| cell(k % n, k / n)).sum::<f64>()
        };
        let candela = [4.0, 2.0, 0.0, 8.0, 6.0, 4.0, 1.0, 0.0, 9.0];
        for scale in [0.0, 0.4, 1.7, -0.6] {
            let ies = Ies::new(&VERTICAL, &[0.0, 30.0, 90.0], &candela, scale, true).unwrap();
            assert!((mean(&ies) - 1.0).abs() < 2e-3, "{scale}: {}", mean(&ies));
        }
        // Nothing is left of a hemisphere that is scaled away.
        assert_eq!(Ies::new(&VERTICAL, &[0.0, 30.0, 90.0], &candela, -9.0, true), None);
    }

    #[test]
    fn light_stays_within_the_support() {
        let ies = Ies::new(&[0.0, 30.0, 60.0, 90.0, 120.0], &[0.0], &[0.0, 0.0, 1.0, 0.0, 0.0], 0.0, false).unwrap();
        let [from, to] = ies.support();
        assert!((from - 30.0_f64.to_radians()).abs() < 1e-12 && (to - 90.0_f64.to_radians()).abs() < 1e-12);
        assert_eq!(ies.peak(), 1.0);
    }

    #[test]
    fn what_is_no_profile_is_none() {
        let bad: [(&[f64], &[f64], &[f64]); 7] = [
            (&[], &[], &[]),
            (&[0.0], &[0.0], &[1.0]),
            (&[0.0, 90.0], &[0.0], &[1.0]),
            (&[0.0, 90.0], &[0.0], &[0.0, 0.0]),
            (&[0.0, 90.0], &[0.0], &[f64::NAN, 1.0]),
            (&[90.0, 0.0], &[0.0], &[1.0, 1.0]),
            (&[0.0, 90.0], &[0.0, 45.0], &[1.0, 1.0, 1.0, 1.0]),
        ];
        for (vertical, horizontal, candela) in bad {
            assert_eq!(Ies::new(vertical, horizontal, candela, 0.0, false), None);
        }
    }
}
