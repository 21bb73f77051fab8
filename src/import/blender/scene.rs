//! A scene of Blender's, kept between renders so that only what changes is handed over again.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::sync::Arc;

use super::document::{Document, DocumentEdit, MaterialData};
use super::image::{ImageSource, Images, ImagesInMemory, InMemory};
use super::kept::KeptImages;
use super::layers::UvSets;
use super::light::LampShader;
use super::mesh::{self, Dress, LayerArray, MeshArrays, NamedMesh};
use super::motion::{MovedInstances, MovedPoints};
use super::nodes::TreeData;
use super::rounds::{Ends, NamedRounds};
use super::transform::affine_of_floats;
use super::{camera, light, material, nodes, random, rounds, world};
use crate::desc::{InstanceDesc, LightLinks, ObjectInfo, SceneDesc, ShapeRef};
use crate::error::{Error, Place, Result, Stop, Warnings};

/// Everything that the add-on has handed over so far.
#[derive(Debug, Default)]
pub struct BlenderScene {
    document: Document,
    materials: HashMap<u64, Arc<MaterialData>>,
    meshes: HashMap<u64, NamedMesh>,
    rounds: HashMap<u64, NamedRounds>,
    images: ImagesInMemory,
    /// How many images have been handed over.
    revisions: u64,
    kept: KeptImages,
    instances: Vec<Placement>,
    moved: MovedInstances,
    /// What was told of shapes as they came.
    of_shapes: HashMap<u64, Warnings>,
}

/// An instance of an object.
#[derive(Clone, Copy, Debug)]
struct Placement {
    /// Index of the object.
    object: u32,
    /// Its matrix by rows.
    matrix: [f32; 16],
    /// The random id that Blender gives instances; 0 for the object itself.
    random: u32,
}

impl BlenderScene {
    /// Takes in all but materials, meshes, images in memory and placements.
    ///
    /// # Errors
    /// JSON that is no [`Document`].
    pub fn set_document(&mut self, json: &str) -> Result<()> {
        let materials = std::mem::take(&mut self.document.materials);
        self.document = serde_json::from_str(json).map_err(|error| self.unparsable("description", &error))?;
        self.document.materials = materials;
        Ok(())
    }

    /// Takes in those parts of the document that were edited.
    ///
    /// # Errors
    /// JSON that is no [`DocumentEdit`].
    pub fn edit_document(&mut self, json: &str) -> Result<()> {
        let edit: DocumentEdit = serde_json::from_str(json).map_err(|error| self.unparsable("edit", &error))?;
        edit.apply(&mut self.document);
        Ok(())
    }

    /// Takes in the material `key`, in place of an earlier one.
    ///
    /// # Errors
    /// JSON that is no [`MaterialData`].
    pub fn set_material(&mut self, key: u64, json: &str) -> Result<()> {
        let material = serde_json::from_str(json).map_err(|error| self.unparsable("material", &error))?;
        self.materials.insert(key, Arc::new(material));
        Ok(())
    }

    /// Says which materials the objects' indices mean, and forgets all others.
    ///
    /// # Errors
    /// A key that no material was handed over for.
    pub fn set_materials(&mut self, keys: &[u64]) -> Result<()> {
        let known = |key: &u64| {
            let material = self.materials.get(key).cloned();
            material.ok_or_else(|| Error::invalid(&self.place(), format!("no material {key} was handed over")))
        };
        self.document.materials = keys.iter().map(known).collect::<Result<_>>()?;
        let used: HashSet<u64> = keys.iter().copied().collect();
        self.materials.retain(|key, _| used.contains(key));
        Ok(())
    }

    fn unparsable(&self, what: &str, error: &serde_json::Error) -> Error {
        Error::invalid(&self.place(), format!("the add-on's {what} doesn't parse: {error}"))
    }

