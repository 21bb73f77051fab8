//! Shapes, built on all threads: each once for what its materials want of it, however often it is placed.

use std::collections::HashMap;
use std::sync::Arc;

use openusd::sdf::Path;
use openusd_schemas::geom::Primvar;
use rayon::prelude::*;

use super::gather::{Found, Look, Read, ShapeLook};
use super::material::Materials;
use super::shape::{self, Built, Likeness, Source, Wants};
use super::stage::Reading;
use crate::error::Warnings;

/// A shape with materials.
pub(super) struct Dressed {
    /// Index into the shapes as built.
    pub shape: usize,
    /// Material of each slot.
    pub materials: Vec<Option<u32>>,
    /// True where those show the colour of the shape or, where it has none, of the instance.
    pub takes_color: bool,
    /// Primvars that those read by name.
    pub named: Vec<Arc<str>>,
}

/// All shapes, and how each look is made of them.
#[derive(Default)]
pub(super) struct Shapes {
    /// `None` where nothing is left.
    pub built: Vec<Option<Built>>,
    /// Of looks in places with a colour and without.
    pub by_look: HashMap<(*const Look, bool), Dressed>,
}

/// With so many meshes one is compared that look alike at first sight.
const MOST_ALIKE: usize = 16;

/// A shape to be built.
struct Job {
    source: Option<Source>,
    wants: Wants,
    /// The prim that it is built for, and those that look the same.
    prims: Vec<Path>,
}

/// Builds the shapes of everything that was found.
pub(super) fn build(
    reading: &Reading<'_>,
    found: &[Found],
    mut reads: Vec<Vec<Read>>,
    materials: &mut Materials<'_>,
) -> Shapes {
    let mut shapes = Shapes::default();
    let mut jobs: Vec<Job> = Vec::new();
    let mut known: HashMap<((usize, usize), Wants), usize> = HashMap::new();
    let mut alike: HashMap<(Likeness, Wants), usize> = HashMap::new();
    // Assets that are referenced again and again without being instances.
    let mut same_meshes: HashMap<(u64, Wants), Vec<usize>> = HashMap::new();
    for one in found {
        let key = one.key();
        let Some(look) = &one.look.shape else { continue };
        if shapes.by_look.contains_key(&key) {
            continue;
        }
        let slots = slots(&one.look, look, materials);
        let wants = wants(materials, &slots, one.color.is_some());
        let (takes_color, named) = (wants.display_color, wants.named.clone());
        let shape = *known.entry((look.shape, wants.clone())).or_insert_with(|| {
            let read = reads.get_mut(look.shape.0).and_then(|batch| batch.get_mut(look.shape.1));
            let source = read.and_then(|read| {
                let mut source = read.source.take().or_else(|| again(reading, read))?;
                if !wants.named.is_empty() {
                    let prim = reading.stage.prim(&read.prim).ok()?;
                    source.read_named(reading, &prim, &inherited(reading, read), &wants.named);
                }
                Some(source)
            });
            let prim = one.look.prim.clone();
            let likeness = source.as_ref().and_then(Source::likeness);
            let number = match (likeness, source.as_ref().and_then(|source| Some((source, source.digest()?)))) {
                (Some(likeness), _) => *alike.entry((likeness, wants.clone())).or_insert(jobs.len()),
                (None, Some((source, digest))) => {
                    let same = same_meshes.entry((digest, wants.clone())).or_default();
                    let is_same = |job: &Job| job.source.as_ref().is_some_and(|known| known.is_same_mesh(source));
                    same.iter().rev().take(MOST_ALIKE).copied().find(|&job| is_same(&jobs[job])).unwrap_or_else(|| {
                        same.push(jobs.len());
                        jobs.len()
                    })
                }
                (None, None) => jobs.len(),
            };
            match jobs.get_mut(number) {
                Some(job) => job.prims.push(prim),
                None => jobs.push(Job { source, wants, prims: vec![prim] }),
            }
            number
        });
        shapes.by_look.insert(key, Dressed { shape, materials: slots, takes_color, named });
    }
    let subdivision = reading.options.subdivision;
    let place = &reading.place;
    let build = |job: Job| {
        let mut warnings = Warnings::new();
        let place = job.prims.first().map_or_else(|| place.clone(), |prim| place.at(prim.as_str()));
        let built = job.source.and_then(|s| shape::build(s, &job.wants, subdivision, &place, &mut warnings));
        (built, warnings, job.prims)
    };
    let built: Vec<_> = jobs.into_par_iter().map(build).collect();
    for (built, warnings, prims) in built {
        shapes.built.push(built);
        for warning in warnings.iter() {
            prims.iter().skip(1).for_each(|prim| reading.warn(prim, &*warning.what));
        }
        reading.warnings.borrow_mut().extend(warnings);
    }
    shapes
}

/// Reads once more a shape that was built in another way before.
fn again(reading: &Reading<'_>, read: &Read) -> Option<Source> {
    let prim = reading.stage.prim(&read.prim).ok()?;
    shape::read(reading, &prim, &inherited(reading, read), read.skin.as_deref())
}

/// The primvars that a shape inherits.
fn inherited(reading: &Reading<'_>, read: &Read) -> Vec<Primvar> {
    let primvar = |path| Primvar::from_attribute(reading.stage.attribute(path).ok()?);
    read.primvars.iter().filter_map(primvar).collect()
}

/// The material of the shape and of each of its subsets.
fn slots(look: &Look, shape: &ShapeLook, materials: &mut Materials<'_>) -> Vec<Option<u32>> {
    let all = std::iter::once(&look.material).chain(&shape.subsets);
    let index = |bound: &Option<_>| {
        let bound = bound.as_ref().and_then(|material| materials.at(material));
        Some(bound.unwrap_or_else(|| materials.unbound()))
    };
    all.map(index).collect()
}

/// What those materials need of a shape.
fn wants(materials: &Materials<'_>, slots: &[Option<u32>], colored: bool) -> Wants {
    let each = || slots.iter().flatten().copied();
    // The UV pass shows the first set, whatever the materials use.
    let used: Vec<u32> = each().flat_map(|m| materials.used_uv_sets(m)).collect();
    let sets = 1 + used.iter().max().map_or(0, |&set| set as usize);
    let name = |set: u32| {
        let looked_at = set == 0 || used.contains(&set);
        if looked_at { materials.uv_sets[set as usize].clone() } else { "".into() }
    };
    let shows: Vec<bool> = slots.iter().map(|slot| slot.is_some_and(|m| materials.is_tinted(m))).collect();
    let display_color = shows.contains(&true);
    let some = display_color && shows.contains(&false);
    let mut named: Vec<_> = each().flat_map(|m| materials.named_primvars(m)).collect();
    named.sort_unstable();
    named.dedup();
    Wants {
        named,
        uv_sets: (0..sets as u32).map(name).collect(),
        spare_first_set: !used.contains(&0),
        tangents: each().find_map(|m| materials.tangent_uv_set(m)),
        display_color,
        colored_slots: if some { shows } else { Vec::new() },
        instance_color: display_color && colored,
    }
}
