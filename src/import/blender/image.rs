//! Images: files, packed bytes and pixels in memory, decoded once each and all at a time.

use std::collections::{BTreeSet, HashMap};
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;

use super::blending::{self, AlphaUse, Reading};
use super::colors::Space;
use super::document::ImageData;
use super::kept::{KeptImages, Version, Wanted};
use crate::desc::{Blending, ColorSpace, Filter, ImageDesc, PixelData, TextureDesc, Wrap};
use crate::error::{Error, Place, Result, Stop, Warnings};
use crate::import::image::{decode_image, load_image};

/// An image that Blender holds in memory.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// The bytes of a packed file.
    Encoded(Vec<u8>),
    /// Four floats per pixel, rows from the bottom, as `Image.pixels` has them.
    Pixels {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
        /// `width × height × 4` numbers.
        values: Vec<f32>,
        /// True where they are linear (`Image.is_float`); else they are in the image's colour space.
        linear: bool,
    },
}

/// An image in memory, and how many were handed over before it.
#[derive(Clone, Debug)]
pub struct InMemory {
    /// The image.
    pub source: ImageSource,
    /// Another one for everything that is handed over.
    pub revision: u64,
}

/// Images in memory by name and tile; none for those without tiles.
pub type ImagesInMemory = HashMap<(String, Option<u32>), InMemory>;

/// How a node looks at an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Outside of 0 to 1.
    pub wrap: Wrap,
    /// Interpolation.
    pub filter: Filter,
    /// What is made of the alpha.
    pub alpha: AlphaUse,
}

/// The images that nodes ask for; they are decoded by [`Images::finish`].
pub struct Images<'a> {
    data: &'a HashMap<String, ImageData>,
    in_memory: &'a ImagesInMemory,
    place: &'a Place,
    version: [u32; 3],
    /// Each image asked for.
    wanted: Vec<Wanted>,
    textures: Vec<TextureDesc>,
}

impl<'a> Images<'a> {
    /// No image is asked for yet.
    pub fn new(
        data: &'a HashMap<String, ImageData>,
        in_memory: &'a ImagesInMemory,
        place: &'a Place,
        version: [u32; 3],
    ) -> Self {
        Self { data, in_memory, place, version, wanted: Vec::new(), textures: Vec::new() }
    }

    /// The version of Blender that all this is from.
    pub fn version(&self) -> [u32; 3] {
        self.version
    }

