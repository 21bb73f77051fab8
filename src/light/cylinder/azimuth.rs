//! The azimuth at which a tube is sampled: between its two tangents, uniformly, or by how much of it
//! is seen there where that varies.

/// Intervals of half the range.
const STEPS: usize = 8;

/// Up to this ratio between the middle and the tangents a uniform choice does as well.
const EVEN: f64 = 2.0;

/// A density of azimuths from −`max` to `max`, the same on both sides.
pub struct Azimuth {
    max: f64,
    /// Linear between [`node`]s, not normalised; `None` for a uniform density.
    density: Option<[f64; STEPS + 1]>,
}

/// Share of the half range at which interval `k` begins. From outside and close to a tube what is
/// seen of it changes ever faster towards the tangents, so the intervals halve.
fn node(k: usize) -> f64 {
    if k < STEPS { 1.0 - 1.0 / f64::from(1 << k) } else { 1.0 }
}

impl Azimuth {
    /// Azimuths up to `max`, roughly in proportion to `width`, which is even.
    pub fn new(max: f64, width: impl Fn(f64) -> f64) -> Self {
        let (middle, rim) = (width(0.0), width(max));
        let even = rim <= EVEN * middle && middle <= EVEN * rim;
        let density = (!even).then(|| std::array::from_fn(|k| width(max * node(k))));
        let possible = |density: &[f64; STEPS + 1]| density.iter().all(|d| d.is_finite() && *d > 0.0);
        Self { max, density: density.filter(possible) }
    }

    /// The azimuth of the uniform number `u` and its density.
    pub fn sample(&self, u: f64) -> (f64, f64) {
        let Some(density) = &self.density else { return ((2.0 * u - 1.0) * self.max, 0.5 / self.max) };
        let (sign, u) = if u < 0.5 { (-1.0, 1.0 - 2.0 * u) } else { (1.0, 2.0 * u - 1.0) };
        let total = total(density);
        let mut left = u * total;
        let mut k = 0;
        while k + 1 < STEPS && left > mass(density, k) {
            left -= mass(density, k);
            k += 1;
        }
        let (a, b) = (density[k], density[k + 1]);
        let u = (left / mass(density, k)).min(1.0);
        // The inverse of a linear density's distribution (Pharr, Jakob, Humphreys: PBRT, 4th edition, 2.3.2).
        let t = (u * (a + b) / (a + (a * a + u * (b * b - a * a)).max(0.0).sqrt())).min(1.0);
        let share = node(k) + t * (node(k + 1) - node(k));
        (sign * share * self.max, 0.5 * (a + t * (b - a)) / (total * self.max))
    }

    /// The azimuth `phi`, moved into the range if rounding has left it outside, and its density.
    pub fn pdf(&self, phi: f64) -> (f64, f64) {
        let phi = phi.clamp(-self.max, self.max);
        let Some(density) = &self.density else { return (phi, 0.5 / self.max) };
        let share = phi.abs() / self.max;
        let k = (1..STEPS).find(|&k| share < node(k)).unwrap_or(STEPS) - 1;
        let t = (share - node(k)) / (node(k + 1) - node(k));
        (phi, 0.5 * (density[k] + t * (density[k + 1] - density[k])) / (total(density) * self.max))
    }
}

/// Integral over interval `k`, in shares of the half range.
fn mass(density: &[f64; STEPS + 1], k: usize) -> f64 {
    0.5 * (density[k] + density[k + 1]) * (node(k + 1) - node(k))
}

fn total(density: &[f64; STEPS + 1]) -> f64 {
    (0..STEPS).map(|k| mass(density, k)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_normalised_and_that_of_the_samples() {
        for width in [(|_| 1.0) as fn(f64) -> f64, |phi| 1.0 / (1.01 - phi.sin().abs()), |phi| 1e-3 + (0.8 - phi.abs())]
        {
            let azimuth = Azimuth::new(0.8, width);
            let n = 200_000;
            let all: f64 = (0..n).map(|i| azimuth.pdf(1.6 * (f64::from(i) + 0.5) / f64::from(n) - 0.8).1).sum();
            assert!((all * 1.6 / f64::from(n) - 1.0).abs() < 1e-4);
            let mut last = (-0.8, 0.0);
            for i in 0..=1000 {
                let u = f64::from(i) / 1000.0;
                let (phi, q) = azimuth.sample(u);
                assert!((azimuth.pdf(phi).1 / q - 1.0).abs() < 1e-9, "{u}");
                // Between two samples there is as much mass as between their numbers.
                let steps = 256;
                let mass: f64 = (0..steps)
                    .map(|j| azimuth.pdf(last.0 + (phi - last.0) * (f64::from(j) + 0.5) / f64::from(steps)).1)
                    .sum();
                assert!((mass * (phi - last.0) / f64::from(steps) - (u - last.1)).abs() < 1e-5, "{u}");
                last = (phi, u);
            }
        }
    }
}
