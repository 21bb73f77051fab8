//! Primitives to meshes: attributes read, deformed, cleaned of what can't be traced.

use super::accessor::Reader;
use super::deform::{self, Influences, SkinPose};
use super::document::label;
use super::json::Primitive;
use super::tangents;
use super::topology;
use crate::desc::{Attribute, MeshDesc};
use crate::error::{Error, Place, Result, Warnings};
use crate::math::Vec3;

/// What a primitive is to become.
pub(super) struct Job<'a> {
    /// Index of the mesh.
    pub mesh: usize,
    /// Index of the primitive in it.
    pub primitive: usize,
    /// Weights of the morph targets.
    pub weights: &'a [f64],
    /// Pose of the skin, for skinned meshes.
    pub skin: Option<&'a SkinPose>,
    /// UV set that tangents go by, where the material needs tangents.
    pub tangent_uv_set: Option<u32>,
}

/// Per-point data while it is worked on.
struct Geometry {
    points: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Option<Vec<[f32; 3]>>,
    tangents: Option<Vec<[f32; 4]>>,
    uvs: Vec<Vec<[f32; 2]>>,
    colors: Option<Vec<[f32; 4]>>,
}

/// Builds the mesh of `job`; `None`, with a warning, where nothing of it has area.
///
/// # Errors
/// Accessors that are not what they have to be.
pub(super) fn build(
    reader: Reader<'_>,
    job: &Job<'_>,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<Option<MeshDesc>> {
    let mesh = &reader.root.meshes[job.mesh];
    let primitive = &mesh.primitives[job.primitive];
    let mut place = place.at(label("mesh", job.mesh, mesh.name.as_deref()));
    let mut name = mesh.name.clone().filter(|n| !n.is_empty()).unwrap_or_else(|| format!("mesh_{}", job.mesh));
    if mesh.primitives.len() > 1 {
        place = place.at(format!("{}, primitive {}", place.node.as_deref().unwrap_or_default(), job.primitive));
        name = format!("{name}.{}", job.primitive);
    }
    let invalid = |what: String| Error::invalid(&place, what);
    let Some(mut geometry) = read(reader, primitive, &place, warnings).map_err(invalid)? else { return Ok(None) };
    deform(reader, primitive, job, &mut geometry, &place, warnings).map_err(invalid)?;
    clean(&mut geometry, &place, warnings);
    if geometry.triangles.is_empty() {
        warnings.push(&place, "no triangle has area; the primitive is left out");
        return Ok(None);
    }
    compact(&mut geometry);
    let tangents = job.tangent_uv_set.and_then(|set| finish_tangents(&mut geometry, set as usize, &place, warnings));
    Ok(Some(MeshDesc {
        name: name.into(),
        place,
        points: geometry.points,
        triangles: geometry.triangles,
        normals: geometry.normals.map(Attribute::Point),
        uvs: geometry.uvs.into_iter().map(Attribute::Point).collect(),
        tangents,
        colors: geometry.colors.map(Attribute::Point),
        material_slots: None,
    }))
}

