//! Materials with their constants folded, and the textures that are left.

use std::sync::Arc;

use rayon::prelude::*;

use super::mend::Mended;
use crate::desc::{self, AlphaMode, Channel, ImageDesc, MaterialDesc, PixelData, SceneDesc};
use crate::error::Warnings;
use crate::math::Rgb;
use crate::scene::Material;
use crate::scene::effects;
use crate::scene::material::{ColorInput, NormalInput, Opacity, ScalarInput};
use crate::settings::Settings;
use crate::texture::{Image, Texture, TextureRef};

/// Materials as in `desc`, with the default one added at the end, and every texture of `desc` that
/// one of them looks up. Texels move out of `desc` into the textures.
pub fn prepare(desc: &mut SceneDesc, settings: &Settings, warnings: &mut Warnings) -> (Vec<Material>, Vec<Texture>) {
    let mut used = vec![false; desc.materials.len()];
    for &material in desc.instances.iter().flat_map(|i| i.materials.iter().flatten()) {
        used[material as usize] = true;
    }
    let images = prepare_images(desc, &used, warnings);
    let textures = Textures { desc, images, index: vec![None; desc.textures.len()], list: Vec::new() };
    let mut builder = Builder { desc, settings, textures };
    let fallback = MaterialDesc::default();
    let materials = desc.materials.iter().zip(&used).map(|(material, used)| (material, *used));
    let materials = materials
        .chain([(&fallback, true)])
        // A material that nothing uses keeps its index, and none of its textures.
        .map(|(material, used)| builder.material(if used { material } else { &fallback }, warnings))
        .collect();
    (materials, builder.textures.list)
}

/// Pyramids of the images that materials in use look up, in parallel.
fn prepare_images(desc: &mut SceneDesc, used: &[bool], warnings: &mut Warnings) -> Vec<Option<Arc<Image>>> {
    let mut wanted = vec![false; desc.images.len()];
    let materials = desc.materials.iter().zip(used).filter_map(|(material, used)| used.then_some(material));
    for texture in materials.flat_map(MaterialDesc::textures) {
        wanted[desc.textures[texture.texture as usize].image as usize] = true;
    }
    // Texels that light are still needed.
    let mut lights = vec![false; desc.images.len()];
    for image in desc.lights.iter().filter_map(|light| light.kind.image()) {
        lights[image as usize] = true;
    }
    let prepared: Vec<(Option<Image>, Warnings)> = desc
        .images
        .par_iter_mut()
        .enumerate()
        .map(|(i, image)| {
            let mut warnings = Warnings::new();
            if !wanted[i] {
                return (None, warnings);
            }
            let (name, place) = (image.name.clone(), image.place.clone());
            let pixels = if lights[i] {
                image.pixels.clone()
            } else {
                std::mem::replace(&mut image.pixels, PixelData::U8(Vec::new()))
            };
            let made = Image::new(ImageDesc { name, place: place.clone(), pixels, ..*image }, &mut warnings);
            (made.map_err(|error| warnings.push(&place, format!("{error}: taken as white"))).ok(), warnings)
        })
        .collect();
    prepared
        .into_iter()
        .map(|(image, of_image)| {
            warnings.extend(of_image);
            image.map(Arc::new)
        })
        .collect()
}

/// Textures of the scene, made when the first material asks.
struct Textures<'a> {
    desc: &'a SceneDesc,
    images: Vec<Option<Arc<Image>>>,
    /// New index of each texture that is used.
    index: Vec<Option<u32>>,
    list: Vec<Texture>,
}

