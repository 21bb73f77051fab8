//! Lights that are not emissive meshes, as authored and already in the one internal unit.

use std::sync::Arc;

use super::graph::{Atmosphere, Graph, ValueId};
use super::{Motion, ShadowDesc, Visibility};
use crate::error::Place;
use crate::math::DAffine3;

/// A light that is not an emissive mesh. Its local −z is the direction in which it shines.
#[derive(Clone, Debug, PartialEq)]
pub struct LightDesc {
    /// Name.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Light to world. Sizes are those of `kind`, in metres of the world: the scale of the transform
    /// does nothing but distort the cone of a spot, as in Cycles.
    pub transform: DAffine3,
    /// The same at other times of the shutter, in the order of time; empty for what does not move.
    pub motion: Vec<Motion<DAffine3>>,
    /// What and how much it emits.
    pub kind: LightKind,
    /// How emission varies with direction.
    pub shaping: ShapingDesc,
    /// How emission varies with distance.
    pub decay: DecayDesc,
    /// Which rays see it, and which kinds of reflection it lights; the shadow flag means nothing,
    /// since lamps never stop light.
    pub visibility: Visibility,
    /// Whom it lights and what stops its light.
    pub links: LightLinks,
}

/// What a light is. Radiance is in W·sr⁻¹·m⁻², linear RGB, before shaping and decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// A point, a delta.
    Point {
        /// Radiant intensity, W·sr⁻¹.
        intensity: [f64; 3],
    },
    /// A sphere that emits on both sides; a point light of Cycles.
    Sphere {
        /// Metres, above 0.
        radius: f64,
        /// Radiance of its surface.
        radiance: [f64; 3],
        /// True for Cycles' soft falloff: the light is a disk of this radius that faces whoever looks.
        facing: bool,
    },
    /// A rectangle in the local xy plane.
    Rect {
        /// Along local x, metres.
        width: f64,
        /// Along local y, metres.
        height: f64,
        /// Radiance, or the factor of the texture.
        radiance: [f64; 3],
        /// Full angle of the cone into which each point emits, radians: π for all of the half-space.
        /// Cycles' spread, which keeps the power.
        spread: f64,
        /// True for a light that emits along local +z, too.
        two_sided: bool,
        /// Index into `SceneDesc::images`, seen upright from where the light shines, its top along
        /// local +y.
        image: Option<u32>,
    },
    /// An ellipse in the local xy plane.
    Disk {
        /// Diameter along local x, metres.
        width: f64,
        /// Diameter along local y, metres.
        height: f64,
        /// Radiance.
        radiance: [f64; 3],
        /// As that of a rectangle.
        spread: f64,
        /// True for a light that emits along local +z, too.
        two_sided: bool,
    },
    /// The outside of a tube along local x, without its ends (UsdLux CylinderLight).
    Cylinder {
        /// Metres.
        radius: f64,
        /// Metres.
        length: f64,
        /// Radiance of its surface.
        radiance: [f64; 3],
    },
    /// Light from infinitely far away, from one direction or a disk of directions.
    Distant {
        /// Irradiance on a surface that faces it, W·m⁻², as long as the disk is above its horizon.
        irradiance: [f64; 3],
        /// Full angle of the disk, radians; 0 for one direction.
        angle: f64,
    },
    /// An opening in the local xy plane through which the light of domes comes, towards local −z: it emits
    /// nothing and changes nothing but where domes are sampled.
    Portal {
        /// Along local x, metres.
        width: f64,
        /// Along local y, metres.
        height: f64,
    },
    /// What surrounds everything: constant, or a lat-long image. The image's centre is the light's
    /// local +x, its top row is +y; u grows clockwise seen from above, as in Cycles' equirectangular
    /// mapping.
    Dome {
        /// Radiance, or the factor of the image.
        radiance: [f64; 3],
        /// Index into `SceneDesc::images`; `None` for a constant dome.
        image: Option<u32>,
    },
    /// What surrounds everything, by a graph. Its transform says nothing of what it emits, but where the
    /// poles of the map are that light sampling goes by: along local y.
    ShadedDome {
        /// Index into `SceneDesc::dome_shaders`.
        shader: u32,
    },
}

