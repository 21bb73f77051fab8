//! Layers of a surface that a material may have.

use super::graph::ValueId;
use super::{ColorInput, NormalInput, ScalarInput, TextureRef};

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
    /// False where metal has none (Blender's Principled BSDF before 5.0).
    pub on_metal: bool,
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
    /// Of MaterialX's `roughness_anisotropy`: α over and times `√(1 − strength)`, wider along the direction; strengths
    /// count up to 0.98.
    RoughnessAnisotropy,
    /// Of OpenPBR: `α √(2 / (1 + (1 − strength)²))` along the direction, `1 − strength` times that across.
    OpenPbr,
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
