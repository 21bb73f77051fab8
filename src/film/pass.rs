//! PASSES: every pass of a picture, one row each; the film, the EXR file, the command line and the docs follow from it.
//!
//! Names and channels are those that Blender 5.0 writes. Light passes are contributions divided by
//! accumulated color, so that
//! `Combined = Σ Color × (Direct + Indirect) + Emission + Environment` (Cycles' convention), and
//! `Diffuse Direct = Shadow × Diffuse Direct Unshadowed`. Rows named `…_<group>` are templates: one
//! pass for each light group that a [`PassSet`](super::PassSet) was resolved with; the row of `…<name>` is that of
//! the scene's AOVs.

use super::cryptomatte::CryptoKind;
use super::quantity::Quantity;
use super::sample::FirstHit;

/// How a pass may be stored in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Storage {
    /// Scene-linear color; half floats are enough where the user asks for them.
    Color,
    /// Positions, normals, ids: float, always.
    Data,
}

/// The sums of one pixel over its samples, as a pass sees them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means<'a> {
    /// Sum of weight × value per number of the film's layout.
    pub(super) sums: &'a [f64],
    /// Where each quantity begins in `sums`, for a row of groups those of its group.
    pub(super) offsets: &'a [u32; Quantity::ALL.len()],
    /// Sums of the AOV, for the row of AOVs.
    pub(super) aov: &'a [f64],
    /// Samples taken in.
    pub(super) count: u32,
    /// From the extra ray.
    pub(super) first_hit: FirstHit,
    /// True where shadow catchers are summed up.
    pub(super) has_catchers: bool,
}

impl Means<'_> {
    /// Mean of `q`; 0 where there is no sample yet. `q` must be among the pass's needs.
    fn of(&self, q: Quantity) -> [f64; 4] {
        let mut mean = [0.0; 4];
        if self.count > 0 {
            let start = self.offsets[q as usize] as usize;
            for (mean, sum) in mean.iter_mut().zip(&self.sums[start..start + q.width()]) {
                *mean = sum / f64::from(self.count);
            }
        }
        mean
    }

    /// Mean of the AOV.
    fn aov(&self) -> [f64; 4] {
        let mut mean = [0.0; 4];
        if self.count > 0 {
            for (mean, sum) in mean.iter_mut().zip(self.aov) {
                *mean = sum / f64::from(self.count);
            }
        }
        mean
    }

    /// Combined, with what lies behind shadow catchers darkened by the shadows on them and covered by as much.
    pub(super) fn combined(&self) -> [f64; 4] {
        let mut combined = self.of(Q::Combined);
        if self.has_catchers {
            let s = self.of_catchers();
            let (behind, share, mean) = (self.of(Q::Behind), self.of(Q::CatcherShare)[0], (s[0] + s[1] + s[2]) / 3.0);
            for i in 0..3 {
                combined[i] += s[i] * behind[i];
            }
            combined[3] += (1.0 - mean) * share + mean * behind[3];
        }
        combined
    }

    /// What shadow catchers leave of the light on them.
    fn of_catchers(&self) -> [f64; 3] {
        let (lit, all) = (self.of(Q::CatcherLit), self.of(Q::CatcherUnshadowed));
        std::array::from_fn(|i| if all[i] == 0.0 { 1.0 } else { (lit[i] / all[i]).min(1.0) })
    }

    /// The same laid over white by all that the picture covers, catchers included, as Cycles does it: what is
    /// transparent beside a catcher is left as it is.
    fn shadow_catcher(&self) -> [f64; 4] {
        let alpha = (self.of(Q::Combined)[3] + self.of(Q::CatcherShare)[0]).clamp(0.0, 1.0);
        let [r, g, b] = self.of_catchers().map(|s| 1.0 - alpha * (1.0 - s));
        [r, g, b, 0.0]
    }

    /// Mean of `q` over that of `share`; 0 where nothing has one.
    fn of_share(&self, q: Quantity, share: Quantity) -> [f64; 4] {
        let share = self.of(share)[0];
        self.of(q).map(|value| if share == 0.0 { 0.0 } else { value / share })
    }

    /// Mean of `a` over the mean of `b` per channel; 0 where `b` is 0.
    fn ratio(&self, a: Quantity, b: Quantity) -> [f64; 4] {
        let (a, b) = (self.of(a), self.of(b));
        std::array::from_fn(|i| if b[i] == 0.0 { 0.0 } else { a[i] / b[i] })
    }

    /// Sum of the means.
    fn sum<const N: usize>(&self, all: [Quantity; N]) -> [f64; 4] {
        all.into_iter().map(|q| self.of(q)).fold([0.0; 4], |sum, mean| std::array::from_fn(|i| sum[i] + mean[i]))
    }

    /// The shadow of all lights.
    fn whole_shadow(&self) -> [f64; 4] {
        self.shadow([[Q::DiffuseDirect, Q::Unshadowed], [Q::IrradianceShadowed, Q::IrradianceUnshadowed]])
    }

    /// S = mean of the shadowed / mean of the unshadowed light, from the first pair that has light, else 1.
    fn shadow(&self, pairs: [[Quantity; 2]; 2]) -> [f64; 4] {
        let [[lit, all], [lit_bare, all_bare]] = pairs.map(|pair| pair.map(|q| self.of(q)));
        std::array::from_fn(|i| {
            if all[i] != 0.0 {
                lit[i] / all[i]
            } else if all_bare[i] != 0.0 {
                lit_bare[i] / all_bare[i]
            } else {
                1.0
            }
        })
    }
}

