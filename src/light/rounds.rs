//! Strands and balls that emit, and instances of them as lights.
//!
//! A segment is chosen as a triangle of a mesh is (`mesh.rs`), and on it a point of its surface by area. Half
//! of the points face away and others lie within the next segment: rays to them are stopped, as are rays to
//! the back of a closed mesh.

use std::f64::consts::PI;
use std::sync::Arc;

use super::placed::Placed;
use super::tree::refined;
use super::{Emission, Emitter, EmitterHit, LightBounds, LightSample, LightTree, Profile, Receiver};
use crate::math::{Affine3A, Bounds, DMat3, DVec3, Rgb, RoundPoint, Vec3, gamma, offset_ray_origin, place_point};
use crate::shape::Rounds;

/// Numbers the choice of a segment among those that draw on one random number.
const SEGMENT: u32 = 1;

/// All emissive segments or balls of a shape.
#[derive(Debug)]
pub struct RoundEmitters {
    rounds: Arc<Rounds>,
    emission: Arc<dyn Emission>,
    /// Segments that the tree's items are, growing; `None` where they are all.
    segments: Option<Box<[u32]>>,
    tree: LightTree,
}

/// The emissive segments or balls of an instance.
#[derive(Clone, Debug)]
pub struct RoundLight {
    emitters: Arc<RoundEmitters>,
    placed: Arc<Placed>,
    /// What areas grow by along each axis of a normal: the cofactors of the transform.
    cofactors: DMat3,
}

impl RoundEmitters {
    /// The segments or balls of `rounds` that emit something; `None` where none does.
    pub fn new(rounds: Arc<Rounds>, emission: Arc<dyn Emission>) -> Option<Self> {
        use rayon::prelude::*;
        let count = u32::try_from(rounds.len()).ok()?;
        let bounds = |segment: u32| Some((segment, bounds_of(&rounds, segment, emission.mean(segment))?));
        let (segments, bounds): (Vec<u32>, Vec<LightBounds>) = (0..count).into_par_iter().filter_map(bounds).unzip();
        let tree = LightTree::new(&bounds)?;
        let segments = (segments.len() < rounds.len()).then(|| segments.into_boxed_slice());
        Some(Self { rounds, emission, segments, tree })
    }

    fn segment_of(&self, item: u32) -> u32 {
        self.segments.as_ref().map_or(item, |segments| segments[item as usize])
    }

    fn item_of(&self, segment: u32) -> Option<u32> {
        let Some(segments) = &self.segments else { return Some(segment) };
        segments.binary_search(&segment).ok().map(|i| i as u32)
    }

    fn area(&self, segment: u32) -> f64 {
        self.rounds.cone(segment).0.areas().iter().sum()
    }
}

/// Bounds of a segment that emits `mean`; `None` where that is nothing.
fn bounds_of(rounds: &Rounds, segment: u32, mean: Rgb) -> Option<LightBounds> {
    let (cone, origin) = rounds.cone(segment);
    // What a convex body shows of its surface is a quarter of it on the mean.
    let intensity = 0.25 * cone.areas().iter().sum::<f64>() * f64::from(mean.luminance());
    if !(intensity > 0.0 && intensity.is_finite()) {
        return None;
    }
    let corners = [origin, origin + cone.axis].into_iter().zip(cone.radii).flat_map(|(p, r)| [p - r, p + r]);
    Some(LightBounds {
        bounds: Bounds::of_points(corners.map(DVec3::as_vec3)),
        axis: Vec3::Z,
        cos_normals: -1.0,
        cos_emission: 0.0,
        intensity: (intensity as f32).clamp(f32::MIN_POSITIVE, f32::MAX),
        two_sided: false,
    })
}

