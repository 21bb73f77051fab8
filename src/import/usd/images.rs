//! Image files that a stage names: next to its layers, or inside of a `.usdz`.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use openusd::ar::{DefaultResolver, ResolvedPath, Resolver};
use openusd::sdf::{self, AssetPath};
use rayon::prelude::*;

use super::stage::Reading;
use super::udim;
use crate::desc::{ColorSpace, ImageDesc, PixelData};
use crate::error::Place;
use crate::import::image::decode_image;

/// How the values of a file become linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Space {
    /// By UsdUVTexture's rule: sRGB where it has 8 bits and three or four channels, else raw.
    Auto,
    /// As they are.
    Raw,
    /// sRGB; float files are linear all the same.
    Srgb,
}

/// Where an asset path leads.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum File {
    /// A file, or an entry of a package as `scene.usdz[a.png]`.
    One(String),
    /// The tiles of a UDIM set, 1001 and on.
    Tiles(Vec<(u32, String)>),
    /// Nowhere: the path as authored, and the layer that names it.
    Missing(String),
}

impl File {
    /// The file that `asset` names in the layer `layer`, which is what relative paths start from.
    pub fn find(asset: &AssetPath, layer: Option<&str>) -> Self {
        let resolver = DefaultResolver::new();
        let anchor = layer.map(ResolvedPath::new);
        let authored = asset.asset_path();
        let resolve = |path: &str| {
            let identifier = resolver.create_identifier(path, anchor.as_ref());
            resolver.resolve(&identifier).map(|found| found.to_string_lossy().into_owned())
        };
        if authored.contains(udim::MARK) {
            let tiles = udim::tiles(authored, resolve);
            if !tiles.is_empty() {
                return Self::Tiles(tiles);
            }
        } else if let Some(found) = asset.resolved_path().filter(|found| !found.is_empty()) {
            return Self::One(found.to_string());
        } else if let Some(found) = (!authored.is_empty()).then(|| resolve(authored)).flatten() {
            return Self::One(found);
        }
        let named_by = layer.map(|layer| format!(", which {layer} names,")).unwrap_or_default();
        Self::Missing(format!("image @{authored}@{named_by} is not there"))
    }
}

/// Images read so far, each once for each colour space.
#[derive(Default)]
pub(super) struct Images {
    /// In the order of `SceneDesc::images`.
    pub images: Vec<Arc<ImageDesc>>,
    /// Index of a file read as sRGB, and as raw.
    known: HashMap<String, [Option<u32>; 2]>,
    /// Files that are decoded and not used yet, and what is wrong with those that can't be.
    decoded: HashMap<String, Result<ImageDesc, String>>,
}

impl Images {
    /// Index of the image that `asset`, an attribute of the prim at `path`, names. `None`, with a warning,
    /// for one that can't be read.
    pub fn load(
        &mut self,
        reading: &Reading<'_>,
        path: &sdf::Path,
        asset: &AssetPath,
        space: ColorSpace,
    ) -> Option<u32> {
        let space = if space == ColorSpace::Srgb { Space::Srgb } else { Space::Raw };
        let read = match File::find(asset, None) {
            File::One(file) => self.get(&file, space),
            File::Tiles(tiles) => match tiles.first() {
                Some((_, file)) => self.get(file, space),
                None => Err("no tiles".to_string()),
            },
            File::Missing(what) => Err(what),
        };
        read.map_err(|what| reading.warn(path, format!("{what}; left out"))).ok()
    }

    /// Index of the image of `file`.
    ///
    /// # Errors
    /// What is wrong with a file that can't be read.
    pub fn get(&mut self, file: &str, space: Space) -> Result<u32, String> {
        let known = self.known.get(file).copied().unwrap_or_default();
        let mut image = match known.iter().flatten().next() {
            Some(&index) => {
                let image = &self.images[index as usize];
                if let Some(same) = known[usize::from(!is_srgb(image, space))] {
                    return Ok(same);
                }
                ImageDesc::clone(image)
            }
            None => match self.decoded.remove(file).unwrap_or_else(|| decode(file)) {
                Ok(image) => image,
                Err(what) => {
                    self.decoded.insert(file.to_string(), Err(what.clone()));
                    return Err(what);
                }
            },
        };
        let srgb = is_srgb(&image, space);
        image.color_space = if srgb { ColorSpace::Srgb } else { ColorSpace::Linear };
        let index = self.push(image);
        self.known.entry(file.to_string()).or_default()[usize::from(!srgb)] = Some(index);
        Ok(index)
    }

    /// An image that comes from no file, as one that was computed.
    pub fn push(&mut self, image: ImageDesc) -> u32 {
        self.images.push(image.into());
        self.images.len() as u32 - 1
    }

    /// Decodes those of `files` that are not known yet, all at once.
    pub fn preload(&mut self, mut files: Vec<String>) {
        files.retain(|file| !self.known.contains_key(file) && !self.decoded.contains_key(file));
        files.sort_unstable();
        files.dedup();
        let decoded: Vec<_> = files.par_iter().map(|file| decode(file)).collect();
        self.decoded.extend(files.into_iter().zip(decoded));
    }
}

/// Whether a file read as `space` carries the sRGB curve.
fn is_srgb(image: &ImageDesc, space: Space) -> bool {
    match (&image.pixels, space) {
        (PixelData::F16(_) | PixelData::F32(_), _) | (_, Space::Raw) => false,
        (_, Space::Srgb) => true,
        (pixels, Space::Auto) => matches!(pixels, PixelData::U8(_)) && image.channels >= 3,
    }
}

