//! Meshes of a subdivision scheme: their rules as authored, and their refinement.

use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::Interpolation;

use super::super::stage::Reading;
use super::super::values::pick;
use super::finish::{Channels, Surface};
use super::polygons::Polygons;
use super::primvar::Channel;
use super::triangulate::{Scratch, triangulate};
use crate::desc::{Attribute, Motion};
use crate::error::{Place, Warnings};
use crate::import::subdivision::{Boundary, Cage, FaceVarying, Faces, Refinement, Scheme};

/// More faces than this are not made of one mesh.
const MOST_FACES: u64 = 1 << 25;

/// How a mesh is subdivided.
#[derive(PartialEq)]
pub(super) struct Rules {
    scheme: Scheme,
    boundary: Boundary,
    face_varying: FaceVarying,
    smooth_triangles: bool,
    crease_indices: Vec<i32>,
    crease_lengths: Vec<i32>,
    crease_sharpnesses: Vec<f32>,
    corner_indices: Vec<i32>,
    corner_sharpnesses: Vec<f32>,
}

/// The rules of the mesh `prim`; `None` for scheme `none`.
pub(super) fn read(reading: &Reading<'_>, prim: &Prim) -> Option<Rules> {
    let token = |name: &str| reading.value::<Token>(prim, name);
    let schemes = [
        ("catmullClark", Some(Scheme::CatmullClark)),
        ("loop", Some(Scheme::Loop)),
        ("bilinear", Some(Scheme::Bilinear)),
        ("none", None),
    ];
    let scheme = pick(reading, prim, "subdivisionScheme", token("subdivisionScheme"), &schemes)?;
    let boundaries =
        [("edgeAndCorner", Boundary::EdgeAndCorner), ("edgeOnly", Boundary::EdgeOnly), ("none", Boundary::None)];
    let triangles = [("catmullClark", false), ("smooth", true)];
    let rule = "triangleSubdivisionRule";
    let name = "faceVaryingLinearInterpolation";
    let options = [
        ("cornersPlus1", FaceVarying::CornersPlus1),
        ("none", FaceVarying::None),
        ("cornersOnly", FaceVarying::CornersOnly),
        ("cornersPlus2", FaceVarying::CornersPlus2),
        ("boundaries", FaceVarying::Boundaries),
        ("all", FaceVarying::All),
    ];
    Some(Rules {
        scheme,
        boundary: pick(reading, prim, "interpolateBoundary", token("interpolateBoundary"), &boundaries),
        face_varying: pick(reading, prim, name, token(name), &options),
        smooth_triangles: pick(reading, prim, rule, token(rule), &triangles),
        crease_indices: reading.value(prim, "creaseIndices").unwrap_or_default(),
        crease_lengths: reading.value(prim, "creaseLengths").unwrap_or_default(),
        crease_sharpnesses: reading.value(prim, "creaseSharpnesses").unwrap_or_default(),
        corner_indices: reading.value(prim, "cornerIndices").unwrap_or_default(),
        corner_sharpnesses: reading.value(prim, "cornerSharpnesses").unwrap_or_default(),
    })
}