impl RoundLight {
    /// The light of `emitters` placed by `to_render`; `None` where that can't be undone.
    pub fn new(emitters: Arc<RoundEmitters>, to_render: Affine3A) -> Option<Self> {
        let placed = Placed::new(&emitters.tree, to_render)?;
        let [x, y, z] = [to_render.matrix3.x_axis, to_render.matrix3.y_axis, to_render.matrix3.z_axis];
        let [x, y, z] = [x, y, z].map(|axis| Vec3::from(axis).as_dvec3());
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        Some(Self { emitters, placed: Arc::new(placed), cofactors })
    }

    /// The same with `profile`, without decay.
    pub fn shaped(mut self, profile: Option<Arc<Profile>>) -> Self {
        if profile.is_some() {
            Arc::make_mut(&mut self.placed).profile = profile;
        }
        self
    }

    /// How it emits.
    pub fn emission(&self) -> &dyn Emission {
        &*self.emitters.emission
    }

    /// Density by area at a point of `segment`, in render space.
    fn density(&self, segment: u32, point: &RoundPoint) -> f64 {
        1.0 / (self.emitters.area(segment) * (self.cofactors * point.normal).length())
    }
}

impl Emitter for RoundLight {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let asked = self.placed.asked(at);
        let tree = &self.emitters.tree;
        let chosen = tree.sample_from(&asked, &tree.weigh(&asked), refined(u[0], &asked, SEGMENT))?;
        let segment = self.emitters.segment_of(chosen.item);
        let (cone, origin) = self.emitters.rounds.cone(segment);
        let uv = cone.sample([chosen.u, u[1]].map(f64::from));
        let point = cone.point(uv);
        let local = (origin + point.p).as_vec3();
        let (on_light, p_err) = place_point(&self.placed.to_render, local, local.abs() * gamma(2));
        let det = self.cofactors.z_axis.dot(Vec3::from(self.placed.to_render.matrix3.z_axis).as_dvec3());
        let ng = (self.cofactors * point.normal * det.signum()).normalize_or_zero();
        let to_light = on_light.as_dvec3() - at.p.as_dvec3();
        let dist_squared = to_light.length_squared();
        let wi = to_light / dist_squared.sqrt();
        let pdf = self.density(segment, &point) * f64::from(chosen.pmf) * dist_squared / ng.dot(wi).abs();
        let (wi, ng, pdf) = (wi.as_vec3(), ng.as_vec3(), pdf as f32);
        let li = self.emitters.emission.radiance(segment, uv) * self.placed.factor(-wi);
        if !(pdf.is_finite() && pdf > 0.0) || li.is_black() {
            return None;
        }
        // Rounding has moved the light's point, and moves the ray that is traced towards it from `p`.
        let largest = at.p.abs().max(on_light.abs()).max_element();
        let end = Some(offset_ray_origin(on_light, p_err + Vec3::splat(gamma(8) * largest), ng, -wi));
        Some(LightSample { li, wi, end, pdf, delta: false })
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let Some(hit) = hit else { return 0.0 };
        let Some(item) = self.emitters.item_of(hit.triangle) else { return 0.0 };
        let point = self.emitters.rounds.cone(hit.triangle).0.point(hit.uv);
        let dist = f64::from(hit.dist);
        let density = self.density(hit.triangle, &point) * dist * dist / f64::from(hit.ng.dot(wi).abs());
        let pdf = (density * f64::from(self.emitters.tree.pmf_of(&self.placed.asked(at), item))) as f32;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    fn bounds(&self) -> Option<LightBounds> {
        Some(self.placed.shaped_bounds())
    }

    fn importance(&self, at: &Receiver) -> f32 {
        self.placed.importance(&self.emitters.tree, at)
    }

    fn power(&self, _scene: Bounds) -> f32 {
        let emitters = &self.emitters;
        let scale = self.cofactors.determinant().abs().cbrt();
        let power = |segment: u32| emitters.area(segment) * f64::from(emitters.emission.mean(segment).luminance());
        let sum: f64 = match &emitters.segments {
            Some(segments) => segments.iter().map(|&i| power(i)).sum(),
            None => (0..emitters.rounds.len() as u32).map(power).sum(),
        };
        (PI * scale * sum) as f32 * self.placed.mean_factor()
    }
}
