//! Values of one prim at the time that is read.

use openusd::sdf::{self, AssetPath, Value};
use openusd::tf::Token;
use openusd::usd::Prim;

use super::material;
use super::stage::Reading;

/// A prim whose attributes are read; what is said of them is said of `path`.
#[derive(Clone, Copy)]
pub(super) struct Values<'a> {
    pub reading: &'a Reading<'a>,
    pub prim: &'a Prim,
    pub path: &'a sdf::Path,
}

/// What `token`, the value of `name`, stands for among `choices`; otherwise the first of them, with a warning where
/// there is a token.
pub(super) fn pick<T: Copy>(
    reading: &Reading<'_>,
    prim: &Prim,
    name: &str,
    token: Option<Token>,
    choices: &[(&str, T)],
) -> T {
    let found = token.as_ref().and_then(|token| choices.iter().find(|(choice, _)| token == choice));
    if let (None, Some(token)) = (found, &token) {
        reading.warn(prim.path(), format!("there is no {name} \"{token}\"; {} is used", choices[0].0));
    }
    found.unwrap_or(&choices[0]).1
}

impl Values<'_> {
    /// A float, authored or the schema's fallback; `None` where there is none or no number.
    pub fn number(&self, name: &str) -> Option<f64> {
        let own = || self.reading.value::<f32>(self.prim, name).map(f64::from);
        self.finite(name, self.connected(name).map_or_else(own, |[value, ..]| Some(value)))
    }

    /// A double.
    pub fn double(&self, name: &str) -> Option<f64> {
        self.finite(name, self.reading.value::<f64>(self.prim, name))
    }

    fn finite(&self, name: &str, value: Option<f64>) -> Option<f64> {
        let value = value?;
        if !value.is_finite() {
            self.warn(format!("{name} is {value}: taken for not authored"));
        }
        value.is_finite().then_some(value)
    }

    pub fn flag(&self, name: &str) -> Option<bool> {
        self.connected(name).map_or_else(|| self.reading.value(self.prim, name), |[value, ..]| Some(value != 0.0))
    }

    /// What an input takes from where it is connected to. Where that is nothing that is the same everywhere, its own
    /// value counts, which is told.
    fn connected(&self, name: &str) -> Option<[f64; 4]> {
        let attribute = name.starts_with("inputs:").then(|| self.prim.attribute(name))?;
        if !attribute.has_authored_connections().unwrap_or(false) {
            return None;
        }
        let value = material::of_connection(self.reading, &attribute);
        if value.is_none() {
            self.warn(format!("{name} is connected to what has no constant value: its own value is taken"));
        }
        value
    }

    pub fn token(&self, name: &str) -> Option<String> {
        self.reading.value::<Token>(self.prim, name).map(|token| token.to_string())
    }

    /// Three floats.
    pub fn color(&self, name: &str) -> Option<[f64; 3]> {
        let color = match self.connected(name) {
            Some([r, g, b, _]) => [r, g, b],
            None => self.reading.value::<[f32; 3]>(self.prim, name)?.map(f64::from),
        };
        if !color.iter().all(|c| c.is_finite()) {
            self.warn(format!("{name} is {color:?}: taken for not authored"));
            return None;
        }
        Some(color)
    }

    /// A file; `None` where the path is empty, too.
    pub fn asset(&self, name: &str) -> Option<AssetPath> {
        self.reading.value::<AssetPath>(self.prim, name).filter(|asset| !asset.is_empty())
    }

    /// A number or truth value of any type, for properties that no schema types.
    pub fn loose(&self, name: &str) -> Option<f64> {
        match self.reading.value::<Value>(self.prim, name)? {
            Value::Bool(value) => Some(f64::from(u8::from(value))),
            Value::Int(value) => Some(f64::from(value)),
            Value::Float(value) => Some(f64::from(value)),
            Value::Double(value) => Some(value),
            _ => None,
        }
        .filter(|value| value.is_finite())
    }

    /// Targets of a relationship; empty where there are none.
    pub fn targets(&self, name: &str) -> Vec<sdf::Path> {
        self.prim.relationship(name).forwarded_targets().unwrap_or_default()
    }

    pub fn has_api(&self, schema: &str) -> bool {
        self.prim.has_api_schema(schema).unwrap_or(false)
    }

    pub fn warn(&self, what: impl Into<String>) {
        self.reading.warn(self.path, what);
    }

    /// Tells of what may be as it should be.
    pub fn note(&self, what: impl Into<String>) {
        self.reading.warnings.borrow_mut().note(&self.reading.place_of(self.path), what);
    }
}