/// How a pass comes out of the sums.
#[derive(Clone, Copy, Debug)]
pub(super) enum Develop {
    /// Per pixel, the first `channels` of four numbers.
    Pixel(fn(&Means<'_>) -> [f64; 4]),
    /// The estimated standard error of such numbers.
    Error(fn(&Means<'_>) -> [f64; 4]),
    /// Whether the error of Combined can be believed.
    Trust,
    /// Ranked ids and coverages, two to a layer.
    Cryptomatte(CryptoKind),
}

/// A row of [`PASSES`].
#[derive(Debug)]
pub struct Pass {
    /// Name for `--passes`; that of a row of groups ends in [`GROUP`], that of the row of AOVs in [`AOV`].
    pub name: &'static str,
    /// Name of the layer, as Blender 5.0 writes it, with the same ending.
    pub layer: &'static str,
    /// One letter per channel; of the row of AOVs those of colors.
    pub channels: &'static str,
    /// What a file may do to it.
    pub storage: Storage,
    /// What the film has to accumulate.
    pub needs: &'static [Quantity],
    pub(super) develop: Develop,
    /// One line for `--help` and the docs.
    pub help: &'static str,
}

/// Stands for a light group's name in the rows that there is one pass per group of.
pub(super) const GROUP: &str = "<group>";

/// Stands for an AOV's name in the row of them.
pub(super) const AOV: &str = "<name>";

impl Pass {
    /// The name up to that of a light group or AOV; `None` where there is one such pass, whatever the scene.
    pub fn prefix(&self) -> Option<&'static str> {
        self.name.strip_suffix(GROUP).or_else(|| self.name.strip_suffix(AOV))
    }

    /// True for the standard error of another pass, and what there is to say about it: samples are dealt in another
    /// way where one is asked for.
    pub const fn is_error(&self) -> bool {
        matches!(self.develop, Develop::Error(_) | Develop::Trust)
    }

    /// True for the row of AOVs.
    pub fn is_of_aovs(&self) -> bool {
        self.name.ends_with(AOV)
    }
}

const fn pixel(
    name: &'static str,
    layer: &'static str,
    channels: &'static str,
    storage: Storage,
    needs: &'static [Quantity],
    develop: fn(&Means<'_>) -> [f64; 4],
    help: &'static str,
) -> Pass {
    Pass { name, layer, channels, storage, needs, develop: Develop::Pixel(develop), help }
}

const fn error(
    name: &'static str,
    layer: &'static str,
    needs: &'static [Quantity],
    develop: fn(&Means<'_>) -> [f64; 4],
    help: &'static str,
) -> Pass {
    Pass { name, layer, channels: "RGB", storage: Storage::Data, needs, develop: Develop::Error(develop), help }
}

const fn crypto(name: &'static str, kind: CryptoKind, needs: &'static [Quantity], help: &'static str) -> Pass {
    let develop = Develop::Cryptomatte(kind);
    Pass { name, layer: kind.layer(), channels: "rgba", storage: Storage::Data, needs, develop, help }
}

use Quantity as Q;
use Storage::{Color, Data};

/// What the shadow pass is made of.
const SHADOW: &[Quantity] = &[Q::DiffuseDirect, Q::Unshadowed, Q::IrradianceShadowed, Q::IrradianceUnshadowed];

/// What the shadow catcher pass is made of, and Combined with catchers.
const CATCHER: &[Quantity] = &[Q::Combined, Q::CatcherLit, Q::CatcherUnshadowed, Q::CatcherShare, Q::Behind];

/// The passes, in the order in which a file holds them.
#[rustfmt::skip]
pub static PASSES: &[Pass] = &[
    pixel("combined", "Combined", "RGBA", Color, &[Q::Combined], |m| m.combined(),
        "radiance, premultiplied by alpha"),
    pixel("depth", "Depth", "Z", Data, &[Q::FirstHit], |m| [f64::from(m.first_hit.depth), 0.0, 0.0, 0.0],
        "distance along the camera's axis at the pixel's centre; background 1e10"),
    pixel("mist", "Mist", "Z", Data, &[Q::Mist], |m| [(1.0 - m.of(Q::Mist)[0]).clamp(0.0, 1.0), 0.0, 0.0, 0.0],
        "how far away, 0 at the start of the mist to 1 at its end, averaged with coverage; background 1"),
    pixel("position", "Position", "XYZ", Data, &[Q::FirstHit], |m| vector(m.first_hit.position.to_array()),
        "point in world space at the pixel's centre; background 0"),
    pixel("normal", "Normal", "XYZ", Data, &[Q::Normal], |m| m.of(Q::Normal),
        "shading normal in world space towards the viewer, averaged with coverage, not renormalised"),
    pixel("uv", "UV", "UVA", Data, &[Q::Uv], |m| m.of(Q::Uv),
        "texture coordinates times coverage; A is the coverage of surfaces that have them"),
    pixel("vector", "Vector", "XYZW", Data, &[Q::Vector, Q::VectorShare], |m| m.of_share(Q::Vector, Q::VectorShare),
        "motion in pixels, right and up: from here to the frame before (X, Y), from the frame after to here (Z, W); background 0"),
    pixel("object_index", "Object Index", "X", Data, &[Q::FirstHit], |m| [f64::from(m.first_hit.object_index), 0.0, 0.0, 0.0],
        "pass index of the object at the pixel's centre; background 0"),
    pixel("material_index", "Material Index", "X", Data, &[Q::FirstHit], |m| [f64::from(m.first_hit.material_index), 0.0, 0.0, 0.0],
        "pass index of the material at the pixel's centre; background 0"),
    pixel("diffuse_direct", "Diffuse Direct", "RGB", Color, &[Q::DiffuseDirect, Q::DiffuseColor],
        |m| m.ratio(Q::DiffuseDirect, Q::DiffuseColor),
        "direct light by diffuse reflection, divided by the color: irradiance / pi"),
    pixel("diffuse_indirect", "Diffuse Indirect", "RGB", Color, &[Q::DiffuseIndirect, Q::DiffuseColor],
        |m| m.ratio(Q::DiffuseIndirect, Q::DiffuseColor),
        "bounced light by diffuse reflection, divided by the color"),
    pixel("diffuse_color", "Diffuse Color", "RGB", Color, &[Q::DiffuseColor], |m| m.of(Q::DiffuseColor),
        "diffuse albedo times coverage"),
    pixel("glossy_direct", "Glossy Direct", "RGB", Color, &[Q::GlossyDirect, Q::GlossyColor],
        |m| m.ratio(Q::GlossyDirect, Q::GlossyColor),
        "direct light by glossy reflection, divided by the color"),
    pixel("glossy_indirect", "Glossy Indirect", "RGB", Color, &[Q::GlossyIndirect, Q::GlossyColor],
        |m| m.ratio(Q::GlossyIndirect, Q::GlossyColor),
        "bounced light by glossy reflection, divided by the color"),
    pixel("glossy_color", "Glossy Color", "RGB", Color, &[Q::GlossyColor], |m| m.of(Q::GlossyColor),
        "glossy albedo times coverage"),
    pixel("transmission_direct", "Transmission Direct", "RGB", Color, &[Q::TransmissionDirect, Q::TransmissionColor],
        |m| m.ratio(Q::TransmissionDirect, Q::TransmissionColor),
        "direct light through the surface, divided by the color"),
    pixel("transmission_indirect", "Transmission Indirect", "RGB", Color, &[Q::TransmissionIndirect, Q::TransmissionColor],
        |m| m.ratio(Q::TransmissionIndirect, Q::TransmissionColor),
        "bounced light through the surface, divided by the color"),
    pixel("transmission_color", "Transmission Color", "RGB", Color, &[Q::TransmissionColor], |m| m.of(Q::TransmissionColor),
        "transmission albedo times coverage"),
    pixel("diffuse_light", "Diffuse Light", "RGB", Color, &[Q::DiffuseDirect, Q::DiffuseIndirect],
        |m| m.sum([Q::DiffuseDirect, Q::DiffuseIndirect]),
        "all light by diffuse reflection, with the color: what it adds to Combined"),
    pixel("diffuse_light_direct", "Diffuse Light Direct", "RGB", Color, &[Q::DiffuseDirect], |m| m.of(Q::DiffuseDirect),
        "the part of it that is direct light: Diffuse Color x Diffuse Direct"),
    pixel("diffuse_light_indirect", "Diffuse Light Indirect", "RGB", Color, &[Q::DiffuseIndirect], |m| m.of(Q::DiffuseIndirect),
        "the part of it that is bounced light: Diffuse Color x Diffuse Indirect"),
    pixel("glossy_light", "Glossy Light", "RGB", Color, &[Q::GlossyDirect, Q::GlossyIndirect],
        |m| m.sum([Q::GlossyDirect, Q::GlossyIndirect]),
        "all light by glossy reflection, with the color: what it adds to Combined"),
    pixel("glossy_light_direct", "Glossy Light Direct", "RGB", Color, &[Q::GlossyDirect], |m| m.of(Q::GlossyDirect),
        "the part of it that is direct light: Glossy Color x Glossy Direct"),
    pixel("glossy_light_indirect", "Glossy Light Indirect", "RGB", Color, &[Q::GlossyIndirect], |m| m.of(Q::GlossyIndirect),
        "the part of it that is bounced light: Glossy Color x Glossy Indirect"),
    pixel("transmission_light", "Transmission Light", "RGB", Color, &[Q::TransmissionDirect, Q::TransmissionIndirect],
        |m| m.sum([Q::TransmissionDirect, Q::TransmissionIndirect]),
        "all light through the surface, with the color: what it adds to Combined"),
    pixel("transmission_light_direct", "Transmission Light Direct", "RGB", Color, &[Q::TransmissionDirect], |m| m.of(Q::TransmissionDirect),
        "the part of it that is direct light: Transmission Color x Transmission Direct"),
    pixel("transmission_light_indirect", "Transmission Light Indirect", "RGB", Color, &[Q::TransmissionIndirect], |m| m.of(Q::TransmissionIndirect),
        "the part of it that is bounced light: Transmission Color x Transmission Indirect"),
    pixel("emission", "Emission", "RGB", Color, &[Q::Emission], |m| m.of(Q::Emission),
        "emission of what the camera sees"),
    pixel("environment", "Environment", "RGB", Color, &[Q::Environment], |m| m.of(Q::Environment),
        "radiance of the world where the camera sees it"),
    pixel("ao", "Ambient Occlusion", "RGB", Color, &[Q::Ao], |m| m.of(Q::Ao),
        "cosine-weighted openness times coverage: 1 open, 0 closed; background 0"),
    pixel("shadow", "Shadow", "RGB", Color, SHADOW, |m| m.whole_shadow(),
        "share of the direct light that arrives: 1 lit, 0 in full shadow; 1 where no light could reach"),
    pixel("unshadowed", "Diffuse Direct Unshadowed", "RGB", Color, &[Q::Unshadowed, Q::DiffuseColor],
        |m| m.ratio(Q::Unshadowed, Q::DiffuseColor),
        "Diffuse Direct with nothing in the way: Diffuse Direct = Shadow x this"),
    pixel("shadow_catcher", "Shadow Catcher", "RGB", Color, CATCHER, |m| m.shadow_catcher(),
        "what shadow catchers leave of the light on them, to multiply a picture by; 1 beside them"),
    pixel("combined_<group>", "Combined_<group>", "RGB", Color, &[Q::GroupCombined], |m| m.of(Q::GroupCombined),
        "part of Combined that the lights of a light group brought; the groups sum to Combined where every light is in one"),
    pixel("shadow_<group>", "Shadow_<group>", "RGB", Color,
        &[Q::GroupLit, Q::GroupUnshadowed, Q::GroupIrradianceShadowed, Q::GroupIrradianceUnshadowed],
        |m| m.shadow([[Q::GroupLit, Q::GroupUnshadowed], [Q::GroupIrradianceShadowed, Q::GroupIrradianceUnshadowed]]),
        "Shadow of the lights of a light group alone"),
    pixel("sample_count", "Debug Sample Count", "X", Data, &[], |m| [f64::from(m.count), 0.0, 0.0, 0.0],
        "samples in the pixel"),
    error("error", "Error", &[Q::Combined], |m| m.combined(),
        "estimated standard error of Combined; 0 below 16 samples"),
    error("error_ao", "Error Ambient Occlusion", &[Q::Ao], |m| m.of(Q::Ao),
        "the same of the ao pass"),
    error("error_shadow", "Error Shadow", SHADOW, |m| m.whole_shadow(),
        "the same of the shadow pass"),
    Pass { name: "error_trust", layer: "Error Trust", channels: "X", storage: Data, needs: &[Q::Combined], develop: Develop::Trust,
        help: "1 where the error of Combined is to be believed, 0 where it hangs on a few samples" },
    pixel("aov:<name>", "<name>", "RGBA", Data, &[Q::Aov], |m| m.aov(),
        "what the AOV Output nodes of that name give; X alone for numbers"),
    crypto("crypto_object", CryptoKind::Object, &[Q::CryptoObject], "Cryptomatte of objects"),
    crypto("crypto_material", CryptoKind::Material, &[Q::CryptoMaterial], "Cryptomatte of materials"),
    crypto("crypto_asset", CryptoKind::Asset, &[Q::CryptoAsset], "Cryptomatte of assets (topmost parents)"),
    pixel("denoising_normal", "Denoising Normal", "XYZ", Data, &[Q::DenoisingNormal], |m| m.of(Q::DenoisingNormal),
        "normal for a denoiser, camera space"),
    pixel("denoising_albedo", "Denoising Albedo", "RGB", Color, &[Q::DenoisingAlbedo], |m| m.of(Q::DenoisingAlbedo),
        "albedo for a denoiser"),
    pixel("denoising_depth", "Denoising Depth", "Z", Data, &[Q::DenoisingDepth], |m| m.of(Q::DenoisingDepth),
        "depth for a denoiser"),
];

fn vector([x, y, z]: [f32; 3]) -> [f64; 4] {
    [f64::from(x), f64::from(y), f64::from(z), 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_layers_are_unique_and_rows_are_complete() {
        for (i, a) in PASSES.iter().enumerate() {
            assert!(!a.help.is_empty() && (1..=4).contains(&a.channels.len()), "{}", a.name);
            let stem = a.prefix().unwrap_or(a.name);
            assert!(stem.chars().all(|c| c.is_ascii_lowercase() || "_:".contains(c)), "{}", a.name);
            assert_eq!(a.layer.ends_with(GROUP), a.name.ends_with(GROUP), "{}", a.name);
            assert_eq!(a.layer.ends_with(AOV), a.is_of_aovs(), "{}", a.name);
            assert!(a.needs.iter().all(|q| q.is_of_group() == a.name.ends_with(GROUP)), "{}", a.name);
            for b in &PASSES[i + 1..] {
                assert!(a.name != b.name && a.layer != b.layer, "{} and {}", a.name, b.name);
            }
        }
        assert_eq!(PASSES[0].name, "combined");
    }
}
