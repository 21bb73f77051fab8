//! Meshes, from the arrays that Blender keeps them in.

use std::sync::Arc;

use rayon::prelude::*;

use super::motion::{self, MovedPoints};
use crate::desc::{Attribute, MeshDesc, NamedAttribute};
use crate::error::{Error, Place, Result, Warnings};
use crate::import::tangents;
use crate::math::Cluster;

/// Nothing can be computed with a vertex that is farther out: about where `f32` can't hold squares any more.
const REACH: f32 = 1e18;

/// Triangles to a vertex that is so many times farther off than most would be met where they are not: `f32` has seven
/// digits.
const MOST_SPREADS: f64 = 1e8;

/// The arrays of an evaluated mesh, as `foreach_get` fills them.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeshArrays<'a> {
    /// `attributes["position"]`, three per vertex.
    pub positions: &'a [f32],
    /// `attributes[".corner_vert"]`, one per corner.
    pub corner_verts: &'a [i32],
    /// `loop_triangles.loops`, three corners per triangle.
    pub triangles: &'a [i32],
    /// `corner_normals`, three per corner; or three per vertex where every corner of a vertex has
    /// the same; empty for flat faces.
    pub normals: &'a [f32],
    /// Material slot of each polygon; empty where all are 0.
    pub material_index: &'a [i32],
    /// `loop_triangle_polygons`: polygon of each triangle; needed with `material_index`.
    pub triangle_polygons: &'a [i32],
    /// `texspace_location` and `texspace_size`: the middle and half the size of the box of generated
    /// coordinates; `None` for that of the vertices.
    pub texture_space: Option<[[f64; 3]; 2]>,
}

/// A layer of values: its name, how many numbers a value has, and the numbers, one value per vertex
/// or per corner, whichever the count says.
#[derive(Clone, Copy, Debug)]
pub struct LayerArray<'a> {
    /// Name of the attribute or UV map.
    pub name: &'a str,
    /// The numbers.
    pub values: &'a [f32],
}

/// A mesh and the names of its UV maps.
#[derive(Clone, Debug)]
pub struct NamedMesh {
    /// The mesh.
    pub mesh: Arc<MeshDesc>,
    /// Names of its UV maps, the one to render with first.
    pub uv_names: Vec<Arc<str>>,
    /// The mesh as materials asked for it last.
    dressed: Option<(Dress, Arc<MeshDesc>)>,
}

/// What materials want of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dress {
    /// Names of UV maps beside the one to render with.
    pub uv_maps: Vec<String>,
    /// Tangents of the UV map to render with.
    pub tangents: bool,
    /// UV maps beside that one whose tangents are wanted, as attributes; see [`tangents_of`].
    pub tangent_maps: Vec<String>,
}

/// Name of the attribute that holds the tangents of a UV map, which no attribute of Blender's has.
pub fn tangents_of(uv_map: &str) -> String {
    format!("tangents of \u{0}{uv_map}")
}

