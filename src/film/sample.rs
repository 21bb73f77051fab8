//! What one camera path brings back to the film, and what one extra ray through the pixel's centre does.

use super::pass_set::PassSet;
use crate::math::{Rgb, Vec3};

/// A quantity split by the lobe that the path took at its first surface, as Cycles' light passes are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Split {
    /// Diffuse reflection (sheen and subsurface count here).
    pub diffuse: Rgb,
    /// Glossy and mirror reflection.
    pub glossy: Rgb,
    /// Transmission through the surface, refracted.
    pub transmission: Rgb,
}

impl std::ops::AddAssign for Split {
    fn add_assign(&mut self, other: Self) {
        self.diffuse += other.diffuse;
        self.glossy += other.glossy;
        self.transmission += other.transmission;
    }
}

/// Cryptomatte identifiers of what a camera path saw, each a hash as float bits; see
/// [`id_from_name`](super::cryptomatte::id_from_name). An id of 0 is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CryptoSample {
    /// Of the object (instance) name.
    pub object: f32,
    /// Of the material name.
    pub material: f32,
    /// Of the name of the asset: the topmost parent.
    pub asset: f32,
    /// How much of the sample it covers, 0 (background) to 1 (opaque).
    pub coverage: f32,
}

/// Light of one light group in a sample. All but `combined` are for a ratio alone, and estimated by
/// samples of the group's lights alone, so that a dim group is known as well as a bright one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroupSample {
    /// Part of `combined` that the group's lights brought.
    pub combined: Rgb,
    /// An estimate of their part of `direct.diffuse`.
    pub lit: Rgb,
    /// The same with nothing in the way.
    pub unshadowed: Rgb,
    /// As `irradiance_shadowed` of the whole sample.
    pub irradiance_shadowed: Rgb,
    /// As `irradiance_unshadowed` of the whole sample.
    pub irradiance_unshadowed: Rgb,
}

/// What a shadow catcher that the camera path met makes of what lies behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CatcherSample {
    /// How much of the sample it covers.
    pub share: f32,
    /// Direct irradiance that arrives at it.
    pub lit: Rgb,
    /// The same with no other object in the way.
    pub unshadowed: Rgb,
    /// Radiance of what lies behind it, premultiplied by `alpha`; no part of `combined`.
    pub behind: Rgb,
    /// Alpha of that; no part of the sample's.
    pub alpha: f32,
}

/// What one camera path gives. Radiances are scene-linear Rec.709 and carry everything up to the eye;
/// fields whose pass is not asked for stay 0 and are not read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PixelSample {
    /// Radiance towards the camera, premultiplied by `alpha`.
    pub combined: Rgb,
    /// 1 where a surface was met, 0 where the background shows through.
    pub alpha: f32,
    /// Light that met one surface between emitter and camera; contribution, color included.
    pub direct: Split,
    /// Light that met more than one; contribution, color included.
    pub indirect: Split,
    /// Albedo of each lobe class at the first surface, times coverage.
    pub color: Split,
    /// Emission of surfaces and lights seen by the camera.
    pub emission: Rgb,
    /// Radiance of the world seen by the camera.
    pub environment: Rgb,
    /// Cosine-weighted openness at the first surface times coverage; 0 for the background.
    pub ao: Rgb,
    /// `direct.diffuse` as it would be with nothing in the way of the light, color included.
    pub unshadowed: Rgb,
    /// Direct irradiance over π without the albedo, shadowed; for surfaces that have no diffuse albedo.
    pub irradiance_shadowed: Rgb,
    /// The same with nothing in the way.
    pub irradiance_unshadowed: Rgb,
    /// Shading normal of the first surface in world space towards the viewer, times coverage; 0 for the background.
    pub normal: Vec3,
    /// Texture coordinates times coverage; the third is the coverage where the surface has UVs, else 0.
    pub uv: [f32; 3],
    /// How much of the picture is clear of mist: 1 less the mist at each surface, times what the surface covers.
    pub mist: f32,
    /// How far the first surface moves in the picture, right and up in pixels: where it was a frame before less where
    /// it is, and where it is less where it will be a frame after.
    pub vector: [f32; 4],
    /// 1 where `vector` is known.
    pub vector_share: f32,
    /// A shadow catcher in front.
    pub catcher: CatcherSample,
    /// Normal for a denoiser, in camera space.
    pub denoising_normal: Vec3,
    /// Albedo for a denoiser; for emitters their emission.
    pub denoising_albedo: Rgb,
    /// Depth for a denoiser.
    pub denoising_depth: f32,
    /// What was seen, by name.
    pub crypto: CryptoSample,
    /// Light by group, in the order of [`PassSet::groups`](super::PassSet::groups); empty, without
    /// allocation, where no pass asks for groups.
    pub groups: Box<[GroupSample]>,
    /// Numbers of the AOVs, one after the other in the order of [`PassSet::aovs`](super::PassSet::aovs); empty,
    /// without allocation, where no pass asks for one.
    pub aovs: Box<[f32]>,
}

