//! A point where a ray meets a surface.

use super::material::NormalInput;
use super::{Instance, PathState, RayCone, Scene};
use crate::bvh::Hit;
use crate::math::{DVec3, Frame, Ray, Vec3, gamma, sqr};
use crate::shape::{Shape, SurfaceGeometry};

/// Geometry of a hit in render space. Materials are evaluated from it, as far as they are needed.
#[derive(Clone, Copy, Debug)]
pub struct Interaction {
    /// The point.
    pub p: Vec3,
    /// Half-width of the box in which rounding has left `p`.
    pub p_err: Vec3,
    /// Unit geometric normal, outward (of a mesh as wound).
    pub ng: Vec3,
    /// Unit shading normal on the side of `ng`, before normal maps.
    pub ns: Vec3,
    /// Unit direction back along the ray.
    pub wo: Vec3,
    /// True where `wo` is on the side of `ng`.
    pub front: bool,
    /// Which instance.
    pub instance: u32,
    /// Which primitive of its shape.
    pub primitive: u32,
    /// Which material.
    pub material: u32,
    /// Where on that: on a triangle the barycentrics of the second and third corner.
    pub at: [f32; 2],
    /// Width of the ray's cone here, stretched by the slant of the surface.
    pub footprint: f32,
    /// The primitive's size in render space; see [`crate::shape::SurfaceGeometry::size`].
    pub size: f32,
    /// When it is met: [`Ray::time`], which rays that leave it share.
    pub time: f32,
    /// The path that the ray is part of, where [`super::Effects::light_path`] asks for it.
    pub path: PathState,
}

impl Scene {
    /// The geometry at `hit`, which `ray` with unit direction and footprint `cone` has found.
    pub fn interaction(&self, ray: &Ray, hit: &Hit, cone: RayCone) -> Interaction {
        let it = self.interaction_by(ray, hit, cone);
        Interaction { p: along(ray, hit.t, &it), ..it }
    }

    /// The same by what `hit` says alone, where `ray` is in another space.
    pub(super) fn interaction_by(&self, ray: &Ray, hit: &Hit, cone: RayCone) -> Interaction {
        let instance = &self.instances[hit.instance as usize];
        let it = Interaction::on(self.shape(instance), instance, hit.primitive, [hit.u, hit.v], -ray.d, ray.time);
        let footprint = cone.at(hit.t) / it.wo.dot(it.ng).abs().max(0.05);
        Interaction { instance: hit.instance, footprint, ..it }
    }
}

/// `it.p`, or where it was found on a primitive much larger than the way to it: the ray's own point, moved along the
/// normal to where `it.p` lies. Barycentrics place a point to within a share of the primitive's size, which on a floor of
/// 200 km is more than a speck that stands on it.
fn along(ray: &Ray, t: f32, it: &Interaction) -> Vec3 {
    let way = ray.d * t;
    let rounding = (ray.o.abs() + way.abs()).max_element() * gamma(3);
    if it.p_err.max_element() <= 16.0 * rounding {
        return it.p;
    }
    let aside = ray.o + way - it.p;
    let p = it.p + (aside - it.ng * aside.dot(it.ng));
    // Near the largest float differences overflow.
    if p.is_finite() { p } else { it.p }
}

impl Interaction {
    /// A point of `primitive`, seen from `wo` by a ray without width. The index of its instance, here 0, is
    /// the caller's.
    #[inline(always)]
    pub(super) fn on(shape: &Shape, instance: &Instance, primitive: u32, at: [f32; 2], wo: Vec3, time: f32) -> Self {
        let mut moved = None;
        let placement = instance.placement_at(time, &mut moved);
        let SurfaceGeometry { p, p_err, ng, ns, size } = shape.geometry(primitive, at, placement, time);
        let ng = ng.unwrap_or(wo);
        let ns = ns.map_or(ng, |n| {
            let n = n.normalize_or(ng);
            // Authored normals that point inward would turn the surface inside out.
            if n.dot(ng) < 0.0 { -n } else { n }
        });
        Self {
            p,
            p_err,
            ng,
            ns,
            wo,
            front: wo.dot(ng) >= 0.0,
            instance: 0,
            primitive,
            material: instance.material(shape.slot(primitive)),
            at,
            footprint: 0.0,
            size,
            time,
            path: PathState::CAMERA,
        }
    }

