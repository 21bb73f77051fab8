//! The choice among the lights that reach one class of receivers.

use super::bounds::Asked;
use super::tree::{LARGEST, refined};
use super::{Decay, Emitter, Light, LightBounds, LightTree, Receiver};
use crate::math::{Bounds, ONE_MINUS_EPSILON, Vec3};
use crate::sampling::AliasTable;

/// Up to so many lights are weighed at every shading point, each by what it knows of itself.
pub(super) const SCAN_LIMIT: usize = 32;

/// By what a light is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Strategy {
    /// What it may send to the point that asks: few lights one by one, many by a tree.
    #[default]
    Tree,
    /// Its power, wherever the point is.
    Power,
    /// All alike.
    Uniform,
}

/// A light that was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Its index.
    pub light: u32,
    /// Probability with which it was chosen.
    pub pmf: f32,
    /// A fresh uniform number, made of what the choice left of the one it took.
    pub u: f32,
}

/// Some lights of a scene and the choice among them.
#[derive(Clone, Debug)]
pub(super) enum Selection {
    /// By what they may send.
    Weighed(Weighed),
    /// By fixed odds.
    Table {
        /// Odds.
        table: AliasTable,
        /// The light of each entry.
        lights: Vec<u32>,
    },
    /// There are none.
    Nothing,
}

/// Lights weighed one by one, and all others in a tree.
#[derive(Clone, Debug)]
pub(super) struct Weighed {
    /// Indices of the lights that are weighed one by one, growing.
    scanned: Vec<u32>,
    tree: Option<LightTree>,
    /// The lights of the tree's items, growing.
    items: Vec<u32>,
}

impl Selection {
    /// A choice by `strategy` among `members`, growing indices into `lights`.
    pub fn new(lights: &[Light], members: Vec<u32>, scene: Bounds, strategy: Strategy) -> Self {
        let emitter = |i: u32| &lights[i as usize].emitter;
        if members.is_empty() {
            return Self::Nothing;
        }
        let weights: Vec<f64> = match strategy {
            Strategy::Tree => return Self::Weighed(Weighed::new(lights, members)),
            Strategy::Uniform => vec![1.0; members.len()],
            Strategy::Power => {
                let power = |&i: &u32| f64::from(emitter(i).power(scene)).clamp(0.0, 1e30);
                let powers: Vec<f64> = members.iter().map(power).collect();
                // Those whose power is lost in `f32` still get a small share.
                let least = (1e-3 * powers.iter().sum::<f64>() / powers.len() as f64).max(f64::MIN_POSITIVE);
                powers.iter().map(|p| p.max(least)).collect()
            }
        };
        AliasTable::new(&weights).map_or(Self::Nothing, |table| Self::Table { table, lights: members })
    }

    /// Chooses a light for `at` by `u`; `None` where none can reach it.
    pub fn choose(&self, lights: &[Light], at: &Receiver, u: f32) -> Option<Choice> {
        match self {
            Self::Weighed(weighed) => weighed.choose(lights, at, u),
            Self::Table { table, lights } => {
                let chosen = table.sample(u);
                Some(Choice { light: lights[chosen.index], pmf: chosen.pmf, u: chosen.u })
            }
            Self::Nothing => None,
        }
    }

    /// Probability with which [`Selection::choose`] at `at` chooses `light`.
    pub fn pmf(&self, lights: &[Light], at: &Receiver, light: u32) -> f32 {
        match self {
            Self::Weighed(weighed) => weighed.pmf(lights, at, light),
            Self::Table { table, lights } => lights.binary_search(&light).map_or(0.0, |i| table.pmf(i)),
            Self::Nothing => 0.0,
        }
    }
}

/// Importance of lights at a receiver; those beyond [`SCAN_LIMIT`] are asked again where needed.
struct Scan {
    first: [f32; SCAN_LIMIT],
    total: f64,
}

