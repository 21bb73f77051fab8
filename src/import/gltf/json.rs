//! The JSON of glTF 2.0 as typed data; names and defaults are those of the specification
//! (<https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>, section 5 and the KHR extensions).
//!
//! Indices are raw numbers: nothing here is checked against the length of the list it points into.

use serde::Deserialize;
use std::collections::BTreeMap;

macro_rules! object {
    ($(#[$meta:meta])* $name:ident { $($(#[$field_meta:meta])* $field:ident : $ty:ty $(= $default:expr)?),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Deserialize)]
        #[serde(rename_all = "camelCase", default)]
        pub(super) struct $name { $($(#[$field_meta])* pub $field: $ty),* }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: object!(@default $($default)?)),* }
            }
        }
    };
    (@default) => { Default::default() };
    (@default $default:expr) => { $default };
}

object!(Root {
    asset: Asset,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
    scene: Option<usize>,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<Mesh>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    images: Vec<Image>,
    samplers: Vec<Sampler>,
    cameras: Vec<Camera>,
    skins: Vec<Skin>,
    animations: Vec<Animation>,
    extensions: RootExtensions,
});

object!(
    /// The part of the root that is read first.
    Head {
        asset: Asset,
        extensions_used: Vec<String>,
        extensions_required: Vec<String>,
    }
);

object!(Asset { version: String, min_version: Option<String>, generator: String });

object!(RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    lights: LightList,
    #[serde(rename = "EXT_lights_ies")]
    ies: IesList,
    #[serde(rename = "KHR_materials_variants")]
    variants: VariantList,
});
object!(LightList { lights: Vec<Light> });
object!(IesList { lights: Vec<IesProfile> });
object!(IesProfile { name: Option<String>, uri: Option<String>, buffer_view: Option<usize> });
object!(VariantList { variants: Vec<Variant> });
object!(Variant { name: String });

object!(Scene { name: Option<String>, nodes: Vec<usize>, extensions: SceneExtensions });
object!(SceneExtensions {
    #[serde(rename = "PENUMBRA_blender")]
    stamp: Option<serde_json::Value>,
});

object!(Node {
    name: Option<String>,
    children: Vec<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
    mesh: Option<usize>,
    camera: Option<usize>,
    skin: Option<usize>,
    weights: Option<Vec<f64>>,
    extras: serde_json::Value,
    extensions: NodeExtensions,
});
object!(NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    light: Option<NodeLight>,
    #[serde(rename = "EXT_lights_ies")]
    ies: Option<NodeIes>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    visibility: Option<NodeVisibility>,
    #[serde(rename = "PENUMBRA_blender")]
    stamp: Option<serde_json::Value>,
});
object!(NodeLight { light: Option<usize> });
object!(NodeIes { light: Option<usize>, multiplier: f64 = 1.0, color: [f64; 3] = [1.0; 3] });
object!(Instancing { attributes: BTreeMap<String, usize> });
object!(NodeVisibility { visible: bool = true });

object!(Mesh { name: Option<String>, primitives: Vec<Primitive>, weights: Vec<f64> });
object!(Primitive {
    attributes: BTreeMap<String, usize>,
    indices: Option<usize>,
    material: Option<usize>,
    mode: u32 = 4,
    targets: Vec<BTreeMap<String, usize>>,
    extensions: PrimitiveExtensions,
});
object!(PrimitiveExtensions {
    #[serde(rename = "KHR_materials_variants")]
    variants: VariantMappings,
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<Draco>,
});
object!(VariantMappings { mappings: Vec<VariantMapping> });
object!(VariantMapping { material: Option<usize>, variants: Vec<usize> });
object!(Draco { buffer_view: Option<usize>, attributes: BTreeMap<String, u32> });
object!(Empty {});

object!(Accessor {
    name: Option<String>,
    buffer_view: Option<usize>,
    byte_offset: usize,
    component_type: u32,
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Sparse>,
});
object!(Sparse { count: usize, indices: SparseIndices, values: SparseValues });
object!(SparseIndices { buffer_view: Option<usize>, byte_offset: usize, component_type: u32 });
object!(SparseValues { buffer_view: Option<usize>, byte_offset: usize });

object!(BufferView {
    buffer: Option<usize>,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
    extensions: BufferViewExtensions,
});
object!(BufferViewExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    meshopt: Option<Meshopt>,
});
object!(Meshopt {
    buffer: Option<usize>,
    byte_offset: usize,
    byte_length: usize,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
});

object!(Buffer { name: Option<String>, uri: Option<String>, byte_length: usize, extensions: BufferExtensions });
object!(BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression", alias = "KHR_meshopt_compression")]
    meshopt: Option<MeshoptFallback>,
});
object!(MeshoptFallback { fallback: bool });

object!(Texture {
    name: Option<String>,
    sampler: Option<usize>,
    source: Option<usize>,
    extensions: TextureExtensions,
});
object!(TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    webp: Option<TextureSource>,
    #[serde(rename = "KHR_texture_basisu")]
    basisu: Option<TextureSource>,
});
object!(TextureSource { source: Option<usize> });
object!(Image { name: Option<String>, uri: Option<String>, mime_type: Option<String>, buffer_view: Option<usize> });
object!(Sampler { mag_filter: Option<u32>, min_filter: Option<u32>, wrap_s: u32 = 10497, wrap_t: u32 = 10497 });

object!(Camera {
    name: Option<String>,
    #[serde(rename = "type")]
    kind: String,
    perspective: Option<Perspective>,
    orthographic: Option<Orthographic>,
});
object!(Perspective { aspect_ratio: Option<f64>, yfov: f64, zfar: Option<f64>, znear: f64 });
object!(Orthographic { xmag: f64, ymag: f64, zfar: f64, znear: f64 });

