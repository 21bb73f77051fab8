//! What an input of something else than a material, as a light, is connected to.

use std::collections::BTreeSet;

use openusd::usd::Attribute;

use super::super::images::Images;
use super::super::stage::Reading;
use super::evaluate::{Evaluator, widen};
use super::network::Value;
use super::{Materials, shade};
use crate::desc::graph::Value as V;

/// The value that `attribute` takes from its connection: that of an input of a material or node graph, or what nodes
/// compute of such. `None` where there is none, or none that is the same everywhere.
pub(in super::super) fn of_connection(reading: &Reading<'_>, attribute: &Attribute) -> Option<V> {
    let (network, input) = shade::connected(reading, attribute)?;
    if let Some(Value::Numbers(values, count)) = input.value {
        return Some(widen(values, count));
    }
    let mut materials = Materials::new(reading, Images::default(), BTreeSet::new(), Vec::new());
    let mut evaluator = Evaluator::new(&mut materials, &network);
    let id = evaluator.output(&input.source?)?;
    evaluator.exprs.known(id)
}
