//! How the light of a lamp falls off with distance, beyond what its solid angle does.

/// The law of decay; all agree at one metre but for the polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// None: a light is as bright from everywhere.
    Constant,
    /// `1 / d`.
    Linear,
    /// Physical, `1 / d²`.
    Quadratic,
    /// `1 / (kc + kl d + kq d²)`, none of them negative, not all 0.
    Polynomial {
        /// Constant term.
        kc: f64,
        /// Linear term, 1/m.
        kl: f64,
        /// Quadratic term, 1/m².
        kq: f64,
    },
}

/// Decay of one light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// The law.
    pub falloff: Falloff,
    /// Cycles' Light Falloff node: the factor `d² / (smooth + d²)`, m²; 0 for none.
    pub smooth: f64,
    /// KHR_lights_punctual's window `clamp(1 − (d / range)⁴, 0, 1)`, metres; infinite for none.
    pub range: f64,
}

impl Decay {
    /// That of nature.
    pub const PHYSICAL: Self = Self { falloff: Falloff::Quadratic, smooth: 0.0, range: f64::INFINITY };

    /// What the law makes of the physical `1 / d²`; grows with `d`.
    fn gain(&self, d: f64) -> f64 {
        let gain = match self.falloff {
            Falloff::Constant => d * d,
            Falloff::Linear => d,
            Falloff::Quadratic => 1.0,
            Falloff::Polynomial { kc, kl, kq } => d * d / (kc + kl * d + kq * d * d),
        };
        if self.smooth > 0.0 { gain * (d * d / (self.smooth + d * d)) } else { gain }
    }

    /// What the range leaves; shrinks with `d`.
    fn window(&self, d: f64) -> f64 {
        if self.range.is_finite() { (1.0 - (d / self.range).powi(4)).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// The factor on what the physical law brings to the distance `d` in metres, above 0.
    pub fn factor(&self, d: f64) -> f64 {
        self.gain(d) * self.window(d)
    }

    /// A bound from above of the factor at distances of `near` to `far`.
    pub fn at_most(&self, near: f64, far: f64) -> f64 {
        self.gain(far) * self.window(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_agree_at_a_metre_and_differ_as_named() {
        let at = |falloff, d: f64| Decay { falloff, ..Decay::PHYSICAL }.factor(d) / (d * d);
        for d in [0.01, 0.5, 1.0, 3.0, 1e4] {
            assert!((at(Falloff::Constant, d) - 1.0).abs() < 1e-12);
            assert!((at(Falloff::Linear, d) * d - 1.0).abs() < 1e-12);
            assert!((at(Falloff::Quadratic, d) * d * d - 1.0).abs() < 1e-12);
            let polynomial = at(Falloff::Polynomial { kc: 0.5, kl: 2.0, kq: 0.25 }, d);
            assert!((polynomial * (0.5 + 2.0 * d + 0.25 * d * d) - 1.0).abs() < 1e-12);
        }
        let smooth = Decay { smooth: 4.0, ..Decay::PHYSICAL };
        assert!((smooth.factor(2.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_window_ends_at_the_range_and_bounds_hold() {
        let decay = Decay { falloff: Falloff::Linear, smooth: 0.3, range: 10.0 };
        assert_eq!((decay.factor(10.0), decay.factor(11.0), decay.at_most(10.0, 12.0)), (0.0, 0.0, 0.0));
        for (near, far) in [(0.0, 3.0), (2.0, 2.0), (8.0, 12.0)] {
            let most = decay.at_most(near, far);
            for i in 0..=100 {
                assert!(decay.factor(near + (far - near) * f64::from(i) / 100.0) <= most + 1e-12);
            }
        }
    }
}