object!(Light {
    name: Option<String>,
    #[serde(rename = "type")]
    kind: String,
    color: [f64; 3] = [1.0; 3],
    intensity: f64 = 1.0,
    range: Option<f64>,
    spot: Spot,
});
object!(Spot { inner_cone_angle: f64, outer_cone_angle: f64 = std::f64::consts::FRAC_PI_4 });

object!(Skin { name: Option<String>, inverse_bind_matrices: Option<usize>, joints: Vec<usize> });

object!(Animation { name: Option<String>, channels: Vec<Channel>, samplers: Vec<AnimationSampler> });
object!(Channel { sampler: usize, target: ChannelTarget });
object!(ChannelTarget { node: Option<usize>, path: String, extensions: ChannelTargetExtensions });
object!(ChannelTargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pointer: Option<AnimationPointer>,
});
object!(AnimationPointer { pointer: String });
object!(AnimationSampler { input: usize, interpolation: Option<String>, output: usize });

object!(
    /// `textureInfo`, `normalTextureInfo` and `occlusionTextureInfo` in one.
    TextureInfo {
        index: Option<usize>,
        tex_coord: u32,
        scale: f64 = 1.0,
        strength: f64 = 1.0,
        extensions: TextureInfoExtensions,
    }
);
object!(TextureInfoExtensions {
    #[serde(rename = "KHR_texture_transform")]
    transform: Option<Transform>,
});
object!(Transform { offset: [f64; 2], rotation: f64, scale: [f64; 2] = [1.0; 2], tex_coord: Option<u32> });

object!(Material {
    name: Option<String>,
    pbr_metallic_roughness: MetallicRoughness,
    normal_texture: Option<TextureInfo>,
    occlusion_texture: Option<TextureInfo>,
    emissive_texture: Option<TextureInfo>,
    emissive_factor: [f64; 3],
    alpha_mode: Option<String>,
    alpha_cutoff: f64 = 0.5,
    double_sided: bool,
    extensions: MaterialExtensions,
});
object!(MetallicRoughness {
    base_color_factor: [f64; 4] = [1.0; 4],
    base_color_texture: Option<TextureInfo>,
    metallic_factor: f64 = 1.0,
    roughness_factor: f64 = 1.0,
    metallic_roughness_texture: Option<TextureInfo>,
});
object!(MaterialExtensions {
    #[serde(rename = "KHR_materials_anisotropy")]
    anisotropy: Option<Anisotropy>,
    #[serde(rename = "KHR_materials_clearcoat")]
    clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_diffuse_transmission")]
    diffuse_transmission: Option<DiffuseTransmission>,
    #[serde(rename = "KHR_materials_dispersion")]
    dispersion: Option<Dispersion>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_ior")]
    ior: Option<Ior>,
    #[serde(rename = "KHR_materials_iridescence")]
    iridescence: Option<Iridescence>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    specular_glossiness: Option<SpecularGlossiness>,
    #[serde(rename = "KHR_materials_sheen")]
    sheen: Option<Sheen>,
    #[serde(rename = "KHR_materials_specular")]
    specular: Option<Specular>,
    #[serde(rename = "KHR_materials_transmission")]
    transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_unlit")]
    unlit: Option<Empty>,
    #[serde(rename = "KHR_materials_volume")]
    volume: Option<Volume>,
});
object!(Anisotropy {
    anisotropy_strength: f64,
    anisotropy_rotation: f64,
    anisotropy_texture: Option<TextureInfo>,
});
object!(Clearcoat {
    clearcoat_factor: f64,
    clearcoat_texture: Option<TextureInfo>,
    clearcoat_roughness_factor: f64,
    clearcoat_roughness_texture: Option<TextureInfo>,
    clearcoat_normal_texture: Option<TextureInfo>,
});
object!(DiffuseTransmission {
    diffuse_transmission_factor: f64,
    diffuse_transmission_texture: Option<TextureInfo>,
    diffuse_transmission_color_factor: [f64; 3] = [1.0; 3],
    diffuse_transmission_color_texture: Option<TextureInfo>,
});
object!(Dispersion { dispersion: f64 });
object!(EmissiveStrength { emissive_strength: f64 = 1.0 });
object!(Ior { ior: f64 = 1.5 });
object!(Iridescence {
    iridescence_factor: f64,
    iridescence_texture: Option<TextureInfo>,
    iridescence_ior: f64 = 1.3,
    iridescence_thickness_minimum: f64 = 100.0,
    iridescence_thickness_maximum: f64 = 400.0,
    iridescence_thickness_texture: Option<TextureInfo>,
});
object!(SpecularGlossiness {
    diffuse_factor: [f64; 4] = [1.0; 4],
    diffuse_texture: Option<TextureInfo>,
    specular_factor: [f64; 3] = [1.0; 3],
    glossiness_factor: f64 = 1.0,
    specular_glossiness_texture: Option<TextureInfo>,
});
object!(Sheen {
    sheen_color_factor: [f64; 3],
    sheen_color_texture: Option<TextureInfo>,
    sheen_roughness_factor: f64,
    sheen_roughness_texture: Option<TextureInfo>,
});
object!(Specular {
    specular_factor: f64 = 1.0,
    specular_texture: Option<TextureInfo>,
    specular_color_factor: [f64; 3] = [1.0; 3],
    specular_color_texture: Option<TextureInfo>,
});
object!(Transmission { transmission_factor: f64, transmission_texture: Option<TextureInfo> });
object!(Volume {
    thickness_factor: f64,
    thickness_texture: Option<TextureInfo>,
    attenuation_distance: Option<f64>,
    attenuation_color: [f64; 3] = [1.0; 3],
});
