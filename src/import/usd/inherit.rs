//! What a prim takes from its ancestors, handed down from parent to child.

use std::borrow::Cow;
use std::rc::Rc;
use std::sync::Arc;

use openusd::tf::Token;
use openusd::usd::{Attribute, Prim, TimeCode};
use openusd_schemas::geom::Primvar;

use super::bindings::Bindings;
use super::draw_mode::DrawMode;
use super::kinds::Kind;
use super::stage::Reading;
use super::values::pick;
use super::xform::Xform;
use super::{retime, skel};
use crate::desc::Motion;
use crate::import::Purpose;
use crate::math::DAffine3;

/// Where something is: at the frame and at the times of the shutter.
#[derive(Clone)]
pub(super) struct Pose {
    /// Object to the space that the walk started in.
    pub world: DAffine3,
    /// The same at each of the walk's times; `None` for what does not move.
    pub motion: Option<Arc<[DAffine3]>>,
    /// True below `!resetXformStack!`: `world` leads to our space, whatever the walk started in.
    pub absolute: bool,
}

impl Pose {
    /// Something that stays where it is.
    pub fn still(world: DAffine3) -> Self {
        Self { world, motion: None, absolute: false }
    }

    /// What is at `inner` within this.
    pub fn place(&self, inner: &Self) -> Self {
        if inner.absolute {
            return inner.clone();
        }
        let motion = match (&self.motion, &inner.motion) {
            (None, None) => None,
            (Some(outer), None) => Some(outer.iter().map(|&outer| outer * inner.world).collect()),
            (None, Some(motion)) => Some(motion.iter().map(|&inner| self.world * inner).collect()),
            (Some(outer), Some(inner)) => Some(outer.iter().zip(&**inner).map(|(&o, &i)| o * i).collect()),
        };
        Self { world: self.world * inner.world, motion, absolute: self.absolute }
    }
}

/// The transforms of `pose` at `times`.
pub(super) fn moving(times: &[f64], pose: &Pose) -> Vec<Motion<DAffine3>> {
    let values = pose.motion.iter().flat_map(|values| values.iter());
    times.iter().zip(values).map(|(&time, &value)| Motion { time, value }).collect()
}

/// What the children of a prim take from it and from all above.
#[derive(Clone)]
pub(super) struct Context {
    pub pose: Pose,
    pub purpose: Option<Purpose>,
    /// Opinions of VisibilityAPI for render, proxy and guide; true for what is hidden.
    pub hidden_purposes: [bool; 3],
    /// True where the prim or one above it is invisible.
    pub invisible: bool,
    pub primvars: Rc<Vec<Primvar>>,
    pub bindings: Option<Rc<Bindings>>,
    /// Name of the model that it belongs to; `None` above any.
    pub asset: Option<Arc<str>>,
    /// True where a child may be a model.
    pub group: bool,
    /// How models are drawn instead of themselves.
    pub draw_mode: Option<DrawMode>,
    /// Which skeleton is followed; `None` where none is named.
    pub skel: Option<Rc<skel::Inherited>>,
}

impl Context {
    /// That of what stands in the root, whose space is `pose`.
    pub fn root(pose: Pose) -> Self {
        Self {
            pose,
            purpose: None,
            hidden_purposes: [false; 3],
            invisible: false,
            primvars: Rc::default(),
            bindings: None,
            asset: None,
            group: true,
            draw_mode: None,
            skel: None,
        }
    }

    /// True where nothing but a camera is of use.
    pub fn hidden(&self, reading: &Reading<'_>) -> bool {
        let Some(purpose) = self.purpose else { return self.invisible };
        self.invisible || self.hidden_purposes[index(purpose)] || !reading.purposes.contains(&purpose)
    }

    /// True where the same prims below both are hidden or replaced.
    pub fn shows_like(&self, other: &Self) -> bool {
        self.draw_mode == other.draw_mode
            && self.invisible == other.invisible
            && self.purpose == other.purpose
            && self.hidden_purposes == other.hidden_purposes
    }

