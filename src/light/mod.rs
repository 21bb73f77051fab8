//! Emitters: one file each, one list, and the choice among them.
//!
//! Adding a light = its file here, a line in [`emitters!`], a variant in `desc/light.rs` and its
//! translation in `scene/prepare/lamp.rs`, and a file in `tests/lights/`.

mod aim;
mod bounds;
mod choice;
mod cylinder;
mod disk;
mod distant;
mod dome;
mod emission;
mod flat;
mod mesh;
mod placed;
mod point;
mod profile;
mod rect;
mod rounds;
mod rules;
mod select;
mod shadow_look;
mod sphere;
mod spread;
mod tree;

pub use bounds::LightBounds;
pub use choice::{Choice, Strategy};
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use distant::Distant;
pub use dome::{Dome, DomeImage, DomeRadiance, Portal, Portals};
pub use emission::Emission;
pub use flat::Flat;
pub use mesh::{MeshEmitters, MeshLight};
pub use point::Point;
pub use profile::{Cone, Decay, Drawn, Falloff, Ies, Profile, Shaping};
pub use rect::Rect;
pub use rounds::{RoundEmitters, RoundLight};
pub use rules::{Light, Rules, Seen, Shadow};
pub use select::LightSet;
pub use shadow_look::ShadowLook;
pub use sphere::Sphere;
pub use spread::Spread;
pub use tree::{ChosenItem, LightTree};

use crate::math::{Bounds, Rgb, Vec3, gamma, offset_ray_origin};

/// A point that asks for light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// Render space.
    pub p: Vec3,
    /// Unit normal of the side from which light can be scattered; `None` where it can come from any.
    pub n: Option<Vec3>,
    /// Which of the classes of receivers that light linking tells apart.
    pub class: u16,
    /// True where light sampling is the only strategy: any light that may reach the point must then
    /// have a density above 0. Else directions that the surface samples find the light, too, and
    /// light sampling may leave to them what they do better (MIS compensation, Karlík et al. 2019).
    pub alone: bool,
    /// When it asks, 0 to 1 within the shutter.
    pub time: f32,
}

/// What a light sends to a point, as sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// Radiance that arrives unoccluded, W·sr⁻¹·m⁻²; for a delta light the irradiance on a surface
    /// that faces it, so that `li · f · cos / pdf` holds with `pdf = 1`.
    pub li: Rgb,
    /// Unit direction to the light.
    pub wi: Vec3,
    /// Where a shadow ray ends: a point just before the light, by more than rounding has moved it;
    /// `None` for lights infinitely far away along `wi`.
    pub end: Option<Vec3>,
    /// Density in solid angle; 1 for a delta light.
    pub pdf: f32,
    /// True where no other strategy can find the light, so that the sample has MIS weight 1.
    pub delta: bool,
}

/// A point on an emitter that a ray has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmitterHit {
    /// Distance from the receiver along the ray's unit direction.
    pub dist: f32,
    /// Geometric normal there, unit.
    pub ng: Vec3,
    /// Which triangle of a mesh, or segment of strands.
    pub triangle: u32,
    /// Where on the emitter: barycentrics of a mesh's triangle, coordinates on a round cone, texture
    /// coordinates of a lamp.
    pub uv: [f32; 2],
}

/// What the engine asks of a light. Points and directions are in render space.
///
/// Emitters are of three kinds: *lamps* have a shape of their own, which a ray meets by
/// [`Emitter::hit`]; *background* lights are infinitely far away; a *mesh* light's triangles, or a *round*
/// light's segments, are those of an object in the scene. Lamps never stop light.
pub trait Emitter {
    /// Chooses a point of the light as seen from `at`, by one number and a point. `None` where the
    /// point chosen sends nothing.
    fn sample_li(&self, at: &Receiver, uc: f32, u: [f32; 2]) -> Option<LightSample>;

    /// Density in solid angle with which [`Emitter::sample_li`] at `at` chooses direction `wi`, where
    /// a ray along it meets the light at `hit` (`None` for background lights); 0 for delta lights.
    fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32;

    /// Where a ray from `p` along the unit direction `wi` meets a lamp; `None` where it misses, meets a
    /// dark side, or the light is no lamp.
    fn hit(&self, _p: Vec3, _wi: Vec3) -> Option<EmitterHit> {
        None
    }

