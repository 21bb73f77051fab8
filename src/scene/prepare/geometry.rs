//! Shapes moved to the middle of their box, instances to render space, and the tree over them.

use std::sync::Arc;

use rayon::prelude::*;

use super::cache::{Cache, Ready};
use super::links::Links;
use crate::bvh::{self, Blas, Bvh};
use crate::desc::{self, InstanceDesc, MeshDesc, RoundsDesc, SceneDesc, ShapeRef, TerminatorDesc};
use crate::error::{Result, Warnings};
use crate::math::{Bounds, Cluster, DAffine3, DVec3, MovingTransform, Times, Vec2, Vec3};
use crate::scene::shutter::{Keys, Shutter};
use crate::scene::{Inside, Instance, Material, mask};
use crate::shape::{self, Mesh, MeshMotion, Placement, RoundMotion, Rounds, Shape};

/// Everything that has a place.
pub struct Geometry {
    /// Meshes, then strands and balls, as in the `SceneDesc`.
    pub shapes: Vec<Shape>,
    /// Placed shapes.
    pub instances: Vec<Instance>,
    /// For each of `instances`, its index in the `SceneDesc`.
    pub placed: Vec<u32>,
    /// The tree.
    pub bvh: Bvh,
    /// Of each of `instances` whose inside light may walk in, that; empty where there is none.
    pub insides: Vec<Option<Inside>>,
    /// The instances whose insides absorb light, and which they are.
    pub absorbing: Option<(Bvh, Vec<u32>)>,
}

/// Prepares all shapes that are placed, in parallel; `terminator` is that of objects which have none of their own.
///
/// # Errors
/// A preparation that is stopped.
pub fn prepare(
    desc: &SceneDesc,
    origin: DVec3,
    shutter: Option<Shutter>,
    materials: &[Material],
    links: &Links,
    terminator: TerminatorDesc,
    cache: &mut Cache,
    warnings: &mut Warnings,
) -> Result<Geometry> {
    let index = |shape: ShapeRef| match shape {
        ShapeRef::Mesh(i) => i as usize,
        ShapeRef::Rounds(i) => desc.meshes.len() + i as usize,
    };
    let mut used = vec![false; desc.meshes.len() + desc.rounds.len()];
    for instance in &desc.instances {
        used[index(instance.shape)] = true;
    }
    cache.forget_motion_of_other(shutter);
    let meshes = desc.meshes.par_iter().zip(&used).map(|(desc, used)| {
        cache.mesh(desc).unwrap_or_else(|| {
            let wanted = *used && !cache.stop.is_wished();
            let (mesh, blas) =
                if wanted { prepare_mesh(desc, shutter) } else { (Mesh::default(), Blas::build(&[], &[])) };
            (Shape::Mesh(Arc::new(mesh)), Arc::new(blas))
        })
    });
    let rounds = desc.rounds.par_iter().zip(&used[desc.meshes.len()..]).map(|(desc, used)| {
        cache.rounds(desc).unwrap_or_else(|| {
            let wanted = *used && !cache.stop.is_wished();
            let (rounds, blas) =
                if wanted { prepare_rounds(desc, shutter) } else { (Rounds::default(), Blas::build(&[], &[])) };
            (Shape::Rounds(Arc::new(rounds)), Arc::new(blas))
        })
    });
    let prepared: Vec<Ready> = meshes.chain(rounds).collect();
    cache.keep(desc, &used, &prepared);
    // Of a preparation that is stopped nothing is kept, and nobody sees what is missing.
    cache.stop.check()?;
    let (shapes, blases): (Vec<_>, Vec<_>) = prepared.into_iter().unzip();
    let default_material = materials.len() as u32 - 1;
    let (mut instances, mut boxes, mut placed) = (Vec::new(), Vec::new(), Vec::new());
    let (mut insides, mut absorbing) = (Vec::new(), Vec::new());
    for (i, instance) in desc.instances.iter().enumerate() {
        let shape = index(instance.shape);
        if shapes[shape].is_empty() {
            continue;
        }
        let placed_at = place(instance, shape as u32, &shapes[shape], origin, shutter, default_material, terminator);
        let Some(mut prepared) = placed_at else {
            warnings.push(&instance.place, "transform is singular, not finite or out of range: object left out");
            continue;
        };
        let cutout = prepared.materials.iter().any(|&m| materials[m as usize].is_cutout());
        let emits = prepared.materials.iter().any(|&m| materials[m as usize].emits() || materials[m as usize].unlit);
        prepared.receiver_class = links.receiver_class(i);
        boxes.push(bvh::Instance {
            blas: shape as u32,
            object_to_render: prepared.placement.to_render,
            motion: prepared.motion.clone(),
            mask: mask::of(instance.visibility, cutout, emits, instance.catcher, links.blocker_class(i)),
        });
        let has_inside = prepared.materials.iter().any(|&m| materials[m as usize].has_inside());
        let inside = || Inside::new(instances.len() as u32, &prepared, blases[shape].clone());
        insides.push(has_inside.then(inside));
        if prepared.materials.iter().any(|&m| materials[m as usize].absorbs()) {
            absorbing.push(instances.len() as u32);
        }
        instances.push(prepared);
        placed.push(i as u32);
    }
    if insides.iter().all(Option::is_none) {
        insides.clear();
    }
    let absorbing = (!absorbing.is_empty()).then(|| {
        let alone = absorbing.iter().map(|&i| boxes[i as usize].clone()).collect();
        (Bvh::build(blases.clone(), alone), absorbing)
    });
    cache.stop.check()?;
    Ok(Geometry { shapes, instances, placed, bvh: Bvh::build(blases, boxes), insides, absorbing })
}

