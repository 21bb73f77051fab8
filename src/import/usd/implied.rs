//! Classes that are implied across references and lead back to where they started. What a referenced prim
//! inherits or specializes is implied in every layer that refers to it; where such a class holds the very prim
//! that refers, the prim is composed of itself. OpenUSD leaves that out. The openusd crate (0.8) looks for cycles
//! among authored arcs alone and goes around for ever, each prim holding the next, so the authored arc is made a
//! reference in memory, which has the class of its own layer and implies nothing.

use openusd::pcp::{ArcType, Node, PrimIndex};
use openusd::sdf::{self, FieldKey, Reference, Value};
use openusd::usd::Prim;

use super::cycles::ARCS;
use super::stage::Reading;
use crate::error::Place;

/// An authored arc whose class is implied where it closes a cycle.
struct Cycle {
    layer: String,
    spec: sdf::Path,
    field: FieldKey,
    /// As authored.
    class: sdf::Path,
    /// The layer and the prim that it is implied at.
    at: (String, sdf::Path),
}

/// Mends what `prim` is composed of, before what is below it is composed.
pub(super) fn mend(reading: &Reading<'_>, prim: &Prim) {
    // Only what referenced layers have is implied.
    if !reading.has_referenced_classes() {
        return;
    }
    while let Some(cycle) = find(reading, prim) {
        if !make_reference(reading, &cycle) {
            return;
        }
    }
}

pub(super) fn is_class(arc: ArcType) -> bool {
    matches!(arc, ArcType::Inherit | ArcType::Specialize)
}

fn find(reading: &Reading<'_>, prim: &Prim) -> Option<Cycle> {
    let index = prim.prim_index().graph().ok()?;
    // Nodes that the crate culled imply nothing.
    index.nodes().filter(|node| closes(&index, node)).find_map(|node| authored(reading, &index, node))
}

/// True for a class that is implied at a node of which it is part, or which is part of it.
fn closes(index: &PrimIndex, node: &Node) -> bool {
    let Some(parent) = node.parent().filter(|_| is_class(node.arc()) && node.origin() != node.parent()) else {
        return false;
    };
    // A class that refers to what inherits it: OpenUSD as well as the crate has that once.
    if index.node(parent).path() == node.path() {
        return false;
    }
    let mut nested = false;
    let mut above = Some(parent);
    while let Some(id) = above {
        let site = index.node(id);
        // Relocates put classes into one another that are sound.
        if site.arc() == ArcType::Relocate {
            return false;
        }
        nested |= site.layer_id() == node.layer_id() && site.path().is_nested_with(node.path());
        above = site.parent();
    }
    nested
}

/// Where the class of `node` is authored.
fn authored(reading: &Reading<'_>, index: &PrimIndex, node: &Node) -> Option<Cycle> {
    let implied = index.node(node.parent()?);
    let mut first = node;
    while let Some(origin) = first.origin().filter(|origin| Some(*origin) != first.parent()) {
        first = index.node(origin);
    }
    let site = index.node(first.parent()?);
    let [prim, class] = [site, first].map(|node| node.path().strip_all_variant_selections());
    for (layer, _) in reading.stage.node_layer_stack(site)? {
        let Some(identifier) = reading.stage.layer_identifier(layer) else { continue };
        let Some(layer) = reading.stage.layer(&identifier) else { continue };
        // The arc of a prim counts for all that is below it.
        let mut spec = site.path().clone();
        while !spec.is_abs_root() {
            let from = spec.strip_all_variant_selections();
            for field in ARCS {
                let Ok(Some(value)) = layer.data().try_field(&spec, field.as_str()) else { continue };
                let Value::PathListOp(list) = value.into_owned() else { continue };
                let leads = |to: &&sdf::Path| {
                    let to = from.make_absolute(to).strip_all_variant_selections();
                    prim.replace_prefix(&from, &to).is_some_and(|path| path == class)
                };
                if let Some(class) = list.flatten().iter().find(leads) {
                    let (class, identifier) = (class.clone(), identifier.clone());
                    let at = (reading.stage.layer_identifier(implied.layer_id())?, implied.path().clone());
                    return Some(Cycle { layer: identifier, spec, field, class, at });
                }
            }
            spec = spec.parent()?;
        }
    }
    None
}

/// True where the arc could be made a reference, which is told.
fn make_reference(reading: &Reading<'_>, cycle: &Cycle) -> bool {
    let Some(mut layer) = reading.stage.layer_mut(&cycle.layer) else { return false };
    let from = cycle.spec.strip_all_variant_selections();
    let to = from.make_absolute(&cycle.class).strip_all_variant_selections();
    let edited = layer.edit(|edit| {
        let data = edit.data_mut();
        let read = |field: FieldKey| data.try_field(&cycle.spec, field.as_str()).ok().flatten().map(|v| v.into_owned());
        let Some(Value::PathListOp(classes)) = read(cycle.field) else { return Ok(()) };
        let mut references = match read(FieldKey::References) {
            Some(Value::ReferenceListOp(references)) => references,
            _ => Default::default(),
        };
        let reference = Reference { prim_path: to.clone(), ..Reference::default() };
        let is_explicit = references.explicit;
        // Inherited opinions go before referenced ones, specialized ones after.
        match (cycle.field, is_explicit) {
            (FieldKey::InheritPaths, true) => references.explicit_items.insert(0, reference),
            (FieldKey::InheritPaths, false) => references.prepended_items.insert(0, reference),
            (_, true) => references.explicit_items.push(reference),
            (_, false) => references.appended_items.push(reference),
        }
        let classes = classes.filter_map(|class| (class != cycle.class).then_some(class));
        data.set_field(&cycle.spec, cycle.field.as_str(), Value::PathListOp(classes));
        data.set_field(&cycle.spec, FieldKey::References.as_str(), Value::ReferenceListOp(references));
        Ok(())
    });
    drop(layer);
    let (layer, at) = &cycle.at;
    let what = format!(
        "is composed of itself by way of {to}, which is implied at {at} of {layer}; of {to} in layers that refer to this one nothing is taken",
    );
    reading.warnings.borrow_mut().push(&Place::file(&cycle.layer).at(from.as_str()), what);
    edited.is_ok()
}
