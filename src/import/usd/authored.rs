//! Which properties of a prim are authored at all: the others have their schema's fallback, and need not be
//! looked for in every layer.

use std::collections::HashMap;
use std::sync::Arc;

use openusd::sdf::{self, Path, Value};
use openusd::tf::Token;
use openusd::usd::{Prim, PrimDefinition};

use super::schemas;

/// The authored properties of the prim that was asked last; a prim's attributes are read one after another.
#[derive(Default)]
pub(super) struct Authored {
    path: Path,
    names: Vec<Token>,
    definition: Option<Arc<PrimDefinition>>,
    /// True where value clips may give values to what no layer authors.
    clipped: bool,
    /// The same for prims that have children.
    known: HashMap<Path, bool>,
    /// What is to be told of API schemas in versions that are not known here.
    pub unknown: Vec<(Path, String)>,
}

impl Authored {
    /// The fallback of attribute `name` of `prim` if nothing but its schema says anything of it.
    pub fn fallback(&mut self, prim: &Prim, name: &str) -> Option<Option<Value>> {
        if self.path != *prim.path() {
            self.names = prim.authored_property_names().ok()?;
            let info = prim.prim_type_info().ok();
            self.unknown.extend(info.iter().flat_map(|info| schemas::unknown_versions(prim, info)));
            self.definition = info.map(|info| info.prim_definition().clone());
            self.clipped = has_clips(prim) || prim.parent().is_some_and(|parent| self.clipped(&parent));
            self.path = prim.path().clone();
        }
        if self.clipped || self.names.iter().any(|authored| authored.as_str() == name) {
            return None;
        }
        let fallback = self.definition.as_ref()?.attribute_fallback(&Token::from(name));
        // Files are found from the schema's own place.
        let is_file = matches!(fallback, Some(Value::AssetPath(_) | Value::AssetPathVec(_)));
        (!is_file).then_some(fallback)
    }

    fn clipped(&mut self, prim: &Prim) -> bool {
        if let Some(&known) = self.known.get(prim.path()) {
            return known;
        }
        let above = prim.parent().is_some_and(|parent| self.clipped(&parent));
        let clipped = above || has_clips(prim);
        self.known.insert(prim.path().clone(), clipped);
        clipped
    }
}

fn has_clips(prim: &Prim) -> bool {
    let clips = prim.stage().field::<Value>(prim.path(), sdf::FieldKey::Clips);
    clips.is_ok_and(|clips| clips.is_some())
}
