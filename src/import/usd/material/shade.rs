//! UsdShade prims to a `Network`.

use std::collections::{BTreeMap, HashMap};

use openusd::sdf;
use openusd::usd::{Attribute, Prim};
use openusd_schemas::shade::{self, ProducerFilter};

use super::super::images::File;
use super::super::stage::Reading;
use super::network::{Input, Network, Node, Source, Value, category};

/// The longest chain of nodes that is followed.
const DEEPEST: usize = 200;

/// The network behind `output`, an output of a material, and its last node. `None` where nothing is
/// connected.
pub(super) fn network(reading: &Reading<'_>, output: &Attribute) -> Option<(Network, Source)> {
    let mut builder = Builder { reading, network: Network::default(), known: HashMap::new() };
    let producer = builder.producer(output)?;
    let source = builder.source(&producer, 0)?;
    Some((builder.network, source))
}

/// What `attribute`, an input, is connected to, with the network behind it; `None` where that gives nothing.
pub(super) fn connected(reading: &Reading<'_>, attribute: &Attribute) -> Option<(Network, Input)> {
    let typed = shade::Input::from_attribute(attribute.clone())?;
    let found = typed.value_producing_attributes(ProducerFilter::Any).ok()?;
    if found.first()?.attribute().path() == attribute.path() {
        return None;
    }
    let mut builder = Builder { reading, network: Network::default(), known: HashMap::new() };
    let input = builder.input(attribute, 0);
    Some((builder.network, input))
}

struct Builder<'a, 'r> {
    reading: &'a Reading<'r>,
    network: Network,
    known: HashMap<sdf::Path, usize>,
}

impl Builder<'_, '_> {
    /// The attribute that gives `attribute` its value: itself, an output of a node, or an interface input.
    fn producer(&self, attribute: &Attribute) -> Option<Attribute> {
        let typed = match attribute.name().starts_with("outputs:") {
            true => shade::Output::from_attribute(attribute.clone())?.value_producing_attributes(ProducerFilter::Any),
            false => shade::Input::from_attribute(attribute.clone())?.value_producing_attributes(ProducerFilter::Any),
        };
        match typed {
            Ok(found) => match found.first() {
                Some(found) => Some(found.attribute().clone()),
                None => {
                    self.tell_of_lost(attribute);
                    None
                }
            },
            Err(error) => {
                self.reading.warn(attribute.path(), format!("its connections can't be followed: {error}"));
                None
            }
        }
    }

    /// Tells of a connection to what is not there.
    fn tell_of_lost(&self, attribute: &Attribute) {
        let to = attribute.connections().unwrap_or_default();
        // An input of the material that has no value asks for the default.
        let is_unset = |to: &sdf::Path| {
            to.name().is_some_and(|name| name.starts_with("inputs:"))
                && self.reading.stage.attribute(to).is_ok_and(|to| to.is_defined().unwrap_or(false))
        };
        if let Some(to) = to.first().filter(|to| !is_unset(to)) {
            self.reading.warn(attribute.path(), format!("it is connected to {to}, which gives nothing: left out"));
        }
    }

    /// The node that `producer`, an output, stands on.
    fn source(&mut self, producer: &Attribute, depth: usize) -> Option<Source> {
        let output = producer.name().strip_prefix("outputs:")?.to_string();
        let node = self.node(&producer.prim(), depth)?;
        Some(Source { node, output })
    }

    fn node(&mut self, prim: &Prim, depth: usize) -> Option<usize> {
        if let Some(&known) = self.known.get(prim.path()) {
            return Some(known);
        }
        if depth > DEEPEST {
            self.reading.warn(prim.path(), format!("its network is deeper than {DEEPEST} nodes; cut off here"));
            return None;
        }
        let id = prim.attribute("info:id");
        let id = self.reading.value_of::<sdf::Value>(&id, self.reading.time).and_then(text_of).unwrap_or_default();
        let (name, kind) = category(&id);
        let node = Node {
            category: name.to_string(),
            kind: kind.to_string(),
            materialx: id.starts_with("ND_"),
            place: self.reading.place_of(prim.path()),
            inputs: BTreeMap::new(),
        };
        let index = self.network.nodes.len();
        self.network.nodes.push(node);
        self.known.insert(prim.path().clone(), index);
        let inputs = prim.authored_attributes().unwrap_or_default();
        for attribute in inputs {
            if let Some(name) = attribute.name().strip_prefix("inputs:") {
                let (name, input) = (name.to_string(), self.input(&attribute, depth));
                self.network.nodes[index].inputs.insert(name, input);
            }
        }
        Some(index)
    }

