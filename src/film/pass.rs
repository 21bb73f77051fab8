//! PASSES: every pass of a picture, one row each; the film, the EXR file, the command line and the docs follow from it.
//!
//! Names and channels are those that Blender 5.0 writes. Light passes are contributions divided by
//! accumulated color, so that
//! `Combined = Σ Color × (Direct + Indirect) + Emission + Environment` (Cycles' convention), and
//! `Diffuse Direct = Shadow × Diffuse Direct Unshadowed`.

use std::fmt::{self, Write};

use super::cryptomatte::CryptoKind;
use super::quantity::{Quantities, Quantity};
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
    /// Where each quantity begins in `sums`.
    pub(super) offsets: &'a [u8; Quantity::ALL.len()],
    /// Samples taken in.
    pub(super) count: u32,
    /// From the extra ray.
    pub(super) first_hit: FirstHit,
}

impl Means<'_> {
    /// Mean of `q`; 0 where there is no sample yet. `q` must be among the pass's needs.
    fn of(&self, q: Quantity) -> [f64; 4] {
        let mut mean = [0.0; 4];
        if self.count > 0 {
            let start = usize::from(self.offsets[q as usize]);
            for (mean, sum) in mean.iter_mut().zip(&self.sums[start..start + q.width()]) {
                *mean = sum / f64::from(self.count);
            }
        }
        mean
    }

    /// Mean of `a` over the mean of `b` per channel; 0 where `b` is 0.
    fn ratio(&self, a: Quantity, b: Quantity) -> [f64; 4] {
        let (a, b) = (self.of(a), self.of(b));
        std::array::from_fn(|i| if b[i] == 0.0 { 0.0 } else { a[i] / b[i] })
    }

    /// S = mean of the shadowed / mean of the unshadowed light, from the first pair that has light, else 1.
    fn shadow(&self) -> [f64; 4] {
        let (lit, all) = (self.of(Quantity::DiffuseDirect), self.of(Quantity::Unshadowed));
        let (lit_bare, all_bare) = (self.of(Quantity::IrradianceShadowed), self.of(Quantity::IrradianceUnshadowed));
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
#[derive(Clone, Copy)]
pub(super) enum Develop {
    /// Per pixel, the first `channels` of four numbers.
    Pixel(fn(&Means<'_>) -> [f64; 4]),
    /// Ranked ids and coverages, two to a layer.
    Cryptomatte(CryptoKind),
}

/// A row of [`PASSES`].
pub struct Pass {
    /// Name for `--passes`.
    pub name: &'static str,
    /// Name of the layer, as Blender 5.0 writes it.
    pub layer: &'static str,
    /// One letter per channel.
    pub channels: &'static str,
    /// What a file may do to it.
    pub storage: Storage,
    /// What the film has to accumulate.
    pub needs: &'static [Quantity],
    pub(super) develop: Develop,
    /// One line for `--help` and the docs.
    pub help: &'static str,
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

const fn crypto(name: &'static str, kind: CryptoKind, needs: &'static [Quantity], help: &'static str) -> Pass {
    let develop = Develop::Cryptomatte(kind);
    Pass { name, layer: kind.layer(), channels: "rgba", storage: Storage::Data, needs, develop, help }
}

use Quantity as Q;
use Storage::{Color, Data};

/// The passes, in the order in which a file holds them.
#[rustfmt::skip]
pub static PASSES: &[Pass] = &[
    pixel("combined", "Combined", "RGBA", Color, &[Q::Combined], |m| m.of(Q::Combined),
        "radiance, premultiplied by alpha"),
    pixel("depth", "Depth", "Z", Data, &[Q::FirstHit], |m| [f64::from(m.first_hit.depth), 0.0, 0.0, 0.0],
        "distance along the camera's axis at the pixel's centre; background 1e10"),
    pixel("position", "Position", "XYZ", Data, &[Q::FirstHit], |m| vector(m.first_hit.position.to_array()),
        "point in world space at the pixel's centre; background 0"),
    pixel("normal", "Normal", "XYZ", Data, &[Q::Normal], |m| m.of(Q::Normal),
        "shading normal in world space towards the viewer, averaged with coverage, not renormalised"),
    pixel("uv", "UV", "UVA", Data, &[Q::Uv], |m| m.of(Q::Uv),
        "texture coordinates times coverage; A is the coverage of surfaces that have them"),
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
    pixel("emission", "Emission", "RGB", Color, &[Q::Emission], |m| m.of(Q::Emission),
        "emission of what the camera sees"),
    pixel("environment", "Environment", "RGB", Color, &[Q::Environment], |m| m.of(Q::Environment),
        "radiance of the world where the camera sees it"),
    pixel("ao", "Ambient Occlusion", "RGB", Color, &[Q::Ao], |m| m.of(Q::Ao),
        "cosine-weighted openness times coverage: 1 open, 0 closed; background 0"),
    pixel("shadow", "Shadow", "RGB", Color,
        &[Q::DiffuseDirect, Q::Unshadowed, Q::IrradianceShadowed, Q::IrradianceUnshadowed], |m| m.shadow(),
        "share of the direct light that arrives: 1 lit, 0 in full shadow; 1 where no light could reach"),
    pixel("unshadowed", "Diffuse Direct Unshadowed", "RGB", Color, &[Q::Unshadowed, Q::DiffuseColor],
        |m| m.ratio(Q::Unshadowed, Q::DiffuseColor),
        "Diffuse Direct with nothing in the way: Diffuse Direct = Shadow x this"),
    pixel("sample_count", "Debug Sample Count", "X", Data, &[], |m| [f64::from(m.count), 0.0, 0.0, 0.0],
        "samples in the pixel"),
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

/// The passes of one render, and through them what has to be accumulated and computed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSet {
    chosen: Vec<bool>,
    quantities: Quantities,
}

impl fmt::Display for PassSet {
    /// As [`PassSet::parse`] takes it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<&str> = self.iter().map(|pass| pass.name).collect();
        f.write_str(&names.join(","))
    }
}

impl Default for PassSet {
    /// Combined alone.
    fn default() -> Self {
        Self::parse("combined").unwrap_or_else(|_| Self::all())
    }
}

impl PassSet {
    /// Every pass there is.
    pub fn all() -> Self {
        Self::from_rows(vec![true; PASSES.len()])
    }

    /// A comma-separated list of names, or `all`. An empty list is Combined alone.
    ///
    /// # Errors
    /// A message that names the unknown pass and those there are.
    pub fn parse(list: &str) -> Result<Self, String> {
        let mut rows = vec![false; PASSES.len()];
        for name in list.split(',').map(str::trim).filter(|name| !name.is_empty()) {
            if name.eq_ignore_ascii_case("all") {
                return Ok(Self::all());
            }
            match PASSES.iter().position(|pass| pass.name.eq_ignore_ascii_case(name)) {
                Some(row) => rows[row] = true,
                None => return Err(unknown(name)),
            }
        }
        rows[0] |= !rows.contains(&true);
        Ok(Self::from_rows(rows))
    }

    fn from_rows(chosen: Vec<bool>) -> Self {
        let needs = PASSES.iter().zip(&chosen).filter(|(_, chosen)| **chosen).flat_map(|(pass, _)| pass.needs);
        let quantities = needs.fold(Quantities::default(), |set, &q| set.with(q));
        Self { chosen, quantities }
    }

    /// The chosen passes, in the order of [`PASSES`].
    pub fn iter(&self) -> impl Iterator<Item = &'static Pass> {
        PASSES.iter().zip(&self.chosen).filter_map(|(pass, &chosen)| chosen.then_some(pass))
    }

    /// Names of the light groups whose sums are kept, in the order of their indices.
    pub fn groups(&self) -> &[std::sync::Arc<str>] {
        &[]
    }

    /// What the film accumulates.
    pub fn quantities(&self) -> Quantities {
        self.quantities
    }

    /// True where some pass needs `q`.
    pub fn needs(&self, q: Quantity) -> bool {
        self.quantities.contains(q)
    }

    fn needs_any(&self, list: &[Quantity]) -> bool {
        list.iter().any(|&q| self.needs(q))
    }

    /// Ambient-occlusion rays are called for.
    pub fn needs_ao(&self) -> bool {
        self.needs(Q::Ao)
    }

    /// Direct light has to be kept with and without its shadows.
    pub fn needs_shadow(&self) -> bool {
        self.needs_any(&[Q::Unshadowed, Q::IrradianceUnshadowed])
    }

    /// The albedo-free pair of irradiances has to be computed too, for surfaces without diffuse albedo.
    pub fn needs_irradiance(&self) -> bool {
        self.needs(Q::IrradianceUnshadowed)
    }

    /// An extra ray through the pixel's centre is called for.
    pub fn needs_first_hit(&self) -> bool {
        self.needs(Q::FirstHit)
    }

    /// Light has to be split by lobe class.
    pub fn needs_split(&self) -> bool {
        use Q::*;
        self.needs_any(&[DiffuseDirect, DiffuseIndirect, GlossyDirect, GlossyIndirect])
            || self.needs_any(&[TransmissionDirect, TransmissionIndirect])
    }

    /// The albedo of the first surface is called for, by lobe class.
    pub fn needs_color(&self) -> bool {
        self.needs_any(&[Q::DiffuseColor, Q::GlossyColor, Q::TransmissionColor])
    }

    /// Paths beyond the first surface are called for.
    pub fn needs_indirect(&self) -> bool {
        self.needs_any(&[Q::Combined, Q::DiffuseIndirect, Q::GlossyIndirect, Q::TransmissionIndirect])
    }

    /// Light arriving at surfaces is called for at all; without it no light needs to be sampled.
    pub fn needs_light(&self) -> bool {
        self.needs_indirect() || self.needs_split() || self.needs_shadow()
    }

    /// Names have to be hashed and ids kept.
    pub fn needs_cryptomatte(&self) -> bool {
        self.needs_any(&[Q::CryptoObject, Q::CryptoMaterial, Q::CryptoAsset])
    }

    /// Normal, albedo or depth for a denoiser are called for.
    pub fn needs_denoising(&self) -> bool {
        self.needs_any(&[Q::DenoisingNormal, Q::DenoisingAlbedo, Q::DenoisingDepth])
    }
}

fn unknown(name: &str) -> String {
    let mut message = format!("there is no pass '{name}'; there are: all");
    for pass in PASSES {
        let _ = write!(message, ", {}", pass.name);
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_layers_are_unique_and_rows_are_complete() {
        for (i, a) in PASSES.iter().enumerate() {
            assert!(!a.help.is_empty() && (1..=4).contains(&a.channels.len()), "{}", a.name);
            assert!(a.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{}", a.name);
            for b in &PASSES[i + 1..] {
                assert!(a.name != b.name && a.layer != b.layer, "{} and {}", a.name, b.name);
            }
        }
        assert_eq!(PASSES[0].name, "combined");
    }

    #[test]
    fn lists_are_parsed() {
        let names =
            |list: &str| -> Vec<&str> { PassSet::parse(list).expect("known").iter().map(|pass| pass.name).collect() };
        assert_eq!(names(""), ["combined"]);
        assert_eq!(names(" AO , combined,ao"), ["combined", "ao"]);
        assert_eq!(names("shadow"), ["shadow"]);
        assert_eq!(names("ao,all").len(), PASSES.len());
        assert_eq!(PassSet::default(), PassSet::parse("combined").expect("known"));
    }

    #[test]
    fn an_unknown_pass_is_told_with_the_known() {
        let message = PassSet::parse("ao,shadows").expect_err("unknown");
        assert!(message.contains("'shadows'") && message.contains("shadow,") && message.contains("crypto_asset"));
    }

    #[test]
    fn absent_passes_are_absent_work() {
        let set = |list| PassSet::parse(list).expect("known");
        let combined = set("combined");
        assert!(combined.needs_light() && combined.needs_indirect());
        assert!(!combined.needs_ao() && !combined.needs_shadow() && !combined.needs_first_hit());
        assert!(!combined.needs_split() && !combined.needs_color() && !combined.needs_cryptomatte());
        let ao = set("ao,depth");
        assert!(ao.needs_ao() && ao.needs_first_hit() && !ao.needs_light());
        let shadow = set("shadow");
        assert!(shadow.needs_shadow() && shadow.needs_irradiance() && !shadow.needs_indirect());
        assert!(!set("unshadowed").needs_irradiance());
    }
}
