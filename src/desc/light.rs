//! Lights and the world, as authored and already in the one internal unit.

use std::sync::Arc;

use super::Visibility;
use crate::error::Place;
use crate::math::DAffine3;

/// A light that is not an emissive mesh. Its local −z is the direction in which it shines.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDesc {
    /// Name.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Light to world.
    pub transform: DAffine3,
    /// What and how much it emits.
    pub kind: LightKind,
    /// Light group that it belongs to.
    pub group: Option<Arc<str>>,
    /// Which rays see it; the shadow flag is that of the light as an occluder.
    pub visibility: Visibility,
    /// False for a light whose rays pass through everything.
    pub cast_shadow: bool,
}

/// What a light is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// A point, a delta: radiant intensity in W·sr⁻¹.
    Point {
        /// W·sr⁻¹, linear RGB.
        intensity: [f64; 3],
        /// No light farther than this (KHR_lights_punctual's window); infinite for none.
        range: f64,
    },
    /// A point with a cone: full intensity inside `inner`, none outside `outer`, and between them
    /// the square of a linear ramp in the cosine, as KHR_lights_punctual recommends.
    Spot {
        /// W·sr⁻¹ inside the inner cone.
        intensity: [f64; 3],
        /// Half angle of full intensity, radians.
        inner: f64,
        /// Half angle where it ends, radians.
        outer: f64,
        /// No light farther than this; infinite for none.
        range: f64,
    },
    /// Light from infinitely far away, from one direction or a disk of directions.
    Distant {
        /// Irradiance on a surface that faces it, W·m⁻².
        irradiance: [f64; 3],
        /// Full angle of the disk, radians; 0 for one direction.
        angle: f64,
    },
}

/// What surrounds the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldDesc {
    /// Where it came from.
    pub place: Place,
    /// Constant radiance, or the factor of the image, W·sr⁻¹·m⁻².
    pub radiance: [f64; 3],
    /// A lat-long image; `None` for a constant dome.
    pub image: Option<WorldImage>,
    /// False where the camera sees black and alpha 0 instead of the world.
    pub visible: bool,
}

/// A lat-long environment. The image's centre is the direction `rotation`·(+x), its top row is +y;
/// u grows clockwise seen from above, as in Cycles' equirectangular mapping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorldImage {
    /// Index into `SceneDesc::images`.
    pub image: u32,
    /// Turn about the up axis, degrees, counter-clockwise seen from above.
    pub rotation: f64,
}