    /// What Blender says of the image of this name.
    pub fn data(&self, name: &str) -> Option<&'a ImageData> {
        self.data.get(name)
    }

    /// Index of a way to look the image up, or one tile of it; `None` where there is no image of this name.
    pub fn texture(&mut self, name: &str, tile: Option<u32>, look: Look) -> Option<u32> {
        self.data.get(name)?;
        let Look { wrap, filter, alpha } = look;
        let reading = Reading { alpha, cubic: filter == Filter::Cubic };
        let wanted = Wanted { name: name.to_owned(), tile, reading };
        let known = self.wanted.iter().position(|known| *known == wanted);
        let image = known.unwrap_or_else(|| {
            self.wanted.push(wanted);
            self.wanted.len() - 1
        }) as u32;
        let texture = TextureDesc { place: self.place.at(name), image, wrap_u: wrap, wrap_v: wrap, filter };
        let known = self.textures.iter().position(|known| *known == texture);
        Some(known.unwrap_or_else(|| {
            self.textures.push(texture);
            self.textures.len() - 1
        }) as u32)
    }

    /// The image of a texture that was asked for.
    pub fn image_of(&self, texture: u32) -> u32 {
        self.textures[texture as usize].image
    }

    /// All images and textures that were asked for, those of `kept` as they are there. One that can't be
    /// read is told, and is magenta as in Cycles.
    ///
    /// # Errors
    /// Once `stop` is wished; nothing is kept then.
    pub fn finish(
        mut self,
        kept: &mut KeptImages,
        stop: &Stop,
        warnings: &mut Warnings,
    ) -> Result<(Vec<Arc<ImageDesc>>, Vec<TextureDesc>)> {
        let decode = |wanted: &Wanted| {
            let version = self.version_of(&wanted.name, wanted.tile);
            if let Some(known) = version.as_ref().and_then(|version| kept.get(wanted, version)) {
                return (version, Ok(known));
            }
            (version, stop.check().and_then(|()| self.decode(wanted)).map(Arc::new))
        };
        let decoded: Vec<(Option<Version>, Result<Arc<ImageDesc>>)> = self.wanted.par_iter().map(decode).collect();
        stop.check()?;
        let good = self.wanted.iter().zip(&decoded).filter_map(|(key, (version, image))| {
            let (Some(version), Ok(image)) = (version, image) else { return None };
            Some((key.clone(), version.clone(), image.clone()))
        });
        kept.replace(good);
        let images: Vec<Arc<ImageDesc>> = decoded
            .into_iter()
            .zip(&self.wanted)
            .map(|((_, image), Wanted { name, .. })| {
                image.unwrap_or_else(|error| {
                    warnings.push(&self.place.at(name), format!("{error}: magenta stands for it"));
                    magenta(name, self.place).into()
                })
            })
            .collect();
        self.tell_spaces(warnings);
        self.share(&images);
        Ok((images, self.textures))
    }

    /// Lets textures look up the same image where two readings of one turned out to be alike.
    fn share(&mut self, images: &[Arc<ImageDesc>]) {
        let first = |i: usize| {
            let of = |i: usize| (&self.wanted[i].name, self.wanted[i].tile);
            (0..i).find(|&j| of(i) == of(j) && blending::same(&images[i], &images[j])).unwrap_or(i) as u32
        };
        let firsts: Vec<u32> = (0..images.len()).map(first).collect();
        self.textures.iter_mut().for_each(|texture| texture.image = firsts[texture.image as usize]);
    }

    /// Tells the images whose colour space is not known, each once however many tiles it has.
    fn tell_spaces(&self, warnings: &mut Warnings) {
        let unknown = |name: &&String| Space::named(&self.data[*name].colorspace).is_none();
        let names: BTreeSet<&String> = self.wanted.iter().map(|wanted| &wanted.name).filter(unknown).collect();
        for name in names {
            let space = &self.data[name].colorspace;
            let what = format!("the image's colour space \"{space}\" is not supported; sRGB is taken for it");
            warnings.push(&self.place.at(name), what);
        }
    }

    /// What the image is now; `None` for one that is not there.
    fn version_of(&self, name: &str, tile: Option<u32>) -> Option<Version> {
        let data = &self.data[name];
        let space = space(data);
        if data.in_memory {
            let revision = self.in_memory.get(&(name.to_owned(), tile))?.revision;
            return Some(Version::Memory { revision, space });
        }
        Version::of_file(&path_of(data, tile), space)
    }

    fn decode(&self, Wanted { name, tile, reading }: &Wanted) -> Result<ImageDesc> {
        let data = &self.data[name];
        let mut space = space(data);
        let place = self.place.at(name);
        let name: Arc<str> = name.as_str().into();
        let image = match self.in_memory.get(&(name.to_string(), *tile)).map(|image| &image.source) {
            _ if !data.in_memory => {
                let path = path_of(data, *tile);
                if path.is_empty() {
                    return Err(Error::invalid(&place, "the image has neither a file nor pixels"));
                }
                load_image(Path::new(&path), space.stored())?
            }
            None => return Err(Error::invalid(&place, "the image's pixels were not handed over")),
            Some(ImageSource::Encoded(bytes)) => {
                let hint = Path::new(&data.path).extension().and_then(|extension| extension.to_str());
                decode_image(bytes, hint, &name, &place, space.stored())?
            }
            Some(ImageSource::Pixels { width, height, values, linear }) => {
                if *linear {
                    space = Space::Stored(ColorSpace::Linear);
                }
                of_pixels([*width, *height], values, *linear, space.stored(), &name, &place)?
            }
        };
        let straight = matches!(image.pixels, PixelData::U8(_) | PixelData::U16(_));
        Ok(reading.applied(space.applied(image), straight))
    }
}

/// The image of Blender's pixels, which are floats that stand for bytes unless they are `linear`.
fn of_pixels(
    [width, height]: [u32; 2],
    values: &[f32],
    linear: bool,
    color_space: ColorSpace,
    name: &Arc<str>,
    place: &Place,
) -> Result<ImageDesc> {
    let (row, rows) = (width as usize * 4, height as usize);
    if row == 0 || values.len() != row * rows || values.is_empty() {
        let what = format!("{} numbers for {width}x{height} pixels", values.len());
        return Err(Error::invalid(place, what));
    }
    let upside_down = values.chunks_exact(row).rev().flatten().copied();
    let pixels = match linear {
        true => PixelData::F32(upside_down.collect()),
        false => PixelData::U8(upside_down.map(|value| (value * 255.0).round() as u8).collect()),
    };
    let (name, place, blending) = (name.clone(), place.clone(), Blending::default());
    Ok(ImageDesc { name, place, width, height, channels: 4, color_space, blending, pixels })
}

/// Path of the image, or of one tile of it.
fn path_of(data: &ImageData, tile: Option<u32>) -> String {
    tile.map_or_else(|| data.path.clone(), |tile| data.path.replace("<UDIM>", &tile.to_string()))
}

/// The colour space of the image; sRGB for one that is not known.
fn space(data: &ImageData) -> Space {
    Space::named(&data.colorspace).unwrap_or(Space::Stored(ColorSpace::Srgb))
}

