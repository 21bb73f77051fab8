//! Puts the scene together: nodes to instances, cameras and lights; what they use to meshes,
//! materials and textures. What nothing uses is not read.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::Path;

use rayon::prelude::*;

use super::super::ImportOptions;
use super::super::blender::Stamp;
use super::accessor::Reader;
use super::deform::SkinPose;
use super::document::label;
use super::extras::Penumbra;
use super::json::{Material, Primitive};
use super::lights::Lights;
use super::links::Links;
use super::mesh::{self, Job};
use super::node::{self, Hierarchy, PlacedNode};
use super::texture::{Lookup, TextureTable};
use super::{camera, instancing, material, stamp};
use crate::desc::{CameraDesc, InstanceDesc, MaterialDesc, MeshDesc, ObjectInfo, SceneDesc, ShapeRef, Visibility};
use crate::error::{Error, Place, Result, Warnings};
use crate::math::{DAffine3, DMat4, DVec3};

/// Instances that any file may have; more only in proportion to its size.
const FREE_INSTANCES: usize = 1 << 16;

/// Everything that is read from.
pub(super) struct Builder<'a> {
    pub reader: Reader<'a>,
    pub base_dir: Option<&'a Path>,
    pub place: &'a Place,
    pub options: &'a ImportOptions,
    /// Bytes of the file itself.
    pub file_size: usize,
    /// True where nothing counts but where things are: no image is decoded.
    pub moving: bool,
}

/// A mesh in one state of deformation: what nodes can share.
#[derive(Clone, PartialEq, Eq, Hash)]
struct MeshState {
    mesh: usize,
    /// Bits of the morph weights; empty where all are 0.
    weights: Vec<u64>,
    skin: Option<usize>,
}

/// A primitive of a mesh state, as read.
struct Part {
    mesh: u32,
    material: Option<u32>,
}

/// What a mesh state consists of.
#[derive(Default)]
struct State {
    parts: Vec<Part>,
    /// For a skinned mesh, whose points are in the world already: where they are measured from.
    origin: Option<DVec3>,
}

/// Meshes of the scene and the parts that each state consists of.
struct Meshes {
    meshes: Vec<MeshDesc>,
    parts: Vec<State>,
    /// For each placed node, its state in `parts`.
    by_node: Vec<Option<usize>>,
}

/// Materials of the scene by index in the file; `None` for that of primitives that name none.
type MaterialMap = BTreeMap<Option<usize>, u32>;

