//! Materials as authored: one layered surface that every door maps to.
//!
//! The layers and their meaning are those of glTF 2.0's metallic-roughness model with its KHR
//! extensions (Appendix B of the specification).

use std::sync::Arc;

use super::TextureRef;
use super::graph::{Graph, ValueId};
use crate::error::Place;

/// A colour: `factor × texture.rgb × graph.rgb`, linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant part.
    pub factor: [f64; 3],
    /// Texture part; `None` for white.
    pub texture: Option<TextureRef>,
    /// Value of the material's graph; `None` for white.
    pub graph: Option<ValueId>,
}

impl ColorInput {
    /// The same colour everywhere.
    pub const fn constant(factor: [f64; 3]) -> Self {
        Self::textured(factor, None)
    }

    /// `factor × texture`.
    pub const fn textured(factor: [f64; 3], texture: Option<TextureRef>) -> Self {
        Self { factor, texture, graph: None }
    }

    /// What the material's graph says.
    pub const fn graph(value: ValueId) -> Self {
        Self { factor: [1.0; 3], texture: None, graph: Some(value) }
    }
}

/// A channel of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// Red or grey.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// Alpha; 1 for an image without.
    A,
}

/// A number: `factor × texture.channel × graph`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant part.
    pub factor: f64,
    /// Texture part and which channel of it; `None` for 1.
    pub texture: Option<(TextureRef, Channel)>,
    /// Value of the material's graph, its first place; `None` for 1.
    pub graph: Option<ValueId>,
}

impl ScalarInput {
    /// The same number everywhere.
    pub const fn constant(factor: f64) -> Self {
        Self::textured(factor, None)
    }

    /// `factor × texture`.
    pub const fn textured(factor: f64, texture: Option<(TextureRef, Channel)>) -> Self {
        Self { factor, texture, graph: None }
    }

    /// What the material's graph says.
    pub const fn graph(value: ValueId) -> Self {
        Self { factor: 1.0, texture: None, graph: Some(value) }
    }
}

/// Where a normal comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NormalInput {
    /// A tangent-space map, +y along the bitangent.
    Map {
        /// The map.
        texture: TextureRef,
        /// Factor of its x and y.
        scale: f64,
    },
    /// Value of the material's graph: a normal in world space, on the side of whoever looks.
    Graph(ValueId),
}

impl NormalInput {
    /// The map, where it is one.
    pub fn texture(&self) -> Option<TextureRef> {
        match self {
            Self::Map { texture, .. } => Some(*texture),
            Self::Graph(_) => None,
        }
    }

    fn value(&self) -> Option<ValueId> {
        match self {
            Self::Map { .. } => None,
            Self::Graph(value) => Some(*value),
        }
    }
}

/// How opacity is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Opacity is 1 whatever the texture holds.
    Opaque,
    /// Opacity is 1 where alpha reaches the cut-off, else 0.
    Mask {
        /// The cut-off.
        cutoff: f64,
    },
    /// Opacity is alpha.
    Blend,
}

/// KHR_materials_volume: the inside of a transmissive surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeDesc {
    /// Thickness beneath the surface; 0 makes the surface thin-walled. In metres, object space.
    pub thickness: ScalarInput,
    /// Distance after which white light has `attenuation_color`; infinite for none.
    pub attenuation_distance: f64,
    /// Colour that white light has there.
    pub attenuation_color: [f64; 3],
}

/// KHR_materials_clearcoat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatDesc {
    /// Weight, 0 to 1.
    pub weight: ScalarInput,
    /// Perceptual roughness.
    pub roughness: ScalarInput,
    /// Index of refraction; glTF fixes it at 1.5.
    pub ior: f64,
    /// Its own normal map.
    pub normal: Option<NormalInput>,
}

/// KHR_materials_sheen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheenDesc {
    /// Colour; black for none.
    pub color: ColorInput,
    /// Perceptual roughness.
    pub roughness: ScalarInput,
}

/// KHR_materials_iridescence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IridescenceDesc {
    /// Weight, 0 to 1.
    pub weight: ScalarInput,
    /// Index of refraction of the film.
    pub ior: f64,
    /// Thickness in nanometres where the texture is 0.
    pub thickness_min: f64,
    /// Thickness in nanometres where the texture is 1, or without texture.
    pub thickness_max: f64,
    /// Where between the two; `None` for `thickness_max`.
    pub thickness_texture: Option<(TextureRef, Channel)>,
}

/// KHR_materials_anisotropy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnisotropyDesc {
    /// Strength, 0 to 1.
    pub strength: f64,
    /// Direction in tangent space, radians counter-clockwise from the tangent.
    pub rotation: f64,
    /// Direction in red and green, strength in blue.
    pub texture: Option<TextureRef>,
}

