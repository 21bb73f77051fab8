//! A camera for scenes that have none, and the picture's size for those that say nothing.

use crate::desc::{CameraDesc, MeshDesc, ProjectionDesc, RoundsDesc, SceneDesc, ShapeRef};
use crate::error::Place;
use crate::math::{DAffine3, DVec3};

/// Vertical field of view of the camera that frames a scene: that of a 50 mm lens on 36 × 24 mm.
const FOV_Y: f64 = 0.471;

/// Box of everything that is placed, in the world; `None` where there is nothing.
pub fn world_bounds(scene: &SceneDesc) -> Option<(DVec3, DVec3)> {
    let point = |p: [f32; 3]| DVec3::from(p.map(f64::from));
    let of_mesh = |mesh: &MeshDesc| {
        let points = mesh.triangles.iter().flatten().map(|&i| mesh.points[i as usize]);
        union(points.map(point).map(|p| (p, p)))
    };
    let of_rounds = |rounds: &RoundsDesc| {
        let balls = rounds.points.iter().zip(&rounds.radii);
        union(balls.map(|(&p, &r)| (point(p) - f64::from(r), point(p) + f64::from(r))))
    };
    let meshes: Vec<_> = scene.meshes.iter().map(|mesh| of_mesh(mesh)).collect();
    let rounds: Vec<_> = scene.rounds.iter().map(|rounds| of_rounds(rounds)).collect();
    union(scene.instances.iter().filter_map(|instance| {
        let (min, max) = match instance.shape {
            ShapeRef::Mesh(i) => meshes[i as usize]?,
            ShapeRef::Rounds(i) => rounds[i as usize]?,
        };
        let corners = (0..8).map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
            instance.transform.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        });
        union(corners.map(|p| (p, p)))
    }))
}

fn union(boxes: impl Iterator<Item = (DVec3, DVec3)>) -> Option<(DVec3, DVec3)> {
    boxes.filter(|(min, max)| min.is_finite() && max.is_finite()).reduce(|(min, max), (a, b)| (min.min(a), max.max(b)))
}

/// A camera that sees all of `scene` in a picture of width over height `aspect`: from the front,
/// a little from the right and above.
pub fn framing_camera(scene: &SceneDesc, aspect: f64) -> CameraDesc {
    let (min, max) = world_bounds(scene).unwrap_or((DVec3::splat(-1.0), DVec3::splat(1.0)));
    let center = 0.5 * (min + max);
    let forward = DVec3::new(-0.5, -0.35, -1.0).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    // Back off until each corner of the box lies inside the narrower of the two angles.
    let tan_y = 0.5 * FOV_Y;
    let tan_y = tan_y.tan() * 0.92;
    let tan_x = tan_y * aspect;
    let back = (0..8)
        .map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let p = DVec3::new(pick(0), pick(1), pick(2)) - center;
            let (x, y, z) = (p.dot(right).abs(), p.dot(up).abs(), p.dot(forward));
            (x / tan_x).max(y / tan_y) - z
        })
        .fold(0.0, f64::max)
        .max(1e-6);
    let origin = center - forward * back;
    CameraDesc {
        name: "framing".into(),
        place: Place::default(),
        transform: DAffine3::from_cols(right, up, -forward, origin),
        projection: ProjectionDesc::Perspective { fov_y: FOV_Y, aspect: None },
        clip_near: 0.0,
        clip_far: f64::INFINITY,
        shift: [0.0; 2],
        lens: None,
        shutter: [0.0; 2],
        shutter_curve: Vec::new(),
        rolling_shutter: None,
        zoom: Vec::new(),
        exposure: 1.0,
        motion: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{InstanceDesc, LightLinks, ObjectInfo, Visibility};

    #[test]
    fn every_corner_is_in_the_picture() {
        let mesh = MeshDesc {
            points: vec![[-1.0, 0.0, -3.0], [4.0, 0.1, 2.0], [0.0, 2.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..MeshDesc::default()
        };
        let instance = InstanceDesc {
            name: "a".into(),
            place: Place::default(),
            asset: "a".into(),
            shape: ShapeRef::Mesh(0),
            transform: DAffine3::from_translation(DVec3::new(1e5, 0.0, 0.0)),
            motion: Vec::new(),
            materials: vec![],
            color: None,
            object_index: 0,
            info: ObjectInfo::default(),
            visibility: Visibility::ALL,
            links: LightLinks::default(),
            shaped: None,
            holdout: false,
            catcher: false,
            terminator: None,
        };
        let scene = SceneDesc { meshes: vec![mesh.into()], instances: vec![instance], ..SceneDesc::default() };
        for aspect in [0.3, 1.0, 3.0] {
            let to_camera = framing_camera(&scene, aspect).transform.inverse();
            for p in [[-1.0, 0.0, -3.0], [4.0, 0.1, 2.0], [0.0, 2.0, 0.0]] {
                let p = to_camera.transform_point3(DVec3::from(p) + DVec3::new(1e5, 0.0, 0.0));
                let tan = (0.5 * FOV_Y).tan();
                assert!(p.z < 0.0 && p.y.abs() < -p.z * tan && p.x.abs() < -p.z * tan * aspect);
            }
        }
    }
}
