//! Light and shadow links by names of nodes: resolved once every instance is there.

use std::collections::HashMap;
use std::ops::Range;

use super::extras::{NameSet, Penumbra};
use super::node::PlacedNode;
use crate::desc::{LightLinks, LinkSet, SceneDesc};
use crate::error::Warnings;

/// What each placed node added to the scene, and the links that wait for names.
#[derive(Default)]
pub(super) struct Links {
    /// Instances of each placed node.
    instances: Vec<Range<u32>>,
    pending: Vec<Pending>,
}

/// Links of the lights and meshes of one node.
struct Pending {
    /// Index of the placed node.
    node: usize,
    lights: Range<usize>,
    receivers: Option<NameSet>,
    blockers: Option<NameSet>,
}

impl Links {
    /// Takes note of the next placed node: the instances and lights that it added, and its links.
    pub fn add(&mut self, instances: Range<usize>, lights: Range<usize>, penumbra: Penumbra) {
        let node = self.instances.len();
        self.instances.push(instances.start as u32..instances.end as u32);
        let Penumbra { receivers, blockers, .. } = penumbra;
        if receivers.is_some() || blockers.is_some() {
            self.pending.push(Pending { node, lights, receivers, blockers });
        }
    }

    /// Writes the links into `scene`, all of whose nodes are `nodes`.
    pub fn resolve(self, nodes: &[PlacedNode], scene: &mut SceneDesc, warnings: &mut Warnings) {
        if self.pending.is_empty() {
            return;
        }
        let mut by_name: HashMap<&str, Vec<usize>> = HashMap::new();
        for (i, node) in nodes.iter().enumerate() {
            by_name.entry(&node.name).or_default().push(i);
            // The path from the root tells nodes of one name apart.
            if let Some(path) = node.place.node.as_deref().filter(|path| **path != *node.name) {
                by_name.entry(path).or_default().push(i);
            }
        }
        for pending in &self.pending {
            let mut set = |key: &str, names: &Option<NameSet>, all: &str| {
                let (set, lost) = self.set(names.as_ref()?, nodes, &by_name);
                if !lost.is_empty() {
                    let lost = lost.join("', '");
                    let done = if set.is_some() { "left out" } else { all };
                    let what = format!("extras.penumbra.{key}: no mesh at or below a node named '{lost}': {done}");
                    warnings.push(&nodes[pending.node].place, what);
                }
                set
            };
            let receivers = set("receivers", &pending.receivers, "lights everything");
            let blockers = set("blockers", &pending.blockers, "everything stops its light");
            let apply = |links: &mut LightLinks| {
                links.receivers.clone_from(&receivers);
                links.blockers.clone_from(&blockers);
            };
            scene.lights[pending.lights.clone()].iter_mut().for_each(|light| apply(&mut light.links));
            let Range { start, end } = self.instances[pending.node];
            scene.instances[start as usize..end as usize].iter_mut().for_each(|instance| apply(&mut instance.links));
        }
    }

    /// The instances of `names` and of all below them, and the names without any. `None` where there
    /// are names but no instance.
    fn set(
        &self,
        names: &NameSet,
        nodes: &[PlacedNode],
        by_name: &HashMap<&str, Vec<usize>>,
    ) -> (Option<LinkSet>, Vec<String>) {
        let mut instances = Vec::new();
        let mut lost = Vec::new();
        for name in &names.names {
            let before = instances.len();
            for &i in by_name.get(name.as_str()).into_iter().flatten() {
                instances.extend(self.below(i, nodes));
            }
            if instances.len() == before {
                lost.push(name.clone());
            }
        }
        instances.sort_unstable();
        instances.dedup();
        let none = instances.is_empty() && !names.names.is_empty();
        ((!none).then_some(LinkSet { instances, exclude: names.exclude }), lost)
    }

    /// Instances of placed node `i` and of its descendants, which follow it.
    fn below(&self, i: usize, nodes: &[PlacedNode]) -> Range<u32> {
        let last = (i + 1..nodes.len()).take_while(|&k| nodes[k].depth > nodes[i].depth).last().unwrap_or(i);
        self.instances[i].start..self.instances[last].end
    }
}
