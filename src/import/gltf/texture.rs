//! Textures, samplers and images: which ones materials use, and those decoded.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use super::accessor::Reader;
use super::document::label;
use super::json::{Image, TextureInfo, Transform};
use super::uri::{self, Target};
use crate::desc::{ColorSpace, Filter, ImageDesc, TextureDesc, TextureRef, TextureTransform, Wrap};
use crate::error::{Error, Place, Warnings};
use crate::import::image::decode_image;

/// `GL_NEAREST` of WebGL, as samplers write it.
const NEAREST: u32 = 9728;

/// Images and textures that materials asked for.
#[derive(Default)]
pub(super) struct TextureTable {
    /// Decoded images.
    pub images: Vec<Arc<ImageDesc>>,
    /// Ways to look them up.
    pub textures: Vec<TextureDesc>,
    /// Index into `textures` by texture of the file and use; `None` for what could not be decoded.
    by_use: BTreeMap<(usize, bool), Option<u32>>,
}

/// What a material's textures are looked up in: first a list of wishes, then the decoded table.
pub(super) enum Lookup<'a> {
    /// Notes what is used; every texture is taken to be there.
    Collect(&'a mut BTreeSet<(usize, bool)>),
    /// Looks it up.
    Table(&'a TextureTable),
}

impl Lookup<'_> {
    /// The reference for one input of a material; `None` where the texture is absent.
    pub fn get(&mut self, info: Option<&TextureInfo>, color_space: ColorSpace) -> Option<TextureRef> {
        let info = info?;
        let key = (info.index?, color_space == ColorSpace::Srgb);
        let texture = match self {
            Self::Collect(used) => {
                used.insert(key);
                0
            }
            Self::Table(table) => table.by_use.get(&key).copied().flatten()?,
        };
        let transform = info.extensions.transform.as_ref();
        let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
        Some(TextureRef { texture, uv_set, transform: transform.map_or(TextureTransform::IDENTITY, matrix) })
    }
}

/// KHR_texture_transform: `T · R · S`, its rotation counter-clockwise on the image.
fn matrix(transform: &Transform) -> TextureTransform {
    let (sin, cos) = transform.rotation.sin_cos();
    let ([x, y], [sx, sy]) = (transform.offset, transform.scale);
    TextureTransform([[cos * sx, sin * sy, x], [-sin * sx, cos * sy, y]])
}

impl TextureTable {
    /// Decodes the images of `used` in parallel. One that doesn't decode is warned of and left out.
    pub fn load(
        reader: Reader<'_>,
        used: &BTreeSet<(usize, bool)>,
        base: Option<&Path>,
        place: &Place,
        warnings: &mut Warnings,
    ) -> Self {
        let mut table = Self::default();
        let mut sources = BTreeMap::new();
        for &(texture, srgb) in used {
            match source(reader, texture) {
                Ok(image) => {
                    sources.entry(image).or_insert_with(BTreeSet::new).insert(srgb);
                }
                Err(what) => warnings.push(place, format!("{what}; materials use their factors alone")),
            }
        }
        let decoded: Vec<_> = sources
            .into_par_iter()
            .map(|(index, uses)| {
                let json = &reader.root.images[index];
                let name = json.name.as_deref().filter(|name| !name.is_empty());
                let here = place.at(label("image", index, name.or(file_name(json))));
                let srgb_first = uses.contains(&true);
                let space = if srgb_first { ColorSpace::Srgb } else { ColorSpace::Linear };
                let image = decode(reader, index, json, base, &here, space);
                (index, uses, here, image)
            })
            .collect();
        let mut images = BTreeMap::new();
        for (index, uses, here, image) in decoded {
            let image = match image {
                Ok(image) => image,
                Err(what) => {
                    warnings.push(&here, format!("{what}; materials use their factors alone"));
                    continue;
                }
            };
            if uses.len() == 2 {
                images.insert((index, false), table.images.len() as u32);
                let linear = ImageDesc { color_space: ColorSpace::Linear, ..image.clone() };
                table.images.push(linear.into());
            }
            images.insert((index, uses.contains(&true)), table.images.len() as u32);
            table.images.push(image.into());
        }
        for &(texture, srgb) in used {
            let image = source(reader, texture).ok().and_then(|index| images.get(&(index, srgb)).copied());
            let slot = image.map(|image| {
                table.textures.push(describe(reader, texture, image, place));
                table.textures.len() as u32 - 1
            });
            table.by_use.insert((texture, srgb), slot);
        }
        table
    }
}

