//! The traversal loop, shared by meshes and the level of instances.
//!
//! Children that a ray enters are visited from near to far. All that is pushed is ordered by
//! distance and then by link, so the order of visits, and with it every bit of the result, is the
//! same for every instruction set.

use std::mem::MaybeUninit;
use std::ops::ControlFlow;

use super::node::{Link, Node, STACK, WIDTH};
use super::ray::{ROW, RaySetup};
use super::simd::{Lanes, Simd, prefetch};

/// A node of a tree: eight boxes, which may move, and where they lead.
pub(super) trait WideNode {
    /// Where the children are.
    fn children(&self) -> &[Link; WIDTH];

    /// The plane of each box in the row that begins `at` bytes into the planes of a [`Node`], when `share` of the
    /// tree's stretch of time has passed.
    ///
    /// # Safety
    /// `at` is where a row begins, and as for [`Lanes`].
    unsafe fn plane<F: Lanes<WIDTH>>(&self, at: usize, share: f32) -> F;
}

impl WideNode for Node {
    #[inline(always)]
    fn children(&self) -> &[Link; WIDTH] {
        &self.children
    }

    #[inline(always)]
    unsafe fn plane<F: Lanes<WIDTH>>(&self, at: usize, _share: f32) -> F {
        // SAFETY: by contract.
        unsafe { F::load(&*(&raw const self.planes).cast::<u8>().add(at).cast()) }
    }
}

/// The slab test of eight boxes: bit `i` is set where the ray meets box `i` between 0 and `t_max`;
/// `near` are the distances of entry.
///
/// 0 times infinity, NaN, stands for a ray that runs in a plane of a box; minimum and maximum then
/// return their second operand, so that the plane does not bound the ray.
///
/// # Safety
/// As for [`Lanes`].
#[inline(always)]
unsafe fn slabs<N: WideNode, F: Lanes<WIDTH>>(node: &N, share: f32, ray: &RaySetup, t_max: f32) -> (u32, F) {
    unsafe {
        let plane = |at: usize, o: F, rcp: F| node.plane::<F>(at, share).sub(o).mul(rcp);
        let (mut near, mut far) = (F::splat(0.0), F::splat(t_max));
        for axis in 0..3 {
            let (at, o) = (ray.near_planes[axis], F::splat(ray.o[axis]));
            near = plane(at, o, F::splat(ray.rcp_near[axis])).max(near);
            far = plane(at ^ ROW, o, F::splat(ray.rcp_far[axis])).min(far);
        }
        (near.le(far), near)
    }
}

/// A node or leaf that waits, and the distance at which the ray enters it in the upper half: as a
/// number, entries order by distance (which is not negative) and then by link.
type Entry = u64;

#[inline(always)]
fn entry(near: f32, link: Link) -> Entry {
    u64::from(near.to_bits()) << 32 | u64::from(link.0)
}

/// What links lead to: nodes, and blocks or instances.
pub(super) struct Links<Item, N = Node> {
    pub nodes: *const N,
    pub items: *const Item,
    /// Share of the tree's stretch of time that has passed.
    pub share: f32,
}

impl<Item, N> Links<Item, N> {
    /// A tree over what stands still.
    #[inline(always)]
    pub fn still(nodes: *const N, items: *const Item) -> Self {
        Self { nodes, items, share: 0.0 }
    }

    /// Begins to load what is visited soon: 9 % on the whole, 13 % for shuffled rays.
    #[inline(always)]
    fn prefetch(&self, link: Link) {
        if link.is_leaf() {
            prefetch(self.items.wrapping_add(link.items().0));
        } else {
            prefetch(self.nodes.wrapping_add(link.index()));
        }
    }
}

