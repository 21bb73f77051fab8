//! Emitters: one file each, one list, and the choice among them.
//!
//! Adding a light = its file here, a line in [`emitters!`], a variant in `desc/light.rs`, and a
//! line in `tests/lights.rs`.

mod distant;
mod dome;
mod mesh;
mod point;
mod select;
mod spot;

pub use distant::Distant;
pub use dome::{Dome, DomeImage};
pub use mesh::{Emission, EmissiveTriangle, MeshLight};
pub use point::Point;
pub use select::{Choice, LightSet};
pub use spot::Spot;

use crate::math::{Bounds, Rgb, Vec3};

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
#[derive(Clone, Copy, Debug)]
pub struct EmitterHit {
    /// Distance from the ray's origin along its unit direction.
    pub dist: f32,
    /// Geometric normal there, unit.
    pub ng: Vec3,
    /// Which triangle of a mesh.
    pub triangle: u32,
}

/// What the engine asks of a light. Points and directions are in render space.
pub trait Emitter {
    /// Chooses a point of the light as seen from `p`. `None` where nothing can arrive.
    fn sample_li(&self, p: Vec3, uc: f32, u: [f32; 2]) -> Option<LightSample>;

    /// Density in solid angle with which [`Emitter::sample_li`] from `p` chooses direction `wi`,
    /// where a ray along it meets the light at `at`; 0 for delta lights.
    fn pdf_li(&self, p: Vec3, wi: Vec3, at: Option<&EmitterHit>) -> f32;

    /// Radiance of the background along `wi`, for lights that are there; black for the others,
    /// whose emission is that of the surface that a ray hits.
    fn le(&self, _wi: Vec3) -> Rgb {
        Rgb::BLACK
    }

    /// True for a light that a ray sees where it leaves the scene.
    fn in_background(&self) -> bool {
        false
    }

    /// Unoccluded irradiance that may arrive around `p`, roughly: decides how often the light is
    /// chosen. Positive wherever the light can reach.
    fn importance(&self, p: Vec3) -> f32;

    /// Emitted power in W, luminance; for far lights the power that reaches `scene`.
    fn power(&self, scene: Bounds) -> f32;
}

/// The list of emitters: an enum that passes each question on to its variant.
macro_rules! emitters {
    ($($name:ident),+) => {
        /// Any emitter.
        #[derive(Clone, Debug)]
        pub enum Light {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name),)+
        }

        impl Emitter for Light {
            fn sample_li(&self, p: Vec3, uc: f32, u: [f32; 2]) -> Option<LightSample> {
                match self { $(Self::$name(light) => light.sample_li(p, uc, u),)+ }
            }
            fn pdf_li(&self, p: Vec3, wi: Vec3, at: Option<&EmitterHit>) -> f32 {
                match self { $(Self::$name(light) => light.pdf_li(p, wi, at),)+ }
            }
            fn le(&self, wi: Vec3) -> Rgb {
                match self { $(Self::$name(light) => light.le(wi),)+ }
            }
            fn in_background(&self) -> bool {
                match self { $(Self::$name(light) => light.in_background(),)+ }
            }
            fn importance(&self, p: Vec3) -> f32 {
                match self { $(Self::$name(light) => light.importance(p),)+ }
            }
            fn power(&self, scene: Bounds) -> f32 {
                match self { $(Self::$name(light) => light.power(scene),)+ }
            }
        }

        $(impl From<$name> for Light {
            fn from(light: $name) -> Self {
                Self::$name(light)
            }
        })+
    };
}

emitters!(Point, Spot, Distant, Dome, MeshLight);

/// KHR_lights_punctual's window: the factor that brings a light to 0 at `range`,
/// `clamp(1 − (d/range)⁴, 0, 1)`; 1 where the range is infinite.
fn range_window(dist: f32, range: f32) -> f32 {
    if range.is_finite() { (1.0 - (dist / range).powi(4)).clamp(0.0, 1.0) } else { 1.0 }
}