/// The radiance of a dome by the direction that it comes from.
///
/// In its graph every point is that unit direction in world space ([`super::graph::Leaf::Position`], those of
/// an object and generated ones), as if the dome were the unit sphere around the world's origin, seen from
/// there: normals and the direction to whoever looks are its negative. Nothing is known of the ray's path.
#[derive(Clone, Debug, PartialEq)]
pub struct DomeShader {
    /// How it is made.
    pub graph: Graph,
    /// The radiance, that of suns left out; negative places count as 0.
    pub radiance: ValueId,
    /// Suns of the skies in it.
    pub suns: Vec<DomeSun>,
}

/// A factor of what a lamp emits, by its graph.
///
/// Its graph sees the lamp as a surface from where its light goes: normals and the direction to whoever looks are the
/// direction in which light leaves, of areas normals are their axis. Object space is the lamp's. Parametric coordinates
/// are 0 to 1: over an area along its x and y, over the square around the cone of a spot, over the sphere around a point
/// (longitude and latitude), over the disk of a sun.
#[derive(Clone, Debug, PartialEq)]
pub struct LampShaderDesc {
    /// How it is made.
    pub graph: Graph,
    /// The factor; negative places count as 0.
    pub factor: ValueId,
}

/// The disk of a sun in a sky of a graph.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DomeSun {
    /// The sky without the disk.
    pub sky: ValueId,
    /// The same with it; directions are the world's.
    pub atmosphere: Atmosphere,
}

/// How the emission of a local light varies with the direction in which light leaves it. The axis is
/// local −z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapingDesc {
    /// A cone outside of which there is no light.
    pub cone: Option<ConeDesc>,
    /// UsdLux focus: the factor `|cos θ|^focus`, to both sides; 0 for none.
    pub focus: f64,
    /// UsdLux focus tint: the colour that the factor fades to instead of black.
    pub focus_tint: [f64; 3],
    /// A measured distribution.
    pub ies: Option<IesRef>,
    /// Index into `SceneDesc::lamp_shaders`.
    pub shader: Option<u32>,
}

/// How the emission of an object varies with direction, as that of a light that stands somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapedDesc {
    /// How.
    pub shaping: ShapingDesc,
    /// The light to world: as that of a [`LightDesc`], its axis is local −z.
    pub transform: DAffine3,
}

/// The edge of a cone; angles are half angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConeDesc {
    /// KHR_lights_punctual: the square of a linear ramp in the cosine from `outer` to `inner`.
    Ramp {
        /// Full intensity inside.
        inner: f64,
        /// None outside.
        outer: f64,
    },
    /// Cycles' spot: a smoothstep of the cosine that takes the share `blend` of the cone; the
    /// direction is that in the light's local space, scale included.
    Blend {
        /// None outside.
        angle: f64,
        /// 0 for a hard edge, 1 for a ramp up to the axis.
        blend: f64,
    },
    /// UsdLux ShapingAPI: `1 − smoothstep(angle · (1 − softness), angle, θ)`.
    Soft {
        /// None outside.
        angle: f64,
        /// 0 for a hard edge.
        softness: f64,
    },
}

/// Use of one of `SceneDesc::ies`. The profile's vertical angle 0 is local −z, its horizontal angle 0
/// is local +x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IesRef {
    /// Index into `SceneDesc::ies`.
    pub profile: u32,
    /// UsdLux `shaping:ies:angleScale`; 0 for none.
    pub angle_scale: f64,
    /// True where the profile is scaled to emit what the light without it would; else to 1 at its
    /// brightest.
    pub keep_power: bool,
}

/// A measured distribution of intensity (IES LM-63), type C.
#[derive(Clone, Debug, PartialEq)]
pub struct IesDesc {
    /// Name.
    pub name: Arc<str>,
    /// Where it came from.
    pub place: Place,
    /// Vertical angles in degrees, growing, 0 is the axis.
    pub vertical: Vec<f64>,
    /// Horizontal angles in degrees, growing; the first is 0 and the last 0, 90, 180 or 360.
    pub horizontal: Vec<f64>,
    /// Candela, `horizontal.len()` rows of `vertical.len()`, finite and not negative.
    pub candela: Vec<f64>,
}

/// How light falls off, in addition to the solid angle of the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecayDesc {
    /// The law.
    pub law: DecayLaw,
    /// Cycles' Light Falloff node: the factor `d² / (smooth + d²)`; 0 for none, m².
    pub smooth: f64,
    /// KHR_lights_punctual's window `clamp(1 − (d / range)⁴, 0, 1)`, metres; infinite for none.
    pub range: f64,
}

