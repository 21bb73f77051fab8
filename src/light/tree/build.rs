//! Building the tree: top down, each node's lights split in two until eight parts are there.

use rayon::prelude::*;

use super::cluster::{Cluster, cos_of_cone};
use super::node::{Child, Node, WIDTH};
use crate::light::LightBounds;
use crate::light::bounds::Lobe;
use crate::math::Vec3;

/// Bins along each axis in which splits are tried.
const BINS: usize = 12;

/// Levels after which parts are halved, which ends within ⌈log₈ 2³²⌉ = 11 levels more.
const LEVELS_BY_COST: u32 = 10;

/// Nodes with more lights are built in parallel.
const PARALLEL: usize = 1 << 13;

/// Sums over more lights are made of chunks of this size, which do not depend on the threads.
const CHUNK: usize = 1 << 15;

/// A light on its way into the tree.
#[derive(Clone, Copy)]
struct Item {
    bounds: LightBounds,
    index: u32,
}

/// Some of the lights, a range of the list.
#[derive(Clone, Copy)]
struct Part {
    start: usize,
    end: usize,
    cluster: Cluster,
}

impl Part {
    fn len(&self) -> usize {
        self.end - self.start
    }
}

/// The nodes of a tree over `lights`, the root first, and the bounds of all; lights without intensity
/// are left out.
pub(super) fn build(lights: &[LightBounds]) -> Option<(Vec<Node>, LightBounds)> {
    let shines = |(i, bounds): (usize, &LightBounds)| {
        let sound = bounds.intensity > 0.0 && bounds.bounds.min.is_finite() && bounds.bounds.max.is_finite();
        (sound && !bounds.bounds.is_empty()).then_some(Item { bounds: *bounds, index: i as u32 })
    };
    let mut items: Vec<Item> = lights.iter().enumerate().filter_map(shines).collect();
    let side = items.first()?.bounds.axis;
    let cluster = sum(&items, side);
    let all = bounds_of(&items, &cluster);
    Some((node(&mut items, cluster, 0), all))
}

/// The tree over `items`, indices relative to its root.
fn node(items: &mut [Item], cluster: Cluster, level: u32) -> Vec<Node> {
    let parts = split_up(items, cluster, level);
    let mut rest = items;
    let mut lists: Vec<(Part, &mut [Item])> = Vec::with_capacity(WIDTH);
    for part in parts {
        let (own, others) = rest.split_at_mut(part.len());
        lists.push((part, own));
        rest = others;
    }
    let below = |(part, own): &mut (Part, &mut [Item])| {
        if let [item] = own {
            return (item.bounds.lobe(), Vec::new());
        }
        (part.cluster.lobe(&bounds_of(own, &part.cluster)), node(own, part.cluster, level + 1))
    };
    let parallel = lists.iter().map(|(part, _)| part.len()).sum::<usize>() > PARALLEL;
    let built: Vec<(Lobe, Vec<Node>)> =
        if parallel { lists.par_iter_mut().map(below).collect() } else { lists.iter_mut().map(below).collect() };

    let mut nodes = vec![Node::EMPTY];
    for (slot, ((lobe, below), (_, own))) in built.into_iter().zip(&lists).enumerate() {
        let first = nodes.len() as u32;
        let child = if below.is_empty() { Child::Light(own[0].index) } else { Child::Node(first) };
        nodes[0].set(slot, &lobe, child);
        nodes.extend(below.into_iter().map(|mut node| {
            node.shift(first);
            node
        }));
    }
    nodes
}

/// At most [`WIDTH`] parts of `items`, in order.
fn split_up(items: &mut [Item], cluster: Cluster, level: u32) -> Vec<Part> {
    let mut parts = vec![Part { start: 0, end: items.len(), cluster }];
    let halve = level >= LEVELS_BY_COST;
    // First those that need nodes of their own below, the costliest first: the largest where parts
    // are halved.
    while parts.len() < WIDTH {
        let rank = |part: &Part| if halve { part.len() as f64 } else { part.cluster.cost() };
        let large = parts.iter().enumerate().filter(|(_, part)| part.len() > WIDTH);
        let Some((i, _)) = large.max_by(|a, b| rank(a.1).total_cmp(&rank(b.1))) else { break };
        let [a, b] = split(items, &parts[i], halve);
        parts[i] = a;
        parts.insert(i + 1, b);
    }
    // Then the room that is left is for single lights of the smallest parts.
    loop {
        let room = WIDTH - parts.len();
        let fits = parts.iter().enumerate().filter(|(_, part)| (2..=room + 1).contains(&part.len()));
        let Some((i, _)) = fits.min_by_key(|(_, part)| part.len()) else { break };
        let part = parts.remove(i);
        for (k, at) in (part.start..part.end).enumerate() {
            let cluster = Cluster::EMPTY.with(&items[at].bounds, items[at].bounds.axis);
            parts.insert(i + k, Part { start: at, end: at + 1, cluster });
        }
    }
    parts
}

