//! The emissive triangles of one placed mesh.
//!
//! A triangle is chosen by its power (area × mean radiance), a point on it uniformly by area; the
//! density in solid angle is `pmf / area · d² / |cos θ_light|`.

use std::f32::consts::PI;
use std::sync::Arc;

use super::{Emission, Emitter, EmitterHit, LightBounds, LightSample, Receiver};
use crate::math::{Bounds, Rgb, Vec3, gamma, offset_ray_origin};
use crate::sampling::{AliasTable, warp};

/// One triangle in render space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissiveTriangle {
    /// Corners.
    pub p: [Vec3; 3],
    /// Mean emitted radiance, by which it is chosen.
    pub mean: Rgb,
    /// Half-width of the box in which rounding has left any of its points.
    pub p_err: Vec3,
    /// Index of the triangle in its mesh.
    pub index: u32,
}

/// All emissive triangles of an instance, emitting on both sides.
#[derive(Clone, Debug)]
pub struct MeshLight {
    triangles: Arc<[EmissiveTriangle]>,
    table: Arc<AliasTable>,
    /// Probability per area of each triangle of the mesh, 0 for those that do not emit.
    pdf_area: Arc<[f32]>,
    bounds: Bounds,
    power: f32,
    /// `None` where each triangle's radiance is its mean.
    emission: Option<Arc<dyn Emission>>,
}

impl MeshLight {
    /// A light of `triangles`, of a mesh that has `mesh_triangles` in all; `None` where nothing is
    /// emitted. `emission` gives the radiance at a point where it varies over a triangle.
    pub fn new(
        triangles: Vec<EmissiveTriangle>,
        mesh_triangles: usize,
        emission: Option<Arc<dyn Emission>>,
    ) -> Option<Self> {
        let area = |t: &EmissiveTriangle| {
            let [a, b, c] = t.p.map(|p| p.as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        };
        let weights: Vec<f64> = triangles.iter().map(|t| area(t) * f64::from(t.mean.luminance())).collect();
        let table = AliasTable::new(&weights)?;
        let mut pdf_area = vec![0.0; mesh_triangles];
        for (i, triangle) in triangles.iter().enumerate() {
            if weights[i] > 0.0 {
                pdf_area[triangle.index as usize] = (f64::from(table.pmf(i)) / area(triangle)) as f32;
            }
        }
        let bounds = Bounds::of_points(triangles.iter().flat_map(|t| t.p));
        let power = (2.0 * std::f64::consts::PI * weights.iter().sum::<f64>()) as f32;
        Some(Self {
            triangles: triangles.into(),
            table: Arc::new(table),
            pdf_area: pdf_area.into(),
            bounds,
            power,
            emission,
        })
    }
}

impl Emitter for MeshLight {
    fn sample_li(&self, at: &Receiver, uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let p = at.p;
        let triangle = &self.triangles[self.table.sample(uc).index];
        let [a, b, c] = triangle.p;
        let [b0, b1, b2] = warp::sample_triangle(u);
        let on_light = a * b0 + b * b1 + c * b2;
        // In f64, where the squares of neither huge nor tiny triangles leave the range.
        let ng = (b - a).as_dvec3().cross((c - a).as_dvec3()).normalize_or_zero().as_vec3();
        let to_light = on_light - p;
        let dist_squared = to_light.length_squared();
        let wi = to_light / dist_squared.sqrt();
        let cos = ng.dot(wi).abs();
        let pdf = self.pdf_area[triangle.index as usize] * dist_squared / cos;
        let li = match &self.emission {
            Some(emission) => emission.radiance(triangle.index, [b1, b2]),
            None => triangle.mean,
        };
        if !(pdf.is_finite() && pdf > 0.0) || li.is_black() {
            return None;
        }
        // Rounding has moved the light's point, and moves the ray that is traced towards it from `p`.
        let p_err = triangle.p_err + Vec3::splat(gamma(8) * p.abs().max_element());
        let end = Some(offset_ray_origin(on_light, p_err, ng, -wi));
        Some(LightSample { li, wi, end, pdf, delta: false })
    }

    fn pdf_li(&self, _at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let Some(at) = hit else { return 0.0 };
        let pdf = self.pdf_area[at.triangle as usize] * at.dist * at.dist / at.ng.dot(wi).abs();
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(LightBounds {
            bounds: self.bounds,
            axis: Vec3::Z,
            cos_normals: -1.0,
            cos_emission: 0.0,
            intensity: self.power / (4.0 * PI),
            two_sided: true,
        })
    }

    fn importance(&self, at: &Receiver) -> f32 {
        self.bounds().map_or(0.0, |bounds| bounds.importance(at))
    }

    fn power(&self, _scene: Bounds) -> f32 {
        self.power
    }
}
