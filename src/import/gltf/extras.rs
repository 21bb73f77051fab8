//! `extras.penumbra` of a node: what glTF has no words for about lights and who sees what.
//!
//! Blender exports custom properties of objects as extras: a property `penumbra` may be a dictionary
//! or, as the interface can edit it, a text that holds the JSON.

use std::borrow::Cow;
use std::sync::Arc;

use serde_json::Value;

use super::fields::Fields;
use super::json::Node;
use super::lamp::{self, Lamp};
use crate::desc::{LightLinks, Visibility};
use crate::error::{Place, Warnings};

/// What a node's `extras.penumbra` says.
#[derive(Default)]
pub(super) struct Penumbra {
    /// A light at the node.
    pub light: Option<Lamp>,
    /// True where it names a light, also one that can't be read.
    names_light: bool,
    /// Kinds of ray for which it says whether they see the node's meshes and lights.
    visibility: [Option<bool>; 5],
    group: Option<Arc<str>>,
    cast_shadow: Option<bool>,
    /// Whom the node's lights reach.
    pub receivers: Option<NameSet>,
    /// What stops the light of the node's lights.
    pub blockers: Option<NameSet>,
}

/// Nodes by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct NameSet {
    pub names: Vec<String>,
    /// True for all but these.
    pub exclude: bool,
}

const PATH: &str = "extras.penumbra";

impl Penumbra {
    /// Reads the extras of the node at `place`.
    pub fn read(extras: &Value, place: &Place, warnings: &mut Warnings) -> Self {
        let value = &extras["penumbra"];
        let parsed = match value.as_str().map(serde_json::from_str::<Value>) {
            None => Cow::Borrowed(value),
            Some(Ok(parsed)) => Cow::Owned(parsed),
            Some(Err(error)) => {
                warnings.push(place, format!("{PATH} is a text that is not JSON ({error}): ignored"));
                return Self::default();
            }
        };
        match parsed.as_ref() {
            Value::Null => Self::default(),
            Value::Object(object) => Self::of(Fields::new(object, PATH, place, warnings)),
            _ => {
                warnings.push(place, format!("{PATH} is not an object: ignored"));
                Self::default()
            }
        }
    }

    fn of(mut fields: Fields<'_>) -> Self {
        let light = fields.object("light").map(lamp::read);
        let penumbra = Self {
            names_light: light.is_some(),
            light: light.flatten(),
            visibility: fields.object("visibility").map(visibility).unwrap_or_default(),
            group: fields.text("light_group").map(Arc::from),
            cast_shadow: fields.flag("cast_shadow"),
            receivers: fields.object("receivers").and_then(name_set),
            blockers: fields.object("blockers").and_then(name_set),
        };
        fields.finish();
        penumbra
    }

    /// `visibility` with what the node says about it.
    pub fn visible(&self, visibility: Visibility) -> Visibility {
        let [camera, diffuse, glossy, transmission, shadow] = self.visibility;
        Visibility {
            camera: camera.unwrap_or(visibility.camera),
            diffuse: diffuse.unwrap_or(visibility.diffuse),
            glossy: glossy.unwrap_or(visibility.glossy),
            transmission: transmission.unwrap_or(visibility.transmission),
            shadow: shadow.unwrap_or(visibility.shadow),
        }
    }

    /// True where `node`, whose extras these are, has a light in one way or another.
    pub fn gives_light(&self, node: &Node) -> bool {
        let punctual = node.extensions.light.as_ref().and_then(|light| light.light);
        let measured = node.extensions.ies.as_ref().and_then(|light| light.light);
        let stamped = node.extensions.stamp.as_ref().is_some_and(|stamp| stamp["light"].is_object());
        self.names_light || stamped || punctual.or(measured).is_some()
    }

    /// Rules of the node's light, but for those that name other nodes.
    pub fn links(&self) -> LightLinks {
        self.over(LightLinks::default())
    }

    /// `links` with what the node says about them.
    pub fn over(&self, links: LightLinks) -> LightLinks {
        LightLinks {
            group: self.group.clone().or(links.group),
            cast_shadow: self.cast_shadow.unwrap_or(links.cast_shadow),
            ..links
        }
    }

    /// True where it says something that needs a mesh or a light to be said of.
    pub fn has_rules(&self) -> bool {
        self.visibility.iter().any(Option::is_some)
            || self.group.is_some()
            || self.cast_shadow.is_some()
            || self.receivers.is_some()
            || self.blockers.is_some()
    }
}

fn visibility(mut fields: Fields<'_>) -> [Option<bool>; 5] {
    let flags = ["camera", "diffuse", "glossy", "transmission", "shadow"].map(|ray| fields.flag(ray));
    fields.finish();
    flags
}

fn name_set(mut fields: Fields<'_>) -> Option<NameSet> {
    let (include, exclude) = (fields.texts("include"), fields.texts("exclude"));
    if include.is_some() && exclude.is_some() {
        fields.tell("exclude", "is ignored: include is given, too");
    }
    fields.finish();
    let set = |exclude| move |names| NameSet { names, exclude };
    include.map(set(false)).or_else(|| exclude.map(set(true)))
}