    /// Width of the footprint in units of UV set `set`.
    pub(super) fn uv_footprint(&self, shape: &Shape, set: u32) -> f32 {
        let uv_size = shape.uv_size(set, self.primitive);
        if self.size > 0.0 { self.footprint * (uv_size / self.size).sqrt() } else { 0.0 }
    }
}

impl Scene {
    /// The shading frame on the side of `wo`, normal map applied, x along the tangent where there
    /// is one.
    pub fn shading_frame(&self, it: &Interaction) -> Frame {
        let material = &self.materials[it.material as usize];
        let mut n = material.normal.as_ref().map_or(it.ns, |map| self.mapped_normal(it, map));
        let tangent = tangent_at(self, it);
        if !it.front {
            n = -n;
        }
        if let Some(program) = material.programs.as_ref().and_then(|programs| programs.normal.as_ref()) {
            let [x, y, z, _] = self.spot(it).run(program)[0];
            n = DVec3::new(x, y, z).as_vec3().normalize_or(n);
        }
        let n = facing(n, if it.front { it.ng } else { -it.ng }, it.wo);
        match tangent {
            Some((tangent, _)) => Frame::from_z_and_tangent(n, tangent),
            None => Frame::from_z_facing(n, &self.camera.view().frame()),
        }
    }

    /// The shading normal on the side of `ng` by a tangent-space map.
    pub(super) fn mapped_normal(&self, it: &Interaction, map: &NormalInput) -> Vec3 {
        let n = it.ns;
        let Some((tangent, _)) = tangent_at(self, it) else { return n };
        let frame = Frame::from_z_and_tangent(n, tangent);
        let [x, y, z, _] = self.look_up(map.input, it);
        let local = Vec3::new((2.0 * x - 1.0) * map.scale, (2.0 * y - 1.0) * map.scale, 2.0 * z - 1.0);
        (frame.s * local.x + frame.t * (local.y * self.handedness(it)) + n * local.z).normalize_or(n)
    }

    /// −1 where the axes of the UVs are mirrored on the surface.
    pub(super) fn handedness(&self, it: &Interaction) -> f32 {
        let sign = tangent_at(self, it).map_or(1.0, |(_, sign)| sign);
        if self.instances[it.instance as usize].placement_at(it.time, &mut None).mirrored { -sign } else { sign }
    }
}

fn tangent_at(scene: &Scene, it: &Interaction) -> Option<(Vec3, f32)> {
    let instance = &scene.instances[it.instance as usize];
    let (tangent, sign) = scene.shape(instance).tangent(it.primitive, it.at, it.time)?;
    Some((instance.placement_at(it.time, &mut None).to_render.transform_vector3(tangent), sign))
}

/// `n`, bent as little as needed for `wo` to be above its horizon; both `n` and the geometric
/// normal `ng` are meant to be on the side of `wo`. Interpolated and mapped normals near the
/// silhouette break that, and would shade black.
pub(super) fn facing(n: Vec3, ng: Vec3, wo: Vec3) -> Vec3 {
    const MIN_COS: f32 = 1e-3;
    let cos = n.dot(wo);
    // Where the surface itself is seen at a grazing angle the shading normal may be so, too.
    let min_cos = MIN_COS.min(0.5 * ng.dot(wo).max(0.0)).max(1e-6);
    if cos >= min_cos {
        return n;
    }
    let along = n - wo * cos;
    let length = along.length();
    if length < 1e-6 {
        return ng;
    }
    along / length * (1.0 - sqr(min_cos)).sqrt() + wo * min_cos
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_normal_faces_the_viewer_and_a_good_one_stays() {
        let (ng, wo) = (Vec3::Z, Vec3::new(0.99, 0.0, 0.14).normalize());
        let good = Vec3::new(0.1, 0.0, 1.0).normalize();
        assert_eq!(facing(good, ng, wo), good);
        let bad = Vec3::new(-0.9, 0.0, 0.2).normalize();
        let bent = facing(bad, ng, wo);
        assert!(bent.dot(wo) > 0.0 && (bent.length() - 1.0).abs() < 1e-5);
        assert!(facing(-wo, ng, wo).dot(wo) > 0.0);
    }
}
