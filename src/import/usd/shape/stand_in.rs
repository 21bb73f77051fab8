//! What is drawn in place of a model: the edges of its bounds, its axes, or cards with pictures of it.

use openusd::sdf;
use openusd_schemas::geom::Interpolation;

use super::finish::{Channels, Surface};
use super::polygons::Triangles;
use super::primvar::Channel;
use super::profile::Solid;
use super::{Built, Wants};
use crate::error::{Place, Warnings};

/// Lines of the wire frame are bars, this thick in diagonals of what they frame.
const THICKNESS: f32 = 1.0 / 200.0;

/// The UV set of cards, named as UsdImaging names it.
pub(in super::super) const CARDS_UV: &str = "cardsUv";

/// Something drawn in place of a model.
#[derive(Clone)]
pub(in super::super) struct StandIn {
    pub shape: StandInShape,
    /// Of all that has no picture.
    pub color: [f32; 3],
    /// Attributes that name the pictures of cards; each is a subset with a material of its own.
    pub textures: Vec<sdf::Path>,
}

/// What it looks like.
#[derive(Clone, Debug)]
pub(in super::super) enum StandInShape {
    /// The edges of a box, given by its smallest and largest corner.
    Bounds([[f32; 3]; 2]),
    /// The unit vectors of the axes.
    Origin,
    Cards(Vec<Quad>),
}

/// A card; counter-clockwise from outside.
#[derive(Clone, Debug)]
pub(in super::super) struct Quad {
    pub points: [[f32; 3]; 4],
    /// v grows upwards.
    pub uvs: [[f32; 2]; 4],
    /// Index into the textures.
    pub texture: Option<usize>,
}

impl StandIn {
    pub(super) fn build(self, wants: &Wants, place: &Place, warnings: &mut Warnings) -> Option<Built> {
        let color = Channel { interpolation: Interpolation::Constant, values: vec![self.color], indices: None };
        let mut channels = Channels { color: wants.display_color.then_some(color), ..Channels::default() };
        let (mut points, mut triangles, mut faces, mut slots) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        match self.shape {
            StandInShape::Bounds(corners) => bars(corners, &edges(), &mut points, &mut triangles),
            StandInShape::Origin => {
                let axes = [0, 1, 2].map(|axis| ([0.0; 3], axis));
                bars([[0.0; 3], [1.0; 3]], &axes, &mut points, &mut triangles);
            }
            StandInShape::Cards(quads) => {
                let mut uvs = Vec::new();
                for (i, quad) in quads.into_iter().enumerate() {
                    let [a, b, c, d] = std::array::from_fn(|k| (points.len() + k) as u32);
                    triangles.extend([[a, b, c], [a, c, d]]);
                    faces.extend([i as u32; 2]);
                    points.extend(quad.points);
                    uvs.extend(quad.uvs);
                    // The first slot is that of the shape itself.
                    slots.push(quad.texture.map_or(0, |texture| texture as u16 + 1));
                }
                let uvs = Channel { interpolation: Interpolation::Vertex, values: uvs, indices: None };
                channels.uvs.push((CARDS_UV.into(), uvs));
            }
        }
        let is_cards = !slots.is_empty();
        let triangles = Triangles { points: triangles, corners: None, faces: is_cards.then_some(faces) };
        let slots = is_cards.then_some(slots);
        let surface = Surface { points, triangles, channels, slots, motion: Vec::new() };
        surface.finish(wants, place, warnings).map(Built::Mesh)
    }
}

/// The edges of the unit cube: where each starts, and the axis along which it goes.
fn edges() -> Vec<([f32; 3], usize)> {
    let along = |axis: usize| {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[a, b]| {
            let mut start = [0.0; 3];
            (start[(axis + 1) % 3], start[(axis + 2) % 3]) = (a, b);
            (start, axis)
        })
    };
    [0, 1, 2].map(along).as_flattened().to_vec()
}

/// Adds a bar for each line from one side of a box to the other.
fn bars(
    [low, high]: [[f32; 3]; 2],
    lines: &[([f32; 3], usize)],
    points: &mut Vec<[f32; 3]>,
    triangles: &mut Vec<[u32; 3]>,
) {
    let size: [f32; 3] = std::array::from_fn(|i| high[i] - low[i]);
    let half = 0.5 * THICKNESS * size.iter().map(|x| x * x).sum::<f32>().sqrt();
    let cube = Solid::cube(1.0);
    for &(start, axis) in lines {
        let first = points.len() as u32;
        let mut end = start;
        end[axis] = 1.0;
        let at = |t: [f32; 3], i: usize| low[i] + size[i] * t[i];
        points.extend(cube.points.iter().map(|p| -> [f32; 3] {
            std::array::from_fn(|i| if p[i] < 0.0 { at(start, i) - half } else { at(end, i) + half })
        }));
        triangles.extend(cube.triangles.iter().map(|t| t.map(|i| first + i)));
    }
}
