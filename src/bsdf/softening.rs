//! The edges of shadows that shading normals make.

use crate::math::{Vec3, safe_acos, sqr};

/// How light near the horizon of a normal is dimmed, so that it ends in no step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Factor of the angle to the normal, from 1 for none; see [`Softening::at_edge`].
    pub frequency: f32,
    /// True where a map or a graph bends the normal; see [`Softening::of_bumps`].
    pub bumps: bool,
}

impl Softening {
    /// What is left at a cosine of `cos` to the normal, either side: cos(f θ) over cos θ, which ends before the horizon.
    /// Appleseed's and Cycles' workaround for coarse triangles.
    pub(super) fn at_edge(&self, cos: f32) -> f32 {
        if self.frequency <= 1.0 || cos <= 0.0 {
            return 1.0;
        }
        let cos = cos.min(1.0);
        (safe_acos(cos) * self.frequency).cos().max(0.0) / cos
    }

    /// What diffuse lobes have left towards `wi` where their normal, z, is bent from the smooth normal `ns`: Alejandro
    /// Conty Estevez, Pascal Lecocq, Clifford Stein, *A Microfacet-Based Shadowing Function to Solve the Bump Terminator
    /// Problem*, Ray Tracing Gems, 2019, chapter 12.
    pub(super) fn of_bumps(&self, ns: Vec3, wi: Vec3) -> f32 {
        let (cos_i, cos_d) = (ns.dot(wi).abs(), ns.z.abs());
        if !self.bumps || cos_d >= 1.0 || cos_i >= 1.0 {
            return 1.0;
        }
        if cos_i < 1e-6 {
            return 0.0;
        }
        let alpha_squared = (0.125 * (1.0 / sqr(cos_d) - 1.0)).min(1.0);
        2.0 / (1.0 + (1.0 + alpha_squared * (1.0 / sqr(cos_i) - 1.0)).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_from_above_stays_and_that_from_the_horizon_goes() {
        let softening = Softening { frequency: 1.0 / (1.0 - 0.5 * 0.4), bumps: true };
        assert!((softening.at_edge(1.0) - 1.0).abs() < 1e-6);
        // cos(1.25 · 60°) / cos 60°.
        assert!((softening.at_edge(0.5) - 75.0_f32.to_radians().cos() / 0.5).abs() < 1e-5);
        assert_eq!((softening.at_edge(0.05), softening.at_edge(-0.5)), (0.0, 1.0));
        let bent = Vec3::new(0.6, 0.0, 0.8);
        let towards = |degrees: f32| {
            softening.of_bumps(bent, Vec3::new(-degrees.to_radians().sin(), 0.0, degrees.to_radians().cos()))
        };
        assert!(towards(0.0) > towards(30.0) && towards(30.0) > towards(50.0) && towards(50.0) > 0.0);
        assert_eq!(softening.of_bumps(Vec3::Z, Vec3::new(0.6, 0.0, 0.8)), 1.0);
        assert_eq!(Softening { bumps: false, ..softening }.of_bumps(bent, Vec3::Z), 1.0);
    }
}
