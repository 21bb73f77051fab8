//! The prims that are shown, and what they take from their ancestors.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use openusd::sdf::{FieldKey, Path, Specifier};
use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::bindings::{Bindings, Scope};
use super::inherit::{Clock, Context, Pose};
use super::kinds::{Kind, Kinds, Role};
use super::per_instance::Each;
use super::prototypes::Prototypes;
use super::shape::StandIn;
use super::shape::tint::Tint;
use super::stage::Reading;
use super::{
    clips, cycles, draw_mode, implied, instance_classes, instancer, prototypes, pulse, render, schemas, skel, stamp,
};
use crate::desc::Motion;
use crate::math::DAffine3;

/// More than this is not a scene but a mistake, as instances that multiply level by level.
const MOST_PRIMS: usize = 1 << 24;

/// A prim that shows something: a shape, a light, a camera.
pub(super) struct Placed {
    /// Where its properties are read; for what is instanced, below the first of the instances.
    pub prim: Prim,
    /// Where the user sees it.
    pub path: Path,
    /// Its schema, as "Mesh".
    pub kind: Rc<str>,
    /// Object to world: y up, metres.
    pub world: DAffine3,
    /// The same at the ends and samples of the shutter; empty for what does not move.
    pub motion: Vec<Motion<DAffine3>>,
    /// False for what no ray sees.
    pub visible: bool,
}

/// What all instances of a prim have in common.
pub(super) struct Leaf {
    pub prim: Prim,
    pub kind: Kind,
    /// Its authored properties.
    pub names: Rc<[Token]>,
    pub primvars: Rc<Vec<Primvar>>,
    pub bindings: Option<Rc<Bindings>>,
    pub visible: bool,
    /// True where a collection may say what the light that it emits reaches.
    pub linked: bool,
    /// What is drawn in its place.
    pub stand_in: Option<StandIn>,
    /// The skeleton that it follows.
    pub skin: Option<Arc<skel::Bound>>,
}

/// One of them.
#[derive(Clone)]
pub(super) struct Shown {
    pub leaf: Rc<Leaf>,
    /// Where the user sees it.
    pub path: Path,
    pub pose: Pose,
    /// Name of its asset.
    pub asset: Option<Arc<str>>,
    /// The instances that it is in.
    pub scope: Option<Rc<Scope>>,
    /// The colour of the innermost of them that has one.
    pub color: Option<Tint>,
    /// Which instances of point instancers with values of their own it is in, the innermost first.
    pub each: Each,
}

/// A walk of the stage, or of a part of it.
pub(super) struct Walk<'r, 'a> {
    pub reading: &'r Reading<'a>,
    pub clock: Clock<'r, 'a>,
    pub prototypes: Prototypes,
    /// Instances that are left to another walk, and how many prims were shown before them; `None` where
    /// they are shown at once.
    pub later: Option<Vec<(usize, Path)>>,
    /// What stands in for models, by how it looks.
    pub stand_ins: HashMap<String, Rc<Leaf>>,
    /// The first instances of the prototypes that are walked now, and where skeletons below get their poses from.
    pub walked: Vec<(Path, Option<Path>)>,
    /// True while bounds are computed, for which nothing stands in for anything.
    pub measuring: bool,
    kinds: Kinds,
    contexts: HashMap<Path, Rc<Context>>,
    count: usize,
}

impl<'r, 'a> Walk<'r, 'a> {
    pub fn new(clock: Clock<'r, 'a>) -> Self {
        let (prototypes, kinds, contexts, stand_ins, walked) = Default::default();
        Self {
            reading: clock.reading,
            clock,
            prototypes,
            later: None,
            stand_ins,
            walked,
            measuring: false,
            kinds,
            contexts,
            count: 0,
        }
    }

    /// Everything in the stage, parents before children.
    pub fn stage(&mut self) -> Vec<Shown> {
        let mut shown = Vec::new();
        if let Ok(root) = self.reading.stage.prim(Path::abs_root()) {
            self.below(&root, self.root(), false, &mut shown);
        }
        shown
    }

    /// What the prims in the root take from it.
    pub fn root(&self) -> Context {
        Context::root(Pose::still(self.reading.to_world))
    }

    /// What the children of the prim at `path` take from it, by its ancestors.
    pub fn context_at(&mut self, path: &Path) -> Rc<Context> {
        if let Some(known) = self.contexts.get(path) {
            return known.clone();
        }
        let above = path.parent().filter(|_| !path.is_abs_root());
        let prim = self.reading.stage.prim(path).ok();
        let context = match (above, prim) {
            (Some(above), Some(prim)) => {
                let outer = self.context_at(&above);
                let names = self.reading.names(&prim);
                let kind = self.kinds.of(self.reading, &prim);
                let mut inner = outer.enter(&mut self.clock, &prim, &kind, &names);
                inner.hand_down_primvars(self.reading, &prim, &names);
                inner
            }
            _ => self.root(),
        };
        let context = Rc::new(context);
        self.contexts.insert(path.clone(), context.clone());
        context
    }

    /// The prim at `path` and everything below it.
    pub fn from(&mut self, path: &Path, shown: &mut Vec<Shown>) {
        let above = self.context_at(&path.parent().unwrap_or_default());
        let Ok(prim) = self.reading.stage.prim(path) else { return };
        if let Some(context) = self.enter(&prim, &above, false, shown) {
            self.below(&prim, context, false, shown);
        }
    }

