//! Image files in: PNG, JPEG, WebP, TIFF, TGA, BMP, Radiance HDR and OpenEXR, each kept in the size
//! of its own texels (8, 16 or 32 bit).

use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use image::{DynamicImage, ImageFormat, ImageReader, Limits};

use super::exr_image;
pub(super) use super::exr_image::world_to_screen;
use crate::desc::{Blending, ColorSpace, ImageDesc, PixelData};
use crate::error::{Error, Place, Result};

/// Largest width and height.
const LARGEST_SIDE: u32 = 1 << 16;

/// A decoded image of at most this many bytes may come from a file of any size; a larger one only
/// from a file that is not smaller by more than [`LARGEST_RATIO`].
const SMALL: u64 = 256 << 20;

/// Deflate's largest ratio is 1032.
const LARGEST_RATIO: u64 = 2048;

/// Loads the image at `path`. Float formats are linear whatever `color_space` says.
///
/// # Errors
/// A file that can't be read or decoded.
pub fn load_image(path: &Path, color_space: ColorSpace) -> Result<ImageDesc> {
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "can't read", source))?;
    let name: Arc<str> = path.file_name().map_or_else(|| "image".into(), |name| name.to_string_lossy().into());
    let hint = path.extension().and_then(|extension| extension.to_str());
    decode_image(&bytes, hint, &name, &Place::file(path), color_space)
}

/// Decodes an image. What it is shows in its first bytes; `hint`, an extension or a MIME type, is
/// for formats that don't show it (TGA). Float formats are linear whatever `color_space` says.
///
/// # Errors
/// Bytes that don't decode.
pub fn decode_image(
    bytes: &[u8],
    hint: Option<&str>,
    name: &Arc<str>,
    place: &Place,
    color_space: ColorSpace,
) -> Result<ImageDesc> {
    if exr_image::is_exr(bytes) {
        return exr_image::decode(bytes, name, place);
    }
    let format = image::guess_format(bytes).ok().or_else(|| hint.and_then(format_of));
    let format = format.ok_or_else(|| Error::invalid(place, "not an image of a known format"))?;
    let undecodable = |e: image::ImageError| Error::invalid(place, format!("the image doesn't decode: {e}"));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits(bytes.len()));
    let decoded = reader.decode().map_err(undecodable)?;
    let (width, height) = (decoded.width(), decoded.height());
    let (channels, pixels) = unpack(decoded).ok_or_else(|| Error::unsupported(place, "unknown texel format"))?;
    if width == 0 || height == 0 {
        return Err(Error::invalid(place, "the image has no texels"));
    }
    let color_space = match &pixels {
        PixelData::F16(_) | PixelData::F32(_) => ColorSpace::Linear,
        PixelData::U8(_) | PixelData::U16(_) => color_space,
    };
    let (name, place, blending) = (name.clone(), place.clone(), Blending::default());
    Ok(ImageDesc { name, place, width, height, channels, color_space, blending, pixels })
}

/// What a file of `length` bytes may decode to.
fn limits(length: usize) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(LARGEST_SIDE);
    limits.max_image_height = Some(LARGEST_SIDE);
    limits.max_alloc = Some(SMALL.max((length as u64).saturating_mul(LARGEST_RATIO)));
    limits
}

fn format_of(hint: &str) -> Option<ImageFormat> {
    ImageFormat::from_mime_type(hint).or_else(|| ImageFormat::from_extension(hint))
}