impl NamedMesh {
    /// Takes in where its points are at other times of the shutter. Points that move out of number or whose count
    /// changes are told, and stand still.
    pub fn set_motion(&mut self, moved: &[MovedPoints<'_>], blurred: bool, warnings: &mut Warnings) {
        self.dressed = None;
        let mesh = Arc::make_mut(&mut self.mesh);
        let count = mesh.points.len();
        let fits = |moved: &MovedPoints<'_>| moved.positions.len() == 3 * count;
        let finite = |moved: &MovedPoints<'_>| moved.positions.par_iter().all(|x| x.is_finite());
        let points = |moved: &MovedPoints<'_>| (moved.time, moved.positions.as_chunks::<3>().0.to_vec());
        mesh.motion = if moved.iter().all(|moved| fits(moved) && finite(moved)) {
            motion::keys(&mesh.points, moved.iter().map(points))
        } else {
            motion::tell_of_still(&mesh.name, &mesh.place, moved.iter().all(fits), blurred, warnings);
            Vec::new()
        };
    }

    /// The mesh with what materials want of it; the same one as long as they want the same.
    pub fn dressed(&mut self, dress: &Dress) -> Arc<MeshDesc> {
        if let Some((known, mesh)) = &self.dressed
            && known == dress
        {
            return mesh.clone();
        }
        let mesh = if *dress == Dress::default() { self.mesh.clone() } else { Arc::new(self.dress(dress)) };
        self.dressed = Some((dress.clone(), mesh.clone()));
        mesh
    }

    fn dress(&self, dress: &Dress) -> MeshDesc {
        let mut mesh = MeshDesc::clone(&self.mesh);
        if dress.tangents
            && let Some(uvs) = mesh.uvs.first()
        {
            mesh.tangents = tangents::generate(&mesh.points, mesh.normals.as_ref(), uvs, &mesh.triangles);
        }
        for name in &dress.tangent_maps {
            let index = self.uv_names.iter().position(|known| **known == **name);
            let tangents = index
                .and_then(|index| self.mesh.uvs.get(index))
                .and_then(|uvs| tangents::generate(&mesh.points, mesh.normals.as_ref(), uvs, &mesh.triangles));
            if let Some(values) = tangents {
                mesh.attributes.push(NamedAttribute { name: tangents_of(name).into(), values });
            }
        }
        let none = || Attribute::Point(vec![[0.0, 1.0]; mesh.points.len()]);
        let named = |name: &String| {
            let index = self.uv_names.iter().position(|known| **known == **name);
            index.and_then(|index| self.mesh.uvs.get(index).cloned()).unwrap_or_else(none)
        };
        if !dress.uv_maps.is_empty() {
            // 0 everywhere for a map that it lacks, as in Cycles.
            let first = self.mesh.uvs.first().cloned().unwrap_or_else(none);
            mesh.uvs = std::iter::once(first).chain(dress.uv_maps.iter().map(named)).collect();
        }
        mesh
    }
}

/// The mesh of `arrays`, with UV maps, colour attributes, and other attributes as colors, too.
///
/// # Errors
/// Arrays whose lengths or indices don't fit together. Vertices that are not finite, beyond
/// [`REACH`], or [`MOST_SPREADS`] away from most are told, and the triangles at them left out.
pub fn mesh(
    name: &str,
    place: &Place,
    arrays: &MeshArrays<'_>,
    uvs: &[LayerArray<'_>],
    [colors, others]: [&[LayerArray<'_>]; 2],
    warnings: &mut Warnings,
) -> Result<NamedMesh> {
    let broken = |what: String| Error::invalid(place, format!("the mesh \"{name}\" {what}"));
    let (points, corners) = (arrays.positions.len() / 3, arrays.corner_verts.len());
    if !arrays.positions.len().is_multiple_of(3) || !arrays.triangles.len().is_multiple_of(3) {
        return Err(broken("has arrays of odd lengths".into()));
    }
    let in_range = |index: i32, count: usize| usize::try_from(index).is_ok_and(|index| index < count);
    if let Some(index) = arrays.corner_verts.par_iter().find_any(|&&i| !in_range(i, points)) {
        return Err(broken(format!("refers to vertex {index} of {points}")));
    }
    if let Some(index) = arrays.triangles.par_iter().find_any(|&&i| !in_range(i, corners)) {
        return Err(broken(format!("refers to corner {index} of {corners}")));
    }
    // So that those beyond reach are left out of every box, too.
    let most = Cluster::of(arrays.positions.as_chunks::<3>().0).filter(|most| most.spread > 0.0);
    let is_far = |p: &[f32; 3]| most.is_some_and(|most| most.distance(*p) > MOST_SPREADS);
    let within =
        |p: &[f32; 3]| if is_far(p) { [f32::NAN; 3] } else { p.map(|x| if x.abs() > REACH { f32::NAN } else { x }) };
    let positions: Vec<[f32; 3]> = arrays.positions.as_chunks::<3>().0.par_iter().map(within).collect();
    let corners_of: &[[i32; 3]] = arrays.triangles.as_chunks::<3>().0;
    let vertex = |corner: i32| arrays.corner_verts[corner as usize] as u32;
    let kept = kept_triangles(&positions, corners_of, vertex, name, place, warnings);
    let corners_of = kept.as_ref().map_or(corners_of, |(corners, _)| corners);
    let triangles: Vec<[u32; 3]> = corners_of.par_iter().map(|t| t.map(vertex)).collect();
    let layer = Layers { points, corners, corners_of, name, place };

    let normals = if arrays.normals.is_empty() { None } else { layer.fit("normals", arrays.normals, warnings) };
    let mut uv_sets = Vec::with_capacity(uvs.len());
    for uv in uvs {
        // Blender's v grows upwards.
        let values = layer.fit::<2>(&format!("UV map \"{}\"", uv.name), uv.values, warnings);
        uv_sets.push(flipped(values.unwrap_or_else(|| Attribute::Point(vec![[0.0; 2]; points]))));
    }
    let mut attributes = Vec::new();
    for color in colors {
        let Some(values) = layer.fit(&format!("colour attribute \"{}\"", color.name), color.values, warnings) else {
            continue;
        };
        if attributes.is_empty() {
            // The one to render with is also found without a name.
            attributes.push(NamedAttribute { name: "".into(), values: values.clone() });
        }
        attributes.push(NamedAttribute { name: color.name.into(), values });
    }
    for other in others {
        if let Some(values) = layer.fit(&format!("attribute \"{}\"", other.name), other.values, warnings) {
            attributes.push(NamedAttribute { name: other.name.into(), values });
        }
    }
    let generated = arrays.texture_space.map(|[middle, half]| {
        let corner = |sign: f64| std::array::from_fn(|i| middle[i] + sign * half[i]);
        [corner(-1.0), corner(1.0)]
    });
    let material_slots = slots(arrays, kept.as_ref().map(|(_, kept)| kept.as_slice()), &broken)?;
    let mesh = MeshDesc {
        name: name.into(),
        place: place.clone(),
        points: positions,
        triangles,
        normals,
        uvs: uv_sets,
        tangents: None,
        colors: None,
        attributes,
        generated,
        material_slots,
        motion: Vec::new(),
    };
    Ok(NamedMesh { mesh: mesh.into(), dressed: None, uv_names: uvs.iter().map(|layer| layer.name.into()).collect() })
}

/// Corners of the triangles whose vertices are all finite (those beyond reach are not any more), and which triangles those are; `None`
/// where all are.
fn kept_triangles(
    positions: &[[f32; 3]],
    corners_of: &[[i32; 3]],
    vertex: impl Fn(i32) -> u32 + Sync,
    name: &str,
    place: &Place,
    warnings: &mut Warnings,
) -> Option<(Vec<[i32; 3]>, Vec<u32>)> {
    let finite = |p: &[f32; 3]| p.iter().all(|x| x.is_finite());
    let bad = positions.par_iter().filter(|p| !finite(p)).count();
    if bad == 0 {
        return None;
    }
    let good = |t: &[i32; 3]| t.iter().all(|&corner| finite(&positions[vertex(corner) as usize]));
    let kept: Vec<u32> = (0..corners_of.len() as u32).filter(|&i| good(&corners_of[i as usize])).collect();
    let left_out = corners_of.len() - kept.len();
    let what = format!(
        "the mesh \"{name}\" has {bad} vertices that are not finite or too far away; {left_out} triangles are left out"
    );
    warnings.push(place, what);
    Some((kept.iter().map(|&i| corners_of[i as usize]).collect(), kept))
}

/// Material slot of each triangle; `None` where all are 0.
fn slots(arrays: &MeshArrays<'_>, kept: Option<&[u32]>, broken: &dyn Fn(String) -> Error) -> Result<Option<Vec<u16>>> {
    if arrays.material_index.is_empty() {
        return Ok(None);
    }
    let count = arrays.triangles.len() / 3;
    if arrays.triangle_polygons.len() != count {
        let given = arrays.triangle_polygons.len();
        return Err(broken(format!("has {given} polygon indices for {count} triangles")));
    }
    let of_triangle = |triangle: usize| {
        let polygon = arrays.triangle_polygons[triangle];
        let slot = usize::try_from(polygon).ok().and_then(|polygon| arrays.material_index.get(polygon));
        slot.map(|&slot| slot.clamp(0, i32::from(u16::MAX)) as u16).ok_or(polygon)
    };
    let slots: std::result::Result<Vec<u16>, i32> = match kept {
        None => (0..count).into_par_iter().map(of_triangle).collect(),
        Some(kept) => kept.iter().map(|&triangle| of_triangle(triangle as usize)).collect(),
    };
    slots.map(Some).map_err(|polygon| broken(format!("refers to polygon {polygon}, which has no material index")))
}

/// What layers of values are laid out over.
struct Layers<'a> {
    points: usize,
    corners: usize,
    /// Corners of each triangle that is kept.
    corners_of: &'a [[i32; 3]],
    name: &'a str,
    place: &'a Place,
}

impl Layers<'_> {
    /// The values per point, or per corner of each triangle; `None`, with a warning, for a layer of
    /// another length.
    fn fit<const N: usize>(&self, what: &str, values: &[f32], warnings: &mut Warnings) -> Option<Attribute<[f32; N]>> {
        let (chunks, rest) = values.as_chunks::<N>();
        let corner = |&corner: &i32| chunks[corner as usize];
        if rest.is_empty() && chunks.len() == self.corners {
            Some(Attribute::Corner(self.corners_of.par_iter().flat_map_iter(|t| t.iter().map(corner)).collect()))
        } else if rest.is_empty() && chunks.len() == self.points {
            Some(Attribute::Point(chunks.to_vec()))
        } else {
            let (given, name) = (values.len() / N, self.name);
            let told = format!(
                "the {what} of the mesh \"{name}\" has {given} values for {} vertices and {} corners; left out",
                self.points, self.corners
            );
            warnings.push(self.place, told);
            None
        }
    }
}

/// UVs whose v grows downwards.
fn flipped(mut uvs: Attribute<[f32; 2]>) -> Attribute<[f32; 2]> {
    let (Attribute::Point(values) | Attribute::Corner(values)) = &mut uvs;
    values.par_iter_mut().for_each(|uv| uv[1] = 1.0 - uv[1]);
    uvs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quad of two triangles, in the plane z = 0.
    const POSITIONS: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];

    fn quad() -> MeshArrays<'static> {
        MeshArrays {
            positions: &POSITIONS,
            corner_verts: &[0, 1, 2, 3],
            triangles: &[0, 1, 2, 0, 2, 3],
            triangle_polygons: &[0, 0],
            ..MeshArrays::default()
        }
    }

