//! The analytic daylight of Lukas Hosek, Alexander Wilkie: *An Analytic Model for Full Spectral Sky-Dome Radiance*,
//! SIGGRAPH 2012, with their fit for red, green and blue. Cycles takes their fit for XYZ, which differs by a few
//! percent (tests/addon holds what a sky lights to 4 % of Cycles' in each channel).

use std::f32::consts::{FRAC_PI_2, PI};

use hw_skymodel::rgb::{Channel, SkyParams, SkyState};

use crate::math::{Rgb, Vec3, safe_acos};

/// Cycles' scale of radiance.
const SCALE: f32 = 2.0 * PI / 683.0;

/// What is picked for a Hosek–Wilkie sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hosek {
    /// To the sun, of any length; below the horizon it counts as on it.
    pub sun_direction: Vec3,
    /// Haze, 1 to 10.
    pub turbidity: f32,
    /// Share of light that the ground reflects, 0 to 1.
    pub ground_albedo: f32,
}

/// A Hosek–Wilkie sky by direction.
pub struct HosekSky {
    sun: Vec3,
    /// `None` where some number was none.
    state: Option<SkyState>,
}

impl Hosek {
    /// Works the parameters out. A sky with a number that is not finite is black.
    pub fn prepare(&self) -> HosekSky {
        let sun = self.sun_direction.normalize_or(Vec3::Z);
        let parameters = SkyParams {
            elevation: (FRAC_PI_2 - safe_acos(sun.z)).clamp(0.0, FRAC_PI_2),
            turbidity: self.turbidity.clamp(1.0, 10.0),
            albedo: [self.ground_albedo.clamp(0.0, 1.0); 3],
        };
        HosekSky { sun, state: SkyState::new(&parameters).ok() }
    }
}

impl HosekSky {
    /// Radiance from a unit direction; below the horizon that of the horizon, seen from the true angle to
    /// the sun.
    pub fn radiance(&self, direction: Vec3) -> Rgb {
        let Some(state) = &self.state else { return Rgb::BLACK };
        let gamma = safe_acos(direction.dot(self.sun));
        let theta = safe_acos(direction.z).min(FRAC_PI_2 - 0.001);
        let of = |channel| (SCALE * state.radiance(theta, gamma, channel)).max(0.0);
        Rgb::new(of(Channel::R), of(Channel::G), of(Channel::B))
    }
}
