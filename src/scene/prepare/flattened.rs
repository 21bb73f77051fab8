//! Objects that their transform makes flat. It has no inverse, so rays can't be taken to their space: the object
//! is flattened instead, and stands where it is.

use std::sync::Arc;

use crate::desc::{Attribute, InstanceDesc, MeshDesc, SceneDesc, ShapeRef};
use crate::math::{DAffine3, DMat3, DVec3};

/// An axis counts as gone where the others leave it less than this share of the box that they span: what is left
/// of it is rounding.
const FLAT: f64 = 1e-12;

/// Flattens the meshes of `desc` that flat instances show, each in a copy of its own, which stands still.
pub fn prepare(desc: &mut SceneDesc) {
    let SceneDesc { instances, meshes, .. } = desc;
    // What is flat for an instant of the shutter alone is not.
    let flat = |instance: &&mut InstanceDesc| {
        is_flat(&instance.transform) && instance.motion.iter().all(|moved| is_flat(&moved.value))
    };
    for instance in instances.iter_mut().filter(flat) {
        // Strands and balls would be ribbons and disks; they are left out where they are placed.
        let ShapeRef::Mesh(mesh) = instance.shape else { continue };
        meshes.push(Arc::new(flattened(&meshes[mesh as usize], &instance.transform)));
        *instance = InstanceDesc {
            shape: ShapeRef::Mesh(meshes.len() as u32 - 1),
            transform: DAffine3::IDENTITY,
            motion: Vec::new(),
            ..instance.clone()
        };
    }
}

/// True for a transform that leaves two axes of three.
fn is_flat(transform: &DAffine3) -> bool {
    let m = transform.matrix3;
    let largest = m.to_cols_array().iter().fold(0.0_f64, |largest, v| largest.max(v.abs()));
    if !(transform.is_finite() && largest > 0.0) {
        return false;
    }
    let m = DMat3::from_cols(m.x_axis / largest, m.y_axis / largest, m.z_axis / largest);
    let lengths = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length);
    let spans = [m.x_axis.cross(m.y_axis), m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis)].map(DVec3::length);
    let volume = m.determinant().abs();
    let box_ = lengths.iter().product::<f64>();
    volume <= FLAT * box_ && spans.iter().any(|&span| span > FLAT)
}

/// `mesh` in the world, with the normals of its faces. What graphs ask of the object's space is the world's.
fn flattened(mesh: &MeshDesc, to_world: &DAffine3) -> MeshDesc {
    let point = |p: &[f32; 3]| to_world.transform_point3(DVec3::from(p.map(f64::from))).as_vec3().to_array();
    let tangent = |t: &[f32; 4]| {
        let [x, y, z, sign] = t.map(f64::from);
        let [x, y, z] = to_world.transform_vector3(DVec3::new(x, y, z)).normalize_or(DVec3::X).as_vec3().to_array();
        [x, y, z, sign as f32]
    };
    MeshDesc {
        points: mesh.points.iter().map(point).collect(),
        normals: None,
        tangents: mesh.tangents.as_ref().map(|tangents| match tangents {
            Attribute::Point(tangents) => Attribute::Point(tangents.iter().map(tangent).collect()),
            Attribute::Corner(tangents) => Attribute::Corner(tangents.iter().map(tangent).collect()),
        }),
        motion: Vec::new(),
        ..mesh.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_transforms_are_told_from_points_and_lines_and_from_small_ones() {
        let scale = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        let turn = DAffine3::from_rotation_y(0.3) * DAffine3::from_rotation_x(1.1);
        for flat in [scale(1.0, 1.0, 0.0), scale(1e-6, 0.0, 2e-6), turn * scale(0.0, 3.0, 1e9)] {
            assert!(is_flat(&flat) && is_flat(&(flat * turn)), "{flat}");
        }
        for other in [scale(0.0, 0.0, 0.0), scale(1.0, 0.0, 0.0), scale(f64::NAN, 1.0, 0.0), scale(1.0, 1.0, 1e-11)] {
            assert!(!is_flat(&other), "{other}");
        }
    }
}
