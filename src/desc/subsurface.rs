//! Light that scatters beneath a surface, as authored.

use super::input::{Varying, of_color, of_scalar};
use super::{ColorInput, ScalarInput};

/// What the radius means, and how light goes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubsurfaceMethod {
    /// Blender's *Random Walk*: 4π times the mean free path.
    RandomWalk,
    /// Blender's *Random Walk (Skin)*: the mean free path also goes by the color.
    RandomWalkSkin,
    /// The mean free path itself (MaterialX, OpenPBR).
    FreePath,
    /// Blender's *Christensen-Burley*: 4π times the length of a profile.
    Burley,
}

/// Light that is scattered in the inside of an object and leaves it elsewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubsurfaceDesc {
    /// Share of the diffuse light, 0 to 1.
    pub weight: ScalarInput,
    /// What a large solid reflects diffusely.
    pub color: ColorInput,
    /// How far light goes inside, per channel, metres.
    pub radius: ColorInput,
    /// Mean cosine of scattering.
    pub anisotropy: ScalarInput,
    /// Index of refraction by which light goes in; of a layered surface's `RandomWalk` that surface's counts.
    pub ior: ScalarInput,
    /// What the radius means.
    pub method: SubsurfaceMethod,
    /// True where it counts as a diffuse surface of its color once light has been scattered diffusely on its way to the
    /// eye.
    pub shallow: bool,
}

impl SubsurfaceDesc {
    /// What varies each input, in no order.
    pub(super) fn inputs(&self) -> [Varying; 5] {
        let Self { weight, color, radius, anisotropy, ior, .. } = self;
        [of_scalar(weight), of_color(color), of_color(radius), of_scalar(anisotropy), of_scalar(ior)]
    }
}