/// Two parts of `part`: by the best cost among those of the bins, or of equal size.
fn split(items: &mut [Item], part: &Part, halve: bool) -> [Part; 2] {
    let own = &mut items[part.start..part.end];
    let (centers, side) = (part.cluster.centers, part.cluster.axis());
    let best = if halve { None } else { best_plane(own, part, side) };
    let (middle, clusters) = match best {
        Some(plane) => {
            let middle = partition(own, |item| bin(item, part, plane.axis) <= plane.last);
            (middle, plane.clusters)
        }
        None => {
            let axis = centers.extent().max_position();
            let half = own.len() / 2;
            let key = |item: &Item| (item.bounds.bounds.center()[axis], item.index);
            own.select_nth_unstable_by(half, |a, b| {
                let ((a, i), (b, j)) = (key(a), key(b));
                a.total_cmp(&b).then(i.cmp(&j))
            });
            let (a, b) = own.split_at(half);
            (half, [sum(a, side), sum(b, side)])
        }
    };
    let middle = part.start + middle;
    [
        Part { start: part.start, end: middle, cluster: clusters[0] },
        Part { start: middle, end: part.end, cluster: clusters[1] },
    ]
}

/// Where to split, and what is on each side.
struct Plane {
    axis: usize,
    /// The last bin on the near side.
    last: usize,
    clusters: [Cluster; 2],
}

/// The bin of an item along `axis`.
fn bin(item: &Item, part: &Part, axis: usize) -> usize {
    let (min, max) = (part.cluster.centers.min[axis], part.cluster.centers.max[axis]);
    let share = (item.bounds.bounds.center()[axis] - min) / (max - min);
    ((share * BINS as f32) as usize).min(BINS - 1)
}

/// The cheapest split; `None` where none leaves lights on both sides.
fn best_plane(items: &[Item], part: &Part, side: Vec3) -> Option<Plane> {
    let bins = bins(items, part, side);
    let (extent, spread) = (part.cluster.bounds.extent(), part.cluster.centers.extent());
    let mut best: Option<(f64, Plane)> = None;
    for (axis, bins) in bins.iter().enumerate() {
        if spread[axis] <= 0.0 {
            continue;
        }
        // Long boxes are split across: K_r of the paper.
        let regular = f64::from(extent.max_element() / extent[axis].max(f32::MIN_POSITIVE)).min(1e6);
        let mut right = [(Cluster::EMPTY, 0.0); BINS];
        let mut cluster = Cluster::EMPTY;
        for i in (1..BINS).rev() {
            cluster = cluster.union(&bins[i]);
            right[i] = (cluster, if cluster.bounds.is_empty() { 0.0 } else { cluster.cost() });
        }
        let mut left = Cluster::EMPTY;
        for last in 0..BINS - 1 {
            left = left.union(&bins[last]);
            let (right, cost_right) = &right[last + 1];
            if left.bounds.is_empty() || right.bounds.is_empty() {
                continue;
            }
            let cost = regular * (left.cost() + cost_right);
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, Plane { axis, last, clusters: [left, *right] }));
            }
        }
    }
    best.map(|(_, plane)| plane)
}

/// The lights of each bin along each axis.
fn bins(items: &[Item], part: &Part, side: Vec3) -> [[Cluster; BINS]; 3] {
    let of = |items: &[Item]| {
        let mut bins = [[Cluster::EMPTY; BINS]; 3];
        for item in items {
            for (axis, bins) in bins.iter_mut().enumerate() {
                let bin = &mut bins[bin(item, part, axis)];
                *bin = bin.with(&item.bounds, side);
            }
        }
        bins
    };
    if items.len() <= CHUNK {
        return of(items);
    }
    let chunks: Vec<_> = items.par_chunks(CHUNK).map(of).collect();
    let mut all = [[Cluster::EMPTY; BINS]; 3];
    for chunk in &chunks {
        for (all, chunk) in all.iter_mut().flatten().zip(chunk.iter().flatten()) {
            *all = all.union(chunk);
        }
    }
    all
}

fn sum(items: &[Item], side: Vec3) -> Cluster {
    let of = |items: &[Item]| items.iter().fold(Cluster::EMPTY, |sum, item| sum.with(&item.bounds, side));
    if items.len() <= CHUNK {
        return of(items);
    }
    let chunks: Vec<Cluster> = items.par_chunks(CHUNK).map(of).collect();
    chunks.iter().fold(Cluster::EMPTY, Cluster::union)
}

/// The bounds of `items`, whose sums are `cluster`.
fn bounds_of(items: &[Item], cluster: &Cluster) -> LightBounds {
    let all = cluster.light_bounds(-1.0);
    let narrowest = |items: &[Item]| {
        let cones = items.iter().map(|item| cos_of_cone(all.axis, all.two_sided, &item.bounds));
        cones.fold(1.0, f32::min)
    };
    let cos_normals = if items.len() <= CHUNK {
        narrowest(items)
    } else {
        let chunks: Vec<f32> = items.par_chunks(CHUNK).map(narrowest).collect();
        chunks.into_iter().fold(1.0, f32::min)
    };
    LightBounds { cos_normals, ..all }
}

/// Moves the items that `first` holds for to the front; how many those are.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut end = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(i, end);
            end += 1;
        }
    }
    end
}
