//! The prims that are shown, and what they take from their ancestors.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use openusd::sdf::{self, Specifier};
use openusd::tf::Token;
use openusd::usd::Prim;
use openusd_schemas::geom::Primvar;

use super::bindings::{self, Bindings, Scope};
use super::cycles;
use super::inherit::{Clock, Context, Pose};
use super::stage::Reading;
use crate::desc::Motion;
use crate::math::DAffine3;

/// More than this is not a scene but a mistake, as instances that multiply level by level.
const MOST_PRIMS: usize = 1 << 24;

/// A prim that shows something: a shape, a light, a camera.
pub(super) struct Placed {
    /// Where its properties are read; for what is instanced, below the first of the instances.
    pub prim: Prim,
    /// Where the user sees it.
    pub path: sdf::Path,
    /// Its schema, as "Mesh".
    pub kind: Rc<str>,
    /// Object to world: y up, metres.
    pub world: DAffine3,
    /// The same at the ends and samples of the shutter; empty for what does not move.
    pub motion: Vec<Motion<DAffine3>>,
    /// The material bound to it, by the rules of UsdShade.
    pub material: Option<sdf::Path>,
    /// What it inherits; the same pointer for all instances of a prototype in the same surroundings.
    pub primvars: Rc<Vec<Primvar>>,
    /// False for what no ray sees.
    pub visible: bool,
}

/// What all instances of a prim have in common.
pub(super) struct Leaf {
    pub prim: Prim,
    pub kind: Rc<str>,
    pub primvars: Rc<Vec<Primvar>>,
    pub bindings: Option<Rc<Bindings>>,
    pub visible: bool,
    /// True where a collection may say what the light that it emits reaches.
    pub linked: bool,
}

/// One of them.
#[derive(Clone)]
pub(super) struct Shown {
    pub leaf: Rc<Leaf>,
    /// Where the user sees it.
    pub path: sdf::Path,
    pub pose: Pose,
    /// Name of its asset.
    pub asset: Option<Arc<str>>,
    /// The instances that it is in.
    pub scope: Option<Rc<Scope>>,
}

/// Everything that is shown, parents before children, in the order of the stage.
pub(super) struct Walked {
    pub shown: Vec<Shown>,
    /// The times of the shutter at which poses are known, in time codes after the frame.
    pub times: Vec<f64>,
}

impl Walked {
    /// `shown` for those who read it.
    pub fn placed(&self, reading: &Reading<'_>, shown: &Shown) -> Placed {
        let leaf = &shown.leaf;
        Placed {
            prim: leaf.prim.clone(),
            path: shown.path.clone(),
            kind: leaf.kind.clone(),
            world: shown.pose.world,
            motion: self.motion(shown),
            material: bindings::bound(reading, leaf.bindings.as_ref(), shown.scope.as_ref(), leaf.prim.path()),
            primvars: leaf.primvars.clone(),
            visible: leaf.visible,
        }
    }

    /// The transforms of `shown` during the shutter.
    pub fn motion(&self, shown: &Shown) -> Vec<Motion<DAffine3>> {
        let values = shown.pose.motion.iter().flat_map(|values| values.iter());
        self.times.iter().zip(values).map(|(&time, &value)| Motion { time, value }).collect()
    }
}

/// Walks the stage; twice where something moves while the shutter of a camera is open, which is known only
/// when all was seen.
pub(super) fn walk(reading: &Reading<'_>) -> Walked {
    let mut walk = Walk::new(Clock::still(reading));
    let shown = walk.stage();
    let shutter = shutter(reading, &shown);
    reading.shutter.set(shutter);
    if let Some(clock) = shutter.and_then(|shutter| walk.clock.moving(shutter)) {
        let mut walk = Walk::new(clock);
        let shown = walk.stage();
        return Walked { shown, times: walk.clock.times };
    }
    Walked { shown, times: Vec::new() }
}

