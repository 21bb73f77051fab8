//! The quantities a film can accumulate: what passes are developed from.
//!
//! A pass is not a sum but a function of sums (a ratio of two, say), so film and passes are kept apart:
//! the film adds up the quantities that the chosen passes name, each once, and nothing else.

use super::sample::{GroupSample, PixelSample};
use crate::math::{Rgb, Vec3};

/// One vector-valued sum over the samples of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
#[allow(missing_docs)] // Each is the field of its name of `PixelSample`, or of `GroupSample`, per group.
pub enum Quantity {
    Combined,
    DiffuseDirect,
    DiffuseIndirect,
    DiffuseColor,
    GlossyDirect,
    GlossyIndirect,
    GlossyColor,
    TransmissionDirect,
    TransmissionIndirect,
    TransmissionColor,
    Emission,
    Environment,
    Ao,
    Unshadowed,
    IrradianceShadowed,
    IrradianceUnshadowed,
    GroupCombined,
    GroupLit,
    GroupUnshadowed,
    GroupIrradianceShadowed,
    GroupIrradianceUnshadowed,
    CatcherLit,
    CatcherUnshadowed,
    CatcherShare,
    Behind,
    Normal,
    Uv,
    Mist,
    Vector,
    VectorShare,
    DenoisingNormal,
    DenoisingAlbedo,
    DenoisingDepth,
    /// [`CryptoSample::object`](super::CryptoSample::object), kept as a list of ids.
    CryptoObject,
    /// [`CryptoSample::material`](super::CryptoSample::material), kept as a list of ids.
    CryptoMaterial,
    /// [`CryptoSample::asset`](super::CryptoSample::asset), kept as a list of ids.
    CryptoAsset,
    /// The [`FirstHit`](super::FirstHit), overwritten, never added.
    FirstHit,
    /// What the scene's AOVs are, each with numbers of its own.
    Aov,
}

impl Quantity {
    /// All of them, in the order of the film's memory.
    pub const ALL: [Self; 38] = [
        Self::Combined,
        Self::DiffuseDirect,
        Self::DiffuseIndirect,
        Self::DiffuseColor,
        Self::GlossyDirect,
        Self::GlossyIndirect,
        Self::GlossyColor,
        Self::TransmissionDirect,
        Self::TransmissionIndirect,
        Self::TransmissionColor,
        Self::Emission,
        Self::Environment,
        Self::Ao,
        Self::Unshadowed,
        Self::IrradianceShadowed,
        Self::IrradianceUnshadowed,
        Self::GroupCombined,
        Self::GroupLit,
        Self::GroupUnshadowed,
        Self::GroupIrradianceShadowed,
        Self::GroupIrradianceUnshadowed,
        Self::CatcherLit,
        Self::CatcherUnshadowed,
        Self::CatcherShare,
        Self::Behind,
        Self::Normal,
        Self::Uv,
        Self::Mist,
        Self::Vector,
        Self::VectorShare,
        Self::DenoisingNormal,
        Self::DenoisingAlbedo,
        Self::DenoisingDepth,
        Self::CryptoObject,
        Self::CryptoMaterial,
        Self::CryptoAsset,
        Self::FirstHit,
        Self::Aov,
    ];

    /// True where the film keeps it for each light group, not once.
    pub const fn is_of_group(self) -> bool {
        matches!(
            self,
            Self::GroupCombined
                | Self::GroupLit
                | Self::GroupUnshadowed
                | Self::GroupIrradianceShadowed
                | Self::GroupIrradianceUnshadowed
        )
    }

    /// How many numbers the film adds up for it, for one group; 0 for those that are kept in another way.
    pub const fn width(self) -> usize {
        match self {
            Self::Combined | Self::Behind | Self::Vector => 4,
            Self::DenoisingDepth | Self::CatcherShare | Self::Mist | Self::VectorShare => 1,
            Self::CryptoObject | Self::CryptoMaterial | Self::CryptoAsset | Self::FirstHit | Self::Aov => 0,
            _ => 3,
        }
    }

    /// The values of a light group, for a quantity that groups have.
    pub(super) fn read_group(self, s: &GroupSample) -> Rgb {
        match self {
            Self::GroupCombined => s.combined,
            Self::GroupLit => s.lit,
            Self::GroupUnshadowed => s.unshadowed,
            Self::GroupIrradianceShadowed => s.irradiance_shadowed,
            Self::GroupIrradianceUnshadowed => s.irradiance_unshadowed,
            _ => Rgb::BLACK,
        }
    }

