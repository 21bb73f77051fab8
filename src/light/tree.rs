//! A tree of lights: one is chosen in proportion to what it may send to a point, roughly, in time
//! that grows with the logarithm of their number.
//!
//! After Alejandro Conty Estevez and Christopher Kulla, *Importance Sampling of Many Lights with
//! Adaptive Tree Splitting*, HPG 2018; the trail of an item as in Pharr, Jakob, Humphreys, *Physically
//! Based Rendering*, 4th edition, 12.6.3. Nodes have eight children: a choice among eight boxes goes
//! by tighter bounds than three choices among two, and vector instructions weigh them at once.

mod build;
mod cluster;
mod decay;
mod node;

use super::bounds::Asked;
use super::{Decay, LightBounds, Receiver};
use crate::math::{Bounds, ONE_MINUS_EPSILON, Vec3};
use decay::Decays;
use node::{Child, Node};

pub(super) use node::{LARGEST, Weights};

/// Bits of a trail for each level.
const STEP: u32 = 3;

/// Nodes that wait to be visited by a ray: each level leaves up to seven of its eight children.
const STACK: usize = 7 * 21 + 1;

/// A tree over items of which each has bounds.
#[derive(Clone, Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// For each item, the slots to take from the root on, lowest bits first, under a leading 1; 0 for
    /// items that do not shine.
    trails: Vec<u64>,
    /// For each node, how the lights below decay; empty where all do as in nature.
    decays: Vec<Decays>,
    bounds: LightBounds,
}

/// An item that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChosenItem {
    /// Its index.
    pub item: u32,
    /// Probability with which it was chosen, above 0.
    pub pmf: f32,
    /// A fresh uniform number, made of what the choice left of the one it took.
    pub u: f32,
}

impl LightTree {
    /// A tree over `items`; those without intensity are never chosen. `None` where none shines.
    pub fn new(items: &[LightBounds]) -> Option<Self> {
        let (nodes, bounds) = build::build(items)?;
        let mut trails = vec![0; items.len()];
        let mut waiting = vec![(0, 0_u64, 0)];
        while let Some((node, trail, level)) = waiting.pop() {
            for slot in 0..node::WIDTH {
                let trail = trail | (slot as u64) << (STEP * level);
                match nodes[node as usize].child(slot) {
                    Child::Node(i) => waiting.push((i, trail, level + 1)),
                    Child::Light(i) => trails[i as usize] = trail | 1 << (STEP * (level + 1)),
                    Child::None => {}
                }
            }
        }
        Some(Self { nodes, trails, decays: Vec::new(), bounds })
    }

    /// A tree over `items` with a decay each.
    pub(super) fn decaying(items: &[LightBounds], decays: &[Decay]) -> Option<Self> {
        let tree = Self::new(items)?;
        let size = tree.bounds.bounds.extent().length();
        let decays = decay::of_nodes(&tree.nodes, items, decays, size);
        Some(Self { decays, ..tree })
    }

    /// Bounds of everything.
    pub fn bounds(&self) -> &LightBounds {
        &self.bounds
    }

    /// A few boxes that hold everything.
    pub(super) fn boxes(&self) -> impl Iterator<Item = Bounds> {
        self.nodes[0].boxes()
    }

    /// Unoccluded irradiance of all items at `at`, roughly; 0 only where none can arrive.
    pub fn importance(&self, at: &Receiver) -> f32 {
        self.weigh(&Asked::new(at.p, at.n, Vec3::ZERO)).sum
    }

    /// Chooses an item for `at` by `u`; `None` where none can reach it.
    pub fn sample(&self, at: &Receiver, u: f32) -> Option<ChosenItem> {
        let asked = Asked::new(at.p, at.n, Vec3::ZERO);
        self.sample_from(&asked, &self.weigh(&asked), refined(u, &asked, 0))
    }

    /// Probability with which [`LightTree::sample`] chooses `item`.
    pub fn pmf(&self, at: &Receiver, item: u32) -> f32 {
        self.pmf_of(&Asked::new(at.p, at.n, Vec3::ZERO), item)
    }

    /// Odds of the root's children.
    pub(super) fn weigh(&self, at: &Asked) -> Weights {
        self.weigh_node(0, at)
    }

    #[inline]
    fn weigh_node(&self, node: usize, at: &Asked) -> Weights {
        self.nodes[node].weigh(at, self.decays.get(node))
    }

    pub(super) fn sample_from(&self, at: &Asked, root: &Weights, u: f64) -> Option<ChosenItem> {
        let (mut node, mut weights) = (0, *root);
        let (mut pmf, mut u) = (1.0_f32, u);
        loop {
            let (slot, share, rest) = weights.choose(u)?;
            (pmf, u) = (pmf * share, rest);
            match self.nodes[node].child(slot) {
                Child::Light(item) => {
                    let u = (u as f32).min(ONE_MINUS_EPSILON);
                    return Some(ChosenItem { item, pmf: pmf.max(f32::MIN_POSITIVE), u });
                }
                Child::Node(i) => node = i as usize,
                Child::None => return None,
            }
            weights = self.weigh_node(node, at);
        }
    }

    pub(super) fn pmf_of(&self, at: &Asked, item: u32) -> f32 {
        let mut trail = self.trails[item as usize];
        let (mut node, mut pmf) = (0, 1.0_f32);
        while trail > 1 {
            let slot = (trail & 7) as usize;
            let share = self.weigh_node(node, at).pmf(slot);
            if share == 0.0 {
                return 0.0;
            }
            pmf *= share;
            match self.nodes[node].child(slot) {
                Child::Node(i) => node = i as usize,
                Child::Light(_) | Child::None => return pmf.max(f32::MIN_POSITIVE),
            }
            trail >>= STEP;
        }
        0.0
    }

    /// Calls `visit` with every item whose box the ray from `p` along `wi` meets before `t_max`, in an
    /// order that depends on the tree alone.
    pub fn along(&self, p: Vec3, wi: Vec3, t_max: f32, mut visit: impl FnMut(u32)) {
        let inverse = wi.recip();
        let (mut stack, mut waiting) = ([0_u32; STACK], 1);
        while waiting > 0 {
            waiting -= 1;
            let node = stack[waiting];
            self.nodes[node as usize].along(p, inverse, t_max, |child| match child {
                Child::Node(i) => {
                    stack[waiting] = i;
                    waiting += 1;
                }
                Child::Light(item) => visit(item),
                Child::None => {}
            });
        }
    }

    /// Memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let (nodes, trails) = (self.nodes.as_slice(), self.trails.as_slice());
        std::mem::size_of_val(nodes) + std::mem::size_of_val(trails) + std::mem::size_of_val(self.decays.as_slice())
    }
}

/// `u` with more bits than the 24 that it was drawn with, since a choice among a million takes 20 of
/// them: the rest is a hash of it, of the receiver and of `salt`. So each receiver has a grid of its
/// own, and no light falls between the points of all.
pub(super) fn refined(u: f32, at: &Asked, salt: u32) -> f64 {
    let mut x = at.bits() ^ (u64::from(u.to_bits()) << 32 | u64::from(salt));
    // The finalizer of SplitMix64.
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    const GRID: f64 = 1.0 / (1_u64 << 24) as f64;
    (f64::from(u) + (x >> 40) as f64 * (GRID * GRID)).min(LARGEST)
}
