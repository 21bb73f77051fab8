//! Light and shadow linking: instances that no light tells apart form a class.
//!
//! Which lights reach an instance is then a question to its class, however many instances there are,
//! and which instances stop a light's rays a mask of classes.

use std::collections::HashMap;
use std::sync::Arc;

use crate::desc::{LightLinks, LinkSet, SceneDesc};
use crate::error::Warnings;
use crate::light::Shadow;
use crate::scene::mask;

/// The classes of one kind of link.
#[derive(Debug, Default)]
struct Classes {
    /// Class of each instance of the `SceneDesc`; empty where there are no links.
    of_instance: Vec<u32>,
    /// For each set, the classes that belong to it.
    members: HashMap<LinkSet, Vec<bool>>,
    count: u32,
}

impl Classes {
    fn of<'a>(instances: usize, sets: impl Iterator<Item = &'a LinkSet>) -> Self {
        let mut distinct: Vec<&LinkSet> = Vec::new();
        for set in sets {
            if !distinct.contains(&set) {
                distinct.push(set);
            }
        }
        if distinct.is_empty() {
            return Self { count: 1, ..Self::default() };
        }
        let mut member = vec![Vec::with_capacity(distinct.len()); instances];
        for set in &distinct {
            member.iter_mut().for_each(|list: &mut Vec<bool>| list.push(set.exclude));
            for &i in &set.instances {
                if let Some(last) = member[i as usize].last_mut() {
                    *last = !set.exclude;
                }
            }
        }
        let mut classes: HashMap<&[bool], u32> = HashMap::new();
        let of_instance = member
            .iter()
            .map(|list| {
                let next = classes.len() as u32;
                *classes.entry(list).or_insert(next)
            })
            .collect();
        let count = classes.len() as u32;
        let members = distinct.iter().enumerate().map(|(k, set)| {
            let mut of_class = vec![false; count as usize];
            for (list, &class) in &classes {
                of_class[class as usize] = list[k];
            }
            ((*set).clone(), of_class)
        });
        Self { members: members.collect(), of_instance, count }
    }

    fn class(&self, instance: usize) -> u32 {
        self.of_instance.get(instance).copied().unwrap_or(0)
    }
}

/// Who is lit by what, and what stops whose light.
#[derive(Debug)]
pub struct Links {
    receivers: Classes,
    blockers: Classes,
}

impl Links {
    /// The links of every light of `desc`.
    pub fn of(desc: &SceneDesc, warnings: &mut Warnings) -> Self {
        let all = || desc.lights.iter().map(|l| &l.links).chain(desc.instances.iter().map(|i| &i.links));
        let count = desc.instances.len();
        let receivers = Classes::of(count, all().filter_map(|links| links.receivers.as_ref()));
        let mut blockers = Classes::of(count, all().filter_map(|links| links.blockers.as_ref()));
        if blockers.count > mask::BLOCKER_CLASSES {
            let last = mask::BLOCKER_CLASSES - 1;
            blockers.of_instance.iter_mut().for_each(|class| *class = (*class).min(last));
            for classes in blockers.members.values_mut() {
                classes[last as usize] = true;
            }
            warnings.push(
                &desc.place,
                format!(
                    "shadow links tell {} kinds of object apart, {} are possible: the rest stop the light of every light",
                    blockers.count,
                    mask::BLOCKER_CLASSES
                ),
            );
        }
        Self { receivers, blockers }
    }

    /// How many classes of receivers there are.
    pub fn receiver_classes(&self) -> usize {
        self.receivers.count as usize
    }

    /// Class of an instance of the `SceneDesc` as a receiver.
    pub fn receiver_class(&self, instance: usize) -> u16 {
        self.receivers.class(instance).min(u32::from(u16::MAX)) as u16
    }

    /// Class of an instance as a blocker; `None` where no light asks.
    pub fn blocker_class(&self, instance: usize) -> Option<u32> {
        (!self.blockers.of_instance.is_empty()).then(|| self.blockers.class(instance))
    }

    /// For each class of receivers whether a light with `links` reaches it; `None` where it reaches all.
    pub fn receivers(&self, links: &LightLinks) -> Option<Arc<[bool]>> {
        let classes = &self.receivers.members[links.receivers.as_ref()?];
        (!classes.iter().all(|&lit| lit)).then(|| classes.as_slice().into())
    }

    /// What stops a light with `links`.
    pub fn shadow(&self, links: &LightLinks) -> Shadow {
        if !links.cast_shadow {
            return Shadow::Off;
        }
        let Some(set) = &links.blockers else { return Shadow::Cast };
        let classes = self.blockers.members[set].iter().take(mask::BLOCKER_CLASSES as usize).enumerate();
        Shadow::Only(classes.fold(0, |bits, (class, &stops)| bits | u32::from(stops) << class))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(instances: &[u32], exclude: bool) -> LinkSet {
        LinkSet { instances: instances.to_vec(), exclude }
    }

    #[test]
    fn instances_that_no_set_tells_apart_share_a_class() {
        let (key, fill) = (set(&[0, 1], false), set(&[1], true));
        let classes = Classes::of(5, [&key, &fill, &key].into_iter());
        assert_eq!(classes.count, 3);
        assert_eq!(classes.class(2), classes.class(4));
        for (i, in_key, in_fill) in [(0, true, true), (1, true, false), (2, false, true), (3, false, true)] {
            let class = classes.class(i) as usize;
            assert_eq!((classes.members[&key][class], classes.members[&fill][class]), (in_key, in_fill), "{i}");
        }
        let none = Classes::of(5, std::iter::empty());
        assert_eq!((none.count, none.class(3)), (1, 0));
    }
}
