//! The images and textures that materials look up.

use std::sync::Arc;

use rayon::prelude::*;

use crate::desc::{self, ImageDesc, PixelData, SceneDesc};
use crate::error::Warnings;
use crate::scene::prepare::cache::{Cache, ReadyImage};
use crate::scene::prepare::graphs;
use crate::texture::{Image, Texture, TextureRef};

/// Pyramids of the images that materials in use, domes and lamps look up, in parallel.
pub(super) fn images(
    desc: &mut SceneDesc,
    used: &[bool],
    cache: &mut Cache,
    warnings: &mut Warnings,
) -> Vec<Option<Arc<Image>>> {
    let mut wanted = vec![false; desc.images.len()];
    let materials = desc.materials.iter().zip(used).filter_map(|(material, used)| used.then_some(material));
    for material in materials {
        let plain = material.textures().map(|texture| texture.texture);
        for texture in plain.chain(graphs::textures(material)) {
            wanted[desc.textures[texture as usize].image as usize] = true;
        }
    }
    for shader in &desc.dome_shaders {
        for texture in graphs::looked_up(&shader.graph, [shader.radiance]) {
            wanted[desc.textures[texture as usize].image as usize] = true;
        }
    }
    for shader in &desc.lamp_shaders {
        for texture in graphs::looked_up(&shader.graph, [shader.factor]) {
            wanted[desc.textures[texture as usize].image as usize] = true;
        }
    }
    let background = &desc.background_aovs;
    for texture in graphs::looked_up(&background.graph, background.outputs.iter().flat_map(|(_, values)| *values)) {
        wanted[desc.textures[texture as usize].image as usize] = true;
    }
    // Texels that light are still needed.
    let mut lights = vec![false; desc.images.len()];
    for image in desc.lights.iter().filter_map(|light| light.kind.image()) {
        lights[image as usize] = true;
    }
    let prepared: Vec<ReadyImage> = desc
        .images
        .par_iter_mut()
        .enumerate()
        .map(|(i, image)| {
            let mut warnings = Warnings::new();
            if !wanted[i] || cache.stop.is_wished() {
                return (None, warnings);
            }
            if let Some(known) = cache.image(image) {
                return known;
            }
            let place = image.place.clone();
            let made = Image::new(texels_of(image, lights[i]), &mut warnings);
            let made = made.map_err(|error| warnings.push(&place, format!("{error}: taken as white")));
            (made.ok().map(Arc::new), warnings)
        })
        .collect();
    cache.keep_images(desc, &wanted, &prepared);
    prepared
        .into_iter()
        .map(|(image, of_image)| {
            warnings.extend(of_image);
            image
        })
        .collect()
}

/// The image with its texels, which are taken out of it where nobody else is known to need them.
fn texels_of(image: &mut Arc<ImageDesc>, needed: bool) -> ImageDesc {
    match Arc::get_mut(image) {
        Some(own) if !needed => {
            let pixels = std::mem::replace(&mut own.pixels, PixelData::U8(Vec::new()));
            ImageDesc { name: own.name.clone(), place: own.place.clone(), pixels, ..*own }
        }
        _ => ImageDesc::clone(image),
    }
}

/// Textures of the scene, made when the first material asks.
pub struct Textures<'a> {
    desc: &'a SceneDesc,
    images: Vec<Option<Arc<Image>>>,
    /// New index of each texture that is used.
    index: Vec<Option<u32>>,
    /// Those that were asked for.
    pub list: Vec<Texture>,
}

impl<'a> Textures<'a> {
    /// Those of `desc`, with the pyramids of `images`.
    pub fn new(desc: &'a SceneDesc, images: Vec<Option<Arc<Image>>>) -> Self {
        Self { desc, images, index: vec![None; desc.textures.len()], list: Vec::new() }
    }

    fn image(&self, texture: &desc::TextureRef) -> Option<&Arc<Image>> {
        self.images[self.desc.textures[texture.texture as usize].image as usize].as_ref()
    }

    /// The one value of a texture whose texels are all the same, white for one without image.
    pub fn constant(&self, texture: &desc::TextureRef) -> Option<[f32; 4]> {
        let Some(image) = self.image(texture) else { return Some([1.0; 4]) };
        Texture::new(image.clone(), &self.desc.textures[texture.texture as usize]).constant()
    }

    /// The texture of the scene that a use of one of the description is of.
    pub fn input(&mut self, texture: &desc::TextureRef) -> Option<TextureRef> {
        let image = self.image(texture)?.clone();
        let index = self.index[texture.texture as usize].get_or_insert_with(|| {
            self.list.push(Texture::new(image, &self.desc.textures[texture.texture as usize]));
            self.list.len() as u32 - 1
        });
        Some(TextureRef { texture: *index, uv_set: texture.uv_set, transform: texture.transform.into() })
    }
}
