//! Shading networks to `MaterialDesc`.
//!
//! ```text
//! UsdShade prims ─┐                                                       ┌─ factor × texture
//! .mtlx document ─┴─► network ─► model: inputs as expressions ─► surface ─┴─ value of a graph ─► MaterialDesc
//! ```

mod card;
mod clear;
mod closure;
mod coat;
mod color;
mod compositing;
mod constant;
mod evaluate;
mod expr;
mod geometry;
mod gltf;
mod lower;
mod models;
mod mtlx;
mod network;
mod noise;
mod open_pbr;
mod pattern;
mod ramps;
mod random;
mod relief;
mod shade;
mod spaces;
mod surface;
mod texture;

#[cfg(test)]
mod tests;

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use openusd::sdf;
use openusd_schemas::shade as schema;

pub(super) use self::constant::of_connection;
use self::network::{Network, Source, Value};
use self::surface::{Finished, VertexColors};
use super::images::{File, Images};
use super::shown;
use super::stage::Reading;
use crate::desc::graph::{Leaf, Op};
use crate::desc::{AovDesc, ColorInput, MaterialDesc, ScalarInput, SceneDesc, TextureDesc};

/// Outputs that are read, in this order: MaterialX says more than UsdPreviewSurface.
const CONTEXTS: [&str; 2] = ["mtlx", ""];

/// Index of the image that holds all tiles, and how many there are along u and v.
type Tiled = (u32, [u32; 2]);

/// A network and what it was found as.
struct Found {
    network: Network,
    surface: Source,
}

/// True where a MaterialX document that is referenced above `path` has a material of its name.
pub(super) fn is_in_document(reading: &Reading<'_>, path: &sdf::Path) -> bool {
    if let Some(&known) = reading.documents.borrow().get(path) {
        return known;
    }
    let found = mtlx::find(reading, path).is_some();
    reading.documents.borrow_mut().insert(path.clone(), found);
    found
}

/// UV sets that the graph of `material` asks for.
fn graph_uv_sets(material: &MaterialDesc) -> impl Iterator<Item = u32> {
    material.graph.ops().iter().filter_map(|op| match op {
        Op::Leaf(Leaf::Uv(set)) => Some(*set),
        _ => None,
    })
}

/// Materials read so far.
pub(super) struct Materials<'a> {
    pub reading: &'a Reading<'a>,
    pub images: Images,
    /// Names of the primvars that textures are looked up by; the index is that of the UV set. `st` comes
    /// first.
    pub uv_sets: Vec<Arc<str>>,
    textures: Vec<TextureDesc>,
    finished: Vec<Finished>,
    known: HashMap<sdf::Path, Option<u32>>,
    unbound: Option<u32>,
    /// Networks that were gathered ahead, in the order in which they are tried.
    gathered: HashMap<sdf::Path, Vec<Found>>,
    udims: HashMap<(String, bool), Result<Tiled, String>>,
    /// Primvars of two numbers that instances have values of their own of: no UV set can hold them.
    per_instance: BTreeSet<Arc<str>>,
    /// AOVs that all of them give.
    aovs: Vec<AovDesc>,
}

impl<'a> Materials<'a> {
    pub fn new(reading: &'a Reading<'a>, images: Images, per_instance: BTreeSet<Arc<str>>, aovs: Vec<AovDesc>) -> Self {
        Self {
            reading,
            images,
            uv_sets: vec!["st".into()],
            textures: Vec::new(),
            finished: Vec::new(),
            known: HashMap::new(),
            unbound: None,
            gathered: HashMap::new(),
            udims: HashMap::new(),
            per_instance,
            aovs,
        }
    }

