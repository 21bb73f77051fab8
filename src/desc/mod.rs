//! What an artist wrote: plain data, `f64` where it is authored so, and no behaviour but for what the
//! functions of shader graphs compute ([`graph`]), which doors fold constants with.
//!
//! Every front door (glTF, USD, Blender) fills a [`SceneDesc`] and nothing else; `scene/prepare.rs`
//! turns it into what is traced. The world is right-handed with **y up**, in metres, radiance in
//! W·sr⁻¹·m⁻² and linear Rec.709. Indices point into the vectors of the same `SceneDesc`;
//! [`check`] holds them to that.

mod aov;
mod camera;
mod check;
mod closure;
mod digest;
mod framing;
pub mod graph;
mod image;
mod input;
mod layers;
mod light;
mod material;
mod mesh;
mod render;
mod rounds;
mod shadow;
mod subsurface;
mod terminator;
mod texture;

pub use aov::{AovDesc, AovKind, AovOutput, BackgroundAovs};
pub use camera::{CameraDesc, LensDesc, ProjectionDesc};
pub use check::check;
pub use closure::{ClosureDesc, FacetsDesc, PartDesc};
pub use framing::{Conform, EffectsOff, FramingDesc};
pub use image::{Blending, ColorSpace, ImageDesc, PixelData};
pub use input::{Channel, ColorInput, NormalInput, ScalarInput};
pub use layers::{AnisotropyDesc, AnisotropyLaw, CoatDesc, IridescenceDesc, SheenDesc, TranslucentDesc, VolumeDesc};
pub use light::{
    ConeDesc, DecayDesc, DecayLaw, DomeShader, DomeSun, IesDesc, IesRef, LampShaderDesc, LightDesc, LightKind,
    LightLinks, LinkSet, ShapedDesc, ShapingDesc,
};
pub use material::{AlphaMode, MaterialDesc};
pub use mesh::{Attribute, InstanceDesc, MeshDesc, Motion, NamedAttribute, ObjectInfo, ShapeRef, Visibility};
pub use render::{ProductDesc, RenderDesc};
pub use rounds::{RoundsDesc, RoundsKey, Strand};
pub use shadow::ShadowDesc;
pub use subsurface::{SubsurfaceDesc, SubsurfaceMethod};
pub use terminator::TerminatorDesc;
pub use texture::{Filter, TextureDesc, TextureRef, TextureTransform, Wrap};

use std::sync::Arc;

use crate::error::Place;

/// A scene as authored, at one frame.
#[derive(Clone, Debug, Default)]
pub struct SceneDesc {
    /// Where it came from.
    pub place: Place,
    /// Cameras, in the order of the file. The door has already chosen none of them.
    pub cameras: Vec<CameraDesc>,
    /// Meshes; shared by any number of instances.
    pub meshes: Vec<Arc<MeshDesc>>,
    /// Strands and balls; shared by any number of instances.
    pub rounds: Vec<Arc<RoundsDesc>>,
    /// Shapes placed in the world.
    pub instances: Vec<InstanceDesc>,
    /// Materials.
    pub materials: Vec<MaterialDesc>,
    /// Ways to look an image up.
    pub textures: Vec<TextureDesc>,
    /// Decoded images; shared by any number of textures, and with whoever hands the same over again.
    pub images: Vec<Arc<ImageDesc>>,
    /// Lights that are not emissive meshes, domes included.
    pub lights: Vec<LightDesc>,
    /// What domes emit that is more than an image.
    pub dome_shaders: Vec<DomeShader>,
    /// What lamps emit that varies over them.
    pub lamp_shaders: Vec<LampShaderDesc>,
    /// What the background gives as AOVs; those of a transparent film are 0.
    pub background_aovs: BackgroundAovs,
    /// How many more lights the file has that could not be read; the door has told why.
    pub lights_left_out: usize,
    /// Measured distributions that lights use.
    pub ies: Vec<IesDesc>,
    /// Names of the material variants that the file offers.
    pub variants: Vec<String>,
    /// What the file itself says of the render; the command line comes first.
    pub render: RenderDesc,
}

impl SceneDesc {
    /// The mesh that `instance` shows; `None` for another kind of shape.
    pub fn mesh(&self, instance: &InstanceDesc) -> Option<&MeshDesc> {
        match instance.shape {
            ShapeRef::Mesh(i) => self.meshes.get(i as usize).map(|mesh| &**mesh),
            ShapeRef::Rounds(_) => None,
        }
    }

    /// The strands or balls that `instance` shows; `None` for another kind of shape.
    pub fn rounds(&self, instance: &InstanceDesc) -> Option<&RoundsDesc> {
        match instance.shape {
            ShapeRef::Rounds(i) => self.rounds.get(i as usize).map(|rounds| &**rounds),
            ShapeRef::Mesh(_) => None,
        }
    }
}