impl Textures<'_> {
    fn image(&self, texture: &desc::TextureRef) -> Option<&Arc<Image>> {
        self.images[self.desc.textures[texture.texture as usize].image as usize].as_ref()
    }

    /// The one value of a texture whose texels are all the same, white for one without image.
    fn constant(&self, texture: &desc::TextureRef) -> Option<[f32; 4]> {
        let Some(image) = self.image(texture) else { return Some([1.0; 4]) };
        Texture::new(image.clone(), &self.desc.textures[texture.texture as usize]).constant()
    }

    fn input(&mut self, texture: &desc::TextureRef) -> Option<TextureRef> {
        let image = self.image(texture)?.clone();
        let index = self.index[texture.texture as usize].get_or_insert_with(|| {
            self.list.push(Texture::new(image, &self.desc.textures[texture.texture as usize]));
            self.list.len() as u32 - 1
        });
        Some(TextureRef { texture: *index, uv_set: texture.uv_set, transform: texture.transform.into() })
    }
}

struct Builder<'a> {
    desc: &'a SceneDesc,
    settings: &'a Settings,
    textures: Textures<'a>,
}

impl Builder<'_> {
    fn input(&mut self, inputs: &mut Vec<TextureRef>, texture: &desc::TextureRef) -> Option<u8> {
        let input = self.textures.input(texture)?;
        let index = inputs.iter().position(|known| *known == input).unwrap_or_else(|| {
            inputs.push(input);
            inputs.len() - 1
        });
        Some(index as u8)
    }

    fn color(&mut self, inputs: &mut Vec<TextureRef>, input: &desc::ColorInput) -> ColorInput {
        let factor = Rgb::from(input.factor);
        let Some(texture) = input.texture.filter(|_| !factor.is_black()) else {
            return ColorInput { factor, texture: None };
        };
        match self.textures.constant(&texture) {
            Some([r, g, b, _]) => ColorInput { factor: factor * Rgb::new(r, g, b), texture: None },
            None => ColorInput { factor, texture: self.input(inputs, &texture) },
        }
    }

    fn scalar(&mut self, inputs: &mut Vec<TextureRef>, input: &desc::ScalarInput) -> ScalarInput {
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
        match self.textures.constant(&texture) {
            Some(texel) => ScalarInput { factor: factor * texel[usize::from(channel)], texture: None },
            None => ScalarInput { factor, texture: self.input(inputs, &texture).map(|input| (input, channel)) },
        }
    }

    fn normal(&mut self, normal: desc::NormalInput) -> Option<NormalInput> {
        let desc::NormalInput::Map { texture, scale } = normal else { return None };
        if scale == 0.0 || self.textures.constant(&texture).is_some() {
            return None;
        }
        Some(NormalInput { input: self.textures.input(&texture)?, scale: scale as f32 })
    }

    fn material(&mut self, desc: &MaterialDesc, warnings: &mut Warnings) -> Material {
        warn_of_effects_to_come(desc, warnings);
        let mut inputs = Vec::new();
        let mut mended = Mended::default();
        let emission =
            desc::ColorInput { factor: emission(desc, &mut mended).to_array().map(f64::from), ..desc.emission };
        mended.tell_at(&desc.place, warnings);
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
            absorption: volume.filter(|_| effects::transmits(desc)).map_or(Rgb::BLACK, |v| absorption(&v)),
            emission: self.color(&mut inputs, &emission),
            unlit: desc.unlit,
            normal: desc.normal.and_then(|normal| self.normal(normal)),
            occlusion: desc
                .occlusion
                .filter(|o| self.settings.occlusion_maps && o.factor != 0.0 && o.texture.is_some())
                .map(|o| self.scalar(&mut inputs, &o)),
            inputs,
        }
    }
}

/// True where bad numbers are all that a material was to emit.
pub fn emission_is_lost(desc: &MaterialDesc) -> bool {
    effects::emits(desc) && emission(desc, &mut Mended::default()).is_black()
}

/// Emitted radiance, or the factor of its texture.
fn emission(desc: &MaterialDesc, mended: &mut Mended) -> Rgb {
    let strength = desc.emission_strength;
    // Two negative factors make no light.
    let product = |c: f64| if strength < 0.0 { -(c * strength).abs() } else { c * strength };
    mended.color("emission", desc.emission.factor.map(product))
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
        let what = format!("rendered without its {}: not computed yet", missing.join(", "));
        warnings.push(&desc.place, what);
    }
}
