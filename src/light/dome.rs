//! The world around everything: constant, a lat-long image, or a function of direction.
//!
//! Of a function an image is but the map that light sampling goes by; what arrives is the function's value
//! itself, so that what the map lacks is noise and never missing.
//!
//! Where directions that the surface samples find the light as well, light sampling takes what is
//! brighter than the mean and leaves the rest to them (MIS compensation: Ondřej Karlík, Martin Šik, Petr
//! Vévoda, Tomáš Skřivan, Jaroslav Křivánek, *MIS Compensation: Optimizing Sampling Techniques in
//! Multiple Importance Sampling*, SIGGRAPH Asia 2019): nothing at all of a constant dome. Where light
//! samples stand alone, they are divided between the bright part and all directions alike.

mod image;
mod irradiance;

pub use image::DomeImage;

use std::f32::consts::PI;
use std::fmt;
use std::sync::Arc;

use self::irradiance::IrradianceMap;
use super::{Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Frame, ONE_MINUS_EPSILON, Rgb, Vec3};
use crate::sampling::warp;

/// Where light samples stand alone, so many parts of eight go to all directions alike, at least. Eighths
/// divide runs of 8 samples of a pattern exactly, and are rounded towards the bright part, whose shadows
/// have the sharper edges.
const FEWEST_EIGHTHS: f32 = 1.0;

/// One step of a random number of 24 bits.
const STEP: f64 = 1.0 / 16_777_216.0;

/// Radiance from a unit direction of render space.
pub type DomeRadiance = Arc<dyn Fn(Vec3) -> Rgb + Send + Sync>;

/// A dome.
#[derive(Clone)]
pub struct Dome {
    /// Radiance, or the factor of the image.
    radiance: Rgb,
    image: Option<DomeImage>,
    /// What arrives, where the image is but its map.
    exact: Option<DomeRadiance>,
    /// Irradiance of all of it and of what is brighter than the mean; `None` without an image.
    irradiance: Option<Arc<[IrradianceMap; 2]>>,
    /// Mean radiance over the sphere, luminance.
    mean: f32,
}

impl Dome {
    /// A dome of constant `radiance`, or `image` times it.
    pub fn new(radiance: Rgb, image: Option<DomeImage>) -> Self {
        let irradiance = image.as_ref().map(|image| Arc::new(image.irradiance(radiance)));
        let mean = match &irradiance {
            Some(maps) => maps[0].at(None) / (4.0 * PI),
            None => radiance.luminance(),
        };
        Self { radiance, image, exact: None, irradiance, mean }
    }

    /// A dome of any radiance, sampled by `map` of it.
    pub fn shaded(map: DomeImage, radiance: DomeRadiance) -> Self {
        Self { exact: Some(radiance), ..Self::new(Rgb::WHITE, Some(map)) }
    }

    /// The image, where light sampling follows one that is brighter in places.
    fn bright(&self) -> Option<&DomeImage> {
        self.image.as_ref().filter(|image| image.has_bright_part())
    }

    /// Irradiance of all of it, and of the bright part.
    fn irradiances(&self, at: &Receiver) -> [f32; 2] {
        match (&self.irradiance, &self.image) {
            (Some(maps), Some(image)) => {
                let n = at.n.map(|n| image.to_local(n));
                [maps[0].at(n), maps[1].at(n)]
            }
            _ => [if at.n.is_some() { PI * self.mean } else { 4.0 * PI * self.mean }, 0.0],
        }
    }

    /// Share of the samples at `at` that go to all directions alike.
    fn plain_share(&self, at: &Receiver) -> f32 {
        match (at.alone, self.bright()) {
            (false, _) => 0.0,
            (true, None) => 1.0,
            (true, Some(_)) => {
                let [all, bright] = self.irradiances(at);
                let share = if all > 0.0 { (all - bright) / all } else { 0.5 };
                (8.0 * share).floor().clamp(FEWEST_EIGHTHS, 8.0 - FEWEST_EIGHTHS) / 8.0
            }
        }
    }
}

/// A direction of those alike: by the cosine where there is a normal.
fn sample_plain(at: &Receiver, u: [f32; 2]) -> Vec3 {
    match at.n {
        Some(n) => Frame::from_z(n).to_world(warp::sample_cosine_hemisphere(u)),
        None => warp::sample_uniform_sphere(u),
    }
}

fn pdf_plain(at: &Receiver, wi: Vec3) -> f32 {
    at.n.map_or(warp::PDF_UNIFORM_SPHERE, |n| warp::pdf_cosine_hemisphere(n.dot(wi)))
}

impl fmt::Debug for Dome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut dome = f.debug_struct("Dome");
        dome.field("radiance", &self.radiance).field("exact", &self.exact.is_some()).field("mean", &self.mean);
        dome.finish_non_exhaustive()
    }
}

impl Emitter for Dome {
    fn sample_li(&self, at: &Receiver, uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let share = self.plain_share(at);
        // Random numbers have 24 bits, of which the choice would take some: `uc` adds more below them.
        let u0 = f64::from(u[0]) + f64::from(uc) * STEP;
        let share64 = f64::from(share);
        let (wi, li, pdf) = if u0 < share64 {
            let wi = sample_plain(at, [((u0 / share64) as f32).min(ONE_MINUS_EPSILON), u[1]]);
            (wi, self.le(wi, None), self.pdf_li(at, wi, None))
        } else {
            let s = self.bright()?.sample([(u0 - share64) / (1.0 - share64), f64::from(u[1]) + 0.5 * STEP])?;
            let li = self.exact.as_ref().map_or_else(|| s.radiance * self.radiance, |exact| exact(s.wi));
            (s.wi, li, (1.0 - share) * s.pdf + share * pdf_plain(at, s.wi))
        };
        (pdf > 0.0 && !li.is_black()).then_some(LightSample { li, wi, end: None, pdf, delta: false })
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, _hit: Option<&EmitterHit>) -> f32 {
        let share = self.plain_share(at);
        let plain = if share > 0.0 { share * pdf_plain(at, wi) } else { 0.0 };
        match self.bright() {
            Some(image) => plain + (1.0 - share) * image.pdf(wi),
            None => plain,
        }
    }

    fn le(&self, wi: Vec3, _hit: Option<&EmitterHit>) -> Rgb {
        match (&self.exact, &self.image) {
            (Some(exact), _) => exact(wi),
            (None, None) => self.radiance,
            (None, Some(image)) => image.radiance(wi) * self.radiance,
        }
    }

    fn in_background(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn importance(&self, at: &Receiver) -> f32 {
        let [all, bright] = self.irradiances(at);
        if at.alone { all } else { bright }
    }

    fn power(&self, scene: Bounds) -> f32 {
        let area = 4.0 * PI * scene.radius() * scene.radius();
        (area * PI * self.mean).min(f32::MAX)
    }
}
