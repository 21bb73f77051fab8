//! OpenEXR: writes what Blender 5.0 would write, reads what the field writes.
//!
//! One part per pass, part `<view layer>.<Pass>`, channels `<view layer>.<Pass>.<channel>`, each part
//! with its `colorInteropID`; Rec.709 chromaticities; Cryptomatte manifests as in Psyop's
//! specification 1.2.0. Compression is lossless.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Seek, Write};
use std::path::Path;

use exr::image::write::WritableImage;
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image};
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities, IntegerBounds, Text};
use exr::meta::header::{ImageAttributes, LayerAttributes};
use exr::prelude::{ReadChannels, ReadLayers};
use half::f16;

use super::Metadata;
use super::file;
use crate::error::{Error, Place, Result};
use crate::film::cryptomatte::{Manifest, murmur3_32};
use crate::film::{Layer, Picture, Storage};

/// How the file is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Color passes as half floats; values beyond ±65504 become that. Data passes are float always.
    pub half: bool,
    /// Name of the view layer, the first part of every name.
    pub view_layer: String,
    /// Lossless packing.
    pub compression: Compression,
    /// Where in a larger picture this one lies; `None` for one that is all of it.
    pub window: Option<Window>,
    /// Width of a pixel over its height.
    pub pixel_aspect: f32,
}

/// Where a picture lies in a larger one: the file's data window in its display window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Place of its upper left pixel, beyond the larger picture where it shows more.
    pub corner: [i32; 2],
    /// Width and height of the larger one.
    pub whole: [u32; 2],
}

impl Default for Options {
    fn default() -> Self {
        let compression = Compression::default();
        Self { half: false, view_layer: "ViewLayer".to_owned(), compression, window: None, pixel_aspect: 1.0 }
    }
}

/// Lossless packings of EXR.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// As is: fastest to write, largest.
    None,
    /// Run lengths: good for flat passes, quick.
    Rle,
    /// Deflate over 16 rows, what Blender and most pipelines write.
    #[default]
    Zip,
    /// Wavelets: smallest for noisy pictures.
    Piz,
}

/// Writes the picture, in full or not at all.
///
/// # Errors
/// [`Error::Io`] that names the file where it can't be written; [`Error::Invalid`] for a picture
/// without pixels or layers.
pub fn write(path: &Path, picture: &Picture, metadata: &Metadata, options: &Options) -> Result<()> {
    if picture.layers.is_empty() || picture.width == 0 || picture.height == 0 {
        return Err(Error::invalid(&Place::file(path), "a picture without pixels or passes can't be written"));
    }
    let image = to_exr(picture, metadata, options);
    file::replace(path, |file| {
        let mut buffer = BufWriter::with_capacity(1 << 20, file);
        image.write().to_buffered(&mut buffer).map_err(into_io)?;
        buffer.flush()
    })
}

