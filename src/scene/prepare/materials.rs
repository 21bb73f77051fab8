//! Materials with their constants folded, and the textures that are left.

use crate::desc::{self, AlphaMode, Channel, MaterialDesc, SceneDesc, TextureRef};
use crate::error::Warnings;
use crate::math::Rgb;
use crate::scene::Material;
use crate::scene::effects;
use crate::scene::material::{ColorInput, NormalInput, Opacity, ScalarInput, TextureInput};
use crate::settings::Settings;
use crate::texture::{Texture, UvTransform};

/// Materials as in `desc`, with the default one added at the end, and every texture of `desc` that
/// one of them looks up.
pub fn prepare(desc: &SceneDesc, settings: &Settings, warnings: &mut Warnings) -> (Vec<Material>, Vec<Texture>) {
    let mut used = vec![false; desc.materials.len()];
    for &material in desc.instances.iter().flat_map(|i| i.materials.iter().flatten()) {
        used[material as usize] = true;
    }
    let mut builder = Builder { desc, settings, textures: Textures::new(desc) };
    let fallback = MaterialDesc::default();
    let materials = desc.materials.iter().zip(&used).map(|(material, used)| (material, *used));
    let materials = materials
        .chain([(&fallback, true)])
        // A material that nothing uses keeps its index, and none of its textures.
        .map(|(material, used)| builder.material(if used { material } else { &fallback }, warnings))
        .collect();
    (materials, builder.textures.finish(warnings))
}

/// Textures of the scene, made when the first material asks.
struct Textures<'a> {
    desc: &'a SceneDesc,
    /// New index of each texture that is used.
    index: Vec<Option<u32>>,
    list: Vec<u32>,
    constant: Vec<Option<Option<[f32; 4]>>>,
}

impl<'a> Textures<'a> {
    fn new(desc: &'a SceneDesc) -> Self {
        Self { desc, index: vec![None; desc.textures.len()], list: Vec::new(), constant: vec![None; desc.images.len()] }
    }

    /// The one value of a texture whose texels are all the same.
    fn constant(&mut self, texture: u32) -> Option<[f32; 4]> {
        let image = self.desc.textures[texture as usize].image as usize;
        *self.constant[image].get_or_insert_with(|| crate::texture::constant_value(&self.desc.images[image]))
    }

    fn input(&mut self, texture: &TextureRef) -> TextureInput {
        let index = self.index[texture.texture as usize].get_or_insert_with(|| {
            self.list.push(texture.texture);
            self.list.len() as u32 - 1
        });
        TextureInput { texture: *index, uv_set: texture.uv_set, transform: UvTransform::new(&texture.transform) }
    }

    fn finish(self, warnings: &mut Warnings) -> Vec<Texture> {
        Texture::prepare_all(self.desc, &self.list, warnings)
    }
}

struct Builder<'a> {
    desc: &'a SceneDesc,
    settings: &'a Settings,
    textures: Textures<'a>,
}