/// Bytes of a file, or of an entry of a package.
pub(super) fn bytes(file: &str) -> Result<Vec<u8>, String> {
    let asset = DefaultResolver::new().open_asset(&ResolvedPath::new(file));
    let bytes = asset.and_then(|mut asset| asset.read_all());
    bytes.map_err(|error| format!("{file} can't be read: {error}"))
}

fn decode(file: &str) -> Result<ImageDesc, String> {
    let bytes = bytes(file)?;
    let name = file.trim_end_matches(']').rsplit(['/', '\\', '[']).next().unwrap_or(file);
    let hint = Path::new(name).extension().and_then(|extension| extension.to_str());
    decode_image(&bytes, hint, &name.into(), &Place::file(file), ColorSpace::Linear).map_err(|error| error.to_string())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::import::ImportOptions;
    use image::{DynamicImage, ImageBuffer, Luma, Rgb, Rgba};

    /// Writes an RGB image of the given texels, row by row from the top.
    pub fn png(folder: &Path, name: &str, width: u32, texels: &[[u8; 3]]) {
        let raw: Vec<u8> = texels.iter().flatten().copied().collect();
        let height = texels.len() as u32 / width;
        ImageBuffer::<Rgb<u8>, _>::from_raw(width, height, raw).unwrap().save(folder.join(name)).unwrap();
    }

    /// A stage of `text` in `folder`.
    pub fn stage<'a>(folder: &Path, text: &str, options: &'a ImportOptions) -> Reading<'a> {
        let path = folder.join("test.usda");
        std::fs::write(&path, format!("#usda 1.0\n{text}")).unwrap();
        Reading::open(&path, options).unwrap()
    }

    fn saved(folder: &Path, name: &str, image: impl Into<DynamicImage>) -> String {
        let path = folder.join(name);
        image.into().save(&path).unwrap();
        path.to_string_lossy().into_owned()
    }

    #[test]
    fn auto_is_srgb_for_eight_bit_color_alone() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let files = [
            (saved(folder, "rgb.png", ImageBuffer::from_pixel(1, 1, Rgb([9_u8; 3]))), ColorSpace::Srgb),
            (saved(folder, "rgba.png", ImageBuffer::from_pixel(1, 1, Rgba([9_u8; 4]))), ColorSpace::Srgb),
            (saved(folder, "grey.png", ImageBuffer::from_pixel(1, 1, Luma([9_u8]))), ColorSpace::Linear),
            (saved(folder, "deep.png", ImageBuffer::from_pixel(1, 1, Rgb([9_u16; 3]))), ColorSpace::Linear),
            (saved(folder, "float.hdr", ImageBuffer::from_pixel(1, 1, Rgb([0.5_f32; 3]))), ColorSpace::Linear),
        ];
        let mut images = Images::default();
        images.preload(files.iter().map(|(file, _)| file.clone()).collect());
        for (file, space) in &files {
            let index = images.get(file, Space::Auto).unwrap();
            assert_eq!(images.images[index as usize].color_space, *space, "{file}");
        }
        // The other space is another image; the same one is the same.
        let raw = images.get(&files[0].0, Space::Raw).unwrap();
        assert_eq!(images.images[raw as usize].color_space, ColorSpace::Linear);
        assert_eq!(images.get(&files[0].0, Space::Raw), Ok(raw));
        assert_eq!(images.get(&files[0].0, Space::Srgb), images.get(&files[0].0, Space::Auto));
        assert_eq!(images.get(&files[4].0, Space::Srgb), images.get(&files[4].0, Space::Raw));
        assert_eq!(images.images.len(), 6);
    }

    #[test]
    fn paths_start_at_the_layer_and_lead_into_packages() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::create_dir(folder.path().join("tex")).unwrap();
        png(folder.path(), "tex/a.png", 1, &[[1, 2, 3]]);
        let layer = folder.path().join("scene.usda").to_string_lossy().into_owned();
        let File::One(file) = File::find(&AssetPath::new("./tex/a.png"), Some(&layer)) else { panic!() };
        assert!(file.ends_with("tex/a.png"));
        let missing = File::find(&AssetPath::new("tex/b.png"), Some(&layer));
        let File::Missing(what) = missing else { panic!("{missing:?}") };
        assert!(what.contains("tex/b.png") && what.contains("scene.usda"), "{what}");
        assert!(Images::default().get("nowhere.png", Space::Auto).unwrap_err().contains("nowhere.png"));
        std::fs::write(folder.path().join("bad.png"), b"no image").unwrap();
        let bad = folder.path().join("bad.png").to_string_lossy().into_owned();
        assert!(Images::default().get(&bad, Space::Auto).unwrap_err().contains("bad.png"));
    }

    #[test]
    fn a_missing_asset_is_told_of_once() {
        let folder = tempfile::tempdir().unwrap();
        let options = ImportOptions::default();
        let reading = stage(folder.path(), "def Xform \"a\" {}", &options);
        let path = sdf::Path::new("/a").unwrap();
        let mut images = Images::default();
        assert_eq!(images.load(&reading, &path, &AssetPath::new("x.exr"), ColorSpace::Linear), None);
        let warnings = reading.warnings.take();
        assert!(warnings.iter().any(|w| w.to_string().contains("x.exr") && w.to_string().contains("/a")));
    }
}