impl PixelSample {
    /// Multiplies all radiance by `factor`; what is a share, a color or geometry stays.
    pub fn expose(&mut self, factor: f32) {
        for split in [&mut self.direct, &mut self.indirect] {
            for color in [&mut split.diffuse, &mut split.glossy, &mut split.transmission] {
                *color *= factor;
            }
        }
        let once = [
            &mut self.combined,
            &mut self.emission,
            &mut self.environment,
            &mut self.unshadowed,
            &mut self.irradiance_shadowed,
            &mut self.irradiance_unshadowed,
            &mut self.catcher.lit,
            &mut self.catcher.unshadowed,
            &mut self.catcher.behind,
        ];
        for color in once {
            *color *= factor;
        }
        for group in &mut self.groups {
            let GroupSample { combined, lit, unshadowed, irradiance_shadowed, irradiance_unshadowed } = group;
            for color in [combined, lit, unshadowed, irradiance_shadowed, irradiance_unshadowed] {
                *color *= factor;
            }
        }
    }

    /// A sample that brings nothing, with room for the light groups and AOVs of `passes`.
    pub fn of(passes: &PassSet) -> Self {
        let groups = vec![GroupSample::default(); passes.groups().len()].into();
        Self { groups, aovs: vec![0.0; passes.aov_numbers()].into(), ..Self::default() }
    }
}

/// What the ray through the pixel's centre meets first: passes that must not be averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Distance along the camera's axis, in scene units.
    pub depth: f32,
    /// Point in world space.
    pub position: Vec3,
    /// Pass index of the object.
    pub object_index: f32,
    /// Pass index of the material.
    pub material_index: f32,
}

impl FirstHit {
    /// Nothing met: Cycles' background values.
    pub const BACKGROUND: Self = Self { depth: 1e10, position: Vec3::ZERO, object_index: 0.0, material_index: 0.0 };
}

impl Default for FirstHit {
    fn default() -> Self {
        Self::BACKGROUND
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_is_a_factor_of_radiance_alone() {
        let one = Split { diffuse: Rgb::WHITE, glossy: Rgb::WHITE, transmission: Rgb::WHITE };
        let white = Rgb::WHITE;
        let mut sample = PixelSample {
            combined: white,
            alpha: 1.0,
            direct: one,
            indirect: one,
            color: one,
            emission: white,
            environment: white,
            ao: white,
            unshadowed: white,
            irradiance_shadowed: white,
            irradiance_unshadowed: white,
            denoising_albedo: white,
            denoising_depth: 1.0,
            aovs: [1.0].into(),
            ..PixelSample::default()
        };
        let group = GroupSample {
            combined: white,
            lit: white,
            unshadowed: white,
            irradiance_shadowed: white,
            irradiance_unshadowed: white,
        };
        sample.groups = [group].into();
        let before = sample.clone();
        sample.expose(4.0);
        let four = Rgb::splat(4.0);
        for color in [sample.combined, sample.emission, sample.environment, sample.unshadowed, sample.direct.glossy] {
            assert_eq!(color, four);
        }
        assert_eq!((sample.groups[0].lit, sample.indirect.transmission), (four, four));
        assert_eq!((sample.color, sample.ao, sample.alpha), (before.color, before.ao, 1.0));
        assert_eq!((sample.denoising_albedo, sample.denoising_depth), (white, 1.0));
        assert_eq!(*sample.aovs, [1.0]);
    }
}
