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
mod portal;

pub use image::DomeImage;
pub use portal::{Portal, Portals};

use std::f32::consts::PI;
use std::fmt;
use std::sync::Arc;

use self::irradiance::IrradianceMap;
use self::portal::Openings;
use super::{Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Frame, ONE_MINUS_EPSILON, Rgb, Vec3};
use crate::sampling::warp;

/// Where light samples stand alone, so many parts of eight go to all directions alike, at least. Eighths
/// divide runs of 8 samples of a pattern exactly, and are rounded towards the bright part, whose shadows
/// have the sharper edges.
const FEWEST_EIGHTHS: f32 = 1.0;

/// Share of the samples that go through portals where light can come through any, and there is another strategy.
const GUIDED: f64 = 0.5;

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
    /// Where its light comes into rooms.
    portals: Option<Arc<Portals>>,
}

impl Dome {
    /// A dome of constant `radiance`, or `image` times it.
    pub fn new(radiance: Rgb, image: Option<DomeImage>) -> Self {
        let irradiance = image.as_ref().map(|image| Arc::new(image.irradiance(radiance)));
        let mean = match &irradiance {
            Some(maps) => maps[0].at(None) / (4.0 * PI),
            None => radiance.luminance(),
        };
        Self { radiance, image, exact: None, irradiance, mean, portals: None }
    }

    /// A dome of any radiance, sampled by `map` of it.
    pub fn shaded(map: DomeImage, radiance: DomeRadiance) -> Self {
        Self { exact: Some(radiance), ..Self::new(Rgb::WHITE, Some(map)) }
    }

    /// Samples it through `portals` as well, from where they are seen.
    pub fn guide(&mut self, portals: Arc<Portals>) {
        self.portals = Some(portals);
    }

    /// The portals through which it shines on `at`, and the share of the samples that goes through them; `None`
    /// where there are none.
    fn openings(&self, at: &Receiver) -> Option<(Openings<'_>, f64)> {
        let openings = self.portals.as_ref()?.from(at);
        let alone = !at.alone && self.bright().is_none();
        (!openings.are_none()).then_some((openings, if alone { 1.0 } else { GUIDED }))
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

    /// Density of `wi` beside the portals.
    fn pdf_unguided(&self, at: &Receiver, wi: Vec3) -> f32 {
        let share = self.plain_share(at);
        let plain = if share > 0.0 { share * pdf_plain(at, wi) } else { 0.0 };
        match self.bright() {
            Some(image) => plain + (1.0 - share) * image.pdf(wi),
            None => plain,
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

/// `unguided`, the density of `wi` beside the portals, with that of the portals.
fn with_openings((openings, guided): &(Openings<'_>, f64), wi: Vec3, unguided: f32) -> f32 {
    let guided = *guided as f32;
    let beside = if guided < 1.0 { (1.0 - guided) * unguided } else { 0.0 };
    guided * openings.pdf(wi) + beside
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
        // Random numbers have 24 bits, of which choices would take some: `uc` adds more below them.
        let mut u0 = f64::from(u[0]) + f64::from(uc) * STEP;
        let openings = self.openings(at);
        if let Some(through @ (openings, guided)) = &openings {
            if u0 < *guided {
                let wi = openings.sample(uc, [((u0 / guided) as f32).min(ONE_MINUS_EPSILON), u[1]])?;
                let (li, pdf) = (self.le(wi, None), with_openings(through, wi, self.pdf_unguided(at, wi)));
                return (pdf > 0.0 && !li.is_black()).then_some(LightSample { li, wi, end: None, pdf, delta: false });
            }
            u0 = (u0 - guided) / (1.0 - guided);
        }
        let share = self.plain_share(at);
        let share64 = f64::from(share);
        let (wi, li, pdf) = if u0 < share64 {
            let wi = sample_plain(at, [((u0 / share64) as f32).min(ONE_MINUS_EPSILON), u[1]]);
            (wi, self.le(wi, None), self.pdf_unguided(at, wi))
        } else {
            let s = self.bright()?.sample([(u0 - share64) / (1.0 - share64), f64::from(u[1]) + 0.5 * STEP])?;
            let li = self.exact.as_ref().map_or_else(|| s.radiance * self.radiance, |exact| exact(s.wi));
            (s.wi, li, (1.0 - share) * s.pdf + share * pdf_plain(at, s.wi))
        };
        let pdf = openings.map_or(pdf, |openings| with_openings(&openings, wi, pdf));
        (pdf > 0.0 && !li.is_black()).then_some(LightSample { li, wi, end: None, pdf, delta: false })
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, _hit: Option<&EmitterHit>) -> f32 {
        let pdf = self.pdf_unguided(at, wi);
        self.openings(at).map_or(pdf, |openings| with_openings(&openings, wi, pdf))
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
        if at.alone {
            return all;
        }
        let through = self.portals.as_ref().map_or(0.0, |portals| self.mean * portals.from(at).solid_angle as f32);
        bright.max(through)
    }

    fn power(&self, scene: Bounds) -> f32 {
        let area = 4.0 * PI * scene.radius() * scene.radius();
        (area * PI * self.mean).min(f32::MAX)
    }
}
