//! A factor of emission that the light's author has computed for each direction.

use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

use crate::math::{DMat3, DVec3, Rgb, Vec3};

/// By the unit direction in which light leaves, render space, and how far it goes, metres: a factor from 0.
#[derive(Clone)]
pub struct Drawn(Arc<dyn Fn(Vec3, f32) -> Rgb + Send + Sync>);

/// Directions over the polar and the azimuthal angle among which the largest factor is looked for.
const LOOKED_AT: [usize; 2] = [64, 128];

/// What may be missed between them is allowed for by this factor; it decides how often a light is chosen, no more.
const MARGIN: f32 = 1.1;

impl Drawn {
    /// What `factor` computes.
    pub fn new(factor: impl Fn(Vec3, f32) -> Rgb + Send + Sync + 'static) -> Self {
        Self(Arc::new(factor))
    }

    pub(super) fn factor(&self, w: DVec3, dist: f32) -> Rgb {
        (self.0)(w.normalize_or_zero().as_vec3(), dist)
    }

    /// A little more than the largest factor of some directions, spread evenly within the angle `half` from `axis`, a metre
    /// away.
    pub(super) fn peak(&self, axis: Vec3, half: f64) -> Rgb {
        let z = axis.as_dvec3().normalize_or(DVec3::Z);
        let x = z.any_orthonormal_vector();
        let frame = DMat3::from_cols(x, z.cross(x), z);
        let [polar, azimuths] = LOOKED_AT;
        let mut peak = Rgb::BLACK;
        for i in 0..polar {
            let cos = 1.0 - (1.0 - half.cos()) * (i as f64 + 0.5) / polar as f64;
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            for j in 0..azimuths {
                let (sin_phi, cos_phi) = (TAU * j as f64 / azimuths as f64).sin_cos();
                let found = self.factor(frame * DVec3::new(sin * cos_phi, sin * sin_phi, cos), 1.0);
                peak = Rgb::new(peak.r.max(found.r), peak.g.max(found.g), peak.b.max(found.b));
            }
        }
        peak * MARGIN
    }
}

impl fmt::Debug for Drawn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Drawn")
    }
}

impl PartialEq for Drawn {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}