    /// Decodes the images of the materials at `paths` on all threads, which `at` would do one by one.
    pub fn preload<'p>(&mut self, paths: impl IntoIterator<Item = &'p sdf::Path>) {
        let mut files = Vec::new();
        for path in paths {
            if self.known.contains_key(path) || self.gathered.contains_key(path) {
                continue;
            }
            let found = self.gather(path);
            // The first one is nearly always the one that is read.
            let inputs = found.iter().take(1).flat_map(|found| &found.network.nodes).flat_map(|n| n.inputs.values());
            for input in inputs {
                match &input.value {
                    Some(Value::File(File::One(file))) => files.push(file.clone()),
                    Some(Value::File(File::Tiles(tiles))) => files.extend(tiles.iter().map(|tile| tile.1.clone())),
                    _ => {}
                }
            }
            self.gathered.insert(path.clone(), found);
        }
        self.images.preload(files);
    }

    /// Index of the material at `path`, or of the card whose picture that attribute names; `None`, with a warning, where there is none that can be read:
    /// what is bound to it looks as if nothing were.
    pub fn at(&mut self, path: &sdf::Path) -> Option<u32> {
        if let Some(&known) = self.known.get(path) {
            return known;
        }
        let index = self.read(path).map(|finished| self.add(finished));
        self.known.insert(path.clone(), index);
        index
    }

    /// Index of the material of shapes that none is bound to: white times their displayColor, diffuse.
    /// Shapes without displayColor have to come with colors of 0.5, as UsdImaging gives them.
    pub fn unbound(&mut self) -> u32 {
        if let Some(index) = self.unbound {
            return index;
        }
        let material = MaterialDesc {
            name: "displayColor".into(),
            place: self.reading.place.clone(),
            base_color: ColorInput::constant([1.0; 3]),
            roughness: ScalarInput::constant(1.0),
            specular: ScalarInput::constant(0.0),
            // Whether anything is seen through is up to the shapes' displayOpacity.
            alpha_mode: crate::desc::AlphaMode::Blend,
            ..MaterialDesc::default()
        };
        let colors = VertexColors { color: Some("displayColor".into()), opacity: Some("displayOpacity".into()) };
        let index = self.add(Finished { material, colors });
        self.unbound = Some(index);
        index
    }

    /// The material at an index.
    pub fn get(&self, index: u32) -> Option<&MaterialDesc> {
        self.finished.get(index as usize).map(|finished| &finished.material)
    }

    /// True where material `index` shows the colors of the shape.
    pub fn is_tinted(&self, index: u32) -> bool {
        self.get(index).is_some_and(|material| material.tinted)
    }

    /// What `MeshDesc::colors` of a shape with material `index` has to hold.
    #[cfg(test)]
    pub fn vertex_colors(&self, index: u32) -> VertexColors {
        self.finished.get(index as usize).map(|finished| finished.colors.clone()).unwrap_or_default()
    }

    /// The UV set that the tangents of material `index` go by; `None` where it needs none.
    pub fn tangent_uv_set(&self, index: u32) -> Option<u32> {
        let material = self.get(index)?;
        let coat = material.coat.and_then(|coat| coat.normal);
        let normal = material.normal.or(coat).map(|normal| match normal.texture() {
            Some(texture) => texture.uv_set,
            // Whatever its graph looks up: a tilt has to go by something.
            None => graph_uv_sets(material).next().unwrap_or(0),
        });
        let named = material.graph.ops().contains(&Op::Leaf(Leaf::Tangent)).then_some(0);
        normal.or(material.anisotropy.filter(|a| a.strength.factor > 0.0).map(|_| 0)).or(named)
    }

    /// The UV sets that material `index` looks textures up by.
    pub fn used_uv_sets(&self, index: u32) -> Vec<u32> {
        let material = self.get(index);
        let mut sets: Vec<u32> = material.into_iter().flat_map(|m| m.textures()).map(|t| t.uv_set).collect();
        sets.extend(material.into_iter().flat_map(graph_uv_sets));
        sets.sort_unstable();
        sets.dedup();
        sets
    }

    /// Names of the primvars that the graph of material `index` asks for.
    pub fn named_primvars(&self, index: u32) -> impl Iterator<Item = Arc<str>> {
        self.get(index).into_iter().flat_map(|material| material.graph.ops()).filter_map(|op| match op {
            Op::Leaf(Leaf::Attribute { name, .. }) => Some(name.clone()),
            _ => None,
        })
    }

    /// Moves everything into `scene`.
    pub fn finish(self, scene: &mut SceneDesc) {
        scene.images = self.images.images;
        scene.textures = self.textures;
        scene.materials = self.finished.into_iter().map(|finished| finished.material).collect();
    }

    fn add(&mut self, mut finished: Finished) -> u32 {
        shown::add(&mut finished.material, &self.aovs, self.reading.meters);
        finished.material.tinted = finished.colors != VertexColors::default();
        self.finished.push(finished);
        self.finished.len() as u32 - 1
    }

    /// Index of the UV set of the primvar `name`.
    fn uv_set(&mut self, name: Arc<str>) -> u32 {
        let known = self.uv_sets.iter().position(|known| *known == name);
        known.unwrap_or_else(|| {
            self.uv_sets.push(name);
            self.uv_sets.len() - 1
        }) as u32
    }

    fn read(&mut self, path: &sdf::Path) -> Option<Finished> {
        let found = self.gathered.remove(path).unwrap_or_else(|| self.gather(path));
        if found.is_empty() {
            self.tell_why_not(path);
            return None;
        }
        for found in &found {
            let mut evaluator = evaluate::Evaluator::new(self, &found.network);
            if let Some(surface) = models::read(&mut evaluator, &found.surface) {
                let mut finished = surface::finish(&mut evaluator, found.surface.node, surface);
                finished.material.name = path.name().unwrap_or_default().into();
                finished.material.place = self.reading.place_of(path);
                self.tell_of_more(path);
                return Some(finished);
            }
        }
        let models: Vec<&str> =
            found.iter().map(|found| found.network.nodes[found.surface.node].category.as_str()).collect();
        let models = models.join("\", \"");
        self.reading.warn(path, format!("shading model \"{models}\" isn't read; displayColor is shown"));
        None
    }

    /// The networks of the material at `path`, best first.
    fn gather(&self, path: &sdf::Path) -> Vec<Found> {
        let reading = self.reading;
        if path.is_property_path() {
            return card::network(reading, path).into_iter().collect();
        }
        let material = schema::Material::get(&reading.stage, path.clone()).ok().flatten();
        let mut found = Vec::new();
        for context in CONTEXTS {
            let output = material.as_ref().and_then(|material| match context {
                "" => Some(material.surface_output()),
                _ => material.surface_output_for(context).ok(),
            });
            let network = output.and_then(|output| shade::network(reading, output.attribute()));
            found.extend(network.map(|(network, surface)| Found { network, surface }));
        }
        if found.is_empty()
            && let Some((file, name)) = mtlx::find(reading, path)
        {
            match mtlx::network(&file, &name) {
                Ok((network, surface)) => found.push(Found { network, surface }),
                Err(what) => reading.warn(path, what),
            }
        }
        found
    }

    /// Tells of what a material has beside its surface.
    fn tell_of_more(&self, path: &sdf::Path) {
        let reading = self.reading;
        let Some(material) = schema::Material::get(&reading.stage, path.clone()).ok().flatten() else { return };
        let outputs = [("displacement", material.displacement_outputs()), ("volume", material.volume_outputs())];
        for (what, outputs) in outputs {
            let models = outputs.unwrap_or_default().into_iter().filter_map(|output| {
                let (network, source) = shade::network(reading, output.attribute())?;
                Some(network.nodes[source.node].category.clone())
            });
            // Of UsdPreviewSurface its input tells whether there is any.
            if models.into_iter().any(|model| model != "UsdPreviewSurface") {
                reading.warn(path, format!("its {what} is left out: not computed yet"));
            }
        }
    }

    fn tell_why_not(&self, path: &sdf::Path) {
        let reading = self.reading;
        let Some(material) = schema::Material::get(&reading.stage, path.clone()).ok().flatten() else {
            reading.warn(path, "there is no material here; displayColor is shown");
            return;
        };
        let outputs = material.surface_outputs().unwrap_or_default();
        let contexts: Vec<String> = outputs
            .iter()
            .filter(|output| output.attribute().has_authored_connections().unwrap_or_default())
            .filter_map(|output| output.base_name().strip_suffix(":surface").map(str::to_string))
            .collect();
        let what = match contexts.is_empty() {
            true => "has no surface".to_string(),
            false => format!("has a surface for {} alone, which isn't read", contexts.join(", ")),
        };
        reading.warn(path, format!("{what}; displayColor is shown"));
    }
}