impl Builder<'_> {
    /// Builds the scene.
    pub fn build(&self, warnings: &mut Warnings) -> Result<SceneDesc> {
        let root = self.reader.root;
        let variant = self.variant()?;
        let hierarchy = node::walk(root, self.place, warnings);
        let used = self.used_materials(&hierarchy, variant);
        let (textures, materials, material_map) = self.materials(&used, warnings);
        let meshes = self.meshes(&hierarchy, variant, &materials, &material_map, warnings)?;
        let mut scene = SceneDesc {
            place: self.place.clone(),
            materials,
            textures: textures.textures,
            images: textures.images,
            variants: root.extensions.variants.variants.iter().map(|v| v.name.clone()).collect(),
            lights_left_out: hierarchy.lights_left_out,
            ..SceneDesc::default()
        };
        let mut lights = Lights::new(self.reader, self.base_dir, self.place, self.options.light_units);
        let mut links = Links::default();
        for (i, node) in hierarchy.nodes.iter().enumerate() {
            let penumbra = Penumbra::read(&root.nodes[node.node].extras, &node.place, warnings);
            let (first_light, first_instance) = (scene.lights.len(), scene.instances.len());
            let json = root.nodes[node.node].extensions.stamp.as_ref();
            let stamp = stamp::read(json, self.base_dir, self.options, &node.place, warnings);
            self.camera(node, stamp.as_ref(), &mut scene, warnings);
            lights.add(node, &penumbra, stamp.as_ref(), &mut scene, warnings);
            if let Some(state) = meshes.by_node[i] {
                self.instances(node, &penumbra, &meshes.parts[state], &mut scene, warnings)?;
            }
            let (lights, instances) = (first_light..scene.lights.len(), first_instance..scene.instances.len());
            let is_dark = stamp.is_some_and(|stamp| stamp.light.is_some());
            if lights.is_empty() && !is_dark && penumbra.gives_light(&root.nodes[node.node]) {
                scene.lights_left_out += 1;
            } else if penumbra.has_rules() && lights.is_empty() && instances.is_empty() {
                warnings.push(&node.place, "extras.penumbra: the node has neither a mesh nor a light to apply to");
            }
            links.add(instances, lights, penumbra);
        }
        links.resolve(&hierarchy.nodes, &mut scene, warnings);
        let json = root.scenes.get(root.scene.unwrap_or(0)).and_then(|scene| scene.extensions.stamp.as_ref());
        if let Some(stamp) = stamp::read(json, self.base_dir, self.options, self.place, warnings) {
            let world = stamp::world(&stamp, &mut scene, warnings);
            scene.lights.extend(world);
        }
        lights.tell_of_lost(warnings);
        scene.meshes = meshes.meshes.into_iter().map(Into::into).collect();
        Ok(scene)
    }

    /// The index of the variant that was asked for.
    fn variant(&self) -> Result<Option<usize>> {
        let Some(wanted) = self.options.variants.last() else { return Ok(None) };
        let variants = &self.reader.root.extensions.variants.variants;
        if let Some(index) = variants.iter().position(|v| v.name == *wanted) {
            return Ok(Some(index));
        }
        let names: Vec<&str> = variants.iter().map(|v| v.name.as_str()).collect();
        let known =
            if names.is_empty() { "the file has none".into() } else { format!("there are: {}", names.join(", ")) };
        Err(Error::invalid(self.place, format!("no material variant '{wanted}'; {known}")))
    }

    fn used_materials(&self, hierarchy: &Hierarchy, variant: Option<usize>) -> BTreeSet<Option<usize>> {
        let root = self.reader.root;
        let used_meshes: BTreeSet<usize> = hierarchy.nodes.iter().filter_map(|n| root.nodes[n.node].mesh).collect();
        let meshes = used_meshes.into_iter().filter_map(|mesh| root.meshes.get(mesh));
        meshes.flat_map(|mesh| &mesh.primitives).map(|primitive| self.material_of(primitive, variant)).collect()
    }

    /// The material of a primitive under a variant, if there is such a material.
    fn material_of(&self, primitive: &Primitive, variant: Option<usize>) -> Option<usize> {
        let mappings = &primitive.extensions.variants.mappings;
        let mapped = variant.and_then(|v| mappings.iter().find(|m| m.variants.contains(&v))?.material);
        mapped.or(primitive.material).filter(|&material| material < self.reader.root.materials.len())
    }

    fn materials(
        &self,
        used: &BTreeSet<Option<usize>>,
        warnings: &mut Warnings,
    ) -> (TextureTable, Vec<MaterialDesc>, MaterialMap) {
        let default = Material { double_sided: true, ..Material::default() };
        let root = self.reader.root;
        let json = |index: Option<usize>| index.map_or(&default, |i| &root.materials[i]);
        let mut wishes = BTreeSet::new();
        for &index in used {
            let mut collect = Lookup::Collect(&mut wishes);
            material::convert(index, json(index), &mut collect, self.place, &mut Warnings::new());
        }
        if self.moving {
            wishes.clear();
        }
        let table = TextureTable::load(self.reader, &wishes, self.base_dir, self.place, warnings);
        let mut lookup = Lookup::Table(&table);
        let materials =
            used.iter().map(|&i| material::convert(i, json(i), &mut lookup, self.place, warnings)).collect();
        let map = used.iter().enumerate().map(|(at, &index)| (index, at as u32)).collect();
        (table, materials, map)
    }

    fn meshes(
        &self,
        hierarchy: &Hierarchy,
        variant: Option<usize>,
        materials: &[MaterialDesc],
        material_map: &MaterialMap,
        warnings: &mut Warnings,
    ) -> Result<Meshes> {
        let root = self.reader.root;
        let mut states: Vec<MeshState> = Vec::new();
        let mut known: HashMap<MeshState, usize> = HashMap::new();
        let mut by_node = vec![None; hierarchy.nodes.len()];
        for (slot, placed) in by_node.iter_mut().zip(&hierarchy.nodes) {
            let Some(state) = self.mesh_state(placed, warnings) else { continue };
            *slot = Some(*known.entry(state.clone()).or_insert_with(|| {
                states.push(state);
                states.len() - 1
            }));
        }
        let poses = self.skin_poses(&states, hierarchy, warnings)?;
        let weights: Vec<Vec<f64>> =
            states.iter().map(|s| s.weights.iter().map(|&bits| f64::from_bits(bits)).collect()).collect();
        let mut jobs = Vec::new();
        for (s, state) in states.iter().enumerate() {
            for (p, primitive) in root.meshes[state.mesh].primitives.iter().enumerate() {
                let material = material_map.get(&self.material_of(primitive, variant)).copied();
                let tangent_uv_set = material.and_then(|m| tangent_uv_set(&materials[m as usize]));
                let skin = state.skin.and_then(|skin| poses.get(&skin));
                let job = Job { mesh: state.mesh, primitive: p, weights: &weights[s], skin, tangent_uv_set };
                jobs.push((s, material, job));
            }
        }
        let built: Vec<_> = jobs
            .par_iter()
            .map(|(state, material, job)| {
                let mut warnings = Warnings::new();
                let mesh = mesh::build(self.reader, job, self.place, &mut warnings);
                (*state, *material, mesh, warnings)
            })
            .collect();
        let mut meshes = Meshes { meshes: Vec::new(), parts: Vec::new(), by_node };
        let origin = |state: &MeshState| state.skin.and_then(|skin| poses.get(&skin)).map(|pose| pose.origin);
        meshes.parts.extend(states.iter().map(|state| State { parts: Vec::new(), origin: origin(state) }));
        for (state, material, mesh, own_warnings) in built {
            warnings.extend(own_warnings);
            if let Some(mesh) = mesh? {
                meshes.parts[state].parts.push(Part { mesh: meshes.meshes.len() as u32, material });
                meshes.meshes.push(mesh);
            }
        }
        Ok(meshes)
    }

    /// What mesh a node shows, in which state.
    fn mesh_state(&self, placed: &PlacedNode, warnings: &mut Warnings) -> Option<MeshState> {
        let root = self.reader.root;
        let node = &root.nodes[placed.node];
        let index = node.mesh?;
        let Some(mesh) = root.meshes.get(index) else {
            let what = format!("names mesh {index} of {}; the node shows nothing", root.meshes.len());
            warnings.push(&placed.place, what);
            return None;
        };
        let weights = node.weights.as_ref().unwrap_or(&mesh.weights);
        let weights =
            if weights.iter().all(|&w| w == 0.0) { Vec::new() } else { weights.iter().map(|w| w.to_bits()).collect() };
        let skin = node.skin.filter(|&skin| skin < root.skins.len());
        if node.skin.is_some() && skin.is_none() {
            warnings.push(&placed.place, "names a skin that does not exist; the mesh is not deformed");
        }
        Some(MeshState { mesh: index, weights, skin })
    }

    fn skin_poses(
        &self,
        states: &[MeshState],
        hierarchy: &Hierarchy,
        warnings: &mut Warnings,
    ) -> Result<BTreeMap<usize, SkinPose>> {
        let skins: BTreeSet<usize> = states.iter().filter_map(|state| state.skin).collect();
        let pose = |index: usize| Ok((index, self.skin_pose(index, hierarchy, warnings)?));
        skins.into_iter().map(pose).collect()
    }

    fn skin_pose(&self, index: usize, hierarchy: &Hierarchy, warnings: &mut Warnings) -> Result<SkinPose> {
        let skin = &self.reader.root.skins[index];
        let place = self.place.at(label("skin", index, skin.name.as_deref()));
        let inverse_binds: Vec<DMat4> = match skin.inverse_bind_matrices {
            Some(accessor) => {
                let matrices = self.reader.floats::<16>(accessor).map_err(|e| Error::invalid(&place, e))?;
                matrices.into_iter().map(|m| DMat4::from_cols_array(&m.map(f64::from))).collect()
            }
            None => Vec::new(),
        };
        if !inverse_binds.is_empty() && inverse_binds.len() < skin.joints.len() {
            let what = format!("{} inverse bind matrices for {} joints", inverse_binds.len(), skin.joints.len());
            return Err(Error::invalid(&place, what));
        }
        let mut lost = 0;
        let joints: Vec<DAffine3> = skin
            .joints
            .iter()
            .enumerate()
            .map(|(i, &joint)| {
                let world = hierarchy.world.get(joint).copied().flatten();
                lost += usize::from(world.is_none());
                let inverse_bind = inverse_binds.get(i).map_or(DAffine3::IDENTITY, |m| DAffine3::from_mat4(*m));
                world.unwrap_or(DAffine3::IDENTITY) * inverse_bind
            })
            .collect();
        if lost > 0 {
            warnings.push(&place, format!("{lost} joints are not in the node tree; they stay at the origin"));
        }
        let origin = joints.first().map_or(DVec3::ZERO, |joint| joint.translation);
        let origin = if origin.is_finite() { origin } else { DVec3::ZERO };
        let move_back = DAffine3::from_translation(-origin);
        Ok(SkinPose { joints: joints.into_iter().map(|joint| move_back * joint).collect(), origin })
    }

    fn instances(
        &self,
        placed: &PlacedNode,
        penumbra: &Penumbra,
        state: &State,
        scene: &mut SceneDesc,
        warnings: &mut Warnings,
    ) -> Result<()> {
        let node = &self.reader.root.nodes[placed.node];
        // The node's own transform has no part in a skinned mesh (glTF 2.0, 3.7.3.3).
        let world = state.origin.map_or(placed.world, DAffine3::from_translation);
        let transforms = match &node.extensions.instancing {
            Some(instancing) => {
                let locals = instancing::transforms(self.reader, instancing);
                let locals = locals.map_err(|e| Error::invalid(&placed.place, e))?;
                locals.into_iter().map(|local| world * local).collect()
            }
            None => vec![world],
        };
        let budget = FREE_INSTANCES.max(4 * (self.file_size + self.reader.buffers.total_bytes));
        if scene.instances.len() + transforms.len() * state.parts.len() > budget {
            let what = format!("more than {budget} instances come from a file of {} bytes", self.file_size);
            return Err(Error::invalid(&placed.place, what));
        }
        let mut singular = 0;
        for transform in transforms {
            if !node::usable(&transform) {
                singular += 1;
                continue;
            }
            for part in &state.parts {
                scene.instances.push(InstanceDesc {
                    name: placed.name.clone(),
                    place: placed.place.clone(),
                    asset: placed.asset.clone(),
                    shape: ShapeRef::Mesh(part.mesh),
                    transform,
                    motion: Vec::new(),
                    materials: vec![part.material],
                    color: None,
                    object_index: placed.node as u32 + 1,
                    info: ObjectInfo::default(),
                    visibility: penumbra.visible(Visibility::ALL),
                    links: penumbra.links(),
                    shaped: None,
                    holdout: false,
                    catcher: false,
                    terminator: None,
                });
            }
        }
        if singular > 0 {
            warnings.push(&placed.place, format!("{singular} instances have a singular transform; they are left out"));
        }
        Ok(())
    }

    fn camera(&self, placed: &PlacedNode, stamp: Option<&Stamp>, scene: &mut SceneDesc, warnings: &mut Warnings) {
        let root = self.reader.root;
        if let Some((camera, render)) = stamp.and_then(|stamp| stamp::camera(stamp, placed, warnings)) {
            scene.cameras.push(camera);
            if let Some(render) = render {
                scene.render = render;
            }
            return;
        }
        let Some(index) = root.nodes[placed.node].camera else { return };
        let Some(json) = root.cameras.get(index) else {
            warnings.push(&placed.place, format!("names camera {index} of {}; it is left out", root.cameras.len()));
            return;
        };
        match camera::projection(json) {
            Ok((projection, clip_near, clip_far)) => scene.cameras.push(CameraDesc {
                name: placed.name.clone(),
                place: placed.place.clone(),
                transform: placed.world,
                projection,
                clip_near,
                clip_far,
                shift: [0.0; 2],
                lens: None,
                shutter: [0.0; 2],
                shutter_curve: Vec::new(),
                rolling_shutter: None,
                zoom: Vec::new(),
                exposure: 1.0,
                motion: Vec::new(),
            }),
            Err(what) => warnings.push(&placed.place, format!("{what}; the camera is left out")),
        }
    }
}

/// The UV set that a material's tangents go by; `None` where it needs none.
fn tangent_uv_set(material: &MaterialDesc) -> Option<u32> {
    let coat = material.coat.and_then(|coat| coat.normal);
    let normal = material.normal.or(coat).and_then(|normal| normal.texture()).map(|texture| texture.uv_set);
    let anisotropy = material.anisotropy.filter(|a| a.strength.factor > 0.0);
    normal.or(anisotropy.map(|a| a.texture.map_or(0, |texture| texture.uv_set)))
}
