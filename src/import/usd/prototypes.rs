//! Native instances: a prototype is walked once, below the first of its instances, for each kind of
//! surroundings that its instances stand in.

use std::collections::HashMap;
use std::rc::Rc;

use openusd::sdf::{Path, Value};
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::bindings::Scope;
use super::inherit::{Context, Pose};
use super::shape::tint;
use super::stage::Reading;
use super::walk::{Shown, Walk};
use crate::math::DAffine3;

/// What was walked for others to be like.
#[derive(Default)]
pub(super) struct Prototypes {
    /// By the path of the prototype in the stage.
    native: HashMap<Path, Prototype>,
    /// Prototypes of point instancers; `None` while they are walked.
    pub pointed: HashMap<Path, Option<Rc<Vec<Shown>>>>,
}

struct Prototype {
    /// The first of its instances.
    first: Prim,
    /// What that shows in each of the surroundings that were met.
    shown: Vec<(Context, Rc<Vec<Shown>>)>,
}

/// Adds what the instance `prim` shows, whose children take `context` from it.
pub(super) fn instance(walk: &mut Walk<'_, '_>, prim: &Prim, context: Context, shown: &mut Vec<Shown>) {
    let reading = walk.reading;
    let Some(root) = prim.prototype().ok().flatten() else { return };
    // A colour from outside does not make it another prototype.
    let color = tint::inherited(reading, &context.primvars);
    let known = walk.prototypes.native.get(&root);
    let first = known.map_or(prim, |known| &known.first).clone();
    let skel = context.skel.map(|skel| Rc::new(skel.within(first.path(), prim.path())));
    let context = Context { primvars: tint::without(&context.primvars), skel, ..context };
    let like = known.and_then(|known| known.shown.iter().find(|(other, _)| alike(reading, other, &context)));
    let prototype = match like {
        Some((_, shown)) => shown.clone(),
        None => {
            let mut inside = Vec::new();
            let pose = Pose::still(DAffine3::IDENTITY);
            let within = Context { pose, bindings: None, asset: None, ..context.clone() };
            let animation = context.skel.as_ref().and_then(|skel| skel.animation().cloned());
            walk.walked.push((first.path().clone(), animation));
            walk.below(&first, within, false, &mut inside);
            walk.walked.pop();
            let inside = Rc::new(inside);
            let prototype = Prototype { first: first.clone(), shown: Vec::new() };
            let known = walk.prototypes.native.entry(root).or_insert(prototype);
            known.shown.push((context.clone(), inside.clone()));
            inside
        }
    };
    if !walk.affords(prototype.len(), prim) {
        return;
    }
    let (walked, instance) = (first.path().clone(), prim.path().clone());
    let scope = Rc::new(Scope { outer: None, bindings: context.bindings, walked: walked.clone(), instance });
    let mut scopes: Vec<(Rc<Scope>, Rc<Scope>)> = Vec::new();
    for inner in prototype.iter() {
        let scope = match &inner.scope {
            None => scope.clone(),
            Some(inside) => match scopes.iter().find(|(known, _)| Rc::ptr_eq(known, inside)) {
                Some((_, both)) => both.clone(),
                None => {
                    let both = Scope::within(Some(inside), &scope);
                    scopes.push((inside.clone(), both.clone()));
                    both
                }
            },
        };
        let path = inner.path.replace_prefix(&walked, prim.path()).unwrap_or_else(|| inner.path.clone());
        let asset = inner.asset.clone().or_else(|| context.asset.clone());
        let pose = context.pose.place(&inner.pose);
        let color = inner.color.or(color);
        let each = inner.each.clone();
        walk.show(Shown { leaf: inner.leaf.clone(), path, pose, asset, scope: Some(scope), color, each }, shown);
    }
}

/// True where a prototype looks the same in both surroundings.
fn alike(reading: &Reading<'_>, a: &Context, b: &Context) -> bool {
    if !a.shows_like(b) || a.skel != b.skel || a.primvars.len() != b.primvars.len() {
        return false;
    }
    Rc::ptr_eq(&a.primvars, &b.primvars) || a.primvars.iter().zip(&*b.primvars).all(|(a, b)| equal(reading, a, b))
}

fn equal(reading: &Reading<'_>, a: &Primvar, b: &Primvar) -> bool {
    let (of_a, of_b) = (a.attribute(), b.attribute());
    if of_a.path() == of_b.path() {
        return true;
    }
    let value = |primvar: &Primvar| primvar.compute_flattened::<Value>(reading.time).ok();
    let same_type = of_a.type_name().ok() == of_b.type_name().ok();
    of_a.name() == of_b.name() && same_type && value(a) == value(b)
}