/// Pushes `first` and the children of the set bits of `hits`, the farthest first, but for the
/// nearest, which is returned. Two and three, the most frequent numbers, take no loop.
///
/// # Safety
/// `hits` is not 0 and there is room on the stack.
#[inline(always)]
unsafe fn push_all_but_nearest<Item, N: WideNode>(
    stack: &mut [MaybeUninit<Entry>; STACK],
    top: &mut usize,
    first: Entry,
    mut hits: u32,
    distances: &[f32; WIDTH],
    node: &N,
    tree: &Links<Item, N>,
) -> Entry {
    let mut next = || {
        let i = hits.trailing_zeros() as usize & (WIDTH - 1);
        hits &= hits - 1;
        tree.prefetch(node.children()[i]);
        (entry(distances[i], node.children()[i]), hits)
    };
    let bottom = *top;
    let (second, rest) = next();
    let (a, b) = (first.min(second), first.max(second));
    if rest == 0 {
        // SAFETY: there is room, by contract.
        unsafe { stack.get_unchecked_mut(bottom).write(b) };
        *top = bottom + 1;
        return a;
    }
    let (third, mut rest) = next();
    let (low, c) = (b.min(third), b.max(third));
    let (a, b) = (a.min(low), a.max(low));
    // SAFETY: as above.
    unsafe {
        stack.get_unchecked_mut(bottom).write(c);
        stack.get_unchecked_mut(bottom + 1).write(b);
    }
    *top = bottom + 2;
    let mut nearest = a;
    while rest != 0 {
        let new;
        (new, rest) = next();
        let far = nearest.max(new);
        nearest = nearest.min(new);
        let mut at = *top;
        // SAFETY: as above; the entries from `bottom` to `top` were written.
        unsafe {
            while at > bottom && stack.get_unchecked(at - 1).assume_init() < far {
                *stack.get_unchecked_mut(at) = *stack.get_unchecked(at - 1);
                at -= 1;
            }
            stack.get_unchecked_mut(at).write(far);
        }
        *top += 1;
    }
    nearest
}

/// Walks the tree below `root`. `leaf` is called for every leaf that the ray may meet before
/// `t_max(state)`; it may shorten that, or end the walk.
///
/// # Safety
/// `root` and all links below it are valid for `tree`, the tree is no deeper than
/// [`super::node::MAX_DEPTH`], and the instruction set is available.
#[inline(always)]
pub(super) unsafe fn walk<S: Simd, Item, N: WideNode, State>(
    tree: &Links<Item, N>,
    root: Link,
    ray: &RaySetup,
    state: &mut State,
    t_max: impl Fn(&State) -> f32,
    mut leaf: impl FnMut(&mut State, Link) -> ControlFlow<()>,
) {
    let mut stack = [const { MaybeUninit::<Entry>::uninit() }; STACK];
    let mut top = 0;
    let mut link = root;
    loop {
        // Go down to a leaf.
        let reached = loop {
            if link.is_leaf() {
                break true;
            }
            // SAFETY: links are valid, by contract.
            let node = unsafe { &*tree.nodes.add(link.index()) };
            // SAFETY: the instruction set is available, by contract.
            let (mut hits, near) = unsafe { slabs::<N, S::F8>(node, tree.share, ray, t_max(state)) };
            if hits == 0 {
                break false;
            }
            let first = hits.trailing_zeros() as usize & (WIDTH - 1);
            hits &= hits - 1;
            if hits == 0 {
                link = node.children()[first];
                continue;
            }
            let mut distances = [0.0; WIDTH];
            // SAFETY: as above.
            unsafe { near.store(&mut distances) };
            tree.prefetch(node.children()[first]);
            let first = entry(distances[first], node.children()[first]);
            // SAFETY: a level leaves at most WIDTH - 1 entries, and there are at most MAX_DEPTH levels.
            let nearest = unsafe { push_all_but_nearest(&mut stack, &mut top, first, hits, &distances, node, tree) };
            link = Link(nearest as u32);
        };
        if reached && leaf(state, link).is_break() {
            return;
        }
        // Take the nearest that waits and still lies before the end of the ray.
        loop {
            if top == 0 {
                return;
            }
            top -= 1;
            // SAFETY: entries below `top` were written.
            let next = unsafe { stack.get_unchecked(top).assume_init() };
            if f32::from_bits((next >> 32) as u32) <= t_max(state) {
                link = Link(next as u32);
                break;
            }
        }
    }
}