    /// The first `width` numbers are the sample's values.
    pub(super) fn read(self, s: &PixelSample) -> [f32; 4] {
        match self {
            Self::Combined => [s.combined.r, s.combined.g, s.combined.b, s.alpha],
            Self::DiffuseDirect => color(s.direct.diffuse),
            Self::DiffuseIndirect => color(s.indirect.diffuse),
            Self::DiffuseColor => color(s.color.diffuse),
            Self::GlossyDirect => color(s.direct.glossy),
            Self::GlossyIndirect => color(s.indirect.glossy),
            Self::GlossyColor => color(s.color.glossy),
            Self::TransmissionDirect => color(s.direct.transmission),
            Self::TransmissionIndirect => color(s.indirect.transmission),
            Self::TransmissionColor => color(s.color.transmission),
            Self::Emission => color(s.emission),
            Self::Environment => color(s.environment),
            Self::Ao => color(s.ao),
            Self::Unshadowed => color(s.unshadowed),
            Self::IrradianceShadowed => color(s.irradiance_shadowed),
            Self::IrradianceUnshadowed => color(s.irradiance_unshadowed),
            Self::CatcherLit => color(s.catcher.lit),
            Self::CatcherUnshadowed => color(s.catcher.unshadowed),
            Self::CatcherShare => [s.catcher.share, 0.0, 0.0, 0.0],
            Self::Behind => {
                let Rgb { r, g, b } = s.catcher.behind;
                [r, g, b, s.catcher.alpha]
            }
            Self::Normal => vector(s.normal),
            Self::Uv => [s.uv[0], s.uv[1], s.uv[2], 0.0],
            Self::Mist => [s.mist, 0.0, 0.0, 0.0],
            Self::Vector => s.vector,
            Self::VectorShare => [s.vector_share, 0.0, 0.0, 0.0],
            Self::DenoisingNormal => vector(s.denoising_normal),
            Self::DenoisingAlbedo => color(s.denoising_albedo),
            Self::DenoisingDepth => [s.denoising_depth, 0.0, 0.0, 0.0],
            _ => [0.0; 4],
        }
    }
}

fn color(c: Rgb) -> [f32; 4] {
    [c.r, c.g, c.b, 0.0]
}

fn vector(v: Vec3) -> [f32; 4] {
    [v.x, v.y, v.z, 0.0]
}

/// A set of quantities.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Quantities(u64);

impl Quantities {
    /// With `q` in it.
    pub const fn with(self, q: Quantity) -> Self {
        Self(self.0 | 1 << q as u64)
    }

    /// True where `q` is in it.
    pub const fn contains(self, q: Quantity) -> bool {
        self.0 & (1 << q as u64) != 0
    }

    /// Those of it that groups have (`true`), or that they do not have.
    pub(super) fn of_groups(self, of_groups: bool) -> Self {
        self.iter().filter(|q| q.is_of_group() == of_groups).fold(Self::default(), Self::with)
    }

    /// Its members, in the order of [`Quantity::ALL`].
    pub fn iter(self) -> impl Iterator<Item = Quantity> {
        let mut rest = self.0;
        std::iter::from_fn(move || {
            let next = Quantity::ALL.get(rest.trailing_zeros() as usize).copied();
            rest &= rest.wrapping_sub(1);
            next
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_lists_every_quantity_once_at_its_own_index() {
        for (i, q) in Quantity::ALL.into_iter().enumerate() {
            assert_eq!(q as usize, i);
        }
        assert_eq!(Quantity::ALL.len(), Quantity::Aov as usize + 1);
    }

    #[test]
    fn sets_give_their_members_in_order() {
        use Quantity::*;
        let set = Quantities::default().with(FirstHit).with(Ao).with(Combined);
        assert_eq!(set.iter().collect::<Vec<_>>(), [Combined, Ao, FirstHit]);
        assert_eq!(Quantities::default().iter().count(), 0);
        let all = Quantity::ALL.into_iter().fold(Quantities::default(), Quantities::with);
        assert_eq!(all.iter().collect::<Vec<_>>(), Quantity::ALL);
    }
}
