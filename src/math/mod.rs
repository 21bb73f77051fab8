//! The leaf that every room stands on: vectors, frames, rays, boxes and colour.
//!
//! Vectors are `glam`'s. Traced data is `f32` ([`Vec3`]); authored transforms are `f64`
//! ([`DAffine3`]) until `scene/prepare.rs` moves them to render space.

mod bounds;
mod cluster;
mod digest;
mod frame;
mod motion;
mod normal;
mod ray;
mod rgb;
mod round;
mod scalar;
mod srgb;
mod transform;

pub use bounds::Bounds;
pub use cluster::Cluster;
pub use digest::Digest;
pub use frame::{Frame, orthonormal_pair};
pub use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec2, DVec3, Mat3, Mat3A, Vec2, Vec3, Vec3A, Vec4};
pub use motion::{MovingTransform, Times, traced};
pub use normal::normal_quantile;
pub use ray::{Ray, offset_ray_origin};
pub use rgb::Rgb;
pub use round::{Ball, Foot, RoundCone, RoundPoint, center_of, share_of};
pub use scalar::{ONE_MINUS_EPSILON, gamma, safe_acos, safe_sqrt, sqr};
pub use srgb::{srgb_to_linear, srgb_to_linear_f64};
pub use transform::place_point;