    /// Radiance that a ray along `wi` gets from a lamp that it has met at `hit`, or from a background
    /// light (`None`). Black for mesh and round lights, whose emission is the surface's.
    fn le(&self, _wi: Vec3, _hit: Option<&EmitterHit>) -> Rgb {
        Rgb::BLACK
    }

    /// True for a light that a ray sees where it leaves the scene.
    fn in_background(&self) -> bool {
        false
    }

    /// Where it is and where it shines; `None` for lights infinitely far away.
    fn bounds(&self) -> Option<LightBounds>;

    /// How it decays with distance.
    fn decay(&self) -> Decay {
        Decay::PHYSICAL
    }

    /// Unoccluded irradiance that light sampling may bring to `at`, roughly: decides how often the
    /// light is chosen. Positive wherever [`Emitter::sample_li`] can give light.
    fn importance(&self, at: &Receiver) -> f32;

    /// Emitted power in W, luminance; for far lights the power that reaches `scene`.
    fn power(&self, scene: Bounds) -> f32;
}

/// The list of emitters: an enum that passes each question on to its variant.
macro_rules! emitters {
    ($($name:ident),+ $(,)?) => {
        /// Any emitter.
        #[derive(Clone, Debug)]
        pub enum AnyEmitter {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name),)+
        }

        impl Emitter for AnyEmitter {
            fn sample_li(&self, at: &Receiver, uc: f32, u: [f32; 2]) -> Option<LightSample> {
                match self { $(Self::$name(light) => light.sample_li(at, uc, u),)+ }
            }
            fn pdf_li(&self, at: &Receiver, wi: Vec3, hit: Option<&EmitterHit>) -> f32 {
                match self { $(Self::$name(light) => light.pdf_li(at, wi, hit),)+ }
            }
            fn hit(&self, p: Vec3, wi: Vec3) -> Option<EmitterHit> {
                match self { $(Self::$name(light) => light.hit(p, wi),)+ }
            }
            fn le(&self, wi: Vec3, hit: Option<&EmitterHit>) -> Rgb {
                match self { $(Self::$name(light) => light.le(wi, hit),)+ }
            }
            fn in_background(&self) -> bool {
                match self { $(Self::$name(light) => light.in_background(),)+ }
            }
            fn bounds(&self) -> Option<LightBounds> {
                match self { $(Self::$name(light) => light.bounds(),)+ }
            }
            fn decay(&self) -> Decay {
                match self { $(Self::$name(light) => light.decay(),)+ }
            }
            fn importance(&self, at: &Receiver) -> f32 {
                match self { $(Self::$name(light) => light.importance(at),)+ }
            }
            fn power(&self, scene: Bounds) -> f32 {
                match self { $(Self::$name(light) => light.power(scene),)+ }
            }
        }

        $(impl From<$name> for AnyEmitter {
            fn from(light: $name) -> Self {
                Self::$name(light)
            }
        })+
    };
}

emitters!(
    Point, // a delta
    Sphere, Cylinder, Rect, Disk, // lamps
    Distant, Dome, MeshLight, RoundLight,
);

impl AnyEmitter {
    /// True for a light with a shape of its own, which rays find by [`Emitter::hit`] alone.
    pub fn is_lamp(&self) -> bool {
        use AnyEmitter as E;
        !matches!(self, E::Point(_) | E::Distant(_) | E::Dome(_) | E::MeshLight(_) | E::RoundLight(_))
    }
}

/// Where a shadow ray from `p` along `wi` to the point `on_light` of a surface, `dist` away, ends: before
/// it by more than rounding has moved either, and still before `p` where the light almost touches it.
/// `ng` is the normal there.
fn end_before(on_light: Vec3, p: Vec3, ng: Vec3, wi: Vec3, dist: f64) -> Vec3 {
    let rounding = gamma(8) * on_light.abs().max_element().max(p.abs().max_element());
    offset_ray_origin(on_light, Vec3::splat(rounding.min(0.25 * dist as f32)), ng, -wi)
}

impl Receiver {
    /// A point that light can reach from any side, lit by all lights, whose light the directions that
    /// a surface samples find, too.
    pub fn everywhere(p: Vec3) -> Self {
        Self { p, n: None, class: 0, alone: false, time: 0.0 }
    }
}
