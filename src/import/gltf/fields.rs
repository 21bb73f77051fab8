//! One object of `extras.penumbra`: keys are asked for by type, and what is of another type or was
//! never asked for is told, each in one warning that names the node, the key and what was done.

use serde_json::{Map, Value};

use crate::error::{Place, Warnings};

/// An object and which of its keys were asked for.
pub(super) struct Fields<'a> {
    object: &'a Map<String, Value>,
    /// Where it stands, as `extras.penumbra.light`.
    path: String,
    asked: Vec<&'static str>,
    place: &'a Place,
    warnings: &'a mut Warnings,
}

impl<'a> Fields<'a> {
    pub fn new(object: &'a Map<String, Value>, path: &str, place: &'a Place, warnings: &'a mut Warnings) -> Self {
        Self { object, path: path.to_owned(), asked: Vec::new(), place, warnings }
    }

    /// Warns about `key`; `what` says what is wrong and what was done.
    pub fn tell(&mut self, key: &str, what: &str) {
        self.warnings.push(self.place, format!("{}.{key} {what}", self.path));
    }

    /// The value of `key`, whatever its type.
    pub fn value(&mut self, key: &'static str) -> Option<&'a Value> {
        self.asked.push(key);
        self.object.get(key).filter(|value| !value.is_null())
    }

    /// What `read` makes of the value of `key`; where that is nothing the key is told not to be `kind`.
    fn typed<T>(&mut self, key: &'static str, kind: &str, read: impl Fn(&'a Value) -> Option<T>) -> Option<T> {
        let value = self.value(key)?;
        let read = read(value);
        if read.is_none() {
            self.tell(key, &format!("is not {kind}: ignored"));
        }
        read
    }

    pub fn number(&mut self, key: &'static str) -> Option<f64> {
        self.typed(key, "a number", Value::as_f64)
    }

    /// A number for all channels, or three.
    pub fn color(&mut self, key: &'static str) -> Option<[f64; 3]> {
        self.typed(key, "a number or three", |value| value.as_f64().map(|v| [v; 3]).or_else(|| three(value)))
    }

    /// `true` or `false`, or 1 or 0, as which Blender keeps some.
    pub fn flag(&mut self, key: &'static str) -> Option<bool> {
        self.typed(key, "true or false", |value| match value.as_f64() {
            Some(0.0) => Some(false),
            Some(1.0) => Some(true),
            _ => value.as_bool(),
        })
    }

    pub fn text(&mut self, key: &'static str) -> Option<&'a str> {
        self.typed(key, "a text", |value| value.as_str().filter(|text| !text.is_empty()))
    }

    /// A list of texts, or one text.
    pub fn texts(&mut self, key: &'static str) -> Option<Vec<String>> {
        self.typed(key, "a list of names", |value| match value {
            Value::String(one) => Some(vec![one.clone()]),
            Value::Array(list) => list.iter().map(|name| name.as_str().map(str::to_owned)).collect(),
            _ => None,
        })
    }

    /// The object under `key`.
    pub fn object(&mut self, key: &'static str) -> Option<Fields<'_>> {
        let object = self.typed(key, "an object", Value::as_object)?;
        Some(Fields::new(object, &format!("{}.{key}", self.path), self.place, self.warnings))
    }

    /// Tells the keys that nobody asked for.
    pub fn finish(mut self) {
        let object = self.object;
        for key in object.keys().filter(|key| !self.asked.iter().any(|asked| asked == key)).collect::<Vec<_>>() {
            let known = self.asked.join(", ");
            self.tell(key, &format!("is not known here: ignored; known are {known}"));
        }
    }
}

/// Three numbers.
pub(super) fn three(value: &Value) -> Option<[f64; 3]> {
    let list: Vec<f64> = value.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    list.try_into().ok()
}