    fn built(arrays: &MeshArrays<'_>, uvs: &[LayerArray<'_>]) -> (Result<NamedMesh>, Vec<String>) {
        let mut warnings = Warnings::new();
        let mesh = mesh("quad", &Place::default(), arrays, uvs, [&[], &[]], &mut warnings);
        (mesh, warnings.iter().map(|w| w.what.clone()).collect())
    }

    #[test]
    fn corners_and_points_become_attributes() {
        let uv = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.25];
        let normals = [0.0, 0.0, 1.0].repeat(4);
        let arrays = MeshArrays { normals: &normals, material_index: &[3], ..quad() };
        let (mesh, said) = built(&arrays, &[LayerArray { name: "UVMap", values: &uv }]);
        let mesh = mesh.unwrap();
        assert!(said.is_empty());
        assert_eq!(mesh.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.mesh.material_slots, Some(vec![3, 3]));
        let Attribute::Corner(uvs) = &mesh.mesh.uvs[0] else { panic!("as many points as corners") };
        assert_eq!(uvs[5], [0.0, 0.75]);
        assert_eq!(mesh.uv_names, ["UVMap".into()]);
        assert_eq!(mesh.mesh.normals.as_ref().unwrap().len(), 6);
    }

    #[test]
    fn broken_arrays_are_named() {
        let (mesh, _) = built(&MeshArrays { corner_verts: &[0, 1, 2, 4], ..quad() }, &[]);
        assert_eq!(mesh.unwrap_err().to_string(), "scene: the mesh \"quad\" refers to vertex 4 of 4");
        let (mesh, _) = built(&MeshArrays { triangles: &[0, 1, -2], ..quad() }, &[]);
        assert_eq!(mesh.unwrap_err().to_string(), "scene: the mesh \"quad\" refers to corner -2 of 4");
        let (mesh, _) = built(&MeshArrays { material_index: &[0], triangle_polygons: &[0, 1], ..quad() }, &[]);
        assert!(mesh.unwrap_err().to_string().ends_with("refers to polygon 1, which has no material index"));
        let (mesh, said) = built(&quad(), &[LayerArray { name: "UVMap", values: &[0.0; 6] }]);
        assert!(mesh.is_ok());
        assert!(said[0].starts_with("the UV map \"UVMap\" of the mesh \"quad\" has 3 values"), "{said:?}");
    }

    #[test]
    fn triangles_at_a_vertex_that_is_not_finite_are_left_out() {
        let mut positions = POSITIONS;
        positions[4] = f32::NAN;
        let (mesh, said) = built(&MeshArrays { positions: &positions, material_index: &[7], ..quad() }, &[]);
        let mesh = mesh.unwrap().mesh;
        assert_eq!((&mesh.triangles, &mesh.material_slots), (&vec![[0, 2, 3]], &Some(vec![7])));
        assert_eq!(
            said,
            ["the mesh \"quad\" has 1 vertices that are not finite or too far away; 1 triangles are left out"]
        );
    }

    #[test]
    fn triangles_at_a_vertex_beyond_reach_are_left_out_and_told() {
        let huge = POSITIONS.map(|x| 1e16 * x);
        for (quad_of, x, left) in [
            (POSITIONS, 1e30, 1),
            (POSITIONS, -1e30, 1),
            (POSITIONS, f32::INFINITY, 1),
            // Farther off than all others by more than numbers can tell.
            (POSITIONS, 1e10, 1),
            (POSITIONS, 1e7, 2),
            // As far off as the others.
            (huge, 1e17, 2),
            (huge, 1e19, 1),
        ] {
            let mut positions = quad_of;
            positions[3] = x;
            let (mesh, said) = built(&MeshArrays { positions: &positions, ..quad() }, &[]);
            assert_eq!(mesh.unwrap().mesh.triangles.len(), left, "{x}");
            let told =
                ["the mesh \"quad\" has 1 vertices that are not finite or too far away; 1 triangles are left out"];
            assert_eq!(said, told[..2 - left], "{x}");
        }
    }
}
