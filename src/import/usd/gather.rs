//! What is shown, with everything that only the thread of its stage can tell: materials' paths, shapes as
//! authored. From here on nothing is bound to a thread.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use openusd::sdf::Path;

use super::bindings::{self, Bindings, Scope};
use super::inherit::{Clock, Pose};
use super::light::ShapeLight;
use super::per_instance::Each;
use super::shape::tint::Tint;
use super::shape::{self, Source};
use super::skel;
use super::stage::Reading;
use super::walk::{Leaf, Shown, Walk};

/// What all places in which a prim is shown have in common.
pub(super) struct Look {
    /// Where its properties are read.
    pub prim: Path,
    pub kind: Arc<str>,
    pub visible: bool,
    /// True where a collection may say what the light that it emits reaches.
    pub linked: bool,
    pub material: Option<Path>,
    /// What it is a picture of; `None` for lights and cameras.
    pub shape: Option<ShapeLook>,
}

impl Look {
    /// The materials bound to it and its subsets.
    pub fn materials(&self) -> impl Iterator<Item = &Path> {
        let subsets = self.shape.iter().flat_map(|shape| &shape.subsets);
        self.material.iter().chain(subsets.flatten())
    }
}

/// A shape with its materials.
pub(super) struct ShapeLook {
    /// Index of the batch and of the shape in it.
    pub shape: (usize, usize),
    /// Materials of its subsets.
    pub subsets: Vec<Option<Path>>,
    /// The light that it is.
    pub light: Option<ShapeLight>,
}

/// A shape as read.
pub(super) struct Read {
    pub prim: Path,
    /// The primvars that it inherits.
    pub primvars: Vec<Path>,
    /// The skeleton that it follows.
    pub skin: Option<Arc<skel::Bound>>,
    /// Taken by the first who builds it.
    pub source: Option<Source>,
}

/// A prim in one place.
pub(super) struct Found {
    pub look: Arc<Look>,
    /// Where the user sees it.
    pub path: Path,
    pub pose: Pose,
    /// Name of its asset.
    pub asset: Option<Arc<str>>,
    /// Where it has no colours of its own.
    pub color: Option<Tint>,
    /// The instances of point instancers that it is in.
    pub each: Each,
}

impl Found {
    /// What it is made by: its look, and whether it has a colour.
    pub fn key(&self) -> (*const Look, bool) {
        (Arc::as_ptr(&self.look), self.color.is_some())
    }
}

/// Everything that is shown, parents before children.
#[derive(Default)]
pub(super) struct Haul {
    pub found: Vec<Found>,
    /// In batches.
    pub shapes: Vec<Vec<Read>>,
    /// The times of the shutter at which poses are known, in time codes after the frame.
    pub times: Vec<f64>,
}

/// Reads what a walk finds.
pub(super) struct Gatherer<'r, 'a> {
    pub walk: Walk<'r, 'a>,
    /// True for the types that are no shapes.
    aside: fn(&str) -> bool,
    known: HashMap<(*const Leaf, *const Scope), Known>,
    shapes: HashMap<ShapeKey, Option<Rc<Subsets>>>,
}

/// What makes it a shape of its own: its prim, the primvars that it inherits, whether something stands in for it,
/// and the skeleton that it follows.
type ShapeKey = (Path, Vec<Path>, bool, Option<Arc<skel::Bound>>);

/// A look, and what keeps the addresses that it is known by.
struct Known {
    _leaf: Rc<Leaf>,
    _scope: Option<Rc<Scope>>,
    look: Option<Arc<Look>>,
}

/// A shape that was read, and its subsets.
struct Subsets {
    shape: (usize, usize),
    each: Vec<(Path, Option<Rc<Bindings>>)>,
}

impl<'r, 'a> Gatherer<'r, 'a> {
    pub fn new(clock: Clock<'r, 'a>, aside: fn(&str) -> bool) -> Self {
        Self { walk: Walk::new(clock), aside, known: HashMap::new(), shapes: HashMap::new() }
    }

    /// Adds `shown` to `found`, and shapes that were not read before to `batch`, which has the index
    /// `number`.
    pub fn resolve(&mut self, shown: Vec<Shown>, number: usize, batch: &mut Vec<Read>, found: &mut Vec<Found>) {
        for one in shown {
            // Where no binding of the surroundings has a say, all instances look the same.
            let scope = one.scope.as_ref().filter(|scope| scope.matters());
            let key = (Rc::as_ptr(&one.leaf), scope.map_or(std::ptr::null(), Rc::as_ptr));
            let known = self.known.get(&key).map(|known| known.look.clone());
            let look = known.unwrap_or_else(|| {
                let look = self.look(&one, number, batch).map(Arc::new);
                let known = Known { _leaf: one.leaf.clone(), _scope: scope.cloned(), look: look.clone() };
                self.known.insert(key, known);
                look
            });
            if let Some(look) = look {
                let Shown { path, pose, asset, color, each, .. } = one;
                found.push(Found { look, path, pose, asset, color, each });
            }
        }
    }

    fn look(&mut self, shown: &Shown, number: usize, batch: &mut Vec<Read>) -> Option<Look> {
        let reading = self.walk.reading;
        let leaf = &*shown.leaf;
        let material = |bindings: Option<&Rc<Bindings>>, path: &Path| match leaf.stand_in {
            // Nothing is bound to cards: their materials are the attributes that name their pictures.
            Some(_) => path.is_property_path().then(|| path.clone()),
            None => bindings::bound(reading, bindings, shown.scope.as_ref(), path),
        };
        reading.recall(&leaf.prim, &leaf.names, &leaf.kind.type_name);
        let shape = if (self.aside)(&leaf.kind.name) {
            None
        } else {
            let primvars: Vec<Path> = leaf.primvars.iter().map(|p| p.attribute().path().clone()).collect();
            let key = (leaf.prim.path().clone(), primvars, leaf.stand_in.is_some(), leaf.skin.clone());
            let known = self.shapes.entry(key.clone());
            let read = known.or_insert_with(|| {
                let source = match &leaf.stand_in {
                    Some(stand_in) => Source::StandIn(Box::new(stand_in.clone())),
                    None => shape::read(reading, &leaf.prim, &leaf.primvars, leaf.skin.as_deref())?,
                };
                let each = source.subsets().iter().map(|path| (path.clone(), subset(reading, leaf, path))).collect();
                batch.push(Read { prim: key.0, primvars: key.1, skin: key.3, source: Some(source) });
                Some(Rc::new(Subsets { shape: (number, batch.len() - 1), each }))
            });
            let read = read.as_ref()?;
            let subsets = read.each.iter().map(|(path, bindings)| material(bindings.as_ref(), path)).collect();
            let shines = leaf.stand_in.is_none();
            let light = shines.then(|| ShapeLight::of(reading, &leaf.prim, &shown.path)).flatten();
            Some(ShapeLook { shape: read.shape, subsets, light })
        };
        Some(Look {
            prim: leaf.prim.path().clone(),
            kind: leaf.kind.name.clone(),
            visible: leaf.visible,
            linked: leaf.linked,
            material: material(leaf.bindings.as_ref(), leaf.prim.path()),
            shape,
        })
    }
}

/// The bindings of a subset.
fn subset(reading: &Reading<'_>, leaf: &Leaf, path: &Path) -> Option<Rc<Bindings>> {
    let prim = reading.stage.prim(path).ok()?;
    let names = prim.authored_property_names().unwrap_or_default();
    Bindings::of(reading, &prim, &names, leaf.bindings.clone())
}