/// Boxes are so much larger than what most of their points span only where a few of them are far away.
const ODD: f64 = 1e4;

/// The middle of the box of `points`, and the points relative to it. Where a few of them are far from all others it is
/// the middle of those: they have the digits that they need.
fn centered(points: &[[f32; 3]]) -> (DVec3, impl Iterator<Item = Vec3>) {
    let bounds = Bounds::of_points(points.iter().map(|&p| Vec3::from(p)).filter(|p| p.is_finite()));
    let middle = if bounds.is_empty() { DVec3::ZERO } else { 0.5 * (bounds.min.as_dvec3() + bounds.max.as_dvec3()) };
    let half = f64::from((bounds.max - bounds.min).max_element()) * 0.5;
    let most = Cluster::of(points).filter(|most| most.spread > 0.0 && half > ODD * most.spread);
    let center = most.map_or(middle, |most| most.middle);
    (center, relative(points, center))
}

fn relative(points: &[[f32; 3]], center: DVec3) -> impl Iterator<Item = Vec3> {
    points.iter().map(move |p| (DVec3::from(p.map(f64::from)) - center).as_vec3())
}

/// Keys of points that move, relative to `center`; `None` for those that do not.
pub(super) fn moving(keys: Option<Keys<'_, Vec<[f32; 3]>>>, center: DVec3) -> Option<(Times, Vec<Vec<Vec3>>)> {
    let keys = keys?;
    let times = Times::new(keys.iter().map(|key| key.0).collect())?;
    Some((times, keys.iter().map(|(_, points)| relative(points, center).collect()).collect()))
}

fn prepare_rounds(desc: &RoundsDesc, shutter: Option<Shutter>) -> (Rounds, Blas) {
    let (center, points) = centered(&desc.points);
    let balls = |points: &mut dyn Iterator<Item = Vec3>, radii: &[f32]| {
        points.zip(radii).map(|(p, &radius)| [p.x, p.y, p.z, radius]).collect::<Vec<_>>()
    };
    let mut rounds = Rounds {
        center,
        balls: balls(&mut points.into_iter(), &desc.radii),
        segments: desc.segments(),
        uvs: desc.uvs.iter().map(|set| set.iter().map(|&uv| Vec2::from(uv)).collect()).collect(),
        colors: desc.colors.clone(),
        material_slots: desc.segment_slots(),
        motion: None,
    };
    let segments = rounds.segments.as_deref();
    let (now, motion) = desc.keys();
    let keys = shutter.and_then(|shutter| shutter.keys(&now, &motion));
    let timed = keys.and_then(|keys| Some((Times::new(keys.iter().map(|key| key.0).collect())?, keys)));
    let Some((times, keys)) = timed else {
        let blas = Blas::rounds(&rounds.balls, segments);
        return (rounds, blas);
    };
    let keys: Vec<_> = keys.iter().map(|(_, (points, radii))| balls(&mut relative(points, center), radii)).collect();
    let blas = Blas::moving_rounds(times.clone(), &keys, segments);
    rounds.motion = Some(RoundMotion { times, keys }.into());
    (rounds, blas)
}

