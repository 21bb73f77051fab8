//! Triangle meshes, and the placement of shapes, as authored.

use std::sync::Arc;

use super::{LightLinks, ShapedDesc, TerminatorDesc};
use crate::error::Place;
use crate::math::DAffine3;

/// Values on a mesh: one per point, or one per corner of each triangle (3 × triangles).
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute<T> {
    /// One value for each point.
    Point(Vec<T>),
    /// One value for each corner of each triangle.
    Corner(Vec<T>),
}

impl<T> Attribute<T> {
    /// How many values there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Point(values) | Self::Corner(values) => values.len(),
        }
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Values on a mesh that graphs ask for.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedAttribute {
    /// Its name.
    pub name: Arc<str>,
    /// A value as graphs have it: a number in all four places, a linear color with alpha, or a vector.
    pub values: Attribute<[f32; 4]>,
}

/// A triangle mesh in object space. Front faces wind counter-clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshDesc {
    /// Name.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Points, in metres before the instance's transform.
    pub points: Vec<[f32; 3]>,
    /// Three point indices for each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Shading normals, unit; `None` for a faceted mesh.
    pub normals: Option<Attribute<[f32; 3]>>,
    /// UV sets; v grows downwards in the image as in glTF (the image's top row is v = 0).
    pub uvs: Vec<Attribute<[f32; 2]>>,
    /// Tangents (MikkTSpace), w is the sign of the bitangent; only where a material needs them.
    pub tangents: Option<Attribute<[f32; 4]>>,
    /// Vertex colours, linear, straight alpha; multiplied onto the base colour.
    pub colors: Option<Attribute<[f32; 4]>>,
    /// Values that graphs ask for by name. A name that comes twice is the first one's.
    pub attributes: Vec<NamedAttribute>,
    /// The box that is 0 to 1 in generated coordinates, its least and its largest corner; `None` for that
    /// of the points.
    pub generated: Option<[[f64; 3]; 2]>,
    /// Index into the instance's material list for each triangle; `None` for 0 everywhere.
    pub material_slots: Option<Vec<u16>>,
    /// Points at other times of the shutter, in the order of time; empty for a mesh that keeps its
    /// shape. `points` is the shape at the frame itself.
    pub motion: Vec<Motion<Vec<[f32; 3]>>>,
}

/// What something is at another time than the frame's.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<T> {
    /// Frames after the frame itself; negative before it.
    pub time: f64,
    /// What it is then.
    pub value: T,
}

/// Which shape an instance shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShapeRef {
    /// Index into `SceneDesc::meshes`.
    Mesh(u32),
    /// Index into `SceneDesc::rounds`.
    Rounds(u32),
}

/// A shape placed in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct InstanceDesc {
    /// Name of the object, for Cryptomatte.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Name of the asset (topmost parent) that it belongs to, for Cryptomatte.
    pub asset: Arc<str>,
    /// What is placed.
    pub shape: ShapeRef,
    /// Object to world.
    pub transform: DAffine3,
    /// The same at other times of the shutter, in the order of time; empty for what does not move.
    pub motion: Vec<Motion<DAffine3>>,
    /// Index into `SceneDesc::materials` for each slot; a slot without entry, or with `None`, has
    /// the default material.
    pub materials: Vec<Option<u32>>,
    /// Its colour, linear, straight alpha, where the mesh has no vertex colours; multiplied onto the base
    /// colour as those are.
    pub color: Option<[f32; 4]>,
    /// Value of the object index pass.
    pub object_index: u32,
    /// What graphs ask the object for.
    pub info: ObjectInfo,
    /// Which rays see it.
    pub visibility: Visibility,
    /// Rules of the light that it emits, where it emits any.
    pub links: LightLinks,
    /// What it emits is shaped by direction; `None` where its materials alone say it.
    pub shaped: Option<Arc<ShapedDesc>>,
    /// True where the camera sees a hole in the picture instead: black, of alpha 0. All other rays see it as
    /// it is.
    pub holdout: bool,
    /// The camera sees nothing of it but the shadows of others on it.
    pub catcher: bool,
    /// How the edge of its own shadow is softened; `None` for what the settings say.
    pub terminator: Option<TerminatorDesc>,
}

/// What graphs ask an object for.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectInfo {
    /// Its color with alpha.
    pub color: [f64; 4],
    /// A number of 0 to 1 that is its own.
    pub random: f64,
    /// Named values, which those of the mesh come before.
    pub attributes: Vec<(Arc<str>, [f64; 4])>,
}

impl Default for ObjectInfo {
    fn default() -> Self {
        Self { color: [1.0; 4], random: 0.0, attributes: Vec::new() }
    }
}

/// Which kinds of ray see an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Visibility {
    /// Rays from the camera.
    pub camera: bool,
    /// Diffuse bounces.
    pub diffuse: bool,
    /// Reflections.
    pub glossy: bool,
    /// Refractions.
    pub transmission: bool,
    /// Shadow and occlusion rays.
    pub shadow: bool,
}

impl Visibility {
    /// Seen by every ray.
    pub const ALL: Self = Self { camera: true, diffuse: true, glossy: true, transmission: true, shadow: true };
}
