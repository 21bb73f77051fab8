//! A lat-long image of radiance: its lookup, and the density that follows its bright part.
//!
//! The mapping is Cycles' equirectangular one with y up: `u = 1/2 + atan2(z, x) / 2π`, `v = θ / π` from
//! the top row with θ the angle from +y. The lookup is bilinear in (u, v), so is the density, but that
//! the sine of θ is taken at the texels' centres alone.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rayon::prelude::*;

use super::irradiance::{IrradianceMap, Part};
use crate::math::{DVec3, Mat3, Rgb, Vec3};
use crate::sampling::BilinearImage;

/// Nothing is nearer to a pole than this angle, where `v` and `1 − v` keep eight digits each.
const LEAST_POLAR_ANGLE: f64 = 1e-8;

/// The image is looked at in so many columns and rows, at most, to know what comes from where.
const PARTS: [usize; 2] = [64, 32];

/// The image of a dome.
#[derive(Clone, Debug)]
pub struct DomeImage {
    width: usize,
    height: usize,
    /// Radiance of each texel, row by row from the top.
    texels: Arc<Vec<Rgb>>,
    /// Sine of the polar angle of each row's centre.
    sines: Arc<[f64]>,
    /// Only what is brighter than this is sampled.
    threshold: f64,
    /// The density of that; `None` where there is nothing.
    table: Option<Arc<BilinearImage>>,
    /// Render space to the image's.
    to_local: Mat3,
}

/// What [`DomeImage::sample`] chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// Unit direction, render space.
    pub wi: Vec3,
    /// Radiance there.
    pub radiance: Rgb,
    /// Density in solid angle, above 0.
    pub pdf: f32,
}

/// What the density goes by: of every channel it knows the brightest texels.
fn value(texel: Rgb) -> f64 {
    f64::from(texel.max_component())
}

/// Solid angle of each texel of a row.
fn solid_angle(width: usize, height: usize, y: usize) -> f64 {
    // cos a − cos b = 2 sin((a + b) / 2) sin((b − a) / 2).
    let half = 0.5 * PI / height as f64;
    2.0 * (half * (2 * y + 1) as f64).sin() * half.sin() * TAU / width as f64
}

impl DomeImage {
    /// An image of `width` × `height` texels of finite, non-negative radiance. `orientation`
    /// turns the image's space into render space. `None` where it is black all over.
    pub fn new(width: usize, height: usize, texels: Vec<Rgb>, orientation: Mat3) -> Option<Self> {
        if width == 0 || height == 0 || texels.len() != width * height || texels.iter().all(|t| t.is_black()) {
            return None;
        }
        // Summed in the order of the rows, for the same bits on any number of threads.
        let rows: Vec<f64> = texels.par_chunks_exact(width).map(|row| row.iter().copied().map(value).sum()).collect();
        let sum: f64 = rows.iter().enumerate().map(|(y, row)| row * solid_angle(width, height, y)).sum();
        // Without what rounding makes of a constant.
        let threshold = sum / (4.0 * PI) * (1.0 + 1e-5);
        let sines = (0..height).map(|y| (PI * (y as f64 + 0.5) / height as f64).sin()).collect();
        let image = Self {
            width,
            height,
            texels: Arc::new(texels),
            sines,
            threshold,
            table: None,
            to_local: orientation.transpose(),
        };
        let table = BilinearImage::new(width, height, |x, y| image.weight(x, y)).map(Arc::new);
        Some(Self { table, ..image })
    }