/// A surface.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDesc {
    /// Name, for Cryptomatte.
    pub name: Arc<str>,
    /// Where it stands in the file.
    pub place: Place,
    /// Value of the material index pass.
    pub material_index: u32,
    /// What the inputs name as their `graph`; empty for a material of constants and plain textures.
    pub graph: Graph,
    /// Diffuse albedo of dielectrics, normal-incidence reflectance of metals.
    pub base_color: ColorInput,
    /// Alpha; `alpha_mode` says how it is read. Times the vertex colour's alpha.
    pub alpha: ScalarInput,
    /// How alpha is read.
    pub alpha_mode: AlphaMode,
    /// False where back faces are not seen (glTF without `doubleSided`). A path tracer renders
    /// both sides; kept for doors and reports.
    pub double_sided: bool,
    /// 0 dielectric, 1 metal.
    pub metallic: ScalarInput,
    /// Perceptual roughness; the microfacet width is its square.
    pub roughness: ScalarInput,
    /// Index of refraction.
    pub ior: f64,
    /// Weight of the dielectric's reflection (KHR_materials_specular).
    pub specular: ScalarInput,
    /// Tint of the dielectric's reflection at normal incidence.
    pub specular_color: ColorInput,
    /// Share of what enters the dielectric that is refracted instead of scattered.
    pub transmission: ScalarInput,
    /// The inside; `None` for thin-walled.
    pub volume: Option<VolumeDesc>,
    /// 20 / Abbe number; 0 for none (KHR_materials_dispersion).
    pub dispersion: f64,
    /// Clear coat.
    pub coat: Option<CoatDesc>,
    /// Sheen.
    pub sheen: Option<SheenDesc>,
    /// Thin film.
    pub iridescence: Option<IridescenceDesc>,
    /// Stretched highlights.
    pub anisotropy: Option<AnisotropyDesc>,
    /// Emitted radiance, before `emission_strength`.
    pub emission: ColorInput,
    /// Factor of `emission` (KHR_materials_emissive_strength), W·sr⁻¹·m⁻².
    pub emission_strength: f64,
    /// Tangent-space normals.
    pub normal: Option<NormalInput>,
    /// Baked occlusion of indirect light: `1 + strength × (texture − 1)`; factor is the strength.
    pub occlusion: Option<ScalarInput>,
    /// No scattering: the base colour is what is seen (KHR_materials_unlit).
    pub unlit: bool,
    /// The camera sees a hole in the picture instead, black and of alpha 0; all other rays see the surface.
    pub holdout: bool,
}

impl Default for MaterialDesc {
    /// glTF's default material, but for roughness and metallic, which are what most doors mean by
    /// "no material": a white, rough dielectric.
    fn default() -> Self {
        Self {
            name: "default".into(),
            place: Place::default(),
            material_index: 0,
            graph: Graph::default(),
            base_color: ColorInput::constant([0.8; 3]),
            alpha: ScalarInput::constant(1.0),
            alpha_mode: AlphaMode::Opaque,
            double_sided: true,
            metallic: ScalarInput::constant(0.0),
            roughness: ScalarInput::constant(0.5),
            ior: 1.5,
            specular: ScalarInput::constant(1.0),
            specular_color: ColorInput::constant([1.0; 3]),
            transmission: ScalarInput::constant(0.0),
            volume: None,
            dispersion: 0.0,
            coat: None,
            sheen: None,
            iridescence: None,
            anisotropy: None,
            emission: ColorInput::constant([0.0; 3]),
            emission_strength: 1.0,
            normal: None,
            occlusion: None,
            unlit: false,
            holdout: false,
        }
    }
}

impl MaterialDesc {
    /// Every texture that its inputs look up by themselves, in no order; those of the graph come on top.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        let thickness = self.iridescence.as_ref().and_then(|i| i.thickness_texture.map(|(texture, _)| texture));
        let anisotropy = self.anisotropy.as_ref().and_then(|a| a.texture);
        self.inputs().filter_map(|(texture, _)| texture).chain(thickness).chain(anisotropy)
    }

    /// Every value of the graph that an input names, in no order.
    pub fn graph_values(&self) -> impl Iterator<Item = ValueId> {
        self.inputs().filter_map(|(_, value)| value)
    }

    /// What varies each input, in no order: a texture, a value of the graph.
    fn inputs(&self) -> impl Iterator<Item = (Option<TextureRef>, Option<ValueId>)> {
        let color = |input: &ColorInput| (input.texture, input.graph);
        let scalar = |input: &ScalarInput| (input.texture.map(|(texture, _)| texture), input.graph);
        let normal = |input: NormalInput| (input.texture(), input.value());
        [
            Some(color(&self.base_color)),
            Some(scalar(&self.alpha)),
            Some(scalar(&self.metallic)),
            Some(scalar(&self.roughness)),
            Some(scalar(&self.specular)),
            Some(color(&self.specular_color)),
            Some(scalar(&self.transmission)),
            self.volume.as_ref().map(|v| scalar(&v.thickness)),
            self.coat.as_ref().map(|c| scalar(&c.weight)),
            self.coat.as_ref().map(|c| scalar(&c.roughness)),
            self.coat.as_ref().and_then(|c| c.normal).map(normal),
            self.sheen.as_ref().map(|s| color(&s.color)),
            self.sheen.as_ref().map(|s| scalar(&s.roughness)),
            self.iridescence.as_ref().map(|i| scalar(&i.weight)),
            Some(color(&self.emission)),
            self.normal.map(normal),
            self.occlusion.as_ref().map(scalar),
        ]
        .into_iter()
        .flatten()
    }
}