impl Weighed {
    fn new(lights: &[Light], members: Vec<u32>) -> Self {
        let bounds = |i: u32| lights[i as usize].emitter.bounds();
        if members.len() <= SCAN_LIMIT {
            return Self { scanned: members, tree: None, items: Vec::new() };
        }
        let (items, scanned): (Vec<u32>, Vec<u32>) = members.into_iter().partition(|&i| bounds(i).is_some());
        let boxes: Vec<LightBounds> = items.iter().filter_map(|&i| bounds(i)).collect();
        let decays: Vec<Decay> = items.iter().map(|&i| lights[i as usize].emitter.decay()).collect();
        Self { scanned, tree: LightTree::decaying(&boxes, &decays), items }
    }

    /// Bounded, so that a point light at zero distance leaves the sum finite.
    fn weight(&self, lights: &[Light], at: &Receiver, i: usize) -> f32 {
        let weight = lights[self.scanned[i] as usize].emitter.importance(at);
        if weight > 0.0 { weight.min(1e30) } else { 0.0 }
    }

    fn scan(&self, lights: &[Light], at: &Receiver) -> Scan {
        let mut scan = Scan { first: [0.0; SCAN_LIMIT], total: 0.0 };
        for i in 0..self.scanned.len() {
            let weight = self.weight(lights, at, i);
            if let Some(slot) = scan.first.get_mut(i) {
                *slot = weight;
            }
            scan.total += f64::from(weight);
        }
        scan
    }

    fn choose(&self, lights: &[Light], at: &Receiver, u: f32) -> Option<Choice> {
        let asked = Asked::new(at.p, at.n, Vec3::ZERO);
        let scan = self.scan(lights, at);
        let root = self.tree.as_ref().map(|tree| (tree, tree.weigh(&asked)));
        let far = root.as_ref().map_or(0.0, |(_, weights)| f64::from(weights.sum));
        let total = scan.total + far;
        if total <= 0.0 {
            return None;
        }
        let fine = if root.is_some() { refined(u, &asked, 0) } else { f64::from(u) };
        let mut left = fine * total;
        if left < far || scan.total == 0.0 {
            let (tree, weights) = root?;
            let chosen = tree.sample_from(&asked, &weights, (left / far).min(LARGEST))?;
            let share = (far / total) as f32;
            let pmf = (chosen.pmf * share).max(f32::MIN_POSITIVE);
            return Some(Choice { light: self.items[chosen.item as usize], pmf, u: chosen.u });
        }
        left -= far;
        let mut last = None;
        for (i, &light) in self.scanned.iter().enumerate() {
            let weight = f64::from(scan.first.get(i).copied().unwrap_or_else(|| self.weight(lights, at, i)));
            if weight > 0.0 {
                let rest = ((left / weight) as f32).clamp(0.0, ONE_MINUS_EPSILON);
                last = Some(Choice { light, pmf: share(weight, total), u: rest });
                if left < weight {
                    break;
                }
                left -= weight;
            }
        }
        last
    }

    fn pmf(&self, lights: &[Light], at: &Receiver, light: u32) -> f32 {
        let asked = Asked::new(at.p, at.n, Vec3::ZERO);
        let scanned = self.scanned.binary_search(&light).ok();
        let item = self.items.binary_search(&light).ok();
        let far = self.tree.as_ref().map_or(0.0, |tree| f64::from(tree.weigh(&asked).sum));
        match (scanned, item, &self.tree) {
            (Some(i), ..) => {
                let weight = f64::from(self.weight(lights, at, i));
                if weight > 0.0 { share(weight, self.scan(lights, at).total + far) } else { 0.0 }
            }
            (None, Some(item), Some(tree)) => {
                let pmf = tree.pmf_of(&asked, item as u32);
                if pmf == 0.0 {
                    return 0.0;
                }
                let share = (far / (self.scan(lights, at).total + far)) as f32;
                (pmf * share).max(f32::MIN_POSITIVE)
            }
            _ => 0.0,
        }
    }
}

/// `weight / total` of a positive weight, never 0.
fn share(weight: f64, total: f64) -> f32 {
    ((weight / total) as f32).max(f32::MIN_POSITIVE)
}
