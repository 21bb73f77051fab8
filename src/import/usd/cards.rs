//! Cards: pictures of a model on up to six quads, about its bounds or where each picture says
//! (model:cardGeometry of UsdGeomModelAPI).

use openusd::sdf::{AssetPath, Path};
use openusd::tf::Token;
use openusd::usd::Prim;

use super::images::{self, File};
use super::shape::Quad;
use super::stage::Reading;
use crate::import::image::world_to_screen;
use crate::math::{DMat4, DVec3};

/// The two sides of a cross lie this far apart, in diagonals of the bounds.
const GAP: f32 = 1e-4;

/// A face of a box, and how a picture lies on it that is seen from outside.
struct Face {
    name: &'static str,
    axis: usize,
    positive: bool,
    /// The axes along which u and v grow, and whether they do so forwards.
    uv: [(usize, bool); 2],
}

/// In the order in which they are drawn; opposite ones side by side.
const FACES: [Face; 6] = [
    Face { name: "XPos", axis: 0, positive: true, uv: [(1, true), (2, true)] },
    Face { name: "XNeg", axis: 0, positive: false, uv: [(1, false), (2, true)] },
    Face { name: "YPos", axis: 1, positive: true, uv: [(0, false), (2, true)] },
    Face { name: "YNeg", axis: 1, positive: false, uv: [(0, true), (2, true)] },
    Face { name: "ZPos", axis: 2, positive: true, uv: [(0, true), (1, true)] },
    Face { name: "ZNeg", axis: 2, positive: false, uv: [(0, true), (1, false)] },
];

/// A picture for one of the faces.
pub(super) struct Picture {
    /// Index into the faces.
    face: usize,
    /// The attribute that names it.
    pub attribute: Path,
    pub asset: AssetPath,
}

/// The pictures that `prim`, whose authored properties are `names`, has for its faces.
pub(super) fn pictures(reading: &Reading<'_>, prim: &Prim, names: &[Token]) -> Vec<Picture> {
    let picture = |(face, Face { name, .. }): (usize, &Face)| {
        let name = format!("model:cardTexture{name}");
        names.iter().find(|authored| authored.as_str() == name)?;
        let asset = reading.value::<AssetPath>(prim, &name).filter(|asset| !asset.asset_path().is_empty())?;
        Some(Picture { face, attribute: prim.path().append_property(name).ok()?, asset })
    };
    FACES.iter().enumerate().filter_map(picture).collect()
}

/// Quads on the faces of `bounds`, or across its middle. Axes without any picture are left out if another
/// has one; a face without takes that of the opposite one, as if one looked through from behind.
pub(super) fn around(bounds: [[f32; 3]; 2], is_box: bool, pictures: &[Picture]) -> Vec<Quad> {
    let of = |face: usize| pictures.iter().position(|picture| picture.face == face);
    let [low, high] = bounds;
    let diagonal = low.iter().zip(high).map(|(low, high)| (high - low).powi(2)).sum::<f32>().sqrt();
    let mut quads = Vec::new();
    for pair in [[0, 1], [2, 3], [4, 5]] {
        let own = pair.map(of);
        if !pictures.is_empty() && own == [None; 2] {
            continue;
        }
        let differ = own.iter().all(Option::is_some);
        for side in [0, 1] {
            // Both sides of a quad are seen.
            if side == 1 && !is_box && !differ {
                continue;
            }
            let face = &FACES[pair[side]];
            let depth = match (is_box, face.positive) {
                (true, positive) => f32::from(u8::from(positive)),
                (false, _) => 0.5,
            };
            let gap = if is_box || !differ { 0.0 } else { 0.5 * GAP * diagonal };
            let texture = own[side].or(own[1 - side]);
            let picture = &FACES[texture.map_or(pair[side], |texture| pictures[texture].face)];
            let place = |[u, v]: [f32; 2]| {
                let mut p = [depth; 3];
                for ((axis, forwards), t) in face.uv.into_iter().zip([u, v]) {
                    p[axis] = along(t, forwards);
                }
                p
            };
            let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(place);
            let point = |p: [f32; 3]| {
                let mut point: [f32; 3] = std::array::from_fn(|i| low[i] * (1.0 - p[i]) + high[i] * p[i]);
                point[face.axis] += if face.positive { gap } else { -gap };
                point
            };
            let uv = |p: [f32; 3]| picture.uv.map(|(axis, forwards)| along(p[axis], forwards));
            quads.push(Quad { points: unit.map(point), uvs: unit.map(uv), texture });
        }
    }
    quads
}

fn along(t: f32, forwards: bool) -> f32 {
    if forwards { t } else { 1.0 - t }
}

/// A quad for each picture, where the matrix in its file says: its corners are those of the screen. As in
/// UsdImaging, the top of the picture is at the bottom of that screen.
pub(super) fn from_textures(reading: &Reading<'_>, pictures: &[Picture]) -> Vec<Quad> {
    let quad = |(texture, picture): (usize, &Picture)| {
        let left_out = |what| reading.warn(&picture.attribute, format!("{what}; the card is left out"));
        let matrix = matrix(&picture.asset).map_err(left_out).ok()?;
        let corners = [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
        let points = corners.map(|[x, y]| matrix.project_point3(DVec3::new(x, y, 0.0)).as_vec3().to_array());
        let uvs = corners.map(|[x, y]| [0.5 * (1.0 + x as f32), 0.5 * (1.0 - y as f32)]);
        if !points.as_flattened().iter().all(|x| x.is_finite()) {
            reading.warn(&picture.attribute, "its worldtoscreen matrix has no inverse; the card is left out");
            return None;
        }
        Some(Quad { points, uvs, texture: Some(texture) })
    };
    pictures.iter().enumerate().filter_map(quad).collect()
}

/// From the screen to the model's space.
fn matrix(asset: &AssetPath) -> Result<DMat4, String> {
    let file = match File::find(asset, None) {
        File::One(file) => file,
        File::Tiles(_) => return Err("a card can't be made of tiles".to_string()),
        File::Missing(what) => return Err(what),
    };
    let matrix = world_to_screen(&images::bytes(&file)?);
    // Rows of USD are columns here.
    let matrix = matrix.ok_or_else(|| format!("{file} says no worldtoscreen matrix, which only OpenEXR files can"))?;
    Ok(DMat4::from_cols_array(&matrix.map(f64::from)).inverse())
}