    /// Takes in the mesh that objects name by `key`, in place of an earlier one.
    ///
    /// # Errors
    /// Arrays that don't fit together; the mesh of that key is gone then.
    pub fn set_mesh(
        &mut self,
        key: u64,
        name: &str,
        arrays: &MeshArrays<'_>,
        uvs: &[LayerArray<'_>],
        values: [&[LayerArray<'_>]; 2],
    ) -> Result<()> {
        self.remove_shape(key);
        let mut warnings = Warnings::new();
        let mesh = mesh::mesh(name, &self.place(), arrays, uvs, values, &mut warnings)?;
        self.meshes.insert(key, mesh);
        self.of_shapes.insert(key, warnings);
        Ok(())
    }

    /// Takes in the strands, or points where none ends, that objects name by `key`, with UV maps and attributes.
    ///
    /// # Errors
    /// Arrays that don't fit together; what was there of that key is gone then.
    pub fn set_rounds(
        &mut self,
        key: u64,
        name: &str,
        positions: &[f32],
        radii: &[f32],
        ends: Ends<'_>,
        layers: [&[LayerArray<'_>]; 2],
    ) -> Result<()> {
        self.remove_shape(key);
        let mut warnings = Warnings::new();
        let rounds = rounds::rounds(name, &self.place(), positions, radii, ends, layers, &mut warnings)?;
        self.rounds.insert(key, rounds);
        self.of_shapes.insert(key, warnings);
        Ok(())
    }

    /// Takes in where the points of the shape `key` are at other times: of the shutter, which the document has told by
    /// now, or of the frames before and after.
    pub fn set_shape_motion(&mut self, key: u64, moved: &[MovedPoints<'_>]) {
        let blurred = self.document.render.shutter != [0.0; 2];
        let warnings = self.of_shapes.entry(key).or_default();
        if let Some(mesh) = self.meshes.get_mut(&key) {
            mesh.set_motion(moved, blurred, warnings);
        } else if let Some(rounds) = self.rounds.get_mut(&key) {
            rounds.set_motion(moved, blurred, warnings);
        }
    }

    /// Takes in where `instances`, by their index among those of [`Self::set_instances`], are at another time than the
    /// frame's: frames after it, and as many matrices of sixteen floats by rows.
    ///
    /// # Errors
    /// Lists of different lengths, and instances that are not there.
    pub fn add_instance_motion(&mut self, time: f64, instances: &[u32], matrices: &[f32]) -> Result<()> {
        let (count, place) = (self.instances.len(), self.place());
        self.moved.add(time, instances, matrices, count, &place)
    }

    /// Forgets a mesh, strands or points.
    pub fn remove_shape(&mut self, key: u64) {
        self.meshes.remove(&key);
        self.rounds.remove(&key);
        self.of_shapes.remove(&key);
    }

    /// Keeps decoded images from now on: the scene will be asked for again, after edits.
    pub fn keep_images(&mut self) {
        self.kept.turn_on();
    }

    /// Takes in an image that the document says is in memory, or a tile of it.
    pub fn set_image(&mut self, name: &str, tile: Option<u32>, image: ImageSource) {
        self.images.insert((name.to_owned(), tile), InMemory { source: image, revision: self.revisions });
        self.revisions += 1;
    }

    /// Takes in all placements: object indices, as many matrices of sixteen floats by rows, and the random
    /// id of each instance, 0 for the object itself.
    ///
    /// # Errors
    /// Lists of different lengths.
    pub fn set_instances(&mut self, objects: &[u32], matrices: &[f32], random: &[u32]) -> Result<()> {
        let (matrices, rest) = matrices.as_chunks::<16>();
        let count = objects.len();
        if !rest.is_empty() || matrices.len() != count || random.len() != count {
            let what = format!("{} matrices and {} random ids for {count} instances", matrices.len(), random.len());
            return Err(Error::invalid(&self.place(), what));
        }
        self.moved.clear();
        let placements = objects.iter().zip(matrices).zip(random);
        self.instances = placements.map(|((&object, &matrix), &random)| Placement { object, matrix, random }).collect();
        Ok(())
    }

    fn place(&self) -> Place {
        match self.document.file.as_str() {
            "" => Place::default(),
            file => Place::file(file),
        }
    }

    /// The UV maps that materials name.
    fn uv_sets(&self) -> UvSets {
        let trees = self.document.materials.iter().filter_map(|material| material.nodes.as_ref());
        let of_meshes = self.meshes.values().map(|mesh| &*mesh.uv_names);
        let of_rounds = self.rounds.values().map(NamedRounds::uv_names);
        UvSets::new(trees.flat_map(TreeData::uv_map_names), of_meshes.chain(of_rounds))
    }

    /// The scene as authored.
    ///
    /// # Errors
    /// None so far: what can't be used is told and replaced.
    pub fn scene(&mut self, warnings: &mut Warnings) -> Result<SceneDesc> {
        self.scene_unless(&Stop::default(), warnings)
    }

    /// The same, unless `stop` is wished meanwhile.
    ///
    /// # Errors
    /// [`Error::Cancelled`] then.
    pub fn scene_unless(&mut self, stop: &Stop, warnings: &mut Warnings) -> Result<SceneDesc> {
        let place = self.place();
        let mut desc = SceneDesc { place: place.clone(), ..SceneDesc::default() };
        let of_object = self.add_instances(&mut desc, warnings);
        let document = &self.document;
        desc.render = document.render.desc();
        if let Some(data) = &document.camera {
            desc.cameras.push(camera::camera(data, &document.render, &place, warnings));
            desc.render.framing.camera = Some(data.name.as_str().into());
        }
        let mut images = Images::new(&document.images, &self.images, &place, document.version);
        let uv_sets = self.uv_sets();
        material::materials(document, &mut images, &uv_sets, &mut desc, warnings);
        self.add_lights(&of_object, &mut desc, &mut images, warnings);
        (desc.images, desc.textures) = images.finish(&mut self.kept, stop, warnings)?;
        Ok(desc)
    }

    /// Adds what is placed, and the meshes of it; returns the instances of each object.
    fn add_instances(&mut self, desc: &mut SceneDesc, warnings: &mut Warnings) -> Vec<Vec<u32>> {
        let document = &self.document;
        let trees = || document.materials.iter().filter_map(|material| material.nodes.as_ref());
        let uv_sets = self.uv_sets();
        let asked: BTreeSet<String> = trees().flat_map(TreeData::tangent_map_names).collect();
        // Those of set 0 are tangents of their own.
        let beside = |name: &String| uv_sets.set(name).is_some_and(|set| set != 0);
        let dress = Dress {
            uv_maps: uv_sets.names().to_vec(),
            tangents: asked.iter().any(|name| !beside(name)),
            tangent_maps: asked.iter().filter(|name| beside(name)).cloned().collect(),
        };
        let default = material::default_index(document);
        let mut known: HashMap<u64, ShapeRef> = HashMap::new();
        let mut of_object = vec![Vec::new(); document.objects.len()];
        let mut lost = 0;
        for (number, &Placement { object, matrix, random }) in self.instances.iter().enumerate() {
            let Some(data) = document.objects.get(object as usize) else {
                lost += 1;
                continue;
            };
            let shape = match known.get(&data.mesh) {
                Some(shape) => *shape,
                None => {
                    let shape = if let Some(mesh) = self.meshes.get_mut(&data.mesh) {
                        desc.meshes.push(mesh.dressed(&dress));
                        ShapeRef::Mesh(desc.meshes.len() as u32 - 1)
                    } else if let Some(rounds) = self.rounds.get_mut(&data.mesh) {
                        desc.rounds.push(rounds.dressed(&dress.uv_maps));
                        ShapeRef::Rounds(desc.rounds.len() as u32 - 1)
                    } else {
                        continue;
                    };
                    warnings.extend(self.of_shapes.get(&data.mesh).cloned().unwrap_or_default());
                    known.insert(data.mesh, shape);
                    shape
                }
            };
            of_object[object as usize].push(desc.instances.len() as u32);
            let transform = affine_of_floats(&matrix);
            desc.instances.push(InstanceDesc {
                name: data.name.as_str().into(),
                place: desc.place.at(&data.name),
                asset: if data.asset.is_empty() { data.name.as_str().into() } else { data.asset.as_str().into() },
                shape,
                transform,
                motion: self.moved.of(number as u32, &transform),
                materials: match data.materials.as_slice() {
                    [] => vec![Some(default)],
                    slots => slots.iter().map(|slot| Some(slot.unwrap_or(default))).collect(),
                },
                object_index: data.pass_index,
                color: None,
                visibility: data.visibility.into(),
                links: LightLinks::default(),
                shaped: None,
                holdout: data.holdout,
                catcher: data.shadow_catcher,
                terminator: Some(data.terminator.into()),
                info: ObjectInfo {
                    color: data.color,
                    random: if random == 0 { random::of_name(&data.name) } else { random::of_id(random) },
                    attributes: data.attributes.iter().map(|(name, value)| (name.as_str().into(), *value)).collect(),
                },
            });
        }
        if lost > 0 {
            warnings.push(&desc.place, format!("{lost} instances of unknown objects are left out"));
        }
        for (object, data) in document.objects.iter().enumerate() {
            if data.lightgroup.is_empty() && data.receivers.is_none() && data.blockers.is_none() {
                continue;
            }
            let links = light::links_of_object(data, &of_object);
            for &instance in &of_object[object] {
                desc.instances[instance as usize].links = links.clone();
            }
        }
        of_object
    }

    fn add_lights(
        &self,
        of_object: &[Vec<u32>],
        desc: &mut SceneDesc,
        images: &mut Images<'_>,
        warnings: &mut Warnings,
    ) {
        let document = &self.document;
        for data in &document.lights {
            let shader = match &data.nodes {
                Some(tree) => nodes::lamp(tree, images, desc.place.at(&data.name), warnings),
                None => LampShader::default(),
            };
            let Some(mut light) = light::light(data, &shader, &desc.place, warnings) else { continue };
            let own = light::links(&data.lightgroup, data.receivers.as_ref(), data.blockers.as_ref(), of_object);
            if let Some(varying) = shader.varying {
                light.shaping.shader = Some(desc.lamp_shaders.len() as u32);
                desc.lamp_shaders.push(varying);
            }
            let LightLinks { cast_shadow, max_bounces, takes, .. } = light.links;
            light.links = LightLinks { cast_shadow, max_bounces, takes, ..own };
            desc.lights.push(light);
        }
        if let Some(world) = &document.world {
            world::add(world, images, desc, warnings);
        }
    }
}
