//! MaterialX documents: finding the one that a stage references, and reading it into a `Network`.
//!
//! OpenUSD's usdMtlx plugin makes of a document the prims `/MaterialX/Materials/<name>`; the crate that
//! composes stages has no such plugin, so a reference to a document leads nowhere and is followed here.

use std::collections::HashMap;

use openusd::ar::{DefaultResolver, ResolvedPath, Resolver};
use openusd::sdf::{self, AssetPath};
use roxmltree::{Document, Node as Xml};

use super::super::images::{self, File};
use super::super::stage::Reading;
use super::network::{Input, Network, Node, Source, Value};
use crate::error::Place;

/// The longest chain of nodes that is followed.
const DEEPEST: usize = 200;

/// The document that `path`, a material, or one of its ancestors references, and the name of the material
/// in it.
pub(super) fn find(reading: &Reading<'_>, path: &sdf::Path) -> Option<(String, String)> {
    let name = path.name()?.to_string();
    let mut at = path.clone();
    loop {
        for site in reading.stage.prim(at.clone()).ok()?.prim_stack().unwrap_or_default() {
            for (asset, inside) in references(reading, &site.layer, &site.path) {
                // Only the last name counts: a document has no deeper hierarchy.
                let name = if at == *path { inside.name().unwrap_or(&name).to_string() } else { name.clone() };
                let resolver = DefaultResolver::new();
                let identifier = resolver.create_identifier(&asset, Some(&ResolvedPath::new(&site.layer)));
                let file = resolver.resolve(&identifier).map(|file| file.to_string_lossy().into_owned());
                let Some(file) = file else {
                    reading.warn(path, format!("document @{asset}@, which {} references, is not there", site.layer));
                    continue;
                };
                if images::bytes(&file).is_ok_and(|bytes| declares(&bytes, &name)) {
                    return Some((file, name));
                }
            }
        }
        at = at.parent().filter(|parent| !parent.is_abs_root())?;
    }
}

/// References and payloads to MaterialX documents at `path` of `layer`.
fn references(reading: &Reading<'_>, layer: &str, path: &sdf::Path) -> Vec<(String, sdf::Path)> {
    let Some(layer) = reading.stage.layer(layer) else { return Vec::new() };
    let field = |name: &str| layer.data().try_field(path, name).ok().flatten().map(|value| value.into_owned());
    let mut found = Vec::new();
    if let Some(sdf::Value::ReferenceListOp(list)) = field("references") {
        found.extend(list.flatten().into_iter().map(|r| (r.asset_path, r.prim_path)));
    }
    match field("payload") {
        Some(sdf::Value::PayloadListOp(list)) => {
            found.extend(list.flatten().into_iter().map(|p| (p.asset_path, p.prim_path)));
        }
        Some(sdf::Value::Payload(payload)) => found.push((payload.asset_path, payload.prim_path)),
        _ => {}
    }
    found.retain(|(asset, _)| asset.to_ascii_lowercase().ends_with(".mtlx"));
    found
}

fn declares(bytes: &[u8], name: &str) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    Document::parse(text).is_ok_and(|document| material(&document, name).is_some())
}

fn material<'x>(document: &'x Document<'_>, name: &str) -> Option<Xml<'x, 'x>> {
    let mut children = document.root_element().children();
    children.find(|child| child.has_tag_name("surfacematerial") && child.attribute("name") == Some(name))
}

/// The network of the material `name` of the document `file`, and its last node.
///
/// # Errors
/// What is wrong with the document.
pub(super) fn network(file: &str, name: &str) -> Result<(Network, Source), String> {
    let bytes = images::bytes(file)?;
    let text = std::str::from_utf8(&bytes).map_err(|error| format!("{file} is no text: {error}"))?;
    let document = Document::parse(text).map_err(|error| format!("{file} is no MaterialX document: {error}"))?;
    let root = document.root_element();
    let material = material(&document, name).ok_or_else(|| format!("{file} has no material \"{name}\""))?;
    let mut builder = Builder { file, root, network: Network::default(), known: HashMap::new() };
    let shader = child(material, "input", "surfaceshader").and_then(|input| builder.input(input, root, 0).source);
    let shader = shader.ok_or_else(|| format!("material \"{name}\" of {file} has no surface shader"))?;
    Ok((builder.network, shader))
}

struct Builder<'f, 'x> {
    file: &'f str,
    root: Xml<'x, 'x>,
    network: Network,
    known: HashMap<roxmltree::NodeId, usize>,
}

