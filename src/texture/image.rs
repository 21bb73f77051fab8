//! An image as the render looks it up: a mip pyramid in the stored size.

use std::sync::Arc;

use super::texel::{Format, Level, Reader, linearize};
use super::{blend, pyramid};
use crate::desc::{Blending, ColorSpace, Filter, ImageDesc, PixelData};
use crate::error::{Error, Result, Warnings};

/// A mip pyramid, read as linear Rec.709 and alpha.
///
/// Eight-bit images stay eight bit at every level, and so on. Float images are made linear once.
/// NaN and infinite values become 0, with a warning. Negative values stay, since data such as
/// displacement is signed; whoever reads color clamps.
#[derive(Clone, Debug)]
pub struct Image {
    name: Arc<str>,
    pub(super) format: Format,
    /// Of the finest level; all others hold light.
    pub(super) blending: Blending,
    pub(super) levels: Vec<Level>,
    constant: Option<[f32; 4]>,
}

impl Image {
    /// Builds the pyramid.
    ///
    /// # Errors
    /// [`Error::Invalid`] where the image is empty, has no channels or more than four, or its texels
    /// don't fill it.
    pub fn new(desc: ImageDesc, warnings: &mut Warnings) -> Result<Self> {
        let ImageDesc { name, place, width, height, channels, color_space, mut blending, mut pixels } = desc;
        let values = u64::from(width) * u64::from(height) * u64::from(channels);
        if values == 0 || channels > 4 || values != pixels.len() as u64 {
            let what = format!(
                "image '{name}' of {width} x {height} texels and {channels} channels can't hold {} values",
                pixels.len()
            );
            return Err(Error::invalid(&place, what));
        }
        let format = Format { channels: usize::from(channels), space: color_space };
        let replaced = linearize(&mut pixels, format);
        if replaced > 0 {
            warnings
                .push(&place, format!("image '{name}' holds {replaced} values that are NaN or infinite; they are 0"));
        }

        blending.encoded = match &pixels {
            // Made linear already.
            PixelData::F16(_) | PixelData::F32(_) => None,
            // Colours were multiplied by alpha as they are stored.
            _ if color_space == ColorSpace::Srgb && blending.associated => blending.encoded.or(Some(Filter::Linear)),
            _ if color_space == ColorSpace::Srgb => blending.encoded,
            _ => None,
        };
        let mut finest = Level::new(width, height, format.channels, pixels);
        let uniform = is_uniform(&finest.pixels, format.channels);
        if uniform {
            let light = first_texel(&finest.pixels, format, blending);
            finest = Level { strides: [0, 0], pixels: format.store(&light, &finest.pixels), ..finest };
            blending = Blending::default();
        }
        let levels = pyramid::build(finest, format, blending);
        let mut image = Self { name, format, blending, levels, constant: None };
        if uniform {
            image.constant = Some(image.texel(0, 0));
        }
        Ok(image)
    }

    /// Name or file name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Texels per row of the finest level.
    pub fn width(&self) -> u32 {
        self.levels[0].width
    }

    /// Rows of the finest level.
    pub fn height(&self) -> u32 {
        self.levels[0].height
    }

    /// How many levels there are, down to 1×1.
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Texels per row and rows of a level, 0 the finest; levels beyond the last are the last.
    pub fn level_size(&self, level: usize) -> [u32; 2] {
        let level = &self.levels[level.min(self.levels.len() - 1)];
        [level.width, level.height]
    }

    /// Memory of all levels.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|level| level.pixels.bytes()).sum()
    }

    /// The one value of an image whose texels are all the same.
    pub fn constant(&self) -> Option<[f32; 4]> {
        self.constant
    }

    /// Linear color and alpha of a texel of the finest level, column and row from the top left; beyond
    /// the edges the nearest texel.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        self.level_texel(0, x, y)
    }

    /// The same of any level.
    pub fn level_texel(&self, level: usize, x: u32, y: u32) -> [f32; 4] {
        let finest = level == 0;
        let level = &self.levels[level.min(self.levels.len() - 1)];
        let (x, y) = (x.min(level.width - 1), y.min(level.height - 1));
        let one = One(level.offset(x as usize, y as usize));
        if finest && self.blending != Blending::default() {
            return blend::finish(self.format.stored(self.blending).read(&level.pixels, one), self.blending);
        }
        self.format.read(&level.pixels, one)
    }
}

struct One(usize);

impl Reader<[f32; 4]> for One {
    fn read(self, texel: impl Fn(usize) -> [f32; 4] + Sync) -> [f32; 4] {
        texel(self.0)
    }
}

fn is_uniform(pixels: &PixelData, channels: usize) -> bool {
    fn same<T: PartialEq>(values: &[T], n: usize) -> bool {
        values.chunks_exact(n).all(|texel| *texel == values[..n])
    }
    match pixels {
        PixelData::U8(v) => same(v, channels),
        PixelData::U16(v) => same(v, channels),
        PixelData::F16(v) => same(v, channels),
        PixelData::F32(v) => same(v, channels),
    }
}

/// Light of the first texel, as many values as it has.
fn first_texel(pixels: &PixelData, format: Format, blending: Blending) -> Vec<f32> {
    let [r, g, b, a] = blend::finish(format.stored(blending).read(pixels, One(0)), blending);
    match format.channels {
        1 => vec![r],
        2 => vec![r, a],
        3 => vec![r, g, b],
        _ => vec![r, g, b, a],
    }
}
