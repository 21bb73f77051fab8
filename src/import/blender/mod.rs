//! The Blender door: what the add-on hands over becomes a `SceneDesc`.
//!
//! The add-on is thin: it copies properties by name into one JSON [`Document`], and arrays of meshes
//! and images as they lie in memory. What they mean, from the watts of a lamp to the sockets of a node,
//! is decided here, where it is tested without Blender. The world stays Blender's, z up, so that the
//! passes in world space hold the numbers that the artist sees.

mod blending;
mod camera;
mod colors;
mod document;
mod image;
mod islands;
mod kept;
mod layers;
mod light;
mod material;
mod mesh;
mod motion;
mod nodes;
mod pointiness;
mod random;
mod rounds;
mod scene;
mod smooth;
mod stamp;
mod transform;
mod view;
mod world;

pub use document::{
    CameraData, Document, DocumentEdit, DofData, ImageData, LightData, LinkData, MaterialData, ObjectData,
    PanoramaData, RenderData, VisibilityData, WorldData,
};
pub use image::ImageSource;
pub use islands::random_per_island;
pub use mesh::{LayerArray, MeshArrays};
pub use motion::MovedPoints;
pub use nodes::{NodeData, SocketData, TreeData, Value};
pub use pointiness::pointiness;
pub use rounds::Ends;
pub use scene::BlenderScene;
pub(super) use stamp::{Moment, Stamp};
pub use view::ViewData;
