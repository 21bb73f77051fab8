//! The scene as it is traced: `f32`, immutable during a render, in *render space*, whose origin lies
//! near the camera.

mod aovs;
mod asked;
mod blur;
mod effects;
mod framing;
mod ids;
mod inside;
mod instance;
mod interaction;
mod lamp_shading;
mod material;
mod media;
mod mist;
mod path_state;
mod prepare;
mod shading;
mod shutter;
mod spot;
mod surroundings;
mod terminator;
mod trace;
mod vectors;

pub use blur::Blur;
pub use effects::Effects;
pub(crate) use effects::{has_own_shadow, shines};
pub use ids::Ids;
pub use inside::Inside;
pub use instance::{Instance, mask};
pub use interaction::Interaction;
pub use material::{Coverage, Material};
pub use media::{Interior, Media};
pub use mist::Mist;
pub use path_state::{PathState, RayKind};
pub use prepare::{Cache, Prepared, View, prepare, prepare_with};
pub use terminator::Terminator;
pub use trace::RayCone;
pub use vectors::Vectors;

use std::sync::Arc;

use aovs::BackgroundAovs;
use asked::Asked;

use crate::bvh::{Bvh, Isa};
use crate::camera::{Camera, CameraMotion, CameraRay, Exposure};
use crate::film::PassSet;
use crate::light::LightSet;
use crate::math::DVec3;
use crate::shape::Shape;
use crate::texture::Texture;

/// Everything that a ray can ask.
pub struct Scene {
    /// The camera, in the middle of the shutter.
    pub camera: Camera,
    /// How it moves while the shutter is open.
    pub camera_motion: Option<CameraMotion>,
    /// When rays see it.
    pub times: Exposure,
    /// Factor of all radiance in the picture.
    pub exposure: f32,
    /// Width and height of the picture in pixels.
    pub size: [u32; 2],
    /// World position of render space's origin.
    pub origin: DVec3,
    /// What is rendered: the passes asked for, with the scene's light groups.
    pub passes: PassSet,
    /// What this scene can show.
    pub effects: Effects,
    /// All lights.
    pub lights: LightSet,
    /// True where the camera sees what lies behind everything; else that has alpha 0.
    pub background_visible: bool,
    /// True where a dome's radiance goes by the camera: another view lights the scene otherwise.
    pub follows_camera: bool,
    /// True where Combined lacks what lies behind everything.
    pub film_transparent: bool,
    /// Width of microfacets up to which a transparent film is so seen through glass, too; `None` for no glass.
    pub transparent_glass: Option<f32>,
    /// Surfaces that a path may pass unscattered: see the setting of transparent bounces.
    pub max_transparent: u32,
    /// The same of a shadow ray, with those that its path has passed before.
    max_transparent_shadow: u32,
    /// Opacity from which on a surface is what the data passes show.
    pub pass_alpha_threshold: f32,
    /// What the mist pass shows.
    pub mist: Mist,
    /// What the vector pass compares the frame with; `None` where it is not rendered.
    pub vectors: Option<Vectors>,
    /// Names and hashes for the index and Cryptomatte passes.
    pub ids: Ids,
    bvh: Bvh,
    /// By instance, the shape alone where light may walk in its inside; empty where it does so nowhere.
    insides: Vec<Option<Inside>>,
    /// Those of the instances whose insides absorb light, and which instances they are; `None` where there are none.
    absorbing: Option<(Bvh, Vec<u32>)>,
    shapes: Vec<Shape>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    textures: Arc<Vec<Texture>>,
    asked: Arc<Asked>,
    /// `None` where the background gives no AOV that is asked for.
    background_aovs: Option<BackgroundAovs>,
}

impl Scene {
    /// The same scene, its hits found by the code for `isa`; `None` where this machine can't run it.
    pub fn with_isa(self, isa: Isa) -> Option<Self> {
        let bvh = self.bvh.with_isa(isa)?;
        let absorbing = match self.absorbing {
            Some((bvh, instances)) => Some((bvh.with_isa(isa)?, instances)),
            None => None,
        };
        Some(Self { bvh, absorbing, ..self })
    }

    /// The placed shape `i`, an index that a hit gives.
    pub fn instance(&self, i: u32) -> &Instance {
        &self.instances[i as usize]
    }

    /// A ray of the camera at `time`; see [`Camera::lens_ray`].
    pub fn camera_ray(&self, x: f32, y: f32, time: f32, on_lens: impl FnOnce() -> [f32; 2]) -> CameraRay {
        let mut found = match &self.camera_motion {
            None => self.camera.lens_ray(x, y, on_lens),
            Some(motion) => motion.at(&self.camera, time).lens_ray(x, y, on_lens),
        };
        found.ray.time = time;
        found
    }

    /// When a ray of pixels of row `y` from the top sees the scene, by a uniform `u`.
    pub fn time_of_row(&self, y: u32, u: f32) -> f32 {
        self.times.time(u, self.camera.down(y as f32 + 0.5))
    }

    /// The shape of `instance`.
    pub fn shape(&self, instance: &Instance) -> &Shape {
        &self.shapes[instance.shape as usize]
    }

    /// Memory of the acceleration structure, the shapes and the textures, in bytes.
    pub fn bytes(&self) -> [usize; 3] {
        let shapes = self.shapes.iter().map(Shape::bytes).sum();
        let textures = self.textures.iter().map(|texture| texture.image().bytes()).sum();
        [self.bvh.bytes(), shapes, textures]
    }
}
