//! The world around everything: constant, or a lat-long image sampled by its radiance.
//!
//! Matt Pharr, Wenzel Jakob, Greg Humphreys: *Physically Based Rendering*, 4th edition, 12.5.2; the
//! mapping is Cycles' equirectangular one with y up:
//! `u = 1/2 + atan2(z, x) / 2π`, `v = acos(y) / π` from the top row.

use std::f32::consts::PI;
use std::sync::Arc;

use super::{Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Mat3, Rgb, Vec3, safe_acos};
use crate::sampling::Distribution2d;
use crate::sampling::warp;

/// A dome.
#[derive(Clone, Debug)]
pub struct Dome {
    radiance: Rgb,
    image: Option<DomeImage>,
    /// Mean irradiance on a surface, luminance.
    mean_irradiance: f32,
}

/// The image of a dome: radiance where it is looked up and the density that follows it.
#[derive(Clone, Debug)]
pub struct DomeImage {
    width: usize,
    height: usize,
    /// Radiance of each texel, row by row from the top.
    texels: Arc<Vec<Rgb>>,
    distribution: Arc<Distribution2d>,
    /// Render space to the image's.
    to_local: Mat3,
}

impl DomeImage {
    /// An image of `width` × `height` texels of finite, non-negative radiance. `orientation`
    /// turns the image's space into render space. `None` where it is black all over.
    pub fn new(width: usize, height: usize, texels: Vec<Rgb>, orientation: Mat3) -> Option<Self> {
        // Bilinear lookup carries the light of a texel into its neighbours: the density of a texel
        // follows the mean of the lookup over it, so that it is 0 only where the lookup is.
        let value = |x: usize, y: usize| f64::from(texels[y * width + x].mean());
        let blurred_row = |x: usize, y: usize| {
            0.25 * value((x + width - 1) % width, y) + 0.5 * value(x, y) + 0.25 * value((x + 1) % width, y)
        };
        let distribution = Distribution2d::new(width, height, |x, y| {
            let edge = |row: usize| (std::f64::consts::PI * row as f64 / height as f64).cos();
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let mean = 0.25 * blurred_row(x, above) + 0.5 * blurred_row(x, y) + 0.25 * blurred_row(x, below);
            mean * (edge(y) - edge(y + 1))
        })?;
        let distribution = Arc::new(distribution);
        Some(Self { width, height, texels: Arc::new(texels), distribution, to_local: orientation.transpose() })
    }

    /// Mean radiance over the sphere.
    fn mean(&self) -> Rgb {
        let rows = self.texels.chunks_exact(self.width).enumerate();
        let total = rows.fold([0.0_f64; 3], |mut sum, (y, row)| {
            let edge = |row: usize| (std::f64::consts::PI * row as f64 / self.height as f64).cos();
            let weight = 0.5 * (edge(y) - edge(y + 1)) / self.width as f64;
            for texel in row {
                for (s, v) in sum.iter_mut().zip(texel.to_array()) {
                    *s += weight * f64::from(v);
                }
            }
            sum
        });
        Rgb::from(total)
    }

    fn uv_of(&self, wi: Vec3) -> [f32; 2] {
        let w = self.to_local * wi;
        [0.5 + w.z.atan2(w.x) / (2.0 * PI), safe_acos(w.y) / PI]
    }

    /// Direction at `uv`, and the sine of its polar angle.
    fn direction_of(&self, [u, v]: [f32; 2]) -> (Vec3, f32) {
        let (sin_phi, cos_phi) = (2.0 * PI * (u - 0.5)).sin_cos();
        let (sin_theta, cos_theta) = (PI * v).sin_cos();
        let local = Vec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
        (self.to_local.transpose() * local, sin_theta)
    }

    /// Bilinear, around in u and clamped at the poles.
    fn lookup(&self, [u, v]: [f32; 2]) -> Rgb {
        let (x, y) = (u * self.width as f32 - 0.5, v * self.height as f32 - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |i: i64| i.rem_euclid(self.width as i64) as usize;
        let row = |i: i64| i.clamp(0, self.height as i64 - 1) as usize;
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let at = |x, y| self.texels[row(y) * self.width + column(x)];
        at(x, y).lerp(at(x + 1, y), fx).lerp(at(x, y + 1).lerp(at(x + 1, y + 1), fx), fy)
    }

    fn pdf(&self, uv: [f32; 2], sin_theta: f32) -> f32 {
        if sin_theta > 0.0 { self.distribution.pdf(uv) / (2.0 * PI * PI * sin_theta) } else { 0.0 }
    }
}

impl Dome {
    /// A dome of constant `radiance`, or `image` times it.
    pub fn new(radiance: Rgb, image: Option<DomeImage>) -> Self {
        let mean = image.as_ref().map_or(Rgb::WHITE, DomeImage::mean) * radiance;
        Self { radiance, image, mean_irradiance: PI * mean.luminance() }
    }
}

impl Emitter for Dome {
    fn sample_li(&self, _at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let (wi, pdf, li) = match &self.image {
            None => (warp::sample_uniform_sphere(u), 1.0 / (4.0 * PI), self.radiance),
            Some(image) => {
                let uv = image.distribution.sample(u).p;
                let (wi, sin_theta) = image.direction_of(uv);
                (wi, image.pdf(uv, sin_theta), image.lookup(uv) * self.radiance)
            }
        };
        (pdf > 0.0).then_some(LightSample { li, wi, end: None, pdf, delta: false })
    }

    fn pdf_li(&self, _at: &Receiver, wi: Vec3, _hit: Option<&EmitterHit>) -> f32 {
        match &self.image {
            None => 1.0 / (4.0 * PI),
            Some(image) => {
                let uv = image.uv_of(wi);
                image.pdf(uv, (PI * uv[1]).sin())
            }
        }
    }

    fn le(&self, wi: Vec3, _hit: Option<&EmitterHit>) -> Rgb {
        match &self.image {
            None => self.radiance,
            Some(image) => image.lookup(image.uv_of(wi)) * self.radiance,
        }
    }

    fn in_background(&self) -> bool {
        true
    }

    fn bounds(&self) -> Option<LightBounds> {
        None
    }

    fn importance(&self, _at: &Receiver) -> f32 {
        self.mean_irradiance
    }

    fn power(&self, scene: Bounds) -> f32 {
        4.0 * PI * scene.radius() * scene.radius() * self.mean_irradiance
    }
}