    /// The colour space that ColorSpaceAPI gives `prim`, or the nearest of its parents that has one.
    fn color_space_of(&self, prim: &Prim) -> Option<String> {
        let mut prim = Some(prim.clone());
        while let Some(at) = prim {
            if let Some(name) = self.reading.value::<sdf::Value>(&at, "colorSpace:name").and_then(text_of) {
                return Some(name);
            }
            prim = at.parent();
        }
        None
    }

    fn input(&mut self, attribute: &Attribute, depth: usize) -> Input {
        let Some(producer) = self.producer(attribute) else { return Input::default() };
        if producer.name().starts_with("outputs:")
            && let Some(source) = self.source(&producer, depth + 1)
        {
            return Input { source: Some(source), ..Input::default() };
        }
        let color_space = [attribute, &producer]
            .into_iter()
            .find_map(|a| a.get_metadata::<sdf::Value>("colorSpace").ok().flatten().and_then(text_of))
            .or_else(|| is_color(&producer).then(|| self.color_space_of(&producer.prim())).flatten());
        Input { value: value(self.reading, &producer), source: None, color_space }
    }
}

fn is_color(attribute: &Attribute) -> bool {
    attribute.type_name().ok().flatten().is_some_and(|name| name.as_str().starts_with("color"))
}

/// The value of an attribute.
pub(super) fn value(reading: &Reading<'_>, attribute: &Attribute) -> Option<Value> {
    let value = reading.value_of::<sdf::Value>(attribute, reading.time)?;
    if let sdf::Value::AssetPath(asset) = value {
        let layer = attribute.property_stack().ok().and_then(|stack| stack.into_iter().next());
        return Some(Value::File(File::find(&asset, layer.as_ref().map(|site| site.layer.as_str()))));
    }
    match numbers_of(&value) {
        Some((numbers, count)) => Some(Value::Numbers(numbers, count)),
        None => text_of(value).map(Value::Text),
    }
}

fn text_of(value: sdf::Value) -> Option<String> {
    match value {
        sdf::Value::Token(text) => Some(text.to_string()),
        sdf::Value::String(text) => Some(text),
        _ => None,
    }
}

/// One to four numbers, and how many.
fn numbers_of(value: &sdf::Value) -> Option<([f64; 4], u8)> {
    use sdf::Value as V;
    let two = |v: [f64; 2]| Some(([v[0], v[1], 0.0, 0.0], 2));
    let three = |v: [f64; 3]| Some(([v[0], v[1], v[2], 0.0], 3));
    let one = |v: f64| Some(([v, 0.0, 0.0, 0.0], 1));
    match value.clone() {
        V::Bool(v) => one(f64::from(u8::from(v))),
        V::Uchar(v) => one(f64::from(v)),
        V::Int(v) => one(f64::from(v)),
        V::Uint(v) => one(f64::from(v)),
        V::Int64(v) => one(v as f64),
        V::Uint64(v) => one(v as f64),
        V::Half(v) => one(v.to_f64()),
        V::Float(v) => one(f64::from(v)),
        V::Double(v) => one(v),
        V::Vec2h(v) => two([v.x.to_f64(), v.y.to_f64()]),
        V::Vec2f(v) => two([v.x.into(), v.y.into()]),
        V::Vec2d(v) => two([v.x, v.y]),
        V::Vec2i(v) => two([v.x.into(), v.y.into()]),
        V::Vec3i(_) | V::Vec3h(_) | V::Vec3f(_) | V::Vec3d(_) => three(value.clone().cast::<[f64; 3]>().ok()?),
        V::Vec4i(_) | V::Vec4h(_) | V::Vec4f(_) | V::Vec4d(_) => Some((value.clone().cast::<[f64; 4]>().ok()?, 4)),
        _ => None,
    }
}