impl Rules {
    /// The triangles of the refined mesh, and its values.
    pub fn refine(
        self,
        mut polygons: Polygons,
        holes: &[bool],
        points: Vec<[f32; 3]>,
        channels: Channels,
        motion: Vec<Motion<Vec<[f32; 3]>>>,
        depth: u32,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Surface {
        let creases = self.creases(points.len(), place, warnings);
        let corners = self.corners(points.len(), place, warnings);
        let mut holes = holes.to_vec();
        if self.scheme == Scheme::Loop && polygons.faces.corners.len() != 3 * polygons.faces.len() {
            warnings.push(place, "Loop's subdivision is for triangles; the faces are cut to triangles first");
            cut_to_triangles(&mut polygons, &mut holes, &points);
        }
        let depth = self.affordable(depth, &polygons.faces, place, warnings);
        let Polygons { faces, corners: kept_corners, sources: kept_faces, flipped } = polygons;
        let cage_corners = faces.corners.len();
        let refinement = Refinement::new(
            Cage {
                faces,
                points: points.len(),
                creases: &creases,
                corners: &corners,
                holes: &holes,
                scheme: self.scheme,
                boundary: self.boundary,
                face_varying: self.face_varying,
                smooth_triangles: self.smooth_triangles,
            },
            depth,
        );
        let refine = Refine { refinement: &refinement, cage_corners, kept_corners: kept_corners.as_deref() };
        let Channels { uvs, color, opacity, named, .. } = channels;
        let (refined, normals) = refinement.surface(&points);
        let normals = normals.map(|normals| as_channel(normals, flipped));
        let channels = Channels {
            normals,
            uvs: uvs.into_iter().map(|(name, channel)| (name, refine.channel(channel))).collect(),
            color: color.map(|channel| refine.channel(channel)),
            opacity: opacity.map(|channel| refine.channel(channel)),
            named: named.into_iter().map(|(name, channel)| (name, refine.channel(channel))).collect(),
        };
        let sources = refinement.sources();
        let sources = match &kept_faces {
            Some(kept) => sources.iter().map(|&face| kept[face as usize]).collect(),
            None => sources.to_vec(),
        };
        let polygons = Polygons { faces: refinement.faces().clone(), corners: None, sources: Some(sources), flipped };
        let triangles = polygons.triangles(&refined, refinement.holes());
        let motion = motion.into_iter().map(|m| Motion { time: m.time, value: refinement.vertex(&m.value) });
        Surface { motion: motion.collect(), points: refined, triangles, channels, slots: None }
    }

    /// `depth`, or what of it a mesh of this size can afford.
    fn affordable(&self, depth: u32, faces: &Faces, place: &Place, warnings: &mut Warnings) -> u32 {
        // The first step makes a quad of each corner, all others four of each face.
        let first = if self.scheme == Scheme::Loop { 4 * faces.len() } else { faces.corners.len() } as u64;
        let fits = |depth: u32| {
            depth == 0
                || 4u64.checked_pow(depth - 1).and_then(|n| n.checked_mul(first)).is_some_and(|n| n <= MOST_FACES)
        };
        let affordable = (0..=depth.min(31)).rev().find(|&depth| fits(depth)).unwrap_or(0);
        if affordable < depth {
            let what = format!("refined {depth} times it would have too many faces; it is refined {affordable} times");
            warnings.push(place, what);
        }
        affordable
    }

    fn creases(&self, points: usize, place: &Place, warnings: &mut Warnings) -> Vec<([u32; 2], f32)> {
        let lengths = &self.crease_lengths;
        let edges: usize =
            lengths.iter().map(|&length| usize::try_from(length).map_or(0, |n| n.saturating_sub(1))).sum();
        self.tell_of_crease_counts(edges, place, warnings);
        let for_each_edge = self.crease_sharpnesses.len() == edges && edges != lengths.len();
        let mut creases = Vec::new();
        let (mut start, mut wrong, mut edge) = (0, 0, 0);
        for (crease, &length) in lengths.iter().enumerate() {
            let end = start + usize::try_from(length).unwrap_or(0);
            let Some(list) = self.crease_indices.get(start..end) else {
                break;
            };
            for pair in list.windows(2) {
                let sharpness = self.crease_sharpnesses.get(if for_each_edge { edge } else { crease });
                edge += 1;
                let known = pair.iter().all(|&i| usize::try_from(i).is_ok_and(|i| i < points));
                match sharpness {
                    Some(&sharpness) if known && sharpness >= 0.0 => {
                        creases.push(([pair[0] as u32, pair[1] as u32], sharpness));
                    }
                    _ => wrong += 1,
                }
            }
            start = end;
        }
        if wrong > 0 {
            warnings.push(
                place,
                format!("{wrong} creases lack sharpness or use points that don't exist; they are left out"),
            );
        }
        creases
    }

    /// Tells of arrays that don't fit the creases, of `edges` in all; creases without sharpness are told elsewhere.
    fn tell_of_crease_counts(&self, edges: usize, place: &Place, warnings: &mut Warnings) {
        let points: usize = self.crease_lengths.iter().map(|&length| usize::try_from(length).unwrap_or(0)).sum();
        let (creases, indices) = (self.crease_lengths.len(), self.crease_indices.len());
        if points != indices {
            let what = format!("has {indices} creaseIndices where its creaseLengths come to {points}");
            let done = if points < indices { "those beyond are left out" } else { "the creases beyond are left out" };
            warnings.push(place, format!("{what}; {done}"));
        }
        let sharpnesses = self.crease_sharpnesses.len();
        if sharpnesses > creases && sharpnesses != edges {
            let what = format!("has {sharpnesses} creaseSharpnesses for {creases} creases of {edges} edges");
            warnings.push(place, format!("{what}; the first ones are used, one for each crease"));
        }
    }

    fn corners(&self, points: usize, place: &Place, warnings: &mut Warnings) -> Vec<(u32, f32)> {
        let (indices, sharpnesses) = (self.corner_indices.len(), self.corner_sharpnesses.len());
        if sharpnesses > indices {
            let what = format!("has {sharpnesses} cornerSharpnesses for {indices} corners; the first ones are used");
            warnings.push(place, what);
        }
        let pairs = self.corner_indices.iter().zip(&self.corner_sharpnesses);
        let corners: Vec<(u32, f32)> = pairs
            .filter(|&(&i, &sharpness)| usize::try_from(i).is_ok_and(|i| i < points) && sharpness >= 0.0)
            .map(|(&i, &sharpness)| (i as u32, sharpness))
            .collect();
        if corners.len() < self.corner_indices.len() {
            let wrong = self.corner_indices.len() - corners.len();
            let what = format!("{wrong} corners lack sharpness or are points that don't exist; they are left out");
            warnings.push(place, what);
        }
        corners
    }
}

/// Makes triangles of all faces, which keep their numbers.
fn cut_to_triangles(polygons: &mut Polygons, holes: &mut Vec<bool>, points: &[[f32; 3]]) {
    let faces = std::mem::take(&mut polygons.faces);
    let (mut corners, mut kept, mut sources, mut cut_holes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut scratch, mut cut) = (Scratch::default(), Vec::new());
    for face in 0..faces.len() {
        let (start, list) = (faces.starts[face], faces.points(face));
        cut.clear();
        triangulate(list.len(), |i| points[list[i] as usize], &mut cut, &mut scratch);
        for triangle in &cut {
            corners.extend(triangle.map(|i| list[i as usize]));
            let corner = |i: u32| polygons.corners.as_ref().map_or(start + i, |kept| kept[(start + i) as usize]);
            kept.extend(triangle.map(corner));
            sources.push(polygons.sources.as_ref().map_or(face as u32, |sources| sources[face]));
            cut_holes.push(holes.get(face).copied().unwrap_or(false));
        }
    }
    *holes = cut_holes;
    polygons.faces = Faces::new(sources.iter().map(|_| 3), corners);
    (polygons.corners, polygons.sources) = (Some(kept), Some(sources));
}

/// Takes values of the cage to the refined mesh.
struct Refine<'a> {
    refinement: &'a Refinement,
    cage_corners: usize,
    /// What the corners of the cage were among those authored.
    kept_corners: Option<&'a [u32]>,
}