/// The image of a texture: WebP before the plain source, which is its fallback.
fn source(reader: Reader<'_>, index: usize) -> Result<usize, String> {
    let count = reader.root.textures.len();
    let texture =
        reader.root.textures.get(index).ok_or_else(|| format!("texture {index} of {count} does not exist"))?;
    let here = label("texture", index, texture.name.as_deref());
    let webp = texture.extensions.webp.as_ref().and_then(|webp| webp.source);
    let image = match (webp.or(texture.source), &texture.extensions.basisu) {
        (Some(image), _) => image,
        (None, Some(_)) => return Err(format!("{here} is KTX2 (KHR_texture_basisu), which is not supported")),
        (None, None) => return Err(format!("{here} has no image")),
    };
    let count = reader.root.images.len();
    if image < count { Ok(image) } else { Err(format!("{here} names image {image} of {count}")) }
}

fn describe(reader: Reader<'_>, index: usize, image: u32, place: &Place) -> TextureDesc {
    let texture = &reader.root.textures[index];
    let sampler = texture.sampler.and_then(|i| reader.root.samplers.get(i)).cloned().unwrap_or_default();
    let wrap = |code| match code {
        33071 => Wrap::Clamp,
        33648 => Wrap::Mirror,
        _ => Wrap::Repeat,
    };
    TextureDesc {
        place: place.at(label("texture", index, texture.name.as_deref())),
        image,
        wrap_u: wrap(sampler.wrap_s),
        wrap_v: wrap(sampler.wrap_t),
        filter: if sampler.mag_filter == Some(NEAREST) { Filter::Nearest } else { Filter::Linear },
    }
}

pub(super) fn file_name(image: &Image) -> Option<&str> {
    image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).map(|uri| uri.rsplit('/').next().unwrap_or(uri))
}

/// The image `json` of that index. The error is a sentence without place.
pub(super) fn decode(
    reader: Reader<'_>,
    index: usize,
    json: &Image,
    base: Option<&Path>,
    place: &Place,
    color_space: ColorSpace,
) -> Result<ImageDesc, String> {
    let name: Arc<str> = match (json.name.as_deref(), file_name(json)) {
        (Some(name), _) if !name.is_empty() => name.into(),
        (_, Some(file)) => file.into(),
        _ => format!("image_{index}").into(),
    };
    let hint = json.mime_type.as_deref();
    let run = |bytes: &[u8], hint: Option<&str>| decode_image(bytes, hint, &name, place, color_space).map_err(reason);
    match (&json.uri, json.buffer_view) {
        (Some(uri), _) => match uri::resolve(uri, base)? {
            Target::Data { bytes, mime } => run(&bytes, hint.or(Some(&mime))),
            Target::File(path) => {
                let bytes = std::fs::read(&path).map_err(|e| format!("can't read {}: {e}", path.display()))?;
                let extension = path.extension().and_then(|e| e.to_str());
                run(&bytes, hint.or(extension)).map_err(|what| format!("{}: {what}", path.display()))
            }
        },
        (None, Some(view)) => run(reader.buffers.view(reader.root, view)?.0, hint),
        (None, None) => Err("has neither a URI nor a buffer view".into()),
    }
}

/// What is wrong, without the place.
pub(super) fn reason(error: Error) -> String {
    match error {
        Error::Invalid { what, .. } | Error::Unsupported { what, .. } => what,
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix of the extension's own GLSL sample, offset · rotation · scale.
    #[test]
    fn the_transform_is_that_of_the_extension() {
        let transform = Transform {
            offset: [0.0, 1.0],
            rotation: std::f64::consts::FRAC_PI_2,
            scale: [0.5, 0.25],
            tex_coord: None,
        };
        let TextureTransform([u, v]) = matrix(&transform);
        let apply = |row: [f64; 3], s: f64, t: f64| row[0] * s + row[1] * t + row[2];
        // The extension's own figure: offset (0, 1) and a quarter turn show the image turned.
        assert!((apply(u, 1.0, 0.0)).abs() < 1e-12 && (apply(v, 1.0, 0.0) - 0.5).abs() < 1e-12);
        assert!((apply(u, 0.0, 1.0) - 0.25).abs() < 1e-12 && (apply(v, 0.0, 1.0) - 1.0).abs() < 1e-12);
    }
}
