//! Eight children side by side: weighed in one loop that compiles to vector instructions.

use super::decay::Decays;
use crate::light::bounds::{Asked, Lobe};
use crate::math::{Bounds, Vec3};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Each child has at least this share of the weight of all that have any: a bound that is wrong by
/// orders of magnitude then costs noise, not fireflies.
const LEAST_SHARE: f32 = 1.0 / 4096.0;

/// Set in the index of a child that is a light.
const LEAF: u32 = 1 << 31;

/// What a child is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    /// Another node, by its index.
    Node(u32),
    /// A light, by its index.
    Light(u32),
    /// Nothing.
    None,
}

/// Up to [`WIDTH`] children and their bounds.
#[derive(Clone, Debug)]
pub(super) struct Node {
    center: [[f32; WIDTH]; 3],
    half: [[f32; WIDTH]; 3],
    axis: [[f32; WIDTH]; 3],
    cos_normals: [f32; WIDTH],
    cos_cone: [f32; WIDTH],
    intensity: [f32; WIDTH],
    mean_normal: [f32; WIDTH],
    isotropic: [f32; WIDTH],
    child: [u32; WIDTH],
}

/// Odds of a node's children at a receiver.
#[derive(Clone, Copy, Debug)]
pub(in crate::light) struct Weights {
    odds: [f32; WIDTH],
    /// Sum of the odds, in order.
    total: f64,
    /// Sum of what may arrive.
    pub sum: f32,
}

impl Node {
    pub const EMPTY: Self = Self {
        center: [[0.0; WIDTH]; 3],
        half: [[0.0; WIDTH]; 3],
        axis: [[0.0; WIDTH]; 3],
        cos_normals: [-1.0; WIDTH],
        cos_cone: [-1.0; WIDTH],
        intensity: [0.0; WIDTH],
        mean_normal: [0.0; WIDTH],
        isotropic: [0.0; WIDTH],
        child: [u32::MAX; WIDTH],
    };

    pub fn set(&mut self, slot: usize, lobe: &Lobe, child: Child) {
        for axis in 0..3 {
            self.center[axis][slot] = lobe.center[axis];
            self.half[axis][slot] = lobe.half[axis];
            self.axis[axis][slot] = lobe.axis[axis];
        }
        self.cos_normals[slot] = lobe.cos_normals;
        self.cos_cone[slot] = lobe.cos_cone;
        self.intensity[slot] = lobe.intensity;
        self.mean_normal[slot] = lobe.mean_normal;
        self.isotropic[slot] = lobe.isotropic;
        self.child[slot] = match child {
            Child::Node(i) => i,
            Child::Light(i) => i | LEAF,
            Child::None => u32::MAX,
        };
    }

    /// Child `slot`.
    pub fn child(&self, slot: usize) -> Child {
        match self.child[slot] {
            u32::MAX => Child::None,
            i if i & LEAF != 0 => Child::Light(i & !LEAF),
            i => Child::Node(i),
        }
    }

    /// Boxes of the children.
    pub fn boxes(&self) -> impl Iterator<Item = Bounds> {
        let vector = |v: &[[f32; WIDTH]; 3], i: usize| Vec3::new(v[0][i], v[1][i], v[2][i]);
        (0..WIDTH).filter(|&i| self.child[i] != u32::MAX).map(move |i| {
            let (center, half) = (vector(&self.center, i), vector(&self.half, i));
            Bounds { min: center - half, max: center + half }
        })
    }

    /// Moves the indices of inner children, after nodes have moved.
    pub fn shift(&mut self, by: u32) {
        for child in self.child.iter_mut().filter(|child| **child & LEAF == 0) {
            *child += by;
        }
    }

    #[inline(always)]
    pub fn lobe(&self, i: usize) -> Lobe {
        Lobe {
            center: [self.center[0][i], self.center[1][i], self.center[2][i]],
            half: [self.half[0][i], self.half[1][i], self.half[2][i]],
            axis: [self.axis[0][i], self.axis[1][i], self.axis[2][i]],
            cos_normals: self.cos_normals[i],
            cos_cone: self.cos_cone[i],
            intensity: self.intensity[i],
            mean_normal: self.mean_normal[i],
            isotropic: self.isotropic[i],
        }
    }

    /// Odds of the children at `at`, whose lights decay by `decays` or as in nature.
    #[inline]
    pub fn weigh(&self, at: &Asked, decays: Option<&Decays>) -> Weights {
        let mut odds = [0.0; WIDTH];
        for (i, odds) in odds.iter_mut().enumerate() {
            *odds = self.lobe(i).importance(at);
        }
        if let Some(decays) = decays {
            decays.apply(self, at, &mut odds);
        }
        let sum: f32 = odds.iter().sum();
        let least = sum * LEAST_SHARE;
        let mut total = 0.0;
        for odds in &mut odds {
            *odds = if *odds > 0.0 && *odds < least { least } else { *odds };
            total += f64::from(*odds);
        }
        Weights { odds, total, sum }
    }

    /// Calls `visit` with every child whose box the ray from `p` along a direction with the
    /// reciprocal `inverse` meets before `t_max`.
    #[inline]
    pub fn along(&self, p: Vec3, inverse: Vec3, t_max: f32, mut visit: impl FnMut(Child)) {
        let mut near = [0.0_f32; WIDTH];
        let mut far = [t_max; WIDTH];
        for axis in 0..3 {
            let (o, inv) = (p[axis], inverse[axis]);
            // Rounding of the box's planes and of the slabs' distances.
            let slack = 1e-6 * o.abs();
            for i in 0..WIDTH {
                let middle = self.center[axis][i] - o;
                let half = self.half[axis][i] + slack + 1e-6 * middle.abs();
                // A ray in the plane of a slab gives 0 × ∞: NaN, which the comparisons pass over.
                let (a, b) = ((middle - half) * inv, (middle + half) * inv);
                let (enter, leave) = if inv < 0.0 { (b, a) } else { (a, b) };
                near[i] = if enter > near[i] { enter } else { near[i] };
                far[i] = if leave < far[i] { leave } else { far[i] };
            }
        }
        for i in 0..WIDTH {
            if near[i] <= far[i] * (1.0 + 1e-6) && self.child[i] != u32::MAX {
                visit(self.child(i));
            }
        }
    }
}

impl Weights {
    /// Chooses a child by `u` in [0, 1): its slot, its probability and what is left of `u`.
    #[inline]
    pub fn choose(&self, u: f64) -> Option<(usize, f32, f64)> {
        let at = u * self.total;
        let (mut below, mut chosen) = (0.0, None);
        let mut sum = 0.0;
        for (i, &odds) in self.odds.iter().enumerate() {
            if odds > 0.0 && (chosen.is_none() || at >= sum) {
                (chosen, below) = (Some(i), sum);
            }
            sum += f64::from(odds);
        }
        let i = chosen?;
        let odds = f64::from(self.odds[i]);
        Some((i, self.pmf(i), ((at - below) / odds).clamp(0.0, LARGEST)))
    }

    /// Probability of child `slot`; 0 where there is nothing to choose from.
    #[inline]
    pub fn pmf(&self, slot: usize) -> f32 {
        let odds = f64::from(self.odds[slot]);
        if odds > 0.0 { (odds / self.total) as f32 } else { 0.0 }
    }
}

/// The largest number that is a fair draw from [0, 1) for a choice.
pub(in crate::light) const LARGEST: f64 = 1.0 - 1.0 / (1_u64 << 48) as f64;
