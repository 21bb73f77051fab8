//! What was asked of a prim before. Its attributes are read one after another, and each question goes
//! through all of its layers: those that all attributes have in common are asked once.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use openusd::sdf::{self, Path, Value};
use openusd::tf::Token;
use openusd::usd::{Prim, PrimDefinition};

use super::schemas;

/// What is known of the prim that was asked last.
#[derive(Default)]
pub(super) struct Authored {
    path: Path,
    /// Its authored properties; `None` where they can't be told.
    names: Option<Rc<[Token]>>,
    /// Its type as authored.
    type_name: Option<Token>,
    /// True where no API schema is applied to it.
    plain: Option<bool>,
    definition: Option<Option<Arc<PrimDefinition>>>,
    /// True where value clips may give values to what no layer authors.
    clipped: Option<bool>,
    /// The same for prims that have children.
    known: HashMap<Path, bool>,
    /// What is to be told of API schemas in versions that are not known here.
    pub unknown: Vec<(Path, String)>,
}

impl Authored {
    /// Makes `prim` the one that is asked.
    fn turn_to(&mut self, prim: &Prim) {
        if self.path != *prim.path() {
            self.recall(prim, prim.authored_property_names().ok().map(Rc::from), None);
        }
    }

    /// Makes `prim` the one that is asked, of which this is known already.
    pub fn recall(&mut self, prim: &Prim, names: Option<Rc<[Token]>>, type_name: Option<Token>) {
        self.path = prim.path().clone();
        (self.names, self.type_name) = (names, type_name);
        (self.plain, self.definition, self.clipped) = (None, None, None);
    }

    /// The authored properties of `prim`.
    pub fn names(&mut self, prim: &Prim) -> Rc<[Token]> {
        self.turn_to(prim);
        self.names.clone().unwrap_or_default()
    }

    /// The type of `prim` as authored; empty for one without.
    pub fn type_name(&mut self, prim: &Prim) -> Token {
        self.turn_to(prim);
        self.type_name.get_or_insert_with(|| prim.type_name().ok().flatten().unwrap_or_default()).clone()
    }

    /// True where no API schema is applied to `prim`.
    pub fn is_plain(&mut self, prim: &Prim) -> bool {
        self.turn_to(prim);
        *self.plain.get_or_insert_with(|| prim.authored_api_schemas().is_ok_and(|applied| applied.is_empty()))
    }

    /// The fallback of attribute `name` of `prim` if nothing but its schema says anything of it.
    pub fn fallback(&mut self, prim: &Prim, name: &str) -> Option<Option<Value>> {
        self.turn_to(prim);
        if self.names.as_ref()?.iter().any(|authored| authored.as_str() == name) || self.is_clipped(prim) {
            return None;
        }
        let fallback = self.definition(prim)?.attribute_fallback(&Token::from(name));
        // Files are found from the schema's own place.
        let is_file = matches!(fallback, Some(Value::AssetPath(_) | Value::AssetPathVec(_)));
        (!is_file).then_some(fallback)
    }

    fn definition(&mut self, prim: &Prim) -> Option<Arc<PrimDefinition>> {
        if self.definition.is_none() {
            let kind = self.type_name(prim);
            let of_type = prim.stage().schema_registry().concrete_prim_definition(&kind);
            let definition = match of_type.filter(|_| self.is_plain(prim)) {
                Some(definition) => Some(definition.clone()),
                None => {
                    let info = prim.prim_type_info().ok();
                    self.unknown.extend(info.iter().flat_map(|info| schemas::unknown_versions(prim, info)));
                    info.map(|info| info.prim_definition().clone())
                }
            };
            self.definition = Some(definition);
        }
        self.definition.clone().flatten()
    }

    fn is_clipped(&mut self, prim: &Prim) -> bool {
        if let Some(clipped) = self.clipped {
            return clipped;
        }
        let clipped = has_clips(prim) || prim.parent().is_some_and(|parent| self.is_known_clipped(&parent));
        *self.clipped.insert(clipped)
    }

    fn is_known_clipped(&mut self, prim: &Prim) -> bool {
        if let Some(&known) = self.known.get(prim.path()) {
            return known;
        }
        let above = prim.parent().is_some_and(|parent| self.is_known_clipped(&parent));
        let clipped = above || has_clips(prim);
        self.known.insert(prim.path().clone(), clipped);
        clipped
    }
}

fn has_clips(prim: &Prim) -> bool {
    let clips = prim.stage().field::<Value>(prim.path(), sdf::FieldKey::Clips);
    clips.is_ok_and(|clips| clips.is_some())
}
