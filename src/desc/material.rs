//! Materials as authored: one layered surface that every door maps to.
//!
//! The layers and their meaning are those of glTF 2.0's metallic-roughness model with its KHR
//! extensions (Appendix B of the specification).

use std::sync::Arc;

use super::graph::{Graph, ValueId};
use super::input::{Varying, of_color, of_normal, of_scalar};
use super::{
    AnisotropyDesc, AovOutput, CoatDesc, ColorInput, IridescenceDesc, NormalInput, PartDesc, ScalarInput, SheenDesc,
    SubsurfaceDesc, TextureRef, TranslucentDesc, VolumeDesc,
};
use crate::error::Place;

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
    /// True where what is not physical counts as it is (Cycles): base colors above 1, for the diffuse part of a
    /// dielectric, and emission below 0. Else both are cut.
    pub unbounded: bool,
    /// True where `normal` is that of the surface itself, as if it were built so: normals of parts bend from it.
    pub relief: bool,
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
    /// True where the colours of the shape, or where it has none that of the instance, multiply `base_color` and `alpha`.
    pub tinted: bool,
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
            unbounded: false,
            relief: false,
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
            tinted: true,
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