    /// The unit direction at coordinates of the image, in its own space.
    pub fn direction([u, v]: [f64; 2]) -> Vec3 {
        let ((sin_theta, cos_theta), (sin_phi, cos_phi)) = ((PI * v).sin_cos(), (TAU * (u - 0.5)).sin_cos());
        DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi).as_vec3()
    }

    /// True where it is brighter in places, by more than rounding.
    pub(super) fn has_bright_part(&self) -> bool {
        self.table.is_some()
    }

    /// A direction of render space in the image's.
    pub(super) fn to_local(&self, w: Vec3) -> Vec3 {
        self.to_local * w
    }

    /// Radiance that comes from the unit direction `wi`.
    pub(super) fn radiance(&self, wi: Vec3) -> Rgb {
        self.lookup(self.uv_of(wi).0)
    }

    /// Density of [`DomeImage::sample`] in solid angle.
    pub(super) fn pdf(&self, wi: Vec3) -> f32 {
        let Some(table) = &self.table else { return 0.0 };
        let (uv, sin_theta) = self.uv_of(wi);
        to_solid_angle(table.pdf(uv, |x, y| self.weight(x, y)), sin_theta)
    }

    /// A direction of the bright part by `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<Sampled> {
        let s = self.table.as_ref()?.sample(u, |x, y| self.weight(x, y));
        let sin_theta = (PI * s.p[1]).sin();
        let pdf = to_solid_angle(s.pdf, sin_theta);
        let sampled = Sampled { wi: self.to_local.transpose() * Self::direction(s.p), radiance: self.lookup(s.p), pdf };
        (sin_theta > 0.0 && pdf.is_finite()).then_some(sampled)
    }

    /// Irradiance of the image times `factor`: of all of it, and of the bright part.
    pub(super) fn irradiance(&self, factor: Rgb) -> [IrradianceMap; 2] {
        let [columns, rows] = [self.width.min(PARTS[0]), self.height.min(PARTS[1])];
        let mut fluxes = vec![[0.0_f64; 2]; columns * rows];
        // Texels are summed by rows of parts, in parallel and yet always in the same order.
        fluxes.par_chunks_exact_mut(columns).enumerate().for_each(|(part_y, fluxes)| {
            for y in (0..self.height).filter(|y| y * rows / self.height == part_y) {
                let solid_angle = solid_angle(self.width, self.height, y);
                for (x, &texel) in self.row(y).iter().enumerate() {
                    let flux = f64::from((texel * factor).luminance()) * solid_angle;
                    let value = value(texel);
                    let bright = if value > self.threshold { 1.0 - self.threshold / value } else { 0.0 };
                    let sums = &mut fluxes[x * columns / self.width];
                    sums[0] += flux;
                    sums[1] += flux * bright;
                }
            }
        });
        // A texel's light reaches half a texel beyond it; parts differ by a texel in size.
        let size = [(self.width, columns, TAU), (self.height, rows, PI)]
            .map(|(texels, parts, all)| all * (texels.div_ceil(parts) + 2) as f64 / texels as f64);
        let radius = 0.5 * size[0].hypot(size[1]);
        let parts = |which: usize| -> Vec<Part> {
            let part = |(i, flux): (usize, &[f64; 2])| {
                let (sin_phi, cos_phi) = (TAU * ((i % columns) as f64 + 0.5) / columns as f64 - PI).sin_cos();
                let (sin_theta, cos_theta) = (PI * ((i / columns) as f64 + 0.5) / rows as f64).sin_cos();
                let w = DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi);
                Part { w, flux: flux[which] }
            };
            fluxes.iter().enumerate().map(part).collect()
        };
        [0, 1].map(|which| IrradianceMap::new(&parts(which), radius))
    }

    fn row(&self, y: usize) -> &[Rgb] {
        &self.texels[y * self.width..(y + 1) * self.width]
    }

    /// What is sampled of a texel: by how much it is brighter than the threshold, times the sine of the
    /// polar angle, which takes areas of (u, v) to solid angles.
    fn weight(&self, x: usize, y: usize) -> f64 {
        (value(self.texels[y * self.width + x]) - self.threshold).max(0.0) * self.sines[y]
    }

    /// Where a direction stands in the image, and the sine of its polar angle.
    fn uv_of(&self, wi: Vec3) -> ([f64; 2], f64) {
        let w = (self.to_local * wi).as_dvec3();
        // Not by an arc cosine, which has but four digits near the poles.
        let r = w.x.hypot(w.z);
        let theta = r.atan2(w.y).clamp(LEAST_POLAR_ANGLE, PI - LEAST_POLAR_ANGLE);
        ([0.5 + w.z.atan2(w.x) / TAU, theta / PI], theta.sin())
    }

    /// Bilinear, around in u and clamped at the poles.
    fn lookup(&self, [u, v]: [f64; 2]) -> Rgb {
        let (x, y) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (fx, fy) = ((x - x.floor()) as f32, (y - y.floor()) as f32);
        let column = |i: i64| i.rem_euclid(self.width as i64) as usize;
        let row = |i: i64| self.row(i.clamp(0, self.height as i64 - 1) as usize);
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let (left, right, above, below) = (column(x), column(x + 1), row(y), row(y + 1));
        above[left].lerp(above[right], fx).lerp(below[left].lerp(below[right], fx), fy)
    }
}

/// A density over (u, v) as one over solid angle: `dω = 2π² sin θ du dv`.
fn to_solid_angle(pdf: f64, sin_theta: f64) -> f32 {
    if sin_theta > 0.0 { (pdf / (2.0 * PI * PI * sin_theta)) as f32 } else { 0.0 }
}
