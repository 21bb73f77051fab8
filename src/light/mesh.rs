//! The emissive triangles of a mesh, and instances of it as lights.
//!
//! The tree over the triangles is in mesh space and shared by all instances of the mesh: which side of
//! a plane a point is on does not change with an affine map, so a triangle that can light a receiver
//! can do so in mesh space, too. The geometry of the chosen triangle is that of render space. A point
//! on a near one is chosen by solid angle, on a far one by area.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::placed::Placed;
use super::tree::refined;
use super::{Emission, Emitter, EmitterHit, LightBounds, LightSample, LightTree, Profile, Receiver};
use crate::math::{Affine3A, Bounds, DVec3, MovingTransform, Rgb, Vec3, gamma, offset_ray_origin, place_point};
use crate::sampling::warp::{SphericalTriangle, sample_triangle, solid_angle_of_triangle};
use crate::shape::Mesh;

/// A triangle whose longest edge is this share of its distance, squared, or less is far: over it the
/// density by area is nearly uniform in solid angle.
const FAR: f64 = 0.01;

/// Solid angles between which directions are exact to f32 in f64; beyond, a near triangle is sampled
/// by area, too.
const SOLID_ANGLES: std::ops::Range<f64> = 1e-9..TAU * (1.0 - 1e-9);

/// Numbers the choice of a triangle among those that draw on one random number.
const TRIANGLE: u32 = 1;

/// All emissive triangles of a mesh, emitting on both sides.
#[derive(Debug)]
pub struct MeshEmitters {
    mesh: Arc<Mesh>,
    emission: Arc<dyn Emission>,
    /// Triangles of the mesh that the tree's items are, growing; `None` where they are all.
    triangles: Option<Box<[u32]>>,
    tree: LightTree,
}

/// The emissive triangles of an instance.
#[derive(Clone, Debug)]
pub struct MeshLight {
    emitters: Arc<MeshEmitters>,
    placed: Arc<Placed>,
}

/// A triangle in render space.
struct Triangle {
    p: [Vec3; 3],
    p_err: Vec3,
    /// Cross product of its edges, in f64, where the squares of neither huge nor tiny triangles leave
    /// the range.
    cross: DVec3,
}

impl MeshEmitters {
    /// The triangles of `mesh` that emit something; `None` where none does.
    pub fn new(mesh: Arc<Mesh>, emission: Arc<dyn Emission>) -> Option<Self> {
        use rayon::prelude::*;
        let bounds = |triangle: u32| {
            let mean = emission.mean(triangle);
            let bounds = match &mesh.motion {
                None => triangle_bounds(mesh.corners(triangle), mean)?,
                Some(motion) => moving_bounds(motion.keys(mesh.triangles[triangle as usize]), mean)?,
            };
            Some((triangle, bounds))
        };
        let count = u32::try_from(mesh.triangles.len()).ok()?;
        let (triangles, bounds): (Vec<u32>, Vec<LightBounds>) = (0..count).into_par_iter().filter_map(bounds).unzip();
        let tree = LightTree::new(&bounds)?;
        let triangles = (triangles.len() < mesh.triangles.len()).then(|| triangles.into_boxed_slice());
        Some(Self { mesh, emission, triangles, tree })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// How it emits.
    pub fn emission(&self) -> &dyn Emission {
        &*self.emission
    }

    fn triangle_of(&self, item: u32) -> u32 {
        self.triangles.as_ref().map_or(item, |triangles| triangles[item as usize])
    }

    fn item_of(&self, triangle: u32) -> Option<u32> {
        let Some(triangles) = &self.triangles else { return Some(triangle) };
        triangles.binary_search(&triangle).ok().map(|i| i as u32)
    }

    /// Memory held beside the mesh, in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes() + self.triangles.as_ref().map_or(0, |triangles| std::mem::size_of_val(&**triangles))
    }
}

/// Bounds of a triangle that emits `mean`; `None` where that is nothing.
fn triangle_bounds(p: [Vec3; 3], mean: Rgb) -> Option<LightBounds> {
    let [a, b, c] = p.map(|p| p.as_dvec3());
    let cross = (b - a).cross(c - a);
    let intensity = 0.5 * cross.length() * f64::from(mean.luminance());
    if !(intensity > 0.0 && intensity.is_finite()) {
        return None;
    }
    Some(LightBounds {
        bounds: Bounds::of_points(p),
        axis: cross.normalize_or_zero().as_vec3(),
        cos_normals: 1.0,
        cos_emission: 0.0,
        intensity: (intensity as f32).clamp(f32::MIN_POSITIVE, f32::MAX),
        two_sided: true,
    })
}