impl Refine<'_> {
    fn channel<const N: usize>(&self, channel: Channel<N>) -> Channel<N> {
        let interpolation = channel.interpolation;
        match interpolation {
            Interpolation::Constant | Interpolation::Uniform => channel,
            Interpolation::Vertex => {
                Channel { interpolation, values: self.refinement.vertex(&channel.flat()), indices: None }
            }
            Interpolation::Varying => {
                Channel { interpolation, values: self.refinement.linear(&channel.flat()), indices: None }
            }
            Interpolation::FaceVarying => {
                let kept = |corner: usize| self.kept_corners.map_or(corner, |kept| kept[corner] as usize);
                let index = |corner: usize| channel.indices.as_ref().map_or(corner as u32, |list| list[corner]);
                let indices: Vec<u32> = (0..self.cage_corners).map(|corner| index(kept(corner))).collect();
                let (values, indices) = self.refinement.face_varying(&channel.values, &indices);
                Channel { interpolation, values, indices: Some(indices) }
            }
        }
    }
}

/// Normals of the front.
fn as_channel(normals: Attribute<[f32; 3]>, flipped: bool) -> Channel<3> {
    let (interpolation, mut values) = match normals {
        Attribute::Point(values) => (Interpolation::Vertex, values),
        Attribute::Corner(values) => (Interpolation::FaceVarying, values),
    };
    if flipped {
        values.as_flattened_mut().iter_mut().for_each(|v| *v = -*v);
    }
    Channel { interpolation, values, indices: None }
}
