//! Shapes of the scene: each is read once and built while the next are read, however often it is placed.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::mpsc;

use openusd::sdf::Path;

use super::bindings::{self, Bindings};
use super::light::ShapeLight;
use super::material::Materials;
use super::shape::{self, Built, Source, Wants};
use super::stage::Reading;
use super::walk::{Leaf, Shown, Walked};
use crate::error::Warnings;

/// How a shape looks in one place.
pub(super) struct Look {
    /// Index into the shapes.
    pub shape: usize,
    /// Material of each slot.
    pub materials: Vec<Option<u32>>,
    /// The light that it is.
    pub light: Option<ShapeLight>,
}

/// All shapes, and which of them each prim shows.
#[derive(Default)]
pub(super) struct Shapes {
    /// As built; `None` where nothing is left.
    pub built: Vec<Option<Built>>,
    pub looks: Vec<Look>,
    /// For each prim that is shown, its look.
    pub by_shown: Vec<Option<usize>>,
}

/// What was read of a shape.
struct Read {
    /// `None` while it is built.
    source: Option<Source>,
    /// Each with its own bindings.
    subsets: Vec<(Path, Option<Rc<Bindings>>)>,
}

/// Reads what `walked` shows, save what `aside` is true for.
pub(super) fn read(
    reading: &Reading<'_>,
    walked: &Walked,
    materials: &mut Materials<'_>,
    aside: impl Fn(&str) -> bool,
) -> Shapes {
    let (sender, results) = mpsc::channel();
    let mut shapes = Shapes::default();
    let mut count = 0;
    rayon::in_place_scope(|scope| {
        let mut reads = HashMap::new();
        let mut known = HashMap::new();
        let mut unique: HashMap<(Path, Vec<Path>, Wants), usize> = HashMap::new();
        for shown in &walked.shown {
            if aside(&shown.leaf.kind) {
                shapes.by_shown.push(None);
                continue;
            }
            // Where no binding of the surroundings has a say, all instances look the same.
            let scope_matters = shown.scope.as_ref().filter(|scope| scope.matters());
            let key = (Rc::as_ptr(&shown.leaf), scope_matters.map(Rc::as_ptr));
            if let Some(&look) = known.get(&key) {
                shapes.by_shown.push(look);
                continue;
            }
            let leaf = &shown.leaf;
            let read = reads.entry(key.0).or_insert_with(|| read_one(reading, leaf));
            let look = read.as_mut().map(|read| {
                let slots = slots(reading, shown, &read.subsets, materials);
                let wants = wants(materials, &slots);
                let primvars = leaf.primvars.iter().map(|primvar| primvar.attribute().path().clone()).collect();
                let shape = *unique.entry((leaf.prim.path().clone(), primvars, wants.clone())).or_insert_with(|| {
                    let sender = sender.clone();
                    let source = read.source.take().or_else(|| shape::read(reading, &leaf.prim, &leaf.primvars));
                    let place = reading.place_of(leaf.prim.path());
                    let (index, subdivision) = (count, reading.options.subdivision);
                    count += 1;
                    scope.spawn(move |_| {
                        let mut warnings = Warnings::new();
                        let built = source.and_then(|s| shape::build(s, &wants, subdivision, &place, &mut warnings));
                        // Nobody listens only where reading itself has ended in a panic.
                        let _ = sender.send((index, built, warnings));
                    });
                    index
                });
                let light = ShapeLight::of(reading, &leaf.prim, &shown.path);
                shapes.looks.push(Look { shape, materials: slots, light });
                shapes.looks.len() - 1
            });
            known.insert(key, look);
            shapes.by_shown.push(look);
        }
    });
    drop(sender);
    let mut results: Vec<_> = results.into_iter().collect();
    results.sort_by_key(|(index, _, _)| *index);
    for (_, built, warnings) in results {
        shapes.built.push(built);
        reading.warnings.borrow_mut().extend(warnings);
    }
    shapes
}

fn read_one(reading: &Reading<'_>, leaf: &Leaf) -> Option<Read> {
    let source = shape::read(reading, &leaf.prim, &leaf.primvars)?;
    let bindings = |path: &Path| {
        let prim = reading.stage.prim(path).ok()?;
        let names = prim.authored_property_names().unwrap_or_default();
        Bindings::of(reading, &prim, &names, leaf.bindings.clone())
    };
    let subsets = source.subsets().iter().map(|path| (path.clone(), bindings(path))).collect();
    Some(Read { source: Some(source), subsets })
}

/// The material of the shape and of each of its subsets.
fn slots(
    reading: &Reading<'_>,
    shown: &Shown,
    subsets: &[(Path, Option<Rc<Bindings>>)],
    materials: &mut Materials<'_>,
) -> Vec<Option<u32>> {
    let leaf = &shown.leaf;
    let own = (leaf.prim.path(), leaf.bindings.as_ref());
    let all = std::iter::once(own).chain(subsets.iter().map(|(path, bindings)| (path, bindings.as_ref())));
    let material = |(path, bindings): (&Path, Option<&Rc<Bindings>>)| {
        let bound = bindings::bound(reading, bindings, shown.scope.as_ref(), path);
        bound.and_then(|material| materials.at(&material)).unwrap_or_else(|| materials.unbound())
    };
    all.map(material).map(Some).collect()
}

/// What those materials need of a shape.
fn wants(materials: &Materials<'_>, slots: &[Option<u32>]) -> Wants {
    let each = || slots.iter().flatten().copied();
    // The UV pass shows the first set, whatever the materials use.
    let used: Vec<u32> = each().flat_map(|m| materials.used_uv_sets(m)).collect();
    let sets = 1 + used.iter().max().map_or(0, |&set| set as usize);
    Wants {
        uv_sets: materials.uv_sets.iter().take(sets).cloned().collect(),
        spare_first_set: !used.contains(&0),
        tangents: each().find_map(|m| materials.tangent_uv_set(m)),
        // Colours of a mesh are those of all of it: they must not tint a material that has its own.
        display_color: each().all(|m| tinted(materials, m)),
    }
}

/// True for a material that shows the colours of the mesh.
fn tinted(materials: &Materials<'_>, index: u32) -> bool {
    let colors = materials.vertex_colors(index);
    colors.color.is_some() || colors.opacity.is_some()
}
