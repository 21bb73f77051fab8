//! Materials as authored: one layered surface that every door maps to.
//!
//! The layers and their meaning are those of glTF 2.0's metallic-roughness model with its KHR
//! extensions (Appendix B of the specification).

use std::sync::Arc;

use super::graph::{Graph, ValueId};
use super::{AovOutput, PartDesc, SubsurfaceDesc, TextureRef};
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

/// KHR_materials_volume: the inside of a surface that light gets into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeDesc {
    /// Thickness beneath the surface; 0 makes the surface thin-walled. In metres, object space.
    pub thickness: ScalarInput,
    /// Distance after which white light has `attenuation_color`; infinite for none.
    pub attenuation_distance: f64,
    /// Colour that white light has there.
    pub attenuation_color: [f64; 3],
    /// True where it is there beside what the object lies in (Blender's volumes) instead of in its place.
    pub adds: bool,
}

/// KHR_materials_clearcoat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatDesc {
    /// Weight, 0 to 1.
    pub weight: ScalarInput,
    /// Perceptual roughness.
    pub roughness: ScalarInput,
    /// Index of refraction; glTF fixes it at 1.5.
    pub ior: ScalarInput,
    /// What is left of light that goes straight down and up through it; white for a clear one.
    pub tint: ColorInput,
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
    pub ior: ScalarInput,
    /// Thickness in nanometres where `thickness` is 0.
    pub thickness_min: f64,
    /// Thickness in nanometres where `thickness` is 1.
    pub thickness_max: f64,
    /// Where between the two.
    pub thickness: ScalarInput,
}

/// How strength widens microfacets of width α.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnisotropyLaw {
    /// Of KHR_materials_anisotropy: to `α + (1 − α) strength²` along the direction.
    Gltf,
    /// Of Blender's Principled and Metallic BSDF: α over and times `√(1 − 0.9 strength)`, wider along the direction.
    Aspect,
    /// Of Blender's Glossy BSDF: α times and over `1 − strength`, narrower along the direction; of a strength below
    /// 0 the other way round.
    Glossy,
}

/// Microfacets that are wider along one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnisotropyDesc {
    /// Strength, 0 to 1.
    pub strength: ScalarInput,
    /// Direction in tangent space, radians counter-clockwise from the tangent.
    pub rotation: ScalarInput,
    /// Direction in red and green, strength in blue.
    pub texture: Option<TextureRef>,
    /// The tangent in world space, a value of the material's graph; `None` for that of the first UV set.
    pub tangent: Option<ValueId>,
    /// What strength means.
    pub law: AnisotropyLaw,
}

/// Diffuse light that leaves on the other side (KHR_materials_diffuse_transmission).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslucentDesc {
    /// Share of the diffuse light, 0 to 1.
    pub weight: ScalarInput,
    /// Albedo.
    pub color: ColorInput,
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
    /// Share that passes unscattered on top of all that the surface does, per channel; not subject to `alpha_mode`
    /// (Blender's Transparent BSDF). Black for none.
    pub transparency: ColorInput,
    /// What scatters in place of the layers below, where it is not empty.
    pub parts: Vec<PartDesc>,
    /// 0 dielectric, 1 metal.
    pub metallic: ScalarInput,
    /// What a metal reflects at 82 degrees, over what it would by Schlick's curve; white for that.
    pub metal_edge: ColorInput,
    /// Roughness of the diffuse part, 0 for Lambert's law.
    pub diffuse_roughness: ScalarInput,
    /// Perceptual roughness; the microfacet width is its square.
    pub roughness: ScalarInput,
    /// True where light that scatters between microfacets is not lost.
    pub multiscatter: bool,
    /// Index of refraction; 0 stands for an infinite one.
    pub ior: ScalarInput,
    /// Weight of the dielectric's reflection (KHR_materials_specular).
    pub specular: ScalarInput,
    /// Tint of the dielectric's reflection at normal incidence.
    pub specular_color: ColorInput,
    /// Factor of the opaque dielectric's reflectance at normal incidence that changes its index with it.
    pub specular_level: ScalarInput,
    /// Share of what enters the dielectric that is refracted instead of scattered.
    pub transmission: ScalarInput,
    /// The inside; `None` for thin-walled.
    pub volume: Option<VolumeDesc>,
    /// 20 / Abbe number; 0 for none (KHR_materials_dispersion).
    pub dispersion: f64,
    /// Light that scatters beneath the surface, in place of diffuse light.
    pub subsurface: Option<SubsurfaceDesc>,
    /// Diffuse light to the other side.
    pub translucent: Option<TranslucentDesc>,
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
    /// True where diffuse light fades towards the smooth surface whose normal a map bends (Blender's *Bump Map
    /// Correction*).
    pub bump_correction: bool,
    /// Baked occlusion of indirect light: `1 + strength × (texture − 1)`; factor is the strength.
    pub occlusion: Option<ScalarInput>,
    /// No scattering: the base colour is what is seen (KHR_materials_unlit).
    pub unlit: bool,
    /// The camera sees a hole in the picture instead, black and of alpha 0; all other rays see the surface.
    pub holdout: bool,
    /// What it gives as AOVs, each name once; see [`RenderDesc::aovs`](super::RenderDesc::aovs).
    pub aovs: Vec<AovOutput>,
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
            transparency: ColorInput::constant([0.0; 3]),
            parts: Vec::new(),
            metallic: ScalarInput::constant(0.0),
            metal_edge: ColorInput::constant([1.0; 3]),
            diffuse_roughness: ScalarInput::constant(0.0),
            roughness: ScalarInput::constant(0.5),
            multiscatter: true,
            ior: ScalarInput::constant(1.5),
            specular: ScalarInput::constant(1.0),
            specular_color: ColorInput::constant([1.0; 3]),
            specular_level: ScalarInput::constant(1.0),
            transmission: ScalarInput::constant(0.0),
            volume: None,
            dispersion: 0.0,
            subsurface: None,
            translucent: None,
            coat: None,
            sheen: None,
            iridescence: None,
            anisotropy: None,
            emission: ColorInput::constant([0.0; 3]),
            emission_strength: 1.0,
            normal: None,
            bump_correction: true,
            occlusion: None,
            unlit: false,
            holdout: false,
            aovs: Vec::new(),
        }
    }
}