impl Default for DecayDesc {
    fn default() -> Self {
        Self { law: DecayLaw::Quadratic, smooth: 0.0, range: f64::INFINITY }
    }
}

/// The law of decay over distance `d` in metres; all agree at one metre but for the polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DecayLaw {
    /// None: emission is multiplied by `d²`.
    Constant,
    /// `1 / d`: emission is multiplied by `d`.
    Linear,
    /// Physical.
    Quadratic,
    /// `1 / (kc + kl d + kq d²)`.
    Polynomial {
        /// Constant term.
        kc: f64,
        /// Linear term.
        kl: f64,
        /// Quadratic term.
        kq: f64,
    },
}

/// Rules of a light, lamp or emissive object alike.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLinks {
    /// Light group that it belongs to.
    pub group: Option<Arc<str>>,
    /// False for a light that passes through everything.
    pub cast_shadow: bool,
    /// How the shadows look that it casts.
    pub shadow: ShadowDesc,
    /// Instances that it lights; `None` for all.
    pub receivers: Option<LinkSet>,
    /// Instances that stop its light; `None` for all that cast shadows.
    pub blockers: Option<LinkSet>,
    /// Factors of what it lights by diffuse scattering, and by all other.
    pub response: [f64; 2],
    /// How often light was scattered before, at most, where it lights (Cycles); `None` for no limit.
    pub max_bounces: Option<u32>,
    /// True for one that takes light away instead of giving it: Blender's lamps of negative power.
    pub takes: bool,
}

impl Default for LightLinks {
    fn default() -> Self {
        Self {
            group: None,
            cast_shadow: true,
            shadow: ShadowDesc::default(),
            receivers: None,
            blockers: None,
            response: [1.0; 2],
            max_bounces: None,
            takes: false,
        }
    }
}

/// Some of a scene's instances.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct LinkSet {
    /// Indices into `SceneDesc::instances`.
    pub instances: Vec<u32>,
    /// True where the set is all but these.
    pub exclude: bool,
}

impl LightDesc {
    /// A light of `kind` with nothing special about it.
    pub fn new(name: impl Into<Arc<str>>, place: Place, transform: DAffine3, kind: LightKind) -> Self {
        Self {
            name: name.into(),
            place,
            transform,
            motion: Vec::new(),
            kind,
            shaping: ShapingDesc::default(),
            decay: DecayDesc::default(),
            visibility: Visibility::ALL,
            links: LightLinks::default(),
        }
    }
}

impl LightKind {
    /// True for a light with a shape of its own, near or far.
    pub fn is_shape(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Rect { .. } | Self::Disk { .. } | Self::Cylinder { .. })
    }

    /// True for a light that shines out of the background: a dome, or a sun with a size.
    pub fn is_in_background(&self) -> bool {
        match *self {
            Self::Distant { angle, .. } => angle > 0.0,
            Self::Dome { .. } | Self::ShadedDome { .. } => true,
            _ => false,
        }
    }

    /// True for what surrounds everything.
    pub fn is_dome(&self) -> bool {
        matches!(self, Self::Dome { .. } | Self::ShadedDome { .. })
    }

    /// The image that it is textured with.
    pub fn image(&self) -> Option<u32> {
        match *self {
            Self::Rect { image, .. } | Self::Dome { image, .. } => image,
            _ => None,
        }
    }

    /// True for what emits nothing and tells where light comes from.
    pub fn is_portal(&self) -> bool {
        matches!(self, Self::Portal { .. })
    }

    /// Radiance, intensity or irradiance, whichever it is given in; white where a graph says it, black for a
    /// portal.
    pub fn color(&self) -> [f64; 3] {
        match *self {
            Self::Point { intensity } => intensity,
            Self::Distant { irradiance, .. } => irradiance,
            Self::Sphere { radiance, .. }
            | Self::Rect { radiance, .. }
            | Self::Disk { radiance, .. }
            | Self::Cylinder { radiance, .. }
            | Self::Dome { radiance, .. } => radiance,
            Self::ShadedDome { .. } => [1.0; 3],
            Self::Portal { .. } => [0.0; 3],
        }
    }
}
