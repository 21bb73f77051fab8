//! What scatters where shader nodes are mixed: lobes by the name of their nodes, each with its weight.

use super::input::{Varying, of_color, of_normal, of_scalar};
use super::{
    AnisotropyDesc, ColorInput, IridescenceDesc, MaterialDesc, NormalInput, ScalarInput, SheenDesc, SubsurfaceDesc,
};

/// One term of a mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct PartDesc {
    /// Its share.
    pub weight: ScalarInput,
    /// Its own shading normal; `None` for the material's.
    pub normal: Option<NormalInput>,
    /// What it is.
    pub closure: ClosureDesc,
}

/// Microfacets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetsDesc {
    /// Perceptual roughness.
    pub roughness: ScalarInput,
    /// Wider along one direction.
    pub anisotropy: Option<AnisotropyDesc>,
    /// True where light that scatters between them is not lost.
    pub multiscatter: bool,
}

/// A lobe, or all layers.
#[derive(Clone, Debug, PartialEq)]
pub enum ClosureDesc {
    /// The layered surface of a material; of it only what scatters counts, its graph is that of the whole.
    Layered(Box<MaterialDesc>),
    /// Diffuse reflection.
    Diffuse {
        /// Albedo.
        color: ColorInput,
        /// 0 for Lambert's law.
        roughness: ScalarInput,
        /// True where light that scatters more than once at a rough surface is not lost.
        multiscatter: bool,
    },
    /// Scattering beneath the surface.
    Beneath {
        /// What is there.
        subsurface: SubsurfaceDesc,
        /// Width of the microfacets through which light goes in, 0 to 1.
        alpha: ScalarInput,
    },
    /// Diffuse passage.
    Translucent {
        /// Albedo.
        color: ColorInput,
    },
    /// Reflection of one color from everywhere.
    Glossy {
        /// The color.
        color: ColorInput,
        /// Its microfacets.
        facets: FacetsDesc,
    },
    /// Reflection at metal by two reflectances.
    Metal {
        /// At normal incidence.
        base: ColorInput,
        /// At 82 degrees, over that of Schlick's curve.
        edge: ColorInput,
        /// Its microfacets.
        facets: FacetsDesc,
        /// A thin film on it.
        film: Option<IridescenceDesc>,
    },
    /// Reflection at metal by its index of refraction n + ik.
    Conductor {
        /// n.
        eta: ColorInput,
        /// k.
        k: ColorInput,
        /// Its microfacets.
        facets: FacetsDesc,
        /// A thin film on it.
        film: Option<IridescenceDesc>,
    },
    /// Reflection and refraction.
    Glass {
        /// Color of both.
        color: ColorInput,
        /// Index of refraction.
        ior: ScalarInput,
        /// Its microfacets.
        facets: FacetsDesc,
        /// A thin film on it.
        film: Option<IridescenceDesc>,
    },
    /// Refraction alone.
    Refraction {
        /// The color.
        color: ColorInput,
        /// Index of refraction.
        ior: ScalarInput,
        /// Its microfacets.
        facets: FacetsDesc,
    },
    /// Fibers.
    Sheen(SheenDesc),
    /// Light within a cone.
    Toon {
        /// The color.
        color: ColorInput,
        /// Up to which angle it is full, as a share of a right angle.
        size: ScalarInput,
        /// Width of its edge, as a share of a right angle.
        smooth: ScalarInput,
        /// About the mirror direction instead of the normal.
        glossy: bool,
    },
}

impl PartDesc {
    /// What varies each input, in no order.
    pub(super) fn inputs(&self) -> Vec<Varying> {
        let mut all = self.closure.inputs();
        all.push(of_scalar(&self.weight));
        all.extend(self.normal.map(of_normal));
        all
    }
}

impl FacetsDesc {
    fn inputs(&self) -> Vec<Varying> {
        let mut all = vec![of_scalar(&self.roughness)];
        if let Some(a) = &self.anisotropy {
            all.extend([of_scalar(&a.strength), of_scalar(&a.rotation), (a.texture, a.tangent)]);
        }
        all
    }
}

impl ClosureDesc {
    /// True where light from the other side of the surface passes.
    pub fn transmits(&self) -> bool {
        match self {
            Self::Layered(layers) => layers.transmission.factor > 0.0 || layers.translucent.is_some(),
            Self::Translucent { .. } | Self::Glass { .. } | Self::Refraction { .. } => true,
            _ => false,
        }
    }

    fn inputs(&self) -> Vec<Varying> {
        let film = |film: &Option<IridescenceDesc>| {
            film.map(|f| [of_scalar(&f.weight), of_scalar(&f.ior), of_scalar(&f.thickness)])
        };
        let mut all = Vec::new();
        match self {
            Self::Layered(layers) => all.extend(layers.layers().into_iter().flatten()),
            Self::Diffuse { color, roughness, .. } => all.extend([of_color(color), of_scalar(roughness)]),
            Self::Beneath { subsurface, alpha } => {
                all.extend(subsurface.inputs());
                all.push(of_scalar(alpha));
            }
            Self::Translucent { color } => all.push(of_color(color)),
            Self::Glossy { color, facets } => {
                all.push(of_color(color));
                all.extend(facets.inputs());
            }
            Self::Metal { base: a, edge: b, facets, film: of } | Self::Conductor { eta: a, k: b, facets, film: of } => {
                all.extend([of_color(a), of_color(b)]);
                all.extend(facets.inputs());
                all.extend(film(of).into_iter().flatten());
            }
            Self::Glass { color, ior, facets, film: of } => {
                all.extend([of_color(color), of_scalar(ior)]);
                all.extend(facets.inputs());
                all.extend(film(of).into_iter().flatten());
            }
            Self::Refraction { color, ior, facets } => {
                all.extend([of_color(color), of_scalar(ior)]);
                all.extend(facets.inputs());
            }
            Self::Sheen(sheen) => all.extend([of_color(&sheen.color), of_scalar(&sheen.roughness)]),
            Self::Toon { color, size, smooth, .. } => {
                all.extend([of_color(color), of_scalar(size), of_scalar(smooth)]);
            }
        }
        all
    }
}