impl Builder<'_> {
    fn input(&mut self, inputs: &mut Vec<TextureInput>, texture: &TextureRef) -> u8 {
        let input = self.textures.input(texture);
        let index = inputs.iter().position(|known| *known == input).unwrap_or_else(|| {
            inputs.push(input);
            inputs.len() - 1
        });
        index as u8
    }

    fn color(&mut self, inputs: &mut Vec<TextureInput>, input: &desc::ColorInput) -> ColorInput {
        let factor = Rgb::from(input.factor);
        let Some(texture) = input.texture.filter(|_| !factor.is_black()) else {
            return ColorInput { factor, texture: None };
        };
        match self.textures.constant(texture.texture) {
            Some([r, g, b, _]) => ColorInput { factor: factor * Rgb::new(r, g, b), texture: None },
            None => ColorInput { factor, texture: Some(self.input(inputs, &texture)) },
        }
    }

    fn scalar(&mut self, inputs: &mut Vec<TextureInput>, input: &desc::ScalarInput) -> ScalarInput {
        let factor = input.factor as f32;
        let Some((texture, channel)) = input.texture.filter(|_| factor != 0.0) else {
            return ScalarInput { factor, texture: None };
        };
        let channel = match channel {
            Channel::R => 0_u8,
            Channel::G => 1,
            Channel::B => 2,
            Channel::A => 3,
        };
        match self.textures.constant(texture.texture) {
            Some(texel) => ScalarInput { factor: factor * texel[usize::from(channel)], texture: None },
            None => ScalarInput { factor, texture: Some((self.input(inputs, &texture), channel)) },
        }
    }

    fn material(&mut self, desc: &MaterialDesc, warnings: &mut Warnings) -> Material {
        warn_of_effects_to_come(desc, warnings);
        let mut inputs = Vec::new();
        let strength = desc.emission_strength;
        let emission = desc::ColorInput { factor: desc.emission.factor.map(|c| c * strength), ..desc.emission };
        let volume = desc.volume.filter(|v| v.thickness.factor > 0.0);
        let opaque = effects::is_opaque(self.desc, desc);
        Material {
            base_color: self.color(&mut inputs, &desc.base_color),
            alpha: self.scalar(&mut inputs, &desc.alpha),
            opacity: match desc.alpha_mode {
                _ if opaque => Opacity::Opaque,
                AlphaMode::Opaque => Opacity::Opaque,
                AlphaMode::Mask { cutoff } => Opacity::Mask(cutoff as f32),
                AlphaMode::Blend => Opacity::Blend,
            },
            metallic: self.scalar(&mut inputs, &desc.metallic),
            roughness: self.scalar(&mut inputs, &desc.roughness),
            ior: if desc.ior.is_finite() && desc.ior > 0.0 { desc.ior as f32 } else { 1.5 },
            specular: self.scalar(&mut inputs, &desc.specular),
            specular_color: self.color(&mut inputs, &desc.specular_color),
            transmission: self.scalar(&mut inputs, &desc.transmission),
            thin: volume.is_none(),
            absorption: volume.map_or(Rgb::BLACK, |v| absorption(&v)),
            emission: self.color(&mut inputs, &emission),
            unlit: desc.unlit,
            normal: desc
                .normal
                .filter(|n| n.scale != 0.0)
                .map(|n| NormalInput { input: self.textures.input(&n.texture), scale: n.scale as f32 }),
            occlusion: desc
                .occlusion
                .filter(|o| self.settings.occlusion_maps && o.factor != 0.0 && o.texture.is_some())
                .map(|o| self.scalar(&mut inputs, &o)),
            inputs,
        }
    }
}

/// `σ = −ln(color) / distance`, KHR_materials_volume.
fn absorption(volume: &desc::VolumeDesc) -> Rgb {
    let distance = volume.attenuation_distance;
    if !(distance.is_finite() && distance > 0.0) {
        return Rgb::BLACK;
    }
    Rgb::from(volume.attenuation_color.map(|c| -c.clamp(1e-6, 1.0).ln() / distance))
}

/// One warning for what a material asks and the engine doesn't compute yet.
fn warn_of_effects_to_come(desc: &MaterialDesc, warnings: &mut Warnings) {
    let missing: Vec<&str> = [
        ("clear coat", desc.coat.as_ref().is_some_and(|c| c.weight.factor > 0.0)),
        ("sheen", desc.sheen.as_ref().is_some_and(|s| s.color.factor.iter().any(|&c| c > 0.0))),
        ("iridescence", desc.iridescence.as_ref().is_some_and(|i| i.weight.factor > 0.0)),
        ("anisotropy", desc.anisotropy.is_some_and(|a| a.strength != 0.0)),
        ("dispersion", desc.dispersion > 0.0),
    ]
    .into_iter()
    .filter_map(|(name, there)| there.then_some(name))
    .collect();
    if !missing.is_empty() {
        let what =
            format!("material \"{}\" is rendered without its {}: not computed yet", desc.name, missing.join(", "));
        warnings.push(&desc.place, what);
    }
}