    /// That of `prim`, whose authored properties are `names`, without its primvars, which only its children
    /// inherit. Opinions that its `kind` has no use for do not count.
    pub fn enter(&self, clock: &mut Clock<'_, '_>, prim: &Prim, kind: &Kind, names: &[Token]) -> Self {
        let reading = clock.reading;
        let mut inner = self.clone();
        if self.group {
            let kinds = reading.stage.schema_registry().kinds();
            let model = prim.kind().ok().flatten();
            inner.group = model.as_ref().is_some_and(|kind| kinds.is_group(kind));
            // A published asset, or what stands in the root where there is none.
            if prim.path().is_root_prim() || model.is_some_and(|kind| kinds.is_component(&kind)) {
                inner.asset = prim.path().name().map(Into::into);
            }
        }
        let (mut binds, mut follows) = (false, &*kind.name == "SkelRoot");
        for name in names {
            match name.as_str() {
                "xformOpOrder" if kind.xformable => inner.pose = self.pose_of(clock, prim, names),
                "visibility" if kind.imageable => {
                    let token = reading.value::<Token>(prim, name);
                    let choices = [("inherited", false), ("invisible", true)];
                    inner.invisible |= pick(reading, prim, "visibility", token, &choices);
                }
                "model:drawMode" => inner.draw_mode = DrawMode::of(reading, prim, self.draw_mode),
                "purpose" if kind.imageable => inner.purpose = self.purpose_of(reading, prim, name),
                "renderVisibility" | "proxyVisibility" | "guideVisibility" if kind.imageable => {
                    let at =
                        ["renderVisibility", "proxyVisibility", "guideVisibility"].iter().position(|n| *n == &**name);
                    let hidden = at.map(|at| &mut inner.hidden_purposes[at]);
                    match (hidden, token(reading, prim, name).as_str()) {
                        (Some(hidden), "invisible") => *hidden = true,
                        (Some(hidden), "visible") => *hidden = false,
                        _ => {}
                    }
                }
                other => {
                    binds |= other.starts_with("material:binding");
                    follows |= skel::is_of_binding(other);
                }
            }
        }
        if follows {
            inner.skel = skel::Inherited::of(reading, prim, kind, names, self.skel.as_ref());
        }
        if binds {
            inner.bindings = Bindings::of(reading, prim, names, self.bindings.clone());
        }
        inner
    }

    /// Adds the primvars of `prim` that its children inherit.
    pub fn hand_down_primvars(&mut self, reading: &Reading<'_>, prim: &Prim, names: &[Token]) {
        if !names.iter().any(|name| name.starts_with("primvars:")) {
            return;
        }
        match inheritable(prim, &self.primvars) {
            Ok(Some(primvars)) => self.primvars = Rc::new(primvars),
            Ok(None) => {}
            Err(error) => reading.warn(prim.path(), format!("{error}; its primvars are not inherited")),
        }
    }

    fn purpose_of(&self, reading: &Reading<'_>, prim: &Prim, name: &Token) -> Option<Purpose> {
        match token(reading, prim, name).as_str() {
            "render" => Some(Purpose::Render),
            "proxy" => Some(Purpose::Proxy),
            "guide" => Some(Purpose::Guide),
            "default" => None,
            "" => self.purpose,
            other => {
                reading.warn(prim.path(), format!("purpose '{other}' is not known; taken for default"));
                None
            }
        }
    }

    fn pose_of(&self, clock: &mut Clock<'_, '_>, prim: &Prim, names: &[Token]) -> Pose {
        let reading = clock.reading;
        let Some(xform) = Xform::of(reading, prim, names) else { return self.pose.clone() };
        let inner = Pose { world: xform.at(reading, reading.time), motion: clock.motion(&xform), absolute: false };
        let resets = xform.resets;
        clock.note(|| Mover::Transform(xform));
        if resets {
            return Pose { absolute: true, ..Pose::still(reading.to_world).place(&inner) };
        }
        self.pose.place(&inner)
    }
}

/// When a walk looks at what moves.
pub(super) struct Clock<'r, 'a> {
    pub reading: &'r Reading<'a>,
    /// Time codes after the frame, in order; empty where nothing may move.
    pub times: Vec<f64>,
    /// What might move, as far as it was met; `None` where nobody wants to know.
    movers: Option<Vec<Mover>>,
}

/// Something that might move.
pub(super) enum Mover {
    Transform(Xform),
    /// What these attributes move, as the instances of a point instancer; true where there are velocities.
    Attributes(Vec<Attribute>, bool),
}