impl MaterialDesc {
    /// Every texture that its inputs look up by themselves, in no order; those of the graph come on top.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        self.inputs().into_iter().filter_map(|(texture, _)| texture)
    }

    /// Every value of the graph that an input names, in no order.
    pub fn graph_values(&self) -> impl Iterator<Item = ValueId> {
        self.inputs().into_iter().filter_map(|(_, value)| value)
    }

    /// What varies each input, in no order: a texture, a value of the graph.
    fn inputs(&self) -> Vec<Varying> {
        let mut all: Vec<Varying> = self.layers().into_iter().flatten().collect();
        all.extend([of_color(&self.emission), of_scalar(&self.alpha), of_color(&self.transparency)]);
        all.extend(self.occlusion.as_ref().map(of_scalar));
        all.extend(self.normal.map(of_normal));
        all.extend(self.parts.iter().flat_map(PartDesc::inputs));
        all.extend(self.aovs.iter().flat_map(|aov| [of_color(&aov.color), of_scalar(&aov.value)]));
        all
    }

    /// Inputs of what scatters.
    pub(super) fn layers(&self) -> [Option<Varying>; 32] {
        let Self { coat, sheen, iridescence, anisotropy, translucent, .. } = self;
        let beneath = self.subsurface.map(|subsurface| subsurface.inputs());
        let beneath = |i: usize| beneath.map(|inputs| inputs[i]);
        [
            Some(of_color(&self.base_color)),
            Some(of_scalar(&self.metallic)),
            Some(of_color(&self.metal_edge)),
            Some(of_scalar(&self.diffuse_roughness)),
            Some(of_scalar(&self.roughness)),
            Some(of_scalar(&self.ior)),
            Some(of_scalar(&self.specular)),
            Some(of_color(&self.specular_color)),
            Some(of_scalar(&self.specular_level)),
            Some(of_scalar(&self.transmission)),
            self.volume.as_ref().map(|v| of_scalar(&v.thickness)),
            beneath(0),
            beneath(1),
            beneath(2),
            beneath(3),
            beneath(4),
            translucent.as_ref().map(|t| of_scalar(&t.weight)),
            translucent.as_ref().map(|t| of_color(&t.color)),
            coat.as_ref().map(|c| of_scalar(&c.weight)),
            coat.as_ref().map(|c| of_scalar(&c.roughness)),
            coat.as_ref().map(|c| of_scalar(&c.ior)),
            coat.as_ref().map(|c| of_color(&c.tint)),
            coat.as_ref().and_then(|c| c.normal).map(of_normal),
            sheen.as_ref().map(|s| of_color(&s.color)),
            sheen.as_ref().map(|s| of_scalar(&s.roughness)),
            iridescence.as_ref().map(|i| of_scalar(&i.weight)),
            iridescence.as_ref().map(|i| of_scalar(&i.ior)),
            iridescence.as_ref().map(|i| of_scalar(&i.thickness)),
            anisotropy.as_ref().map(|a| of_scalar(&a.strength)),
            anisotropy.as_ref().map(|a| of_scalar(&a.rotation)),
            anisotropy.as_ref().map(|a| (a.texture, None)),
            anisotropy.as_ref().map(|a| (None, a.tangent)),
        ]
    }
}

/// What varies an input: a texture, a value of the graph.
pub(super) type Varying = (Option<TextureRef>, Option<ValueId>);

pub(super) fn of_color(input: &ColorInput) -> Varying {
    (input.texture, input.graph)
}

pub(super) fn of_scalar(input: &ScalarInput) -> Varying {
    (input.texture.map(|(texture, _)| texture), input.graph)
}

pub(super) fn of_normal(input: NormalInput) -> Varying {
    (input.texture(), input.value())
}