/// Channels and texels.
fn unpack(image: DynamicImage) -> Option<(u8, PixelData)> {
    Some(match image {
        DynamicImage::ImageLuma8(b) => (1, PixelData::U8(b.into_raw())),
        DynamicImage::ImageLumaA8(b) => (2, PixelData::U8(b.into_raw())),
        DynamicImage::ImageRgb8(b) => (3, PixelData::U8(b.into_raw())),
        DynamicImage::ImageRgba8(b) => (4, PixelData::U8(b.into_raw())),
        DynamicImage::ImageLuma16(b) => (1, PixelData::U16(b.into_raw())),
        DynamicImage::ImageLumaA16(b) => (2, PixelData::U16(b.into_raw())),
        DynamicImage::ImageRgb16(b) => (3, PixelData::U16(b.into_raw())),
        DynamicImage::ImageRgba16(b) => (4, PixelData::U16(b.into_raw())),
        DynamicImage::ImageRgb32F(b) => (3, PixelData::F32(b.into_raw())),
        DynamicImage::ImageRgba32F(b) => (4, PixelData::F32(b.into_raw())),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageBuffer, Luma, Rgb, Rgba};

    fn encode(image: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
        let mut out = Cursor::new(Vec::new());
        image.into().write_to(&mut out, format).unwrap();
        out.into_inner()
    }

    fn decode(bytes: &[u8], hint: Option<&str>) -> Result<ImageDesc> {
        decode_image(bytes, hint, &"test".into(), &Place::file("a.png"), ColorSpace::Srgb)
    }

    #[test]
    fn texels_keep_their_own_size() {
        let eight = encode(ImageBuffer::from_pixel(3, 2, Rgba([1_u8, 2, 3, 4])), ImageFormat::Png);
        let image = decode(&eight, None).unwrap();
        assert_eq!((image.width, image.height, image.channels), (3, 2, 4));
        assert_eq!(image.pixels, PixelData::U8([1, 2, 3, 4].repeat(6)));
        let sixteen = encode(ImageBuffer::from_pixel(2, 1, Luma([0x1234_u16])), ImageFormat::Png);
        assert_eq!(decode(&sixteen, None).unwrap().pixels, PixelData::U16(vec![0x1234; 2]));
        let float = encode(ImageBuffer::from_pixel(1, 1, Rgb([0.5_f32, 2.0, 4.0])), ImageFormat::Hdr);
        let image = decode(&float, None).unwrap();
        assert_eq!(image.pixels, PixelData::F32(vec![0.5, 2.0, 4.0]));
        assert_eq!(image.color_space, ColorSpace::Linear);
    }

    #[test]
    fn a_format_without_magic_needs_its_hint() {
        let tga = encode(ImageBuffer::from_pixel(2, 2, Rgb([9_u8, 8, 7])), ImageFormat::Tga);
        assert!(decode(&tga, None).is_err());
        assert_eq!(decode(&tga, Some("tga")).unwrap().pixels, PixelData::U8([9, 8, 7].repeat(4)));
    }

    #[test]
    fn truncated_and_foreign_bytes_are_errors() {
        let png = encode(ImageBuffer::from_pixel(64, 64, Rgb([9_u8, 8, 7])), ImageFormat::Png);
        assert!(decode(&png[..png.len() / 2], None).is_err());
        assert!(decode(b"hello", Some("image/png")).is_err());
        assert!(decode(b"", None).is_err());
    }

    /// A PNG header that claims more than the file can hold is refused before memory is taken.
    #[test]
    fn a_claim_of_gigabytes_is_refused() {
        let mut png = encode(ImageBuffer::from_pixel(1, 1, Rgb([9_u8, 8, 7])), ImageFormat::Png);
        png[16..20].copy_from_slice(&60_000_u32.to_be_bytes());
        png[20..24].copy_from_slice(&60_000_u32.to_be_bytes());
        let crc = crc32(&png[12..29]);
        png[29..33].copy_from_slice(&crc.to_be_bytes());
        let message = decode(&png, None).unwrap_err().to_string();
        assert!(message.to_lowercase().contains("limit") || message.contains("memory"), "{message}");
    }

    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(!0_u32, |crc, &b| {
            (0..8).fold(crc ^ u32::from(b), |c, _| if c & 1 == 1 { 0xEDB8_8320 ^ (c >> 1) } else { c >> 1 })
        })
    }
}