/// Bounds of a triangle over all times, given its corners at each key. Between two keys the cross product of its
/// edges is a quadratic curve, which stays within the cone of its three control points.
fn moving_bounds(keys: impl Iterator<Item = [Vec3; 3]>, mean: Rgb) -> Option<LightBounds> {
    let edges = |p: [Vec3; 3]| [p[1] - p[0], p[2] - p[0]].map(|e| e.as_dvec3());
    let (mut bounds, mut normals, mut last) = (Bounds::EMPTY, Vec::new(), None);
    let mut brightest: Option<LightBounds> = None;
    for p in keys {
        let [e, f] = edges(p);
        if let Some([before_e, before_f]) = last.replace([e, f]) {
            normals.push(before_e.cross(f) + e.cross(before_f));
        }
        normals.push(e.cross(f));
        bounds = bounds.union(Bounds::of_points(p));
        let brighter = |at: &LightBounds| brightest.is_none_or(|most| at.intensity > most.intensity);
        brightest = triangle_bounds(p, mean).filter(brighter).or(brightest);
    }
    let axis = normals.iter().map(|n| n.normalize_or_zero()).sum::<DVec3>().normalize_or_zero();
    let cos = normals.iter().map(|n| n.normalize_or_zero().dot(axis)).fold(1.0, f64::min);
    let cos_normals = if cos > 0.0 { cos as f32 - 1e-5 } else { -1.0 };
    Some(LightBounds { bounds, axis: axis.as_vec3(), cos_normals, ..brightest? })
}

impl MeshLight {
    /// The light of `emitters` placed by `to_render`; `None` where that can't be undone.
    pub fn new(emitters: Arc<MeshEmitters>, to_render: Affine3A) -> Option<Self> {
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

    /// The triangles, which other instances may share.
    pub fn emitters(&self) -> &Arc<MeshEmitters> {
        &self.emitters
    }

    /// Corners of triangle `index` of the mesh where the shutter opens, render space.
    pub fn corners(&self, index: u32) -> [Vec3; 3] {
        self.triangle(index, &self.placed.pose(0.0, &mut None).to_render, 0.0).p
    }

    fn triangle(&self, index: u32, to_render: &Affine3A, time: f32) -> Triangle {
        // Blending the corners rounds as `Mesh::point` does.
        let place = |p: Vec3| place_point(to_render, p, p.abs() * gamma(7));
        let corners = self.emitters.mesh.corners_at(index, time).map(place);
        let p_err = corners.iter().fold(Vec3::ZERO, |largest, (_, p_err)| largest.max(*p_err));
        let p = corners.map(|(p, _)| p);
        let cross = (p[1] - p[0]).as_dvec3().cross((p[2] - p[0]).as_dvec3());
        Triangle { p, p_err, cross }
    }
}

impl Triangle {
    /// True where `p` lies in the triangle's plane but for rounding, as the points of an emissive mesh
    /// lie in their own triangle: nothing is sent there, and on which side rounding has left `p` is chance.
    fn is_level_with(&self, p: Vec3) -> bool {
        let height = self.cross.dot(p.as_dvec3() - self.p[0].as_dvec3()).abs();
        let p_err = (self.p_err + p.abs() * gamma(16)).as_dvec3();
        height <= self.cross.abs().dot(p_err)
    }