    /// Everything below `prim`, whose children take `context` from it. `overs` are shown like `def`s in the
    /// prototypes of point instancers.
    pub fn below(&mut self, prim: &Prim, context: Context, overs: bool, shown: &mut Vec<Shown>) {
        let mut stack = Vec::new();
        let push = |stack: &mut Vec<(Prim, Rc<Context>)>, prim: &Prim, context: Context| {
            let children = prim.children().unwrap_or_default();
            let context = Rc::new(context);
            stack.extend(children.into_iter().rev().map(|child| (child, context.clone())));
        };
        push(&mut stack, prim, context);
        while let Some((prim, context)) = stack.pop() {
            if self.full() {
                break;
            }
            if let Some(context) = self.enter(&prim, &context, overs, shown) {
                push(&mut stack, &prim, context);
            }
        }
    }

    /// `prim` alone, or all of it where it is an instance; gives what its children take from it, where
    /// there may be something to see in them.
    pub fn enter(&mut self, prim: &Prim, context: &Context, overs: bool, shown: &mut Vec<Shown>) -> Option<Context> {
        let reading = self.reading;
        pulse::beat(prim.path());
        let defined = match prim.specifier().ok().flatten() {
            Some(Specifier::Def) => true,
            Some(Specifier::Over) => overs,
            Some(Specifier::Class) | None => false,
        };
        if !defined || !flag(prim, FieldKey::Active).unwrap_or(true) {
            return None;
        }
        // Before what is below is composed.
        cycles::mend(reading);
        implied::mend(reading, prim);
        if reading.clipped.get() {
            clips::declare(reading, prim);
        }
        let kind = self.kinds.of(reading, prim);
        if kind.role == Role::Aside {
            if &*kind.name == "RenderSettings" {
                render::tell_of_unnamed(reading, prim.path());
            }
            return None;
        }
        let is_instance = flag(prim, FieldKey::Instanceable) == Some(true)
            && prim.is_instance().unwrap_or(false)
            && !instance_classes::take_apart(reading, prim);
        if let Some(later) = self.later.as_mut().filter(|_| is_instance || kind.role == Role::Instancer) {
            later.push((shown.len(), prim.path().clone()));
            return None;
        }
        let names = reading.names(prim);
        let mut inner = context.enter(&mut self.clock, prim, &kind, &names);
        if kind.role == Role::Group {
            schemas::tell_of_shapeless(reading, prim, &kind, &names);
            if names.iter().any(|name| stamp::shows(name)) {
                let kind = Kind { name: stamp::KIND.into(), ..kind.clone() };
                self.leaf(prim, &kind, context, &inner, &names, shown);
            }
        }
        if draw_mode::replace(self, prim, &kind, &names, [context, &inner], shown) {
            return None;
        }
        match kind.role {
            // Instances share what is below them; a shape, a light or a camera that is one is itself.
            Role::Leaf => self.leaf(prim, &kind, context, &inner, &names, shown),
            Role::Instancer => {
                if !inner.hidden(reading) {
                    instancer::walk(self, prim, &inner, shown);
                }
                return None;
            }
            Role::Group | Role::Aside => {}
        }
        inner.hand_down_primvars(reading, prim, &names);
        if is_instance {
            prototypes::instance(self, prim, inner, shown);
            return None;
        }
        Some(inner)
    }

    /// Adds `prim` itself, whose parent hands down `outer`.
    pub fn leaf(
        &mut self,
        prim: &Prim,
        kind: &Kind,
        outer: &Context,
        inner: &Context,
        names: &Rc<[Token]>,
        shown: &mut Vec<Shown>,
    ) {
        let hidden = inner.hidden(self.reading);
        // A camera may be looked through whether it is seen or not.
        if hidden && &*kind.name != "Camera" {
            return;
        }
        let skin = inner.skel.as_ref().and_then(|skel| skel.bound(self.reading, prim, names, &self.walked));
        let pose = match &skin {
            Some(bound) if bound.rigid => skel::place(&mut self.clock, prim, bound, &inner.pose),
            _ => inner.pose.clone(),
        };
        let is_link = |n: &Token| n.starts_with("collection:lightLink:") || n.starts_with("collection:shadowLink:");
        let leaf = Leaf {
            prim: prim.clone(),
            kind: kind.clone(),
            names: names.clone(),
            primvars: outer.primvars.clone(),
            bindings: inner.bindings.clone(),
            visible: !hidden,
            linked: names.iter().any(is_link),
            stand_in: None,
            skin,
        };
        let (path, asset) = (prim.path().clone(), inner.asset.clone());
        self.show(
            Shown { leaf: Rc::new(leaf), path, pose, asset, scope: None, color: None, each: Each::default() },
            shown,
        );
    }

    /// Adds one.
    pub fn show(&mut self, one: Shown, shown: &mut Vec<Shown>) {
        self.count += 1;
        if self.full() {
            let what = format!("more than {MOST_PRIMS} prims are shown; the rest is left out");
            self.reading.warnings.borrow_mut().push(&self.reading.place, what);
            return;
        }
        shown.push(one);
    }

    /// True where `more` can be added, by the instances of `prim`; else they are left out, which is told. What
    /// prototypes show counts as well: it takes as much memory.
    pub fn affords(&self, more: usize, prim: &Prim) -> bool {
        let affords = self.count.saturating_add(more) <= MOST_PRIMS;
        if !affords {
            let what = format!("shows {more} prims, with which there are more than {MOST_PRIMS}; it is left out");
            self.reading.warn(prim.path(), what);
        }
        affords
    }

    /// True where no more can be added.
    pub fn full(&self) -> bool {
        self.count > MOST_PRIMS
    }
}

/// What is authored of `field` of `prim`. Its ancestors are as they should be, else the walk had not come here:
/// to ask the prim itself (`is_active`, `is_instance`) costs twice as much, and is done for every prim.
fn flag(prim: &Prim, field: FieldKey) -> Option<bool> {
    prim.stage().field::<bool>(prim.path(), field).ok().flatten()
}