fn prepare_mesh(desc: &MeshDesc, shutter: Option<Shutter>) -> (Mesh, Blas) {
    let mut mesh = still_mesh(desc);
    let keys = shutter.and_then(|shutter| shutter.keys(&desc.points, &desc.motion));
    let Some((times, keys)) = moving(keys, mesh.center) else {
        let blas = Blas::build(&mesh.points, &mesh.triangles);
        return (mesh, blas);
    };
    let blas = Blas::moving(times.clone(), &keys, &mesh.triangles);
    let motion = MeshMotion::new(times, keys, &mesh.points, &mesh.triangles, mesh.normals.as_ref());
    mesh.motion = Some(motion.into());
    (mesh, blas)
}

fn still_mesh(desc: &MeshDesc) -> Mesh {
    let (center, points) = centered(&desc.points);
    Mesh {
        center,
        points: points.collect(),
        triangles: desc.triangles.clone(),
        normals: desc.normals.as_ref().map(|n| convert(n, |&n| Vec3::from(n))),
        uvs: desc.uvs.iter().map(|uv| convert(uv, |&uv| Vec2::from(uv))).collect(),
        tangents: desc.tangents.as_ref().map(|t| convert(t, |&t| t)),
        colors: desc.colors.as_ref().map(|c| convert(c, |&c| c)),
        material_slots: desc.material_slots.clone(),
        motion: None,
    }
}

/// Values of the description as the mesh has them.
pub fn convert<T, U>(attribute: &desc::Attribute<T>, f: impl Fn(&T) -> U) -> shape::Attribute<U> {
    match attribute {
        desc::Attribute::Point(values) => shape::Attribute::Point(values.iter().map(f).collect()),
        desc::Attribute::Corner(values) => shape::Attribute::Corner(values.iter().map(f).collect()),
    }
}

/// `desc` in render space; `None` where its transform can't be undone or leaves the range of `f32`.
fn place(
    desc: &InstanceDesc,
    index: u32,
    shape: &Shape,
    origin: DVec3,
    shutter: Option<Shutter>,
    default_material: u32,
    terminator: TerminatorDesc,
) -> Option<Instance> {
    let center = shape.center();
    let to_render = DAffine3::from_translation(-origin) * desc.transform * DAffine3::from_translation(center);
    let keys = shutter.and_then(|shutter| shutter.transform(desc));
    let motion = match keys {
        Some(keys) => {
            let keys: Vec<_> = keys.into_iter().map(|(time, key)| (time, *key)).collect();
            Some(MovingTransform::new(&keys)?.rebased(center, origin))
        }
        None => None,
    };
    // What is squeezed flat at the frame may be so for an instant.
    let on_the_way = || Placement::new(&motion.as_ref()?.at(0.5));
    let placement = Placement::new(&to_render).or_else(on_the_way)?;
    let slots = desc.materials.iter().map(|m| m.unwrap_or(default_material));
    let materials: Box<[u32]> = if desc.materials.is_empty() { [default_material].into() } else { slots.collect() };
    Some(Instance {
        shape: index,
        placement,
        motion: motion.map(Arc::new),
        materials,
        color: desc.color,
        light: None,
        receiver_class: 0,
        rules: None,
        profile: None,
        holdout: desc.holdout,
        catcher: desc.catcher,
        terminator: desc.terminator.unwrap_or(terminator).into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_points_far_away_cost_the_others_no_digits() {
        let near = |i: usize| [(i % 10) as f32 * 0.1 + 3.0, (i / 10) as f32 * 0.1, 0.25];
        let mut points: Vec<[f32; 3]> = (0..100).map(near).collect();
        let (middle, _) = centered(&points);
        assert!((middle - DVec3::new(3.45, 0.45, 0.25)).length() < 1e-6, "{middle}");
        points.push([1e7, 0.0, 0.0]);
        let (center, relative) = centered(&points);
        for (relative, point) in relative.zip(&points) {
            let back = relative.as_dvec3() + center;
            let exact = DVec3::from(point.map(f64::from));
            assert!((back - exact).length() <= 1e-7 * exact.length(), "{back} instead of {exact}");
        }
    }
}
