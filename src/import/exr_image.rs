//! OpenEXR images: the R, G, B, A or Y channels of the first part that has them, half kept as half.

use std::io::Cursor;
use std::sync::Arc;

use exr::image::{AnyChannel, FlatSamples};
use exr::meta::attribute::AttributeValue;
use exr::prelude::{ReadChannels, ReadLayers, read};
use half::f16;

use crate::desc::{Blending, ColorSpace, ImageDesc, PixelData};
use crate::error::{Error, Place, Result};

/// True for bytes that start as an OpenEXR file does.
pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x76, 0x2F, 0x31, 0x01])
}

/// Decodes the first part that has colour.
///
/// # Errors
/// Bytes that don't decode, parts without R, G, B or Y.
pub(super) fn decode(bytes: &[u8], name: &Arc<str>, place: &Place) -> Result<ImageDesc> {
    let invalid = |e: exr::error::Error| Error::invalid(place, format!("the OpenEXR image doesn't decode: {e}"));
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(invalid)?;
    for layer in &image.layer_data {
        let Some(channels) = pick(&layer.channel_data.list) else { continue };
        let (width, height) = (layer.size.0, layer.size.1);
        let (Ok(w), Ok(h)) = (u32::try_from(width), u32::try_from(height)) else { continue };
        if channels.iter().any(|c| c.sample_data.len() != width * height) {
            return Err(Error::unsupported(place, "subsampled OpenEXR channels are not supported"));
        }
        return Ok(ImageDesc {
            name: name.clone(),
            place: place.clone(),
            width: w,
            height: h,
            channels: channels.len() as u8,
            color_space: ColorSpace::Linear,
            blending: Blending::default(),
            pixels: interleave(&channels, width * height),
        });
    }
    Err(Error::invalid(place, "the OpenEXR image has no channels R, G, B or Y"))
}

/// Where the picture stands in the world: the matrix that takes a row vector to the screen, −1 to 1. OpenEXR
/// has a name of its own for it; OpenImageIO writes either.
pub(super) fn world_to_screen(bytes: &[u8]) -> Option<[f32; 16]> {
    let meta = exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), false).ok()?;
    meta.headers.iter().find_map(|header| {
        let attributes = &header.own_attributes;
        let other = attributes.other.iter().find(|(name, _)| *name == "worldtoscreen").map(|(_, value)| value);
        match other {
            Some(AttributeValue::Matrix4x4(matrix)) => Some(*matrix),
            _ => attributes.world_to_normalized_device,
        }
    })
}

/// Colour channels of one layer of names: that without prefix, else the first that has any.
fn pick(list: &[AnyChannel<FlatSamples>]) -> Option<Vec<&AnyChannel<FlatSamples>>> {
    let split = |channel: &AnyChannel<FlatSamples>| {
        let name = channel.name.to_string();
        match name.rsplit_once('.') {
            Some((layer, last)) => (layer.to_owned(), last.to_owned()),
            None => (String::new(), name),
        }
    };
    let mut layers: Vec<String> = list.iter().map(|channel| split(channel).0).collect();
    layers.sort_by_key(|layer| !layer.is_empty());
    layers.dedup();
    layers.into_iter().find_map(|layer| {
        let find = |wanted: &str| list.iter().find(|channel| split(channel) == (layer.clone(), wanted.to_owned()));
        let alpha = find("A");
        let color = match (find("R"), find("G"), find("B"), find("Y")) {
            (Some(r), Some(g), Some(b), _) => vec![r, g, b],
            (.., Some(y)) => vec![y],
            (Some(r), ..) => vec![r],
            _ => return None,
        };
        Some(color.into_iter().chain(alpha).collect())
    })
}

fn interleave(channels: &[&AnyChannel<FlatSamples>], texels: usize) -> PixelData {
    let halves: Option<Vec<&[f16]>> = channels
        .iter()
        .map(|channel| match &channel.sample_data {
            FlatSamples::F16(values) => Some(values.as_slice()),
            _ => None,
        })
        .collect();
    match halves {
        Some(halves) => PixelData::F16((0..texels).flat_map(|i| halves.iter().map(move |c| c[i])).collect()),
        None => PixelData::F32(
            (0..texels)
                .flat_map(|i| channels.iter().map(move |c| c.sample_data.value_by_flat_index(i).to_f32()))
                .collect(),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{WritableImage, write_rgb_file, write_rgba_file};

    fn decode_bytes(bytes: &[u8]) -> Result<ImageDesc> {
        decode(bytes, &"test".into(), &Place::file("a.exr"))
    }

    #[test]
    fn halves_stay_halves_and_floats_floats() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_rgba_file(&path, 2, 1, |x, _| (f16::from_f32(x as f32), f16::ONE, f16::ZERO, f16::from_f32(0.5)))
            .unwrap();
        let image = decode_bytes(&std::fs::read(&path).unwrap()).unwrap();
        let expected = [0.0, 1.0, 0.0, 0.5, 1.0, 1.0, 0.0, 0.5].map(f16::from_f32);
        assert_eq!((image.channels, image.pixels), (4, PixelData::F16(expected.to_vec())));
        write_rgb_file(&path, 1, 2, |_, y| (y as f32, 1e6_f32, 3.0)).unwrap();
        let image = decode_bytes(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!((image.height, image.pixels), (2, PixelData::F32(vec![0.0, 1e6, 3.0, 1.0, 1e6, 3.0])));
    }

    #[test]
    fn layered_names_are_found() {
        use exr::prelude::{AnyChannels, Encoding, Image, Layer, LayerAttributes};
        let channel = |name: &str, v: f32| AnyChannel::new(name, FlatSamples::F32(vec![v]));
        let list = ["View.Z", "View.Combined.R", "View.Combined.G", "View.Combined.B"];
        let channels = list.iter().zip([9.0, 1.0, 2.0, 3.0]).map(|(name, v)| channel(name, v)).collect();
        let channels = AnyChannels::sort(channels);
        let layer = Layer::new((1, 1), LayerAttributes::named("x"), Encoding::UNCOMPRESSED, channels);
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
        assert_eq!(decode_bytes(bytes.get_ref()).unwrap().pixels, PixelData::F32(vec![1.0, 2.0, 3.0]));
    }

    #[test]
    fn truncation_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_rgb_file(&path, 64, 64, |x, y| (x as f32, y as f32, 3.0_f32)).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        for length in [5, 40, 200, bytes.len() / 2] {
            assert!(decode_bytes(&bytes[..length]).is_err(), "{length}");
        }
    }
}
