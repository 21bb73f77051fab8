//! What a program asks of the place where a ray met a surface.

use crate::desc::graph::{Layer, Leaf, Quantity, Space, Value};
use crate::texture::TextureRef;

/// A point beside the hit: so many widths of the ray's footprint along two directions of the surface that are
/// square to each other, on the plane of the triangle.
pub type Beside = [f32; 2];

/// The hit itself.
pub const HERE: Beside = [0.0; 2];

/// A place where a ray met a surface. Whatever is asked is worked out then: what no program asks costs
/// nothing.
pub trait Hit {
    /// What is known there. Attributes are asked by [`Hit::attribute`].
    fn leaf(&self, leaf: &Leaf, at: Beside) -> Value;

    /// The named attribute `slot` of the mesh or object; `None` where neither has it.
    fn attribute(&self, slot: u16, at: Beside) -> Option<Value>;

    /// An image by a UV set of the mesh, filtered by the footprint at the hit.
    fn texture(&self, texture: &TextureRef, at: Beside) -> [f32; 4];

    /// A point, vector or normal taken from one space to another.
    fn transform(&self, quantity: Quantity, from: Space, to: Space, value: Value) -> Value;

    /// What a layer throws back towards whoever looks, of white light that comes from everywhere; see
    /// [`crate::desc::graph::Op::Albedo`]. `normal` is in world space.
    /// Nothing lies over a lamp or a world.
    fn albedo(&self, _layer: Layer, _roughness: f64, _ior: f64, _normal: Value) -> f64 {
        0.0
    }

    /// The two directions of [`Beside`], as long as the footprint is wide, world space.
    fn footprint(&self) -> [Value; 2];
}

/// What lamps and worlds answer to what only meshes and objects have.
pub fn of_no_object(leaf: &Leaf) -> Value {
    match leaf {
        Leaf::Uv(_) => [0.0, 0.0, 0.0, 1.0],
        Leaf::Attribute { fallback, .. } => *fallback,
        Leaf::VertexColor | Leaf::ObjectColor => [1.0; 4],
        _ => [0.0; 4],
    }
}

/// Whether what is known at a hit is another thing beside it.
pub(super) fn varies(leaf: &Leaf) -> bool {
    match leaf {
        Leaf::Position
        | Leaf::Parametric
        | Leaf::ObjectPosition
        | Leaf::ObjectNormal
        | Leaf::Generated
        | Leaf::CameraPosition
        | Leaf::Window
        | Leaf::Uv(_)
        | Leaf::Attribute { .. }
        | Leaf::VertexColor
        | Leaf::SmoothNormal => true,
        Leaf::Normal
        | Leaf::TrueNormal
        | Leaf::Incoming
        | Leaf::RadialTangent
        | Leaf::Backfacing
        | Leaf::Tangent
        | Leaf::ObjectLocation
        | Leaf::ObjectColor
        | Leaf::ObjectIndex
        | Leaf::ObjectRandom
        | Leaf::MaterialIndex
        | Leaf::Path(_) => false,
    }
}

/// Whether it is a number, which stands in all four places.
pub(super) fn is_number(leaf: &Leaf) -> bool {
    matches!(leaf, Leaf::Backfacing | Leaf::ObjectIndex | Leaf::ObjectRandom | Leaf::MaterialIndex | Leaf::Path(_))
}

/// Whether it goes by where the surface is seen from.
pub(super) fn sees(leaf: &Leaf) -> bool {
    match leaf {
        Leaf::Normal
        | Leaf::TrueNormal
        | Leaf::Incoming
        | Leaf::RadialTangent
        | Leaf::Backfacing
        | Leaf::ObjectNormal
        | Leaf::Path(_) => true,
        Leaf::Position
        | Leaf::Parametric
        | Leaf::ObjectPosition
        | Leaf::Generated
        | Leaf::CameraPosition
        | Leaf::Window
        | Leaf::Uv(_)
        | Leaf::Attribute { .. }
        | Leaf::VertexColor
        | Leaf::SmoothNormal
        | Leaf::Tangent
        | Leaf::ObjectLocation
        | Leaf::ObjectColor
        | Leaf::ObjectIndex
        | Leaf::ObjectRandom
        | Leaf::MaterialIndex => false,
    }
}