fn into_io(error: exr::error::Error) -> io::Error {
    match error {
        exr::error::Error::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}

type ExrLayer = exr::image::Layer<AnyChannels<FlatSamples>>;

fn to_exr(
    picture: &Picture,
    metadata: &Metadata,
    options: &Options,
) -> Image<exr::image::Layers<AnyChannels<FlatSamples>>> {
    let size = (picture.width as usize, picture.height as usize);
    let mut layers: exr::image::Layers<AnyChannels<FlatSamples>> =
        picture.layers.iter().map(|layer| to_exr_layer(size, layer, options)).collect();
    describe(&mut layers[0].attributes, metadata, options);
    let whole = options.window.map_or(size, |window| (window.whole[0] as usize, window.whole[1] as usize));
    let mut attributes = ImageAttributes::new(IntegerBounds::from_dimensions(whole));
    attributes.chromaticities = Some(REC_709);
    attributes.pixel_aspect = options.pixel_aspect;
    Image { attributes, layer_data: layers }
}

/// ITU-R BT.709 primaries, white point D65.
const REC_709: Chromaticities = Chromaticities {
    red: exr::math::Vec2(0.64, 0.33),
    green: exr::math::Vec2(0.3, 0.6),
    blue: exr::math::Vec2(0.15, 0.06),
    white: exr::math::Vec2(0.3127, 0.329),
};

fn to_exr_layer(size: (usize, usize), layer: &Layer, options: &Options) -> ExrLayer {
    let part = format!("{}.{}", options.view_layer, layer.name);
    let half = options.half && layer.storage == Storage::Color;
    let n = layer.channels.len();
    let channels = layer.channels.iter().enumerate().map(|(i, channel)| {
        let values = layer.data.iter().skip(i).step_by(n);
        let samples = if half {
            let (min, max) = (f16::MIN.to_f32(), f16::MAX.to_f32());
            FlatSamples::F16(values.map(|value| f16::from_f32(value.clamp(min, max))).collect())
        } else {
            FlatSamples::F32(values.copied().collect())
        };
        AnyChannel::new(text(&format!("{part}.{channel}")), samples)
    });
    let channels = AnyChannels::sort(channels.collect());
    let mut attributes = LayerAttributes::named(text(&part));
    if let Some(Window { corner: [left, top], .. }) = options.window {
        attributes.layer_position = exr::math::Vec2(left, top);
    }
    let space = match layer.storage {
        Storage::Color => "lin_rec709_scene",
        Storage::Data => "data",
    };
    set(&mut attributes, "colorInteropID", space);
    ExrLayer::new(size, attributes, encoding(options.compression), channels)
}

fn encoding(compression: Compression) -> Encoding {
    let compression = match compression {
        Compression::None => exr::compression::Compression::Uncompressed,
        Compression::Rle => exr::compression::Compression::RLE,
        Compression::Zip => exr::compression::Compression::ZIP16,
        Compression::Piz => exr::compression::Compression::PIZ,
    };
    Encoding {
        compression,
        blocks: exr::image::Blocks::ScanLines,
        line_order: exr::meta::attribute::LineOrder::Increasing,
    }
}

/// UTF-8 as it is; the standard leaves the encoding of text open and its readers take UTF-8.
fn text(value: &str) -> Text {
    Text::from_slice_unchecked(value.as_bytes())
}

fn set(attributes: &mut LayerAttributes, name: &str, value: &str) {
    attributes.other.insert(text(name), AttributeValue::Text(text(value)));
}

fn describe(attributes: &mut LayerAttributes, metadata: &Metadata, options: &Options) {
    attributes.software_name = Some(text(Metadata::SOFTWARE));
    attributes.owner = metadata.owner.as_deref().map(text);
    attributes.comments = metadata.comments.as_deref().map(text);
    attributes.capture_date = metadata.cap_date().as_deref().map(text);
    attributes.utc_offset = attributes.capture_date.is_some().then_some(0.0);
    for (name, value) in metadata.attributes() {
        // The format ends names at 255 bytes.
        let end = name.floor_char_boundary(255);
        set(attributes, &name[..end], &value);
    }
    for (name, value) in metadata.manifests.iter().flat_map(|manifest| cryptomatte(manifest, &options.view_layer)) {
        set(attributes, &name, &value);
    }
}

/// What a file says of a Cryptomatte, as names and texts: `cryptomatte/<key>/…`; the key is the first seven digits of the
/// hash of the layer's full name.
pub fn cryptomatte(manifest: &Manifest, view_layer: &str) -> [(String, String); 4] {
    let name = format!("{view_layer}.{}", manifest.kind.layer());
    let key = format!("{:08x}", murmur3_32(name.as_bytes(), 0));
    let fields = [
        ("name", name),
        ("hash", "MurmurHash3_32".into()),
        ("conversion", "uint32_to_float32".into()),
        ("manifest", manifest.to_json()),
    ];
    fields.map(|(field, value)| (format!("cryptomatte/{}/{field}", &key[..7]), value))
}

/// The texts in the header of a file's first part, by name.
///
/// # Errors
/// [`Error::Io`] where it can't be opened, [`Error::Invalid`] where it is broken.
pub fn attributes(path: &Path) -> Result<BTreeMap<String, String>> {
    let cant_read = |source| Error::io(path, "can't read", source);
    let mut file = BufReader::new(File::open(path).map_err(cant_read)?);
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(|error| match error {
        exr::error::Error::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => cant_read(source),
        other => Error::invalid(&Place::file(path), format!("not a sound EXR file: {other}")),
    })?;
    let utf8 = |text: &Text| String::from_utf8_lossy(text.as_slice()).into_owned();
    let texts = meta.headers.first().into_iter().flat_map(|header| &header.own_attributes.other);
    let texts = texts.filter_map(|(name, value)| match value {
        AttributeValue::Text(value) => Some((utf8(name), utf8(value))),
        _ => None,
    });
    Ok(texts.collect())
}

/// Reads every pass of a file, of one part or many, full names kept ("ViewLayer.Combined"); channels
/// without a dot in their name are grouped under their part's name. Half floats are widened.
///
/// # Errors
/// [`Error::Io`] where it can't be opened, [`Error::Invalid`] where it is broken,
/// [`Error::Unsupported`] for parts of different size and for subsampled channels.
pub fn read(path: &Path) -> Result<Picture> {
    let cant_read = |source| Error::io(path, "can't read", source);
    let place = Place::file(path);
    let broken = |error| match error {
        exr::error::Error::Io(source) => cant_read(source),
        exr::error::Error::NotSupported(what) => Error::unsupported(&place, format!("EXR: {what}")),
        other => Error::invalid(&place, format!("not a sound EXR file: {other}")),
    };
    let mut file = BufReader::with_capacity(1 << 20, File::open(path).map_err(cant_read)?);
    let meta = MetaData::read_from_buffered(&mut file, false).map_err(broken)?;
    let length = file.get_ref().metadata().map_err(cant_read)?.len();
    if !is_plausible(&meta, length) {
        return Err(Error::invalid(&place, "not a sound EXR file: its header promises more pixels than it can hold"));
    }
    file.rewind().map_err(cant_read)?;
    let image = exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(file)
        .map_err(broken)?;

    let Some(first) = image.layer_data.first() else {
        return Err(Error::invalid(&place, "an EXR file without parts"));
    };
    let size = first.size;
    let mut layers = Vec::new();
    for part in &image.layer_data {
        if part.size != size || part.channel_data.list.iter().any(|channel| channel.sampling != exr::math::Vec2(1, 1)) {
            let what = "parts of different sizes and subsampled channels are not supported";
            return Err(Error::unsupported(&place, what));
        }
        layers.extend(from_exr_layer(part));
    }
    Ok(Picture { width: size.0 as u32, height: size.1 as u32, layers })
}

/// False where a header asks for more memory than a file of `length` bytes can fill: memory is taken by
/// the header's word, before the first pixel is read.
fn is_plausible(meta: &MetaData, length: u64) -> bool {
    /// Black pictures may be tiny at any ratio.
    const SMALL: u64 = 64 << 20;
    /// Deflate's best ratio is 1032.
    const RATIO: u64 = 2000;
    /// Each chunk's entry in the table of offsets.
    const ENTRY: u64 = 8;
    let (mut bytes, mut chunks) = (0_u64, 0_u64);
    for header in &meta.headers {
        let [width, height] = [header.layer_size.0, header.layer_size.1].map(|n| n as u64);
        let texel: u64 = header.channels.list.iter().map(|channel| channel.sample_type.bytes_per_sample() as u64).sum();
        bytes = bytes.saturating_add(width.saturating_mul(height).saturating_mul(texel));
        chunks = chunks.saturating_add(header.chunk_count as u64);
    }
    bytes <= SMALL.max(length.saturating_mul(RATIO)) && chunks <= length / ENTRY
}

/// The layers of a part: its channels grouped by what stands before the last dot.
fn from_exr_layer(part: &ExrLayer) -> Vec<Layer> {
    let utf8 = |text: &Text| String::from_utf8_lossy(text.as_slice()).into_owned();
    let part_name = part.attributes.layer_name.as_ref().map(utf8).unwrap_or_default();
    let mut groups: BTreeMap<String, Vec<(String, &FlatSamples)>> = BTreeMap::new();
    for channel in &part.channel_data.list {
        let full = utf8(&channel.name);
        let (group, name) = full.rsplit_once('.').unwrap_or((&part_name, &full));
        groups.entry(group.to_owned()).or_default().push((name.to_owned(), &channel.sample_data));
    }
    let interop = part.attributes.other.get(&text("colorInteropID"));
    let data = matches!(interop, Some(AttributeValue::Text(id)) if id.as_slice() == b"data");
    groups.into_iter().map(|(name, channels)| from_channels(name, channels, data)).collect()
}

fn from_channels(name: String, mut channels: Vec<(String, &FlatSamples)>, data: bool) -> Layer {
    // The file sorts by the alphabet; people read RGBA, XYZW, UVA.
    channels.sort_by_key(|(channel, _)| ("RrGgBbXxYyZzWwUuVvAa".find(channel.as_str()).unwrap_or(99), channel.clone()));
    let color = channels.iter().all(|(channel, _)| matches!(channel.as_str(), "R" | "G" | "B" | "A"));
    let n = channels.len();
    let pixels = channels.first().map_or(0, |(_, samples)| samples.len());
    let mut values = vec![0.0; pixels * n];
    for (i, (_, samples)) in channels.iter().enumerate() {
        for (value, sample) in values.iter_mut().skip(i).step_by(n).zip(samples.values_as_f32()) {
            *value = sample;
        }
    }
    let storage = if color && !data { Storage::Color } else { Storage::Data };
    Layer { name, channels: channels.into_iter().map(|(channel, _)| channel).collect(), data: values, storage }
}
