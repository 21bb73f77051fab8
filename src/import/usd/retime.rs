//! Times of classes that are implied across references. OpenUSD has them in the time of the layer in which they
//! are implied. The openusd crate (0.8) conjugates the arc but forgets to undo the offset on the way back, and so
//! shifts and stretches them as if they were in the referenced layer; it is asked at other times instead.

use openusd::pcp::{ArcType, Node, PrimIndex};
use openusd::sdf::LayerOffset;
use openusd::usd::{Attribute, ResolveInfoSource, TimeCode};

use super::implied::is_class;
use super::stage::Reading;

/// From time of the stage to the time at which the crate gives what OpenUSD has then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Retime(LayerOffset);

impl Retime {
    /// That of the samples of `attribute`; `None` where the crate has them right.
    pub fn of(reading: &Reading<'_>, attribute: &Attribute) -> Option<Self> {
        // Few stages imply anything, and others are not to be searched.
        if !reading.has_referenced_classes() || !attribute.value_might_be_time_varying().unwrap_or(false) {
            return None;
        }
        let info = attribute.resolve_info().ok()?;
        let found = info.node().filter(|_| info.source() == ResolveInfoSource::TimeSamples)?;
        let given = found.map_to_root().time_offset();
        let index = reading.stage.prim_index(attribute.path().prim_path()).ok()?.graph().ok()?;
        let is_it = |node: &&Node| {
            node.arc() == found.arc() && node.path() == found.path() && node.map_to_root() == found.map_to_root()
        };
        let node = index.nodes().find(is_it)?;
        let retime = given.concatenate(&offset(&index, node).inverse());
        let is_same = (retime.offset.abs() + (retime.scale - 1.0).abs()) < 1e-12;
        (!is_same && given.scale != 0.0).then_some(Self(retime))
    }

    /// The time at which the crate is to be asked.
    pub fn asked(self, time: TimeCode) -> TimeCode {
        if time.is_earliest_time() { time } else { TimeCode::new(self.0.apply(time.value())) }
    }

    /// The time of the stage that the crate has at `time`.
    pub fn told(self, time: f64) -> f64 {
        self.0.inverse().apply(time)
    }
}

/// As OpenUSD has it: from the time of the layer stack of `node` to that of the stage.
fn offset(index: &PrimIndex, node: &Node) -> LayerOffset {
    let Some(parent) = node.parent() else { return LayerOffset::IDENTITY };
    if !is_class(node.arc()) {
        return offset(index, index.node(parent)).concatenate(&node.map_to_parent().time_offset());
    }
    // Specializes are copied below the root, where they keep the time of where they come from.
    let origin = node.origin().filter(|origin| *origin != parent).map(|origin| index.node(origin));
    match origin.filter(|_| node.arc() == ArcType::Specialize) {
        Some(origin) if origin.layer_id() == node.layer_id() && origin.path() == node.path() => offset(index, origin),
        _ => offset(index, index.node(parent)),
    }
}

/// Times of the stage from `open` to `close` at which one of `attributes` has a sample.
pub(super) fn samples(reading: &Reading<'_>, attributes: &[Attribute], open: f64, close: f64) -> Vec<f64> {
    if !reading.has_referenced_classes() {
        return Attribute::unioned_time_samples_in_interval(attributes, open..=close).unwrap_or_default();
    }
    let of = |attribute: &Attribute| match Retime::of(reading, attribute) {
        None => attribute.time_samples_in_interval(open..=close).unwrap_or_default(),
        Some(retime) => {
            let [open, close] = [open, close].map(|time| retime.asked(TimeCode::new(time)).value());
            let times = attribute.time_samples_in_interval(open.min(close)..=open.max(close)).unwrap_or_default();
            times.into_iter().map(|time| retime.told(time)).collect()
        }
    };
    let mut times: Vec<f64> = attributes.iter().flat_map(of).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