/// From when to when a camera's shutter is open, in time codes after the frame.
fn shutter(reading: &Reading<'_>, shown: &[Shown]) -> Option<[f64; 2]> {
    // Without a frame there is nothing to be before or after.
    if reading.time.is_earliest_time() {
        return None;
    }
    let cameras = shown.iter().filter(|shown| &*shown.leaf.kind == "Camera");
    let of = |camera: &Shown| {
        let end = |name| reading.value::<f64>(&camera.leaf.prim, name).filter(|t| t.is_finite()).unwrap_or(0.0);
        [end("shutter:open"), end("shutter:close")]
    };
    let open = cameras.map(of).filter(|[open, close]| open < close);
    open.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// A prototype as the first of its instances was walked.
struct Prototype {
    /// That instance.
    first: Prim,
    /// What it shows in each of the surroundings that were met.
    shown: Vec<(Context, Rc<Vec<Shown>>)>,
}

/// A walk of the stage.
pub(super) struct Walk<'r, 'a> {
    pub reading: &'r Reading<'a>,
    pub clock: Clock<'r, 'a>,
    kinds: HashMap<Token, Kind>,
    prototypes: HashMap<sdf::Path, Prototype>,
    /// Prototypes of point instancers, walked; `None` while they are.
    pub pointed: HashMap<sdf::Path, Option<Rc<Vec<Shown>>>>,
    count: usize,
}

/// What the walk does at a prim of a type.
#[derive(Clone)]
enum Role {
    /// It shows nothing, its children may.
    Group,
    /// It and all below are no part of the picture, or are read from elsewhere.
    Aside,
    /// Its children are prototypes.
    Instancer,
    /// Something to see, or to see by.
    Leaf,
}

#[derive(Clone)]
struct Kind {
    name: Rc<str>,
    role: Role,
    imageable: bool,
}

impl<'r, 'a> Walk<'r, 'a> {
    fn new(clock: Clock<'r, 'a>) -> Self {
        let (kinds, prototypes, pointed) = Default::default();
        Self { reading: clock.reading, clock, kinds, prototypes, pointed, count: 0 }
    }

    fn stage(&mut self) -> Vec<Shown> {
        let mut shown = Vec::new();
        let root = Context::root(Pose::still(self.reading.to_world));
        if let Ok(prim) = self.reading.stage.prim(sdf::Path::abs_root()) {
            self.below(&prim, root, false, &mut shown);
        }
        shown
    }

    /// Everything below `prim`, whose children take `context` from it.
    pub fn below(&mut self, prim: &Prim, context: Context, overs: bool, shown: &mut Vec<Shown>) {
        let mut stack = Vec::new();
        let reading = self.reading;
        let push = |stack: &mut Vec<(Prim, Rc<Context>)>, prim: &Prim, context: Context| {
            cycles::mend(reading);
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
    /// there is something to see in them.
    pub fn enter(&mut self, prim: &Prim, context: &Context, overs: bool, shown: &mut Vec<Shown>) -> Option<Context> {
        let reading = self.reading;
        let defined = match prim.specifier().ok().flatten() {
            Some(Specifier::Def) => true,
            Some(Specifier::Over) => overs,
            Some(Specifier::Class) | None => false,
        };
        if !defined || !prim.is_active().unwrap_or(false) {
            return None;
        }
        let kind = self.kind(prim);
        if let Role::Aside = kind.role {
            return None;
        }
        let names = prim.authored_property_names().unwrap_or_default();
        let mut inner = context.enter(&mut self.clock, prim, kind.imageable, &names);
        self.warn_of_draw_mode(prim, &names);
        if prim.is_instance().unwrap_or(false) {
            inner.hand_down_primvars(reading, prim, &names);
            self.instance(prim, inner, shown);
            return None;
        }
        match kind.role {
            Role::Leaf => self.leaf(prim, &kind, context, &inner, &names, shown),
            Role::Instancer => {
                if !inner.hidden(reading) {
                    super::instancer::walk(self, prim, &inner, shown);
                }
                return None;
            }
            Role::Group | Role::Aside => {}
        }
        inner.hand_down_primvars(reading, prim, &names);
        Some(inner)
    }

    fn leaf(
        &mut self,
        prim: &Prim,
        kind: &Kind,
        outer: &Context,
        inner: &Context,
        names: &[Token],
        shown: &mut Vec<Shown>,
    ) {
        let hidden = inner.hidden(self.reading);
        if hidden && &*kind.name != "Camera" {
            return;
        }
        let leaf = Leaf {
            prim: prim.clone(),
            kind: kind.name.clone(),
            primvars: outer.primvars.clone(),
            bindings: inner.bindings.clone(),
            visible: !hidden,
            linked: names
                .iter()
                .any(|n| n.starts_with("collection:lightLink:") || n.starts_with("collection:shadowLink:")),
        };
        let (path, asset) = (prim.path().clone(), inner.asset.clone());
        self.show(Shown { leaf: Rc::new(leaf), path, pose: inner.pose.clone(), asset, scope: None }, shown);
    }

    /// Adds one.
    pub fn show(&mut self, one: Shown, shown: &mut Vec<Shown>) {
        self.count += 1;
        if self.count > MOST_PRIMS {
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

    /// What the instance `prim` shows: what the first instance of its prototype in like surroundings does.
    fn instance(&mut self, prim: &Prim, context: Context, shown: &mut Vec<Shown>) {
        let Some(root) = prim.prototype().ok().flatten() else { return };
        let known = self.prototypes.get(&root);
        let first = known.map_or(prim, |known| &known.first).clone();
        let alike = known.and_then(|known| known.shown.iter().find(|(other, _)| self.alike(other, &context)));
        let prototype = match alike {
            Some((_, shown)) => shown.clone(),
            None => {
                let mut inside = Vec::new();
                let pose = Pose::still(DAffine3::IDENTITY);
                let within = Context { pose, bindings: None, asset: None, ..context.clone() };
                self.below(&first, within, false, &mut inside);
                let inside = Rc::new(inside);
                let prototype = Prototype { first: first.clone(), shown: Vec::new() };
                let known = self.prototypes.entry(root).or_insert(prototype);
                known.shown.push((context.clone(), inside.clone()));
                inside
            }
        };
        if !self.affords(prototype.len(), prim) {
            return;
        }
        let (walked, instance) = (first.path().clone(), prim.path().clone());
        let scope = Rc::new(Scope { outer: None, bindings: context.bindings, walked: walked.clone(), instance });
        let mut scopes: Vec<(Rc<Scope>, Rc<Scope>)> = Vec::new();
        for inner in prototype.iter() {
            let scope = match &inner.scope {
                None => scope.clone(),
                Some(inside) => match scopes.iter().find(|(known, _)| Rc::ptr_eq(known, inside)) {
                    Some((_, scope)) => scope.clone(),
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
            self.show(Shown { leaf: inner.leaf.clone(), path, pose, asset, scope: Some(scope) }, shown);
        }
    }

    /// True where a prototype looks the same in both surroundings.
    fn alike(&self, a: &Context, b: &Context) -> bool {
        if !a.shows_like(b) || a.primvars.len() != b.primvars.len() {
            return false;
        }
        Rc::ptr_eq(&a.primvars, &b.primvars) || a.primvars.iter().zip(&*b.primvars).all(|(a, b)| self.equal(a, b))
    }

    fn equal(&self, a: &Primvar, b: &Primvar) -> bool {
        let (of_a, of_b) = (a.attribute(), b.attribute());
        if of_a.path() == of_b.path() {
            return true;
        }
        let value = |primvar: &Primvar| primvar.compute_flattened::<sdf::Value>(self.reading.time).ok();
        let same_type = of_a.type_name().ok() == of_b.type_name().ok();
        of_a.name() == of_b.name() && same_type && value(a) == value(b)
    }

    fn warn_of_draw_mode(&self, prim: &Prim, names: &[Token]) {
        if !names.iter().any(|name| name.as_str() == "model:drawMode") {
            return;
        }
        let Some(mode) = self.reading.value::<Token>(prim, "model:drawMode") else { return };
        let applied = || self.reading.value::<bool>(prim, "model:applyDrawMode") == Some(true);
        if matches!(mode.as_str(), "bounds" | "origin" | "cards") && (applied() || prim.is_component().unwrap_or(false))
        {
            self.reading.warn(prim.path(), format!("draw mode '{mode}' is not drawn; the prim's geometry is"));
        }
    }

    fn kind(&mut self, prim: &Prim) -> Kind {
        let token = prim.type_name().ok().flatten().unwrap_or_default();
        if let Some(kind) = self.kinds.get(&token) {
            return kind.clone();
        }
        let registry = self.reading.stage.schema_registry();
        // A type that is not known may name others that it can be taken for.
        let schema =
            if registry.is_concrete_type(&token) { Some(token.clone()) } else { prim.schema_type().ok().flatten() };
        let role = match (schema.as_ref().unwrap_or(&token)).as_str() {
            "" | "Xform" | "Scope" | "SkelRoot" => Role::Group,
            "Material" | "NodeGraph" | "Shader" | "GeomSubset" | "Skeleton" | "SkelAnimation" | "BlendShape"
            | "RenderSettings" | "RenderProduct" | "RenderVar" | "RenderPass" | "SpatialAudio" => Role::Aside,
            physics if physics.starts_with("Physics") => Role::Aside,
            "PointInstancer" => Role::Instancer,
            _ if schema.is_some() => Role::Leaf,
            _ => {
                let what = format!("type '{token}' is of no schema that is known here; the prim itself shows nothing");
                self.reading.warn(prim.path(), what);
                Role::Group
            }
        };
        let imageable = schema.as_ref().is_some_and(|schema| registry.is_a(schema, &Token::from("Imageable")));
        let kind = Kind { name: schema.as_ref().unwrap_or(&token).as_str().into(), role, imageable };
        if schema.as_ref() == Some(&token) || token.as_str().is_empty() {
            self.kinds.insert(token, kind.clone());
        }
        kind
    }
}