impl<'x> Builder<'_, 'x> {
    /// The element `element` of the graph or document `scope`.
    fn node(&mut self, element: Xml<'x, 'x>, scope: Xml<'x, 'x>, depth: usize) -> Option<usize> {
        if let Some(&known) = self.known.get(&element.id()) {
            return Some(known);
        }
        if depth > DEEPEST {
            return None;
        }
        let category = element.tag_name().name();
        let node = Node {
            category: category.to_string(),
            kind: kind(element),
            materialx: true,
            place: Place::file(self.file).at(element.attribute("name").unwrap_or(category)),
            inputs: Default::default(),
        };
        let index = self.network.nodes.len();
        self.network.nodes.push(node);
        self.known.insert(element.id(), index);
        for input in element.children().filter(|child| child.has_tag_name("input")) {
            let Some(name) = input.attribute("name") else { continue };
            let read = self.input(input, scope, depth + 1);
            self.network.nodes[index].inputs.insert(name.to_string(), read);
        }
        Some(index)
    }

    fn input(&mut self, input: Xml<'x, 'x>, scope: Xml<'x, 'x>, depth: usize) -> Input {
        if let Some(name) = input.attribute("interfacename")
            && scope != self.root
            && depth <= DEEPEST
            && let Some(outer) = child(scope, "input", name)
        {
            return self.input(outer, self.root, depth + 1);
        }
        let output = input.attribute("output");
        if let Some(graph) = input.attribute("nodegraph") {
            return Input { source: self.graph(graph, output, depth), ..Input::default() };
        }
        if let Some(name) = input.attribute("nodename") {
            let element = scope.children().find(|node| node.is_element() && node.attribute("name") == Some(name));
            let node = element.and_then(|element| self.node(element, scope, depth + 1));
            let source = node.map(|node| Source { node, output: output.unwrap_or("out").to_string() });
            return Input { source, ..Input::default() };
        }
        let kind = input.attribute("type").unwrap_or_default();
        let colored = kind.starts_with("color") || kind == "filename";
        let space = input.ancestors().find_map(|node| node.attribute("colorspace")).filter(|_| colored);
        let value = input.attribute("value").and_then(|text| self.value(input, kind, text));
        Input { value, source: None, color_space: space.map(str::to_string) }
    }

    /// The output of a graph of the document; the only one where none is named.
    fn graph(&mut self, name: &str, output: Option<&str>, depth: usize) -> Option<Source> {
        let named = |node: &Xml<'_, '_>| node.has_tag_name("nodegraph") && node.attribute("name") == Some(name);
        let graph = self.root.children().find(named)?;
        let mut outputs = graph.children().filter(|node| node.has_tag_name("output"));
        let output = outputs.find(|node| output.is_none_or(|name| node.attribute("name") == Some(name)))?;
        self.input(output, graph, depth + 1).source
    }

    fn value(&self, input: Xml<'_, '_>, kind: &str, text: &str) -> Option<Value> {
        match kind {
            "filename" => {
                let prefix: Vec<&str> = input.ancestors().filter_map(|node| node.attribute("fileprefix")).collect();
                let path: String = prefix.into_iter().rev().chain([text]).collect();
                Some(Value::File(File::find(&AssetPath::new(path), Some(self.file))))
            }
            "string" => Some(Value::Text(text.to_string())),
            "boolean" => Some(Value::Numbers([f64::from(u8::from(text.trim() == "true")), 0.0, 0.0, 0.0], 1)),
            _ => {
                let mut numbers = [0.0; 4];
                let mut count = 0;
                let parts = text.split([',', ' ']).map(str::trim).filter(|part| !part.is_empty());
                for (number, part) in numbers.iter_mut().zip(parts) {
                    *number = part.parse().ok()?;
                    count += 1;
                }
                (count > 0).then_some(Value::Numbers(numbers, count))
            }
        }
    }
}

fn child<'x>(of: Xml<'x, 'x>, tag: &str, name: &str) -> Option<Xml<'x, 'x>> {
    of.children().find(|child| child.has_tag_name(tag) && child.attribute("name") == Some(name))
}

/// The type as a definition's name ends: what comes in where that tells definitions apart.
fn kind(element: Xml<'_, '_>) -> String {
    let own = element.attribute("type").unwrap_or_default();
    let incoming = |name: &str| child(element, "input", name).and_then(|input| input.attribute("type"));
    match element.tag_name().name() {
        "convert" => format!("{}_{own}", incoming("in").unwrap_or(own)),
        "dotproduct" | "distance" => incoming("in1").unwrap_or(own).to_string(),
        "magnitude" | "maxcomponent" | "mincomponent" => incoming("in").unwrap_or(own).to_string(),
        _ => own.to_string(),
    }
}
