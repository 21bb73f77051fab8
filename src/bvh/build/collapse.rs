//! From the binary tree to 8-wide nodes, by dynamic programming: which subtrees become leaves and
//! which binary nodes vanish into their wide parent so that the expected cost of a ray is least.
//!
//! Henri Ylitie, Tero Karras, Samuli Laine: *Efficient Incoherent Ray Traversal on GPUs Through
//! Compressed Wide BVHs*, High-Performance Graphics 2017, section 4.1. `C(n, i)` is the cost of the
//! subtree `n` as a forest of at most `i` trees:
//!
//! `C(n, 1) = min(area(n) blocks(n) cost_leaf, area(n) + D(n, 8))`,
//! `C(n, i) = min(C(n, i - 1), D(n, i))`, `D(n, i) = min over k of C(left, k) + C(right, i - k)`.

use super::LeafRule;
use super::binary::Binary;
use crate::bvh::buffer::Buffer;
use crate::bvh::node::{Link, Node, WIDTH};
use crate::math::Bounds;

/// The finished tree.
pub(in crate::bvh) struct Wide {
    pub nodes: Buffer<Node>,
    pub root: Link,
    pub bounds: Bounds,
    /// First primitive and number of primitives of each leaf item, `LeafRule::block` at most.
    pub items: Vec<(u32, u32)>,
}

/// `C(n, 1)` to `C(n, 7)`.
type Costs = [f32; WIDTH - 1];

/// Below this many primitives a subtree is not worth a task.
const TASK: usize = 8192;

/// Collapses the tree `binary`.
pub(super) fn collapse(binary: &[Binary], rule: LeafRule) -> Wide {
    let Some(root) = binary.first() else {
        return Wide { nodes: Buffer::zeroed(0), root: Link::EMPTY, bounds: Bounds::EMPTY, items: Vec::new() };
    };
    let mut costs = vec![[0.0; WIDTH - 1]; binary.len()];
    price(binary, &mut costs, rule);
    let mut emitter = Emitter { binary, costs: &costs, rule, nodes: Vec::new(), items: Vec::new() };
    let link = emitter.emit(0);
    let mut nodes = Buffer::zeroed(emitter.nodes.len());
    nodes.copy_from_slice(&emitter.nodes);
    Wide { nodes, root: link, bounds: root.bounds.into(), items: emitter.items }
}

/// `min over k of C(left, k) + C(right, trees - k)`, and the best `k`.
fn distribute(left: &Costs, right: &Costs, trees: usize) -> (f32, usize) {
    let mut best = (f32::INFINITY, 1);
    for k in 1..trees {
        let cost = left[k - 1] + right[trees - k - 1];
        if cost < best.0 {
            best = (cost, k);
        }
    }
    best
}

fn leaf_cost(node: &Binary, rule: LeafRule) -> f32 {
    let count = node.count as usize;
    if count > rule.max { f32::INFINITY } else { node.bounds.half_area() * rule.blocks(count) * rule.cost }
}

/// Fills in the costs of a subtree, bottom up.
fn price(binary: &[Binary], costs: &mut [Costs], rule: LeafRule) {
    let node = &binary[0];
    let as_leaf = leaf_cost(node, rule);
    if node.second == 0 {
        costs[0] = [as_leaf; WIDTH - 1];
        return;
    }
    let (own, below) = costs.split_first_mut().expect("as many costs as nodes");
    let (left, right) = below.split_at_mut(node.second as usize - 1);
    if node.count as usize >= TASK {
        rayon::join(|| price(&binary[1..], left, rule), || price(&binary[node.second as usize..], right, rule));
    } else {
        price(&binary[1..], left, rule);
        price(&binary[node.second as usize..], right, rule);
    }
    own[0] = as_leaf.min(node.bounds.half_area() + distribute(&left[0], &right[0], WIDTH).0);
    for trees in 2..WIDTH {
        own[trees - 1] = own[trees - 2].min(distribute(&left[0], &right[0], trees).0);
    }
}

struct Emitter<'a> {
    binary: &'a [Binary],
    costs: &'a [Costs],
    rule: LeafRule,
    nodes: Vec<Node>,
    items: Vec<(u32, u32)>,
}

impl Emitter<'_> {
    /// Emits the binary node `n` as one tree, children before their own subtrees, and returns where it is.
    fn emit(&mut self, n: usize) -> Link {
        let node = &self.binary[n];
        if leaf_cost(node, self.rule) <= self.costs[n][0] {
            return self.leaf(node.first, node.count);
        }
        let mut children = [0; WIDTH];
        let mut len = 0;
        self.gather_split(n, WIDTH, &mut children, &mut len);
        let at = self.nodes.len();
        self.nodes.push(Node::EMPTY);
        for (slot, &child) in children[..len].iter().enumerate() {
            let link = self.emit(child);
            self.nodes[at].set(slot, self.binary[child].bounds.into(), link);
        }
        Link::node(at)
    }

    /// Adds the roots of the forest of at most `trees` trees that stands for subtree `n`.
    fn gather(&self, n: usize, trees: usize, children: &mut [usize; WIDTH], len: &mut usize) {
        let costs = &self.costs[n];
        let mut trees = trees.min(WIDTH - 1);
        while trees > 1 && costs[trees - 1] == costs[trees - 2] {
            trees -= 1;
        }
        if trees == 1 {
            children[*len] = n;
            *len += 1;
        } else {
            self.gather_split(n, trees, children, len);
        }
    }

    fn gather_split(&self, n: usize, trees: usize, children: &mut [usize; WIDTH], len: &mut usize) {
        let (left, right) = (n + 1, n + self.binary[n].second as usize);
        let (_, k) = distribute(&self.costs[left], &self.costs[right], trees);
        self.gather(left, k, children, len);
        self.gather(right, trees - k, children, len);
    }

    fn leaf(&mut self, first: u32, count: u32) -> Link {
        let block = self.rule.block as u32;
        let at = self.items.len();
        let mut done = 0;
        while done < count {
            let n = block.min(count - done);
            self.items.push((first + done, n));
            done += n;
        }
        Link::leaf(at, self.items.len() - at)
    }
}