/// Reads the attributes. `None`, with a warning, for primitives without area.
fn read(
    reader: Reader<'_>,
    primitive: &Primitive,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<Option<Geometry>, String> {
    let attribute = |name: &str| primitive.attributes.get(name).copied();
    if !(4..=6).contains(&primitive.mode) {
        let what =
            format!("the primitive is {}, which has no area; it is left out", topology::mode_name(primitive.mode));
        warnings.push(place, what);
        return Ok(None);
    }
    let Some(positions) = attribute("POSITION") else {
        let what = if primitive.extensions.draco.is_some() {
            "the primitive is compressed by Draco (KHR_draco_mesh_compression), which is not supported; it is left out"
        } else {
            "the primitive has no positions; it is left out"
        };
        warnings.push(place, what);
        return Ok(None);
    };
    let points = named("POSITION", reader.floats::<3>(positions))?;
    let indices: Vec<u32> = match primitive.indices {
        Some(accessor) => named("indices", reader.integers::<1>(accessor))?.into_flattened(),
        None => (0..points.len() as u32).collect(),
    };
    if primitive.mode == 4 && !indices.len().is_multiple_of(3) {
        let what = format!("{} indices are no multiple of three; the last ones are left out", indices.len());
        warnings.push(place, what);
    }
    let fits = |len: usize, name: &str| -> Result<(), String> {
        let count = points.len();
        if len == count { Ok(()) } else { Err(format!("{name} has {len} elements, POSITION {count}")) }
    };
    let normals = attribute("NORMAL").map(|a| named("NORMAL", reader.floats::<3>(a))).transpose()?;
    fits(normals.as_ref().map_or(points.len(), Vec::len), "NORMAL")?;
    let tangents = attribute("TANGENT").map(|a| named("TANGENT", reader.floats::<4>(a))).transpose()?;
    fits(tangents.as_ref().map_or(points.len(), Vec::len), "TANGENT")?;
    let mut uvs = Vec::new();
    while let Some(accessor) = attribute(&format!("TEXCOORD_{}", uvs.len())) {
        let name = format!("TEXCOORD_{}", uvs.len());
        let set = named(&name, reader.floats::<2>(accessor))?;
        fits(set.len(), &name)?;
        uvs.push(set);
    }
    let colors = attribute("COLOR_0").map(|a| named("COLOR_0", read_colors(reader, a))).transpose()?;
    fits(colors.as_ref().map_or(points.len(), Vec::len), "COLOR_0")?;
    let triangles = topology::triangles(primitive.mode, &indices).unwrap_or_default();
    Ok(Some(Geometry { points, triangles, normals, tangents, uvs, colors }))
}

fn named<T>(name: &str, result: Result<T, String>) -> Result<T, String> {
    result.map_err(|e| format!("{name}: {e}"))
}

fn read_colors(reader: Reader<'_>, accessor: usize) -> Result<Vec<[f32; 4]>, String> {
    if reader.components(accessor)? == 3 {
        return Ok(reader.floats::<3>(accessor)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect());
    }
    reader.floats::<4>(accessor)
}

/// Applies morph targets, then the skin.
fn deform(
    reader: Reader<'_>,
    primitive: &Primitive,
    job: &Job<'_>,
    geometry: &mut Geometry,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<(), String> {
    for (target, &weight) in primitive.targets.iter().zip(job.weights) {
        if weight == 0.0 {
            continue;
        }
        for (name, &accessor) in target {
            let weight = weight as f32;
            let delta = || named(&format!("morph target {name}"), reader.floats::<3>(accessor));
            match name.as_str() {
                "POSITION" => deform::add_target(&mut geometry.points, &delta()?, weight),
                "NORMAL" => {
                    if let Some(normals) = &mut geometry.normals {
                        deform::add_target(normals, &delta()?, weight);
                    }
                }
                "TANGENT" => {
                    if let Some(tangents) = &mut geometry.tangents {
                        deform::add_target(tangents, &delta()?, weight);
                    }
                }
                _ => warnings.push(place, format!("morph targets of {name} are left out")),
            }
        }
    }
    let Some(pose) = job.skin else { return Ok(()) };
    let influences = read_influences(reader, primitive)?;
    let (mirrored, unknown) = deform::skin(
        pose,
        &influences,
        &mut geometry.points,
        geometry.normals.as_deref_mut(),
        geometry.tangents.as_deref_mut(),
    );
    for triangle in &mut geometry.triangles {
        if mirrored.get(triangle[0] as usize).copied().unwrap_or(false) {
            triangle.swap(1, 2);
        }
    }
    if unknown > 0 {
        let what = format!("{unknown} skin weights name joints that the skin doesn't have; they are left out");
        warnings.push(place, what);
    }
    Ok(())
}

fn read_influences(reader: Reader<'_>, primitive: &Primitive) -> Result<Influences, String> {
    let mut influences = Influences { joints: Vec::new(), weights: Vec::new() };
    for set in 0.. {
        let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
        let (Some(&j), Some(&w)) = (primitive.attributes.get(&joints), primitive.attributes.get(&weights)) else {
            break;
        };
        influences.joints.push(named(&joints, reader.integers::<4>(j))?);
        influences.weights.push(named(&weights, reader.floats::<4>(w))?);
    }
    Ok(influences)
}

/// Drops triangles that can't be traced and mends attributes that are not finite.
fn clean(geometry: &mut Geometry, place: &Place, warnings: &mut Warnings) {
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
                normals[i as usize] = crate::math::DVec3::new(x, y, z).normalize().as_vec3().into();
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
fn compact(geometry: &mut Geometry) {
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

/// The file's tangents, or new ones.
fn finish_tangents(
    geometry: &mut Geometry,
    uv_set: usize,
    place: &Place,
    warnings: &mut Warnings,
) -> Option<Attribute<[f32; 4]>> {
    // Tangents mean nothing without the normals that they belong to (glTF 2.0, 3.7.2.1).
    if let (Some(tangents), Some(_)) = (geometry.tangents.take(), &geometry.normals) {
        return Some(Attribute::Point(tangents));
    }
    let Some(uvs) = geometry.uvs.get(uv_set) else {
        let what = format!("the material's normal map or anisotropy needs TEXCOORD_{uv_set}, which is absent");
        warnings.push(place, what);
        return None;
    };
    let tangents = tangents::generate(&geometry.points, geometry.normals.as_deref(), uvs, &geometry.triangles);
    if tangents.is_none() {
        warnings.push(place, "no tangents can be made for the material's normal map or anisotropy");
    }
    tangents
}