impl Mover {
    /// Times of its samples from `open` to `close`; `None` where it stays.
    fn samples(&self, reading: &Reading<'_>, open: f64, close: f64) -> Option<Vec<f64>> {
        match self {
            Self::Transform(xform) if xform.varies() => Some(xform.samples(reading, open, close)),
            Self::Attributes(attributes, velocities)
                if *velocities || attributes.iter().any(|a| a.value_might_be_time_varying().unwrap_or(false)) =>
            {
                Some(retime::samples(reading, attributes, open, close))
            }
            _ => None,
        }
    }
}

impl<'r, 'a> Clock<'r, 'a> {
    /// Of a walk while nothing moves.
    pub fn still(reading: &'r Reading<'a>) -> Self {
        Self { reading, times: Vec::new(), movers: None }
    }

    /// Of a walk that only takes note of what might move.
    pub fn noting(reading: &'r Reading<'a>) -> Self {
        Self { movers: Some(Vec::new()), ..Self::still(reading) }
    }

    /// Of a walk that looks at `times`.
    pub fn at(reading: &'r Reading<'a>, times: Vec<f64>) -> Self {
        Self { reading, times, movers: None }
    }

    /// When to look at what was met while the shutter is open from `open` to `close`: at both, and at every
    /// sample between them. Empty where nothing moves.
    pub fn samples(&mut self, [open, close]: [f64; 2]) -> Vec<f64> {
        let frame = self.reading.time.value();
        let movers = self.movers.take().unwrap_or_default();
        let samples: Vec<Vec<f64>> =
            movers.iter().filter_map(|m| m.samples(self.reading, frame + open, frame + close)).collect();
        if samples.is_empty() {
            return Vec::new();
        }
        let mut times: Vec<f64> = samples.into_iter().flatten().map(|time| time - frame).collect();
        times.retain(|time| open < *time && *time < close);
        times.extend([open, close]);
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Takes note of something that might move.
    pub fn note(&mut self, mover: impl FnOnce() -> Mover) {
        if let Some(movers) = &mut self.movers {
            movers.push(mover());
        }
    }

    /// The local transform `xform` at each of the times, if it moves.
    fn motion(&self, xform: &Xform) -> Option<Arc<[DAffine3]>> {
        if self.times.is_empty() || !xform.varies() {
            return None;
        }
        let frame = self.reading.time.value();
        Some(self.times.iter().map(|time| xform.at(self.reading, TimeCode::new(frame + time))).collect())
    }
}

/// The primvars that the children of `prim` inherit, of which `inherited` reach the prim itself; `None` where
/// these are the same. As the crate's `find_incrementally_inheritable_primvars`, but whether there is a value,
/// for which the crate decodes all of it, is asked only where it matters: UVs are not inherited anyway.
fn inheritable(prim: &Prim, inherited: &[Primvar]) -> openusd::Result<Option<Vec<Primvar>>> {
    let mut primvars = Cow::Borrowed(inherited);
    for attribute in prim.authored_attributes_in_namespace("primvars")? {
        let Some(primvar) = Primvar::from_attribute(attribute) else { continue };
        let known = primvars.iter().position(|other| other.attribute().name() == primvar.attribute().name());
        let interpolation = primvar.attribute().get_metadata::<Token>("interpolation")?;
        let is_constant = interpolation.is_none_or(|token| token == "constant");
        if !(is_constant || known.is_some()) || !primvar.attribute().has_authored_value()? {
            continue;
        }
        match known {
            Some(known) if is_constant => primvars.to_mut()[known] = primvar,
            Some(known) => _ = primvars.to_mut().remove(known),
            None => primvars.to_mut().push(primvar),
        }
    }
    Ok(match primvars {
        Cow::Borrowed(_) => None,
        Cow::Owned(primvars) => Some(primvars),
    })
}

fn token(reading: &Reading<'_>, prim: &Prim, name: &Token) -> String {
    reading.value::<Token>(prim, name).map_or_else(String::new, |token| token.to_string())
}

fn index(purpose: Purpose) -> usize {
    match purpose {
        Purpose::Render => 0,
        Purpose::Proxy => 1,
        Purpose::Guide => 2,
    }
}