fn magenta(name: &str, place: &Place) -> ImageDesc {
    ImageDesc {
        name: name.into(),
        place: place.at(name),
        width: 1,
        height: 1,
        channels: 3,
        color_space: ColorSpace::Linear,
        blending: Blending::default(),
        pixels: PixelData::U8(vec![255, 0, 255]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look() -> Look {
        Look { wrap: Wrap::Repeat, filter: Filter::Linear, alpha: AlphaUse::Apart }
    }

    #[test]
    fn each_image_and_each_look_is_there_once() {
        let data: HashMap<String, ImageData> =
            ["a", "b"].map(|name| (name.to_owned(), ImageData { in_memory: true, ..ImageData::default() })).into();
        let pixels = ImageSource::Pixels {
            width: 1,
            height: 2,
            values: vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0],
            linear: true,
        };
        let in_memory = [(("a".to_owned(), None), InMemory { source: pixels, revision: 0 })].into();
        let place = Place::default();
        let mut images = Images::new(&data, &in_memory, &place, [5, 0, 0]);
        assert_eq!(images.texture("a", None, look()), Some(0));
        assert_eq!(images.texture("b", None, look()), Some(1));
        assert_eq!(images.texture("a", None, look()), Some(0));
        assert_eq!(images.texture("a", None, Look { wrap: Wrap::Clamp, ..look() }), Some(2));
        assert_eq!(images.texture("c", None, look()), None);
        let mut warnings = Warnings::new();
        let (images, textures) = images.finish(&mut KeptImages::default(), &Stop::default(), &mut warnings).unwrap();
        assert_eq!(textures.iter().map(|t| t.image).collect::<Vec<_>>(), [0, 1, 0]);
        // The top row comes first.
        assert_eq!(images[0].pixels.get(0), 1.0);
        assert_eq!(images[1].pixels, PixelData::U8(vec![255, 0, 255]));
        let said: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(said, ["b: b: the image's pixels were not handed over: magenta stands for it"]);
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let data: HashMap<String, ImageData> =
            [("wood".to_owned(), ImageData { path: "/no/wood.png".into(), ..ImageData::default() })].into();
        let (in_memory, place) = (HashMap::new(), Place::default());
        let mut images = Images::new(&data, &in_memory, &place, [5, 0, 0]);
        images.texture("wood", None, look());
        let mut warnings = Warnings::new();
        images.finish(&mut KeptImages::default(), &Stop::default(), &mut warnings).unwrap();
        assert!(warnings.iter().next().unwrap().what.contains("/no/wood.png"));
    }

    #[test]
    fn a_space_that_is_not_known_is_told_once_and_another_space_is_decoded_again() {
        let of = |colorspace: &str| -> HashMap<String, ImageData> {
            [("a".into(), ImageData { in_memory: true, colorspace: colorspace.into(), ..ImageData::default() })].into()
        };
        let pixels = ImageSource::Pixels { width: 1, height: 1, values: vec![1.0, 0.0, 0.0, 0.4], linear: false };
        let of_tile = |tile| (("a".to_owned(), tile), InMemory { source: pixels.clone(), revision: 0 });
        let (in_memory, place) = ([None, Some(1002)].map(of_tile).into(), Place::default());
        let mut kept = KeptImages::default();
        kept.turn_on();
        let mut read = |colorspace: &str| {
            let data = of(colorspace);
            let mut images = Images::new(&data, &in_memory, &place, [5, 0, 0]);
            images.texture("a", None, look());
            images.texture("a", Some(1002), look());
            let mut warnings = Warnings::new();
            let image = images.finish(&mut kept, &Stop::default(), &mut warnings).unwrap().0.remove(0);
            (image, warnings.iter().map(ToString::to_string).collect::<Vec<_>>())
        };
        let (image, said) = read("Filmic Log");
        assert_eq!(image.color_space, ColorSpace::Srgb);
        assert_eq!(said, ["a: the image's colour space \"Filmic Log\" is not supported; sRGB is taken for it"]);
        for (name, red) in [("ACEScg", 1.705_051), ("Linear Rec.2020", 1.660_490_9)] {
            let (image, said) = read(name);
            // Bytes become half floats.
            assert!((image.pixels.get(0) - red).abs() < 0.001 && said.is_empty(), "{:?}", image.pixels.get(0));
            assert!((image.pixels.get(3) - 0.4).abs() < 0.001);
        }
    }

    #[test]
    fn an_image_is_decoded_again_only_where_it_is_another() {
        let data: HashMap<String, ImageData> =
            [("a".to_owned(), ImageData { in_memory: true, ..ImageData::default() })].into();
        let source = |value: f32| ImageSource::Pixels { width: 1, height: 1, values: vec![value; 4], linear: true };
        let place = Place::default();
        let mut kept = KeptImages::default();
        kept.turn_on();
        let mut read = |value: f32, revision: u64| {
            let in_memory = [(("a".to_owned(), None), InMemory { source: source(value), revision })].into();
            let mut images = Images::new(&data, &in_memory, &place, [5, 0, 0]);
            images.texture("a", None, look());
            images.finish(&mut kept, &Stop::default(), &mut Warnings::new()).unwrap().0.remove(0)
        };
        let first = read(0.25, 0);
        assert!(Arc::ptr_eq(&first, &read(0.25, 0)));
        let second = read(0.75, 1);
        assert!(!Arc::ptr_eq(&first, &second));
        assert_eq!(second.pixels.get(0), 0.75);
    }
}