    /// Unit directions from `p` to the corners, if the triangle is to be sampled by solid angle.
    fn near(&self, p: Vec3) -> Option<[DVec3; 3]> {
        let [a, b, c] = self.p.map(|corner| corner.as_dvec3() - p.as_dvec3());
        let edge = (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
        let dist = a.length_squared().min(b.length_squared()).min(c.length_squared());
        (edge > FAR * dist && dist > 0.0).then(|| [a.normalize(), b.normalize(), c.normalize()])
    }

    /// Where the ray from `p` along `w`, which meets the triangle but for rounding, does so.
    fn barycentrics(&self, p: Vec3, w: DVec3) -> [f64; 3] {
        let [a, b, c] = self.p.map(|corner| corner.as_dvec3() - p.as_dvec3());
        // Volumes that the direction spans with two of the corners.
        let shares = [w.dot(b.cross(c)), w.dot(c.cross(a)), w.dot(a.cross(b))];
        let facing = self.cross.dot(a).signum();
        let shares = shares.map(|share| (share * facing).max(0.0));
        let sum: f64 = shares.iter().sum();
        if sum > 0.0 { shares.map(|share| share / sum) } else { [1.0 / 3.0; 3] }
    }

    /// From `p` to the point with the given barycentrics.
    fn to(&self, p: Vec3, barycentrics: [f64; 3]) -> DVec3 {
        let corners = self.p.map(|corner| corner.as_dvec3() - p.as_dvec3());
        corners[0] * barycentrics[0] + corners[1] * barycentrics[1] + corners[2] * barycentrics[2]
    }

    fn area(&self) -> f64 {
        0.5 * self.cross.length()
    }
}

impl Emitter for MeshLight {
    fn sample_li(&self, at: &Receiver, _uc: f32, u: [f32; 2]) -> Option<LightSample> {
        let mut moved = None;
        let pose = self.placed.pose(at.time, &mut moved);
        let asked = pose.asked(at);
        let tree = &self.emitters.tree;
        // A strip of the square for each triangle: its points are spread as well as all of them, which
        // those picked by a number that is independent of the square would not be.
        let chosen = tree.sample_from(&asked, &tree.weigh(&asked), refined(u[0], &asked, TRIANGLE))?;
        let u = [chosen.u, u[1]];
        let index = self.emitters.triangle_of(chosen.item);
        let triangle = self.triangle(index, &pose.to_render, at.time);
        if triangle.is_level_with(at.p) {
            return None;
        }
        let ng = triangle.cross.normalize_or_zero().as_vec3();
        let spherical = triangle.near(at.p).and_then(SphericalTriangle::new);
        let spherical = spherical.filter(|s| SOLID_ANGLES.contains(&s.solid_angle()));
        let barycentrics = match &spherical {
            Some(spherical) => triangle.barycentrics(at.p, spherical.sample(u)),
            None => sample_triangle(u).map(f64::from),
        };
        let to_light = triangle.to(at.p, barycentrics);
        let dist_squared = to_light.length_squared();
        let wi = (to_light / dist_squared.sqrt()).as_vec3();
        let on_light = (at.p.as_dvec3() + to_light).as_vec3();
        let density = match &spherical {
            Some(spherical) => 1.0 / spherical.solid_angle(),
            None => dist_squared / (f64::from(ng.dot(wi).abs()) * triangle.area()),
        };
        let [_, b1, b2] = barycentrics.map(|b| b as f32);
        let pdf = (density * f64::from(chosen.pmf)) as f32;
        let li = self.emitters.emission.radiance_towards(index, [b1, b2], -wi, at.time) * self.placed.factor(-wi);
        if !(pdf.is_finite() && pdf > 0.0) || li.is_black() {
            return None;
        }
        // Rounding has moved the light's point, and moves the ray that is traced towards it from `p`.
        let largest = at.p.abs().max(on_light.abs()).max_element();
        let p_err = triangle.p_err + Vec3::splat(gamma(8) * largest);
        let end = Some(offset_ray_origin(on_light, p_err, ng, -wi));
        Some(LightSample { li, wi, end, pdf, delta: false })
    }

    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
        let Some(hit) = hit else { return 0.0 };
        let Some(item) = self.emitters.item_of(hit.triangle) else { return 0.0 };
        let mut moved = None;
        let pose = self.placed.pose(at.time, &mut moved);
        let triangle = self.triangle(hit.triangle, &pose.to_render, at.time);
        if triangle.is_level_with(at.p) {
            return 0.0;
        }
        let solid_angle = triangle.near(at.p).map(solid_angle_of_triangle);
        let density = match solid_angle.filter(|angle| SOLID_ANGLES.contains(angle)) {
            Some(angle) => 1.0 / angle,
            None => {
                let dist = f64::from(hit.dist);
                dist * dist / (f64::from(hit.ng.dot(wi).abs()) * triangle.area())
            }
        };
        if !density.is_finite() {
            return 0.0;
        }
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
        let mut moved = None;
        let pose = self.placed.pose(0.5, &mut moved);
        let area = |triangle: u32| self.triangle(triangle, &pose.to_render, 0.5).area();
        let power = |triangle: u32| area(triangle) * f64::from(emitters.emission.mean(triangle).luminance());
        let sum: f64 = match &emitters.triangles {
            Some(triangles) => triangles.iter().map(|&i| power(i)).sum(),
            None => (0..emitters.mesh.triangles.len() as u32).map(power).sum(),
        };
        (2.0 * PI * sum) as f32 * self.placed.mean_factor()
    }
}
