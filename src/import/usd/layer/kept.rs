//! What mended layers keep for us in fields of their own, composed as OpenUSD composes it.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use openusd::sdf::{self, LayerOffset, Value};
use openusd::usd::{Attribute, Prim, Stage, TimeCode};

use super::super::spline::{self, Spline};

/// The key under which a text layer's curve keeps its text.
pub(super) const KEPT: &str = "penumbra";
/// What operations on `inactiveIds` are named.
pub(super) const INACTIVE: &str = "penumbra_inactiveIds";
/// What the crate is not to see is named.
pub(super) const EDIT: &str = "penumbra_edit";

/// A curve that gives an attribute its values.
pub(in super::super) struct Site {
    spline: Spline,
    /// From the times of its layer to the stage's.
    offset: LayerOffset,
    kind: ScalarKind,
}

#[derive(Clone, Copy)]
enum ScalarKind {
    Half,
    Float,
    Double,
    TimeCode,
}

/// The curves that were asked for.
#[derive(Default)]
pub(in super::super) struct Kept(RefCell<HashMap<sdf::Path, Option<Rc<Site>>>>);

impl Kept {
    /// The curve that gives `attribute` its values; `None` where a stronger opinion or nothing does.
    pub fn spline(&self, stage: &Stage, attribute: &Attribute) -> Option<Rc<Site>> {
        if let Some(known) = self.0.borrow().get(attribute.path()) {
            return known.clone();
        }
        let found = site(stage, attribute).map(Rc::new);
        self.0.borrow_mut().insert(attribute.path().clone(), found.clone());
        found
    }
}

fn site(stage: &Stage, attribute: &Attribute) -> Option<Site> {
    let mut blocked = false;
    for site in attribute.property_stack().ok()? {
        // Value clips are of no layer of the stage; they come as samples.
        let layer = stage.layer(&site.layer)?;
        let field = |name: &str| layer.data().try_field(&site.path, name).ok().flatten();
        match field("timeSamples").as_deref() {
            Some(Value::TimeSamples(samples)) if !samples.is_empty() => return None,
            Some(Value::ValueBlock) => blocked = true,
            _ => {}
        }
        let kept = field("spline").filter(|_| !blocked);
        if let Some(value) = kept {
            let kind = match attribute.type_name().ok().flatten()?.as_str() {
                "half" => ScalarKind::Half,
                "float" => ScalarKind::Float,
                "double" => ScalarKind::Double,
                "timecode" => ScalarKind::TimeCode,
                _ => return None,
            };
            let spline = read(&value)?;
            let spline = match kind {
                ScalarKind::Half => spline.rounded(|value| half::f16::from_f64(value).to_f64()),
                ScalarKind::Float => spline.rounded(|value| f64::from(value as f32)),
                _ => spline,
            };
            return Some(Site { spline, offset: site.offset, kind });
        }
        if field("default").is_some() {
            return None;
        }
    }
    None
}

/// The curve in the field of a mended layer.
fn read(value: &Value) -> Option<Spline> {
    match value {
        Value::UcharVec(bytes) => spline::from_bytes(bytes),
        Value::Dictionary(fields) => {
            let Value::Dictionary(notes) = fields.get("knotCustomData")? else { return None };
            let Value::Dictionary(note) = notes.get("0")? else { return None };
            let Value::String(text) = note.get(KEPT)? else { return None };
            spline::from_text(text)
        }
        _ => None,
    }
}

impl Site {
    /// The value at `time`; `None` where the curve has none there.
    pub fn at(&self, time: TimeCode) -> Option<Value> {
        let LayerOffset { offset, scale } = self.offset;
        let time =
            if time.is_earliest_time() { self.spline.knots.first()?.time } else { (time.value() - offset) / scale };
        let value = self.spline.at(time)?;
        Some(match self.kind {
            ScalarKind::Half => Value::Half(half::f16::from_f64(value)),
            ScalarKind::Float => Value::Float(value as f32),
            ScalarKind::Double => Value::Double(value),
            ScalarKind::TimeCode => Value::TimeCode((value * scale + offset).into()),
        })
    }

    /// Times of the stage from `open` to `close` between which the curve is nearly straight: those of its
    /// knots, and even steps.
    pub fn samples(&self, open: f64, close: f64) -> Vec<f64> {
        const STEPS: u32 = 8;
        let LayerOffset { offset, scale } = self.offset;
        let ends = [open, close].map(|time| (time - offset) / scale);
        let knots = self.spline.times(ends[0].min(ends[1]), ends[0].max(ends[1]));
        let step = |i| open + (close - open) * f64::from(i) / f64::from(STEPS);
        knots.into_iter().map(|time| time * scale + offset).chain((0..=STEPS).map(step)).collect()
    }

    pub fn varies(&self) -> bool {
        self.spline.varies()
    }
}

/// The instances of `prim` that its `inactiveIds` switch off.
pub(in super::super) fn inactive_ids(stage: &Stage, prim: &Prim) -> HashSet<i64> {
    let mut ids = HashSet::new();
    for site in prim.prim_stack().unwrap_or_default().into_iter().rev() {
        let Some(layer) = stage.layer(&site.layer) else { continue };
        for name in ["inactiveIds", INACTIVE] {
            let field = layer.data().try_field(&site.path, name).ok().flatten();
            apply(field.as_deref(), &mut ids);
        }
    }
    ids
}

/// What one layer does to the ids of weaker ones.
fn apply(field: Option<&Value>, ids: &mut HashSet<i64>) {
    let listed = |text: &String| text.split(',').filter_map(|id| id.trim().parse().ok()).collect::<Vec<i64>>();
    match field {
        Some(Value::Int64Vec(all)) => *ids = all.iter().copied().collect(),
        // An empty list, whose elements have no type.
        Some(Value::StringVec(_) | Value::ValueBlock) => ids.clear(),
        Some(Value::Int64ListOp(list)) if list.explicit => *ids = list.explicit_items.iter().copied().collect(),
        Some(Value::Int64ListOp(list)) => {
            list.deleted_items.iter().for_each(|id| _ = ids.remove(id));
            ids.extend(list.added_items.iter().chain(&list.prepended_items).chain(&list.appended_items));
        }
        Some(Value::UnregisteredValueListOp(list)) => {
            list.deleted_items.iter().flat_map(listed).for_each(|id| _ = ids.remove(&id));
            let more = list.added_items.iter().chain(&list.prepended_items).chain(&list.appended_items);
            ids.extend(more.flat_map(listed));
        }
        _ => {}
    }
}
