//! The memory layout of the tree: 8-wide nodes with full `f32` bounds, and blocks of 4 triangles.
//!
//! Ingo Wald, Carsten Benthin, Solomon Boulos: *Getting Rid of Packets: Efficient SIMD
//! Single-Ray Traversal using Multi-branching BVHs*, IEEE Symposium on Interactive Ray Tracing
//! 2008. Full bounds take 256 bytes a node, of which a visit needs all at once, and no decoding.

use bytemuck::Zeroable;

use crate::math::Bounds;

/// Children of a node.
pub(super) const WIDTH: usize = 8;
/// Triangles of a block.
pub(super) const BLOCK: usize = 4;
/// Depth of the binary tree that the builder never exceeds, so that a stack of fixed size is enough.
pub(super) const MAX_DEPTH: usize = 96;
/// Entries of a traversal stack: each level leaves at most `WIDTH - 1` siblings behind.
pub(super) const STACK: usize = MAX_DEPTH * (WIDTH - 1) + 1;

/// A link to a node or to a run of leaf items (blocks of triangles, or instances).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Zeroable)]
#[repr(transparent)]
pub(super) struct Link(pub u32);

impl Link {
    const LEAF: u32 = 1 << 31;
    const COUNT_BITS: u32 = 3;
    /// Largest number of items in a leaf.
    pub const MAX_COUNT: usize = (1 << Self::COUNT_BITS) - 1;
    /// A leaf without items.
    pub const EMPTY: Self = Self(Self::LEAF);

    /// The node at `index`.
    pub fn node(index: usize) -> Self {
        assert!(index < Self::LEAF as usize, "too many nodes for one tree");
        Self(index as u32)
    }

    /// `count` leaf items from `first` on.
    pub fn leaf(first: usize, count: usize) -> Self {
        assert!(first < (Self::LEAF >> Self::COUNT_BITS) as usize, "too many leaves for one tree");
        debug_assert!(count <= Self::MAX_COUNT);
        Self(Self::LEAF | (first as u32) << Self::COUNT_BITS | count as u32)
    }

    /// True for a run of leaf items.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// Index of the node; meaningless for a leaf.
    #[inline(always)]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// First item and number of items of a leaf.
    #[inline(always)]
    pub fn items(self) -> (usize, usize) {
        (((self.0 & !Self::LEAF) >> Self::COUNT_BITS) as usize, (self.0 & ((1 << Self::COUNT_BITS) - 1)) as usize)
    }
}

/// Eight boxes and where they lead. Unused slots hold an empty box and [`Link::EMPTY`].
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Planes `min x, max x, min y, max y, min z, max z`, each of the eight children: the plane
    /// where a ray enters a slab stands in row `2 axis + (d < 0)`, the other in that row xor 1.
    pub planes: [[f32; WIDTH]; 6],
    /// Where the children are.
    pub children: [Link; WIDTH],
}

const _: () = assert!(size_of::<Node>() == 256);

impl Node {
    /// A node without children.
    pub const EMPTY: Self = {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self { planes: [low, high, low, high, low, high], children: [Link::EMPTY; WIDTH] }
    };

    /// Fills slot `i`.
    pub fn set(&mut self, i: usize, bounds: Bounds, link: Link) {
        for axis in 0..3 {
            self.planes[2 * axis][i] = bounds.min[axis];
            self.planes[2 * axis + 1][i] = bounds.max[axis];
        }
        self.children[i] = link;
    }

    /// Box of slot `i`.
    pub fn bounds(&self, i: usize) -> Bounds {
        let corner = |side: usize| {
            crate::math::Vec3::new(self.planes[side][i], self.planes[2 + side][i], self.planes[4 + side][i])
        };
        Bounds { min: corner(0), max: corner(1) }
    }
}

/// Up to four triangles, side by side. Unused lanes hold NaN, which no ray hits.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(32))]
pub(super) struct Block {
    /// `vertices[k][axis][lane]`.
    pub vertices: [[[f32; BLOCK]; 3]; 3],
    /// Index of each triangle in the list that the caller gave.
    pub triangles: [u32; BLOCK],
}

const _: () = assert!(size_of::<Block>() == 160);

impl Block {
    /// A block without triangles.
    pub const EMPTY: Self = Self { vertices: [[[f32::NAN; BLOCK]; 3]; 3], triangles: [u32::MAX; BLOCK] };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn links_keep_what_they_are_given() {
        assert_eq!(Link::leaf(12_345, 5).items(), (12_345, 5));
        assert!(Link::leaf(0, 1).is_leaf() && Link::EMPTY.is_leaf() && !Link::node(3).is_leaf());
        assert_eq!(Link::EMPTY.items(), (0, 0));
        assert_eq!(Link::node(77).index(), 77);
    }

    #[test]
    fn nodes_keep_boxes() {
        let b = Bounds { min: Vec3::new(1.0, 2.0, 3.0), max: Vec3::new(4.0, 5.0, 6.0) };
        let mut node = Node::EMPTY;
        node.set(5, b, Link::node(1));
        assert_eq!(node.bounds(5), b);
        assert!(node.bounds(4).is_empty());
    }
}
