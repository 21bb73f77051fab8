//! `--variant /Prim{set=choice}`: selections that come before the file's own.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use openusd::sdf::{self, Value};
use openusd::usd::{Prim, Stage};

use super::stage::chain;
use crate::error::{Error, Place, Result};

/// The choices of each variant set of a prim.
pub(super) type Sets = BTreeMap<String, BTreeSet<String>>;

/// Makes each of `wanted` the selection of its prim, in memory and in their order: a later one may name a
/// set that an earlier one brought in.
///
/// # Errors
/// A prim, set or choice that does not exist, with those that do.
pub(super) fn select(stage: &Stage, wanted: &[String], place: &Place) -> Result<()> {
    for text in wanted {
        let error = |what: String| Error::invalid(place, format!("--variant {text}: {what}"));
        let (path, selections) = parse(text).ok_or_else(|| error("expected /Prim{set=choice}".into()))?;
        let prim = stage.prim(path.as_str()).map_err(|e| error(e.to_string()))?;
        if !prim.is_valid().unwrap_or(false) {
            return Err(error(format!("there is no prim {path}; {}", siblings(stage, &prim))));
        }
        for (set, choice) in selections {
            let sets = sets(&prim);
            let Some(choices) = sets.get(&set) else {
                return Err(error(format!("{path} has no variant set '{set}'; {}", list("it has", sets.keys()))));
            };
            if !choices.contains(&choice) {
                let known = list("there are", choices);
                return Err(error(format!("variant set '{set}' of {path} has no '{choice}'; {known}")));
            }
            author(stage, &prim, set, choice).map_err(|e| error(chain(&e)))?;
        }
    }
    Ok(())
}

/// What `prim` offers.
pub(super) fn sets(prim: &Prim) -> Sets {
    let mut sets = Sets::new();
    for site in prim.prim_stack().unwrap_or_default() {
        let Some(layer) = prim.stage().layer(&site.layer) else { continue };
        let tokens = |path: &sdf::Path, key: sdf::ChildrenKey| {
            let field = layer.data().try_field(path, key.as_str()).ok().flatten();
            field.and_then(|value| value.into_owned().try_as_token_vec()).unwrap_or_default()
        };
        for set in tokens(&site.path, sdf::ChildrenKey::VariantSetChildren) {
            let choices = sets.entry(set.to_string()).or_default();
            if let Ok(path) = site.path.append_variant_selection(set.as_str(), "") {
                choices.extend(tokens(&path, sdf::ChildrenKey::VariantChildren).iter().map(ToString::to_string));
            }
        }
    }
    sets
}

/// `/Prim{set=choice}{set=choice}` in its parts.
fn parse(text: &str) -> Option<(String, Vec<(String, String)>)> {
    let (path, rest) = text.split_once('{')?;
    let inside = rest.strip_suffix('}')?;
    let pairs = inside.split("}{").map(|pair| {
        let (set, choice) = pair.split_once('=')?;
        Some((set.trim().to_owned(), choice.trim().to_owned()))
    });
    Some((path.trim().to_owned(), pairs.collect::<Option<_>>()?))
}

fn author(stage: &Stage, prim: &Prim, set: String, choice: String) -> openusd::Result<()> {
    let target = stage.edit_target_session().unwrap_or_else(|| stage.edit_target_root());
    let _restored = stage.edit_context(target)?;
    let key = sdf::FieldKey::VariantSelection.as_str();
    let over = stage.override_prim(prim.path())?;
    over.update_metadata(key, |local| {
        let mut map = match local {
            Some(Value::VariantSelectionMap(map)) => map,
            _ => HashMap::new(),
        };
        map.insert(set, choice);
        Some(Value::VariantSelectionMap(map))
    })?;
    Ok(())
}

/// The nearest prim above `prim` that exists, and its children.
fn siblings(stage: &Stage, prim: &Prim) -> String {
    let exists = |path: &sdf::Path| stage.prim(path).is_ok_and(|p| p.is_valid().unwrap_or(false));
    let above = prim.path().strict_ancestors().find(|path| path.is_abs_root() || exists(path));
    let above = above.unwrap_or_else(sdf::Path::abs_root);
    let children = stage.prim(&above).map(|p| p.child_names().unwrap_or_default()).unwrap_or_default();
    list(&format!("{above} has"), children.iter().map(ToString::to_string))
}

fn list(what: &str, names: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let names: Vec<String> = names.into_iter().map(|name| name.as_ref().to_owned()).collect();
    if names.is_empty() { format!("{what} none") } else { format!("{what} {}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_selection_names_a_prim_and_one_or_more_sets() {
        let pairs = vec![("look".into(), "red".into()), ("lod".into(), "high".into())];
        assert_eq!(parse("/Car/Body{look=red}{lod=high}"), Some(("/Car/Body".into(), pairs)));
        assert_eq!(parse("/Car"), None);
        assert_eq!(parse("/Car{look}"), None);
        assert_eq!(parse("/Car{look=red"), None);
    }
}
