//! Meshes rid of what can't be traced: points that are not finite, indices out of range, triangles
//! without area, normals without direction, points that nothing uses.

use super::mesh::Geometry;
use crate::error::{Place, Warnings};
use crate::math::{DVec3, Vec3};

/// Drops triangles that can't be traced and mends attributes that are not finite.
pub(super) fn clean(geometry: &mut Geometry, place: &Place, warnings: &mut Warnings) {
    let count = geometry.points.len();
    let before = geometry.triangles.len();
    geometry.triangles.retain(|t| t.iter().all(|&i| (i as usize) < count));
    let out_of_range = before - geometry.triangles.len();
    if out_of_range > 0 {
        let what = format!("{out_of_range} triangles use points that don't exist ({count} do); they are left out");
        warnings.push(place, what);
    }
    // Beyond this a squared length leaves single precision.
    let sound = |p: &[f32; 3]| p.iter().all(|v| v.abs() < 1e18);
    let bad: Vec<bool> = geometry.points.iter().map(|p| !sound(p)).collect();
    let bad_count = bad.iter().filter(|&&bad| bad).count();
    if bad_count > 0 {
        let before = geometry.triangles.len();
        geometry.triangles.retain(|t| !t.iter().any(|&i| bad[i as usize]));
        let dropped = before - geometry.triangles.len();
        for (point, bad) in geometry.points.iter_mut().zip(&bad) {
            if *bad {
                *point = [0.0; 3];
            }
        }
        warnings.push(
            place,
            format!("{bad_count} points are not finite; the {dropped} triangles that use them are left out"),
        );
    }
    let points = &geometry.points;
    geometry.triangles.retain(|&t| area_vector(points, t) != [0.0; 3]);
    mend_normals(geometry, place, warnings);
    for uv in geometry.uvs.iter_mut().flatten().flatten() {
        if !uv.is_finite() {
            *uv = 0.0;
        }
    }
    for color in geometry.colors.iter_mut().flatten().flatten() {
        *color = if color.is_finite() { color.max(0.0) } else { 1.0 };
    }
    if geometry.tangents.as_ref().is_some_and(|tangents| !tangents.iter().flatten().all(|v| v.is_finite())) {
        warnings.push(place, "tangents are not finite; they are made anew");
        geometry.tangents = None;
    }
}

/// Twice the area times the normal, free of rounding that could make it 0 where it is not.
fn area_vector(points: &[[f32; 3]], [a, b, c]: [u32; 3]) -> [f64; 3] {
    let point = |i: u32| points[i as usize].map(f64::from);
    let (p, q, r) = (point(a), point(b), point(c));
    let (u, v) = ([q[0] - p[0], q[1] - p[1], q[2] - p[2]], [r[0] - p[0], r[1] - p[1], r[2] - p[2]]);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Makes normals unit length; one that has no direction becomes that of a triangle at its point.
fn mend_normals(geometry: &mut Geometry, place: &Place, warnings: &mut Warnings) {
    let Some(normals) = &mut geometry.normals else { return };
    let mut broken = Vec::new();
    for (i, normal) in normals.iter_mut().enumerate() {
        match Vec3::from(*normal).try_normalize() {
            Some(n) => *normal = n.into(),
            None => {
                *normal = [0.0, 0.0, 1.0];
                broken.push(i);
            }
        }
    }
    if broken.is_empty() {
        return;
    }
    let mut is_broken = vec![false; normals.len()];
    broken.iter().for_each(|&i| is_broken[i] = true);
    let mut used = 0;
    for &triangle in &geometry.triangles {
        for i in triangle {
            if std::mem::take(&mut is_broken[i as usize]) {
                let [x, y, z] = area_vector(&geometry.points, triangle);
                normals[i as usize] = DVec3::new(x, y, z).normalize().as_vec3().into();
                used += 1;
            }
        }
    }
    if used > 0 {
        warnings.push(place, format!("{used} normals have no direction; that of a triangle at the point is used"));
    }
}

/// Leaves out points that no triangle uses, where they are most of them: exporters let many
/// primitives share one long list.
pub(super) fn compact(geometry: &mut Geometry) {
    const UNUSED: u32 = u32::MAX;
    let mut map = vec![UNUSED; geometry.points.len()];
    let mut kept = Vec::new();
    for &i in geometry.triangles.iter().flatten() {
        let slot = &mut map[i as usize];
        if *slot == UNUSED {
            *slot = kept.len() as u32;
            kept.push(i as usize);
        }
    }
    if 2 * kept.len() > geometry.points.len() {
        return;
    }
    fn pick<T: Copy>(values: &mut Vec<T>, kept: &[usize]) {
        *values = kept.iter().map(|&i| values[i]).collect();
    }
    pick(&mut geometry.points, &kept);
    geometry.normals.iter_mut().for_each(|values| pick(values, &kept));
    geometry.tangents.iter_mut().for_each(|values| pick(values, &kept));
    geometry.uvs.iter_mut().for_each(|values| pick(values, &kept));
    geometry.colors.iter_mut().for_each(|values| pick(values, &kept));
    geometry.triangles.iter_mut().flatten().for_each(|i| *i = map[*i as usize]);
}
