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
use crate::math::{
    Affine3A, Bounds, DMat3, DVec3, MovingTransform, Rgb, RoundCone, RoundPoint, Vec3, center_of, gamma,
    offset_ray_origin, place_point,
};
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
}

/// What areas grow by along each axis of a normal: the cofactors of the transform.
fn cofactors(to_render: &Affine3A) -> DMat3 {
    let m = &to_render.matrix3;
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|axis| Vec3::from(axis).as_dvec3());
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
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
}

/// Bounds of a segment that emits `mean`, over all times; `None` where that is nothing.
fn bounds_of(rounds: &Rounds, segment: u32, mean: Rgb) -> Option<LightBounds> {
    let (mut bounds, mut area) = (Bounds::EMPTY, 0.0_f64);
    for [first, last] in rounds.keys(segment) {
        let (cone, origin) = (RoundCone::new(first, last), center_of(first));
        let corners = [origin, origin + cone.axis].into_iter().zip(cone.radii).flat_map(|(p, r)| [p - r, p + r]);
        bounds = bounds.union(Bounds::of_points(corners.map(DVec3::as_vec3)));
        area = area.max(cone.areas().iter().sum());
    }
    // What a convex body shows of its surface is a quarter of it on the mean.
    let intensity = 0.25 * area * f64::from(mean.luminance());
    if !(intensity > 0.0 && intensity.is_finite()) {
        return None;
    }
    Some(LightBounds {
        bounds,
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
        Some(Self { emitters, placed: Arc::new(placed) })
    }

    /// The same where `motion` has it while the shutter is open.
    pub fn moving(mut self, motion: Option<Arc<MovingTransform>>) -> Self {
        if let Some(motion) = motion {
            Arc::make_mut(&mut self.placed).set_motion(&self.emitters.tree, motion);
        }
        self
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
}

/// Density by area at `point` of `cone`, in render space.
fn density(cone: &RoundCone, point: &RoundPoint, cofactors: DMat3) -> f64 {
    1.0 / (cone.areas().iter().sum::<f64>() * (cofactors * point.normal).length())
}

impl Emitter for RoundLight {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let mut moved = None;
        let pose = self.placed.pose(at.time, &mut moved);
        let (asked, cofactors) = (pose.asked(at), cofactors(&pose.to_render));
        let tree = &self.emitters.tree;
        let chosen = tree.sample_from(&asked, &tree.weigh(&asked), refined(u[0], &asked, SEGMENT))?;
        let segment = self.emitters.segment_of(chosen.item);
        let (cone, origin) = self.emitters.rounds.cone(segment, at.time);
        let uv = cone.sample([chosen.u, u[1]].map(f64::from));
        let point = cone.point(uv);
        let local = (origin + point.p).as_vec3();
        let (on_light, p_err) = place_point(&pose.to_render, local, local.abs() * gamma(2));
        let det = cofactors.z_axis.dot(Vec3::from(pose.to_render.matrix3.z_axis).as_dvec3());
        let ng = (cofactors * point.normal * det.signum()).normalize_or_zero();
        let to_light = on_light.as_dvec3() - at.p.as_dvec3();
        let dist_squared = to_light.length_squared();
        let wi = to_light / dist_squared.sqrt();
        let pdf = density(&cone, &point, cofactors) * f64::from(chosen.pmf) * dist_squared / ng.dot(wi).abs();
        let (wi, ng, pdf) = (wi.as_vec3(), ng.as_vec3(), pdf as f32);
        let li = self.emitters.emission.radiance_towards(segment, uv, -wi, at.time) * self.placed.factor(-wi);
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
        let mut moved = None;
        let pose = self.placed.pose(at.time, &mut moved);
        let cone = self.emitters.rounds.cone(hit.triangle, at.time).0;
        let point = cone.point(hit.uv);
        let dist = f64::from(hit.dist);
        let density =
            density(&cone, &point, cofactors(&pose.to_render)) * dist * dist / f64::from(hit.ng.dot(wi).abs());
        let pdf = (density * f64::from(self.emitters.tree.pmf_of(&pose.asked(at), item))) as f32;
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
        let scale = cofactors(&self.placed.pose(0.5, &mut None).to_render).determinant().abs().cbrt();
        let area = |segment: u32| emitters.rounds.cone(segment, 0.5).0.areas().iter().sum::<f64>();
        let power = |segment: u32| area(segment) * f64::from(emitters.emission.mean(segment).luminance());
        let sum: f64 = match &emitters.segments {
            Some(segments) => segments.iter().map(|&i| power(i)).sum(),
            None => (0..emitters.rounds.len() as u32).map(power).sum(),
        };
        (PI * scale * sum) as f32 * self.placed.mean_factor()
    }
}
