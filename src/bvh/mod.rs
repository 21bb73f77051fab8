//! The acceleration structure: what does a ray hit?
//!
//! Two levels: a [`Blas`] holds the triangles of one mesh or the round cones of one set of strands and
//! balls in object space, a [`Bvh`] places instances of them. Both are trees of 8-wide nodes (`node.rs`) built by the surface area
//! heuristic (`build/`) and walked by code that is compiled per instruction set and chosen at run
//! time (`kernel.rs`, [`Isa`]); all of them, the scalar one included, give the same bits. The
//! triangle test is watertight (`triangle.rs`), round cones are decided in `f64` (`round.rs`). What
//! moves has code of its own: shapes nodes whose boxes move (`moving.rs`), instances a transform for each ray
//! (`placed.rs`).
//!
//! This and the foreign-function files are the only places of `unsafe` in the crate; the interface is safe.

#![allow(unsafe_code)]

mod blas;
mod buffer;
mod build;
mod isa;
mod kernel;
mod moving;
mod node;
mod placed;
mod ray;
mod round;
mod simd;
mod top;
mod triangle;
mod walk;

pub use blas::Blas;
pub use isa::Isa;
pub use top::Bvh;

use std::sync::Arc;

use crate::math::{Affine3A, MovingTransform};

/// A shape placed in render space.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index of the shape in the list given to [`Bvh::build`].
    pub blas: u32,
    /// From object to render space.
    pub object_to_render: Affine3A,
    /// The same at the time of a ray, where it changes.
    pub motion: Option<Arc<MovingTransform>>,
    /// A ray sees the instance if its own mask shares a bit with this one.
    pub mask: u64,
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction.
    pub t: f32,
    /// On a triangle the weight of the second vertex: `p = (1 - u - v) p0 + u p1 + v p2`. On a round
    /// cone, with `v`, what [`crate::math::RoundCone::point`] takes.
    pub u: f32,
    /// Weight of the third vertex.
    pub v: f32,
    /// Index in the list of instances given to [`Bvh::build`].
    pub instance: u32,
    /// Index in the list of triangles given to [`Blas::build`], or of segments or balls to
    /// [`Blas::rounds`].
    pub primitive: u32,
}
