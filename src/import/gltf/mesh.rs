//! Primitives to meshes: attributes read, deformed, cleaned of what can't be traced.

use super::accessor::Reader;
use super::attributes::Attributes;
use super::clean::{clean, compact};
use super::deform::{self, Influences, SkinPose};
use super::document::label;
use super::json::Primitive;
use super::topology;
use crate::desc::{Attribute, MeshDesc};
use crate::error::{Error, Place, Result, Warnings};
use crate::import::tangents;

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
pub(super) struct Geometry {
    pub points: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub normals: Option<Vec<[f32; 3]>>,
    pub tangents: Option<Vec<[f32; 4]>>,
    pub uvs: Vec<Vec<[f32; 2]>>,
    pub colors: Option<Vec<[f32; 4]>>,
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
    if !(4..=6).contains(&primitive.mode) {
        let what =
            format!("the primitive is {}, which has no area; it is left out", topology::mode_name(primitive.mode));
        warnings.push(&place, what);
        return Ok(None);
    }
    let attributes = Attributes::new(reader, primitive).map_err(invalid)?;
    let Some(mut geometry) = read(primitive, &attributes, &place, warnings).map_err(invalid)? else { return Ok(None) };
    morph(reader, primitive, job, &mut geometry, &place, warnings).map_err(invalid)?;
    if let Some(pose) = job.skin {
        skin(pose, &attributes, &mut geometry, &place, warnings).map_err(invalid)?;
    }
    clean(&mut geometry, &place, warnings);
    if geometry.triangles.is_empty() {
        warnings.push(&place, "no triangle has area; the primitive is left out");
        return Ok(None);
    }
    compact(&mut geometry);
    let authored = geometry.tangents;
    let mut desc = MeshDesc {
        name: name.into(),
        place,
        points: geometry.points,
        triangles: geometry.triangles,
        normals: geometry.normals.map(Attribute::Point),
        uvs: geometry.uvs.into_iter().map(Attribute::Point).collect(),
        tangents: None,
        colors: geometry.colors.map(Attribute::Point),
        attributes: Vec::new(),
        generated: None,
        material_slots: None,
        motion: Vec::new(),
    };
    desc.tangents = job.tangent_uv_set.and_then(|set| tangents_of(&desc, authored, set as usize, warnings));
    Ok(Some(desc))
}

/// Reads the attributes. `None`, with a warning, for primitives without area.
fn read(
    primitive: &Primitive,
    attributes: &Attributes<'_>,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<Option<Geometry>, String> {
    let Some(points) = attributes.floats::<3>("POSITION")? else {
        warnings.push(place, "the primitive has no positions; it is left out");
        return Ok(None);
    };
    let indices = attributes.indices()?.unwrap_or_else(|| (0..points.len() as u32).collect());
    if primitive.mode == 4 && !indices.len().is_multiple_of(3) {
        let what = format!("{} indices are no multiple of three; the last ones are left out", indices.len());
        warnings.push(place, what);
    }
    let count = points.len();
    let normals = fitting("NORMAL", count, attributes.floats::<3>("NORMAL")?)?;
    let tangents = fitting("TANGENT", count, attributes.floats::<4>("TANGENT")?)?;
    let colors = if attributes.components("COLOR_0")? == 3 {
        let opaque = |colors: Vec<[f32; 3]>| colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect();
        attributes.floats::<3>("COLOR_0")?.map(opaque)
    } else {
        attributes.floats::<4>("COLOR_0")?
    };
    let colors = fitting("COLOR_0", count, colors)?;
    let mut uvs = Vec::new();
    loop {
        let name = format!("TEXCOORD_{}", uvs.len());
        let Some(set) = fitting(&name, count, attributes.floats::<2>(&name)?)? else { break };
        uvs.push(set);
    }
    let triangles = topology::triangles(primitive.mode, &indices).unwrap_or_default();
    Ok(Some(Geometry { points, triangles, normals, tangents, uvs, colors }))
}

/// `values` where there is one for each point.
fn fitting<T>(name: &str, points: usize, values: Option<Vec<T>>) -> Result<Option<Vec<T>>, String> {
    match &values {
        Some(values) if values.len() != points => {
            Err(format!("{name} has {} elements, POSITION {points}", values.len()))
        }
        _ => Ok(values),
    }
}

/// Applies morph targets.
fn morph(
    reader: Reader<'_>,
    primitive: &Primitive,
    job: &Job<'_>,
    geometry: &mut Geometry,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<(), String> {
    for (target, &weight) in primitive.targets.iter().zip(job.weights) {
        let weight = weight as f32;
        for (name, &accessor) in target.iter().filter(|_| weight != 0.0) {
            match name.as_str() {
                "POSITION" => add_target(reader, accessor, weight, Some(&mut geometry.points)),
                "NORMAL" => add_target(reader, accessor, weight, geometry.normals.as_mut()),
                "TANGENT" => add_target(reader, accessor, weight, geometry.tangents.as_mut()),
                _ => {
                    warnings.push(place, format!("morph targets of {name} are left out"));
                    Ok(())
                }
            }
            .map_err(|e| format!("morph target {name}: {e}"))?;
        }
    }
    Ok(())
}

fn add_target<const N: usize>(
    reader: Reader<'_>,
    accessor: usize,
    weight: f32,
    values: Option<&mut Vec<[f32; N]>>,
) -> Result<(), String> {
    let Some(values) = values else { return Ok(()) };
    let delta = reader.floats::<3>(accessor)?;
    if delta.len() != values.len() {
        return Err(format!("{} elements for {} points", delta.len(), values.len()));
    }
    deform::add_target(values, &delta, weight);
    Ok(())
}

/// Applies the skin.
fn skin(
    pose: &SkinPose,
    attributes: &Attributes<'_>,
    geometry: &mut Geometry,
    place: &Place,
    warnings: &mut Warnings,
) -> Result<(), String> {
    let mut influences = Influences { joints: Vec::new(), weights: Vec::new() };
    for set in 0.. {
        let joints = attributes.integers::<4>(&format!("JOINTS_{set}"))?;
        let weights = attributes.floats::<4>(&format!("WEIGHTS_{set}"))?;
        let (Some(joints), Some(weights)) = (joints, weights) else { break };
        influences.joints.push(joints);
        influences.weights.push(weights);
    }
    let (normals, tangents) = (geometry.normals.as_deref_mut(), geometry.tangents.as_deref_mut());
    let (mirrored, unknown) = deform::skin(pose, &influences, &mut geometry.points, normals, tangents);
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

/// The file's tangents, or new ones.
fn tangents_of(
    mesh: &MeshDesc,
    authored: Option<Vec<[f32; 4]>>,
    uv_set: usize,
    warnings: &mut Warnings,
) -> Option<Attribute<[f32; 4]>> {
    // Tangents mean nothing without the normals that they belong to (glTF 2.0, 3.7.2.1).
    if let (Some(tangents), Some(_)) = (authored, &mesh.normals) {
        return Some(Attribute::Point(tangents));
    }
    let Some(uvs) = mesh.uvs.get(uv_set) else {
        let what = format!("the material's normal map or anisotropy needs TEXCOORD_{uv_set}, which is absent");
        warnings.push(&mesh.place, what);
        return None;
    };
    let tangents = tangents::generate(&mesh.points, mesh.normals.as_ref(), uvs, &mesh.triangles);
    if tangents.is_none() {
        warnings.push(&mesh.place, "no tangents can be made for the material's normal map or anisotropy");
    }
    tangents
}
