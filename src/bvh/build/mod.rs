//! From boxes to a tree of 8-wide nodes: a binary tree by the surface area heuristic
//! (`binary.rs`), then collapsed (`collapse.rs`). The result depends on the input only, not on the
//! number of threads.

mod binary;
mod collapse;

pub(super) use collapse::Wide;
use collapse::collapse;

use crate::math::{Bounds, Vec3A};

/// Something with a box: a triangle or an instance.
#[derive(Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Primitive {
    min: [f32; 3],
    /// Index in the caller's list.
    pub index: u32,
    max: [f32; 3],
    unused: u32,
}

impl Primitive {
    /// The primitive `index` with its box, which is finite and not empty.
    pub fn new(bounds: Bounds, index: u32) -> Self {
        Self { min: bounds.min.to_array(), index, max: bounds.max.to_array(), unused: 0 }
    }

    fn bounds(&self) -> Box3 {
        Box3 { min: Vec3A::from_array(self.min), max: Vec3A::from_array(self.max) }
    }

    /// Twice the middle of the box.
    fn center2(&self) -> Vec3A {
        Vec3A::from_array(self.min) + Vec3A::from_array(self.max)
    }
}

/// [`Bounds`] on vector registers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Box3 {
    min: Vec3A,
    max: Vec3A,
}

impl Box3 {
    const EMPTY: Self = Self { min: Vec3A::INFINITY, max: Vec3A::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half of the surface area; of an empty box 0.
    fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3A::ZERO);
        e.x * (e.y + e.z) + e.y * e.z
    }
}

impl From<Box3> for Bounds {
    fn from(b: Box3) -> Self {
        Self { min: b.min.into(), max: b.max.into() }
    }
}

/// What a leaf costs, and how many primitives it may hold.
#[derive(Clone, Copy)]
pub(super) struct LeafRule {
    /// Primitives that one test takes at a time.
    pub block: usize,
    /// Most primitives in a leaf.
    pub max: usize,
    /// Cost of a test of one block, in visits of a node.
    pub cost: f32,
}

impl LeafRule {
    fn blocks(self, count: usize) -> f32 {
        count.div_ceil(self.block) as f32
    }
}

/// The tree over `primitives`, which are reordered so that those of each leaf stand side by side.
pub(super) fn build(primitives: &mut [Primitive], rule: LeafRule) -> Wide {
    collapse(&binary::build(primitives, rule), rule)
}
