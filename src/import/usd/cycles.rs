//! Inherits and specializes that lead back to where they started. OpenUSD leaves the last of them out; the
//! openusd crate (0.8) follows them until the stack ends, so they are taken out of its layers, in memory,
//! before anything below them is composed; those that go through several layers: [`implied`](super::implied). As
//! that looks at every prim of a layer, it notes which stages have value clips, and the classes of referenced layers,
//! and tells of offsets that count for nothing.

use std::collections::{HashMap, HashSet};

use openusd::sdf::{self, ChildrenKey, FieldKey, Value};

use super::stage::Reading;
use super::{layer, offsets};
use crate::error::Place;

pub(super) const ARCS: [FieldKey; 2] = [FieldKey::InheritPaths, FieldKey::Specializes];

/// An authored arc.
struct Arc {
    layer: String,
    /// The spec that has it.
    spec: sdf::Path,
    /// Its prim, and the class.
    from: sdf::Path,
    to: sdf::Path,
}

/// Takes the cycles out of the layers that were opened since the last call.
pub(super) fn mend(reading: &Reading<'_>) {
    let seen = reading.layers.get();
    if reading.stage.layer_count() == seen {
        return;
    }
    let new: Vec<String> = reading.stage.layer_identifiers().into_iter().skip(seen).collect();
    reading.layers.set(seen + new.len());
    if reading.met.borrow().renamed {
        new.iter().for_each(|layer| layer::restore_names(&reading.stage, layer));
    }
    if seen == 0 {
        // The layers of the stage itself, which are composed with one another.
        break_cycles(reading, &new);
        return;
    }
    for layer in new.chunks(1) {
        // What others inherit is implied where they are referred to.
        let classes = break_cycles(reading, layer);
        reading.classes.borrow_mut().extend(classes);
    }
}

/// Takes them out of `layers`; gives the classes of all arcs that these have.
fn break_cycles(reading: &Reading<'_>, layers: &[String]) -> Vec<sdf::Path> {
    let mut arcs = Vec::new();
    layers.iter().for_each(|layer| collect(reading, layer, &mut arcs));
    let classes = arcs.iter().map(|arc| arc.to.clone()).collect();
    let mut told = HashSet::new();
    for arc in cyclic(arcs) {
        let Some(mut layer) = reading.stage.layer_mut(&arc.layer) else { continue };
        let removed = layer.edit(|edit| {
            ARCS.iter().for_each(|field| edit.data_mut().erase_field(&arc.spec, field.as_str()));
            Ok(())
        });
        drop(layer);
        if told.insert(arc.spec.clone()) {
            let what = match removed {
                Ok(_) => format!("inherits from itself by way of {}; what it inherits is left out", arc.to),
                Err(error) => format!("inherits from itself by way of {}: {error}", arc.to),
            };
            reading.warnings.borrow_mut().push(&Place::file(&arc.layer).at(arc.from.as_str()), what);
        }
    }
    classes
}

/// Every arc of a layer.
fn collect(reading: &Reading<'_>, identifier: &str, arcs: &mut Vec<Arc>) {
    let Some(layer) = reading.stage.layer(identifier) else { return };
    let data = layer.data();
    let children = |path: &sdf::Path, key: ChildrenKey| {
        let field = data.try_field(path, key.as_str()).ok().flatten();
        field.and_then(|value| value.into_owned().try_as_token_vec()).unwrap_or_default()
    };
    let mut stack = vec![sdf::Path::abs_root()];
    while let Some(spec) = stack.pop() {
        offsets::tell(reading, identifier, data, &spec);
        if data.has_field(&spec, FieldKey::Clips.as_str()) {
            reading.clipped.set(true);
        }
        for field in ARCS {
            let Ok(Some(value)) = data.try_field(&spec, field.as_str()) else { continue };
            let Value::PathListOp(list) = value.into_owned() else { continue };
            let from = spec.strip_all_variant_selections();
            arcs.extend(list.flatten().iter().map(|to| Arc {
                layer: identifier.to_owned(),
                to: from.make_absolute(to).strip_all_variant_selections(),
                spec: spec.clone(),
                from: from.clone(),
            }));
        }
        let prims = children(&spec, ChildrenKey::PrimChildren);
        stack.extend(prims.iter().filter_map(|name| spec.append_path(name.as_str()).ok()));
        for set in children(&spec, ChildrenKey::VariantSetChildren) {
            let Ok(path) = spec.append_variant_selection(set.as_str(), "") else { continue };
            let choices = children(&path, ChildrenKey::VariantChildren);
            stack.extend(choices.iter().filter_map(|c| spec.append_variant_selection(set.as_str(), c.as_str()).ok()));
        }
    }
}

/// Those of `arcs` that are part of a cycle, or lie between two: one leads to all that its class and the
/// ancestors of that have.
fn cyclic(mut arcs: Vec<Arc>) -> Vec<Arc> {
    loop {
        let before = arcs.len();
        let owners: HashSet<sdf::Path> = arcs.iter().map(|arc| arc.from.clone()).collect();
        let mut reached: HashMap<sdf::Path, bool> = owners.iter().map(|owner| (owner.clone(), false)).collect();
        arcs.retain(|arc| {
            let mut leads = false;
            for path in arc.to.ancestors_below_root() {
                if let Some(reached) = reached.get_mut(&path) {
                    (*reached, leads) = (true, true);
                }
            }
            leads
        });
        arcs.retain(|arc| reached.get(&arc.from) == Some(&true));
        if arcs.len() == before {
            return arcs;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::error::Warnings;
    use crate::import::ImportOptions;

    /// What is said of a stage of these lines.
    fn said(text: &str) -> Vec<String> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("stage.usda");
        std::fs::write(&path, format!("#usda 1.0\n{text}")).unwrap();
        let mut warnings = Warnings::new();
        super::super::load(&path, &ImportOptions::default(), &mut warnings).unwrap();
        warnings.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_prim_that_inherits_from_itself_is_told_and_the_rest_is_there() {
        for (arc, class) in [("inherits", "/A/B"), ("specializes", "/A/B"), ("inherits", "/A/B/C"), ("inherits", "/A")]
        {
            let body = "def Sphere \"C\" { def Xform \"D\" { } }\n def Sphere \"E\" { }";
            let said = said(&format!("def Xform \"A\" {{ def Xform \"B\" ({arc} = <{class}>) {{ {body} }} }}"));
            // The crate finds a prim that inherits from its own parent by itself.
            let what = if class == "/A" { "/A/B: is composed of itself" } else { "/A/B: inherits from itself" };
            assert!(said.iter().any(|said| said.contains(what)), "{class}: {said:?}");
        }
    }

    #[test]
    fn classes_that_inherit_from_each_other_are_told() {
        let said = said(
            "class \"A\" (inherits = </B>) { def Sphere \"C\" { } }\nclass \"B\" (inherits = </A>) { }\ndef \"D\" (inherits = </A>) { }",
        );
        assert_eq!(said.iter().filter(|said| said.contains("inherits from itself")).count(), 2, "{said:?}");
    }

    #[test]
    fn classes_of_classes_are_sound() {
        let text = "class \"A\" { class \"K\" { } }\nclass \"B\" (inherits = </A>) { def Sphere \"S\" (inherits = </A/K>) { } }\ndef \"D\" (inherits = </B>) { }";
        assert_eq!(said(text), [""; 0]);
    }
}
