//! Reflectance of metals by their complex index of refraction.

use super::fresnel::Metal;
use crate::math::{Rgb, sqr};

/// An index n + ik per channel, of colors of type `C`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conductor<C = Rgb> {
    /// n.
    pub eta: C,
    /// k.
    pub k: C,
}

impl Conductor {
    /// Reflectance for unpolarized light by Fresnel's equations.
    #[inline]
    pub(super) fn reflectance(&self, cos: f32) -> Rgb {
        self.eta.zip(self.k, |eta, k| reflectance(cos, eta, k))
    }

    /// The metal of two values whose mean over the hemisphere stands for that of this one: within 0.01 for
    /// real metals.
    pub(super) fn fit(&self) -> Metal {
        Metal::through(self.reflectance(1.0), self.reflectance(1.0 / 7.0))
    }
}

/// Max Born and Emil Wolf, *Principles of Optics*, 7th edition, section 14.4.1, with n + ik for n(1 + ik).
fn reflectance(cos: f32, eta: f32, k: f32) -> f32 {
    let sin_squared = 1.0 - cos * cos;
    let t1 = eta * eta - k * k - sin_squared;
    let t2 = (sqr(t1) + sqr(2.0 * eta * k)).sqrt();
    let u = (0.5 * (t2 + t1)).max(0.0).sqrt();
    let v_squared = (0.5 * (t2 - t1)).max(0.0);
    let divide = |a: f32, b: f32| if b > 0.0 { a / b } else { 1.0 };
    let s = divide(sqr(cos - u) + v_squared, sqr(cos + u) + v_squared);
    let (t3, t4, v) = ((eta * eta - k * k) * cos, 2.0 * eta * k * cos, v_squared.sqrt());
    let p = divide(sqr(t3 - u) + sqr(t4 - v), sqr(t3 + u) + sqr(t4 + v));
    0.5 * (s + p)
}

#[cfg(test)]
mod tests {
    use super::super::fresnel_dielectric;
    use super::*;

    #[test]
    fn without_absorption_it_is_a_dielectric() {
        for cos in [0.02_f32, 0.3, 0.7, 1.0] {
            for eta in [1.2, 1.5, 2.4] {
                assert!((reflectance(cos, eta, 0.0) - fresnel_dielectric(cos, eta)).abs() < 1e-4, "{cos} {eta}");
            }
        }
    }

    #[test]
    fn gold_is_gold() {
        let gold = Conductor { eta: Rgb::new(0.183, 0.422, 1.373), k: Rgb::new(3.424, 2.346, 1.770) };
        let f0 = gold.reflectance(1.0);
        // ((n − 1)² + k²) / ((n + 1)² + k²).
        let exact = gold.eta.zip(gold.k, |n, k| (sqr(n - 1.0) + k * k) / (sqr(n + 1.0) + k * k));
        assert!((f0 - exact).to_array().iter().all(|d| d.abs() < 1e-5), "{f0:?} {exact:?}");
        assert!(gold.reflectance(0.0).to_array().iter().all(|&f| (f - 1.0).abs() < 1e-6));
        // The mean by the fit against the integral.
        let n = 4000;
        let mean = (0..n).map(|i| (i as f32 + 0.5) / n as f32).map(|mu| gold.reflectance(mu) * (2.0 * mu / n as f32));
        let d = mean.sum::<Rgb>() - gold.fit().average();
        assert!(d.to_array().iter().all(|d| d.abs() < 0.01), "{d:?}");
    }
}
