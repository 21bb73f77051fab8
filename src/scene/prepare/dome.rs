//! Domes: the image's texels as radiance, and what is done about those that are none.

use rayon::prelude::*;

use crate::desc::{ColorSpace, ImageDesc, LightDesc, SceneDesc};
use crate::error::Warnings;
use crate::light::{Dome, DomeImage};
use crate::math::{Mat3, Rgb};
use crate::texture::srgb_to_linear;

/// Nothing is brighter, W·sr⁻¹·m⁻²: sums over pixels and samples stay far below the end of `f32`.
const LARGEST: f32 = 1e30;

/// The dome of `radiance`, with the image of that index; `orientation` turns the image's space into
/// render space. `None` for a black image.
pub fn prepare(
    desc: &SceneDesc,
    light: &LightDesc,
    radiance: Rgb,
    image: Option<u32>,
    orientation: Mat3,
    warnings: &mut Warnings,
) -> Option<Dome> {
    let Some(image) = image else { return Some(Dome::new(radiance.map(|v| v.min(LARGEST)), None)) };
    let source = &desc.images[image as usize];
    let mut texels = linear_texels(source);
    let bad = clean(&mut texels, (LARGEST / radiance.max_component()).min(f32::MAX));
    let mut notes = bad.notes();
    let image = DomeImage::new(source.width as usize, source.height as usize, texels, orientation);
    if image.is_none() {
        notes.push("it is black and lights nothing".to_string());
    }
    if !notes.is_empty() {
        let notes = notes.join("; ");
        warnings.push(&light.place, format!("light \"{}\", image \"{}\": {notes}", light.name, source.name));
    }
    image.map(|image| Dome::new(radiance, Some(image)))
}

/// The texels as they are stored, linear.
fn linear_texels(image: &ImageDesc) -> Vec<Rgb> {
    let channels = usize::from(image.channels);
    let linear = |v: f32| match image.color_space {
        ColorSpace::Srgb => srgb_to_linear(v),
        ColorSpace::Linear => v,
    };
    let texel = |i: usize| {
        let at = |c: usize| linear(image.pixels.get(i * channels + if channels < 3 { 0 } else { c }));
        Rgb::new(at(0), at(1), at(2))
    };
    (0..image.width as usize * image.height as usize).into_par_iter().map(texel).collect()
}

/// How many texels were no radiance, and what they are taken as.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bad {
    nan: usize,
    negative: usize,
    infinite: usize,
    too_bright: usize,
    /// The largest finite value, which the infinite ones get.
    largest: f32,
    limit: f32,
}

impl Bad {
    fn notes(&self) -> Vec<String> {
        let Self { nan, negative, infinite, too_bright, largest, limit } = self;
        let pixels = |n: usize| if n == 1 { "1 pixel".to_string() } else { format!("{n} pixels") };
        [
            (*nan, "not a number: taken as 0".to_string()),
            (*negative, "negative: taken as 0".to_string()),
            (*infinite, format!("infinite: taken as {largest}, the largest of the others")),
            (*too_bright, format!("too bright: taken as {limit:e}")),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{} {what}", pixels(count)))
        .collect()
    }
}

/// Makes radiance of at most `limit` of every texel. An infinite one is most often a sun above the range
/// of the file's numbers: it gets the largest of the others.
fn clean(texels: &mut [Rgb], limit: f32) -> Bad {
    let largest_of = |t: &Rgb| t.to_array().into_iter().filter(|v| v.is_finite()).fold(0.0, f32::max);
    let largest = texels.par_iter().map(largest_of).reduce(|| 0.0, f32::max).min(limit);
    let any = |t: &Rgb, test: fn(f32) -> bool| usize::from(t.to_array().into_iter().any(test));
    let mend = |texel: &mut Rgb| {
        let before = *texel;
        // NaN fails every comparison.
        let mended = |v: f32| if v > 0.0 { if v.is_infinite() { largest } else { v.min(limit) } } else { 0.0 };
        *texel = before.map(mended);
        let too_bright = before.to_array().into_iter().any(|v| v.is_finite() && v > limit);
        [
            any(&before, f32::is_nan),
            any(&before, |v| v < 0.0),
            any(&before, |v| v == f32::INFINITY),
            usize::from(too_bright),
        ]
    };
    let add = |a: [usize; 4], b: [usize; 4]| [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]];
    let [nan, negative, infinite, too_bright] = texels.par_iter_mut().map(mend).reduce(|| [0; 4], add);
    Bad { nan, negative, infinite, too_bright, largest, limit }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{LightKind, PixelData};
    use crate::error::Place;
    use crate::light::{Emitter, Receiver};
    use crate::math::{DAffine3, Vec3};

    /// A dome of a 4 × 2 image of one channel, and what was said of it.
    fn dome(pixels: [f32; 8], radiance: f32) -> (Option<Dome>, Vec<String>) {
        let image = ImageDesc {
            name: "sky.exr".into(),
            place: Place::default(),
            width: 4,
            height: 2,
            channels: 1,
            color_space: ColorSpace::Linear,
            pixels: PixelData::F32(pixels.to_vec()),
        };
        let desc = SceneDesc { images: vec![image], ..SceneDesc::default() };
        let kind = LightKind::Dome { radiance: [radiance.into(); 3], image: Some(0) };
        let light = LightDesc::new("world", Place::default(), DAffine3::IDENTITY, kind);
        let mut warnings = Warnings::new();
        let dome = prepare(&desc, &light, Rgb::splat(radiance), Some(0), Mat3::IDENTITY, &mut warnings);
        (dome, warnings.iter().map(|w| w.what.clone()).collect())
    }

    #[test]
    fn a_good_image_is_taken_as_it_is() {
        let (dome, warnings) = dome([1.0; 8], 2.0);
        assert!(warnings.is_empty());
        assert_eq!(dome.unwrap().le(Vec3::X, None), Rgb::splat(2.0));
    }

    #[test]
    fn what_is_no_radiance_is_told_in_one_warning_and_mended() {
        let (dome, warnings) = dome([f32::NAN, -1.0, -f32::INFINITY, f32::INFINITY, 3.0, f32::NAN, 0.5, 0.5], 1.0);
        let expected = "light \"world\", image \"sky.exr\": 2 pixels not a number: taken as 0; 2 pixels negative: \
                        taken as 0; 1 pixel infinite: taken as 3, the largest of the others";
        assert_eq!(warnings, [expected]);
        let dome = dome.unwrap();
        let mut brightest = 0.0_f32;
        for i in 0..1000 {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / 1000.0;
            let (sin, cos) = (2.399_963 * i as f32).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let le = dome.le(Vec3::new(r * cos, z, r * sin), None);
            assert!(le.is_finite() && le.r >= 0.0);
            brightest = brightest.max(le.r);
        }
        assert!((brightest - 3.0).abs() < 0.1, "{brightest}");
    }

    #[test]
    fn sums_of_huge_values_stay_finite() {
        for (pixel, radiance, told) in [(f32::MAX, 1.0, 1), (1e38, 1e38, 1), (1e-38, 1e38, 0), (1e38, 1e-38, 0)] {
            let (dome, warnings) = dome([pixel; 8], radiance);
            assert_eq!(warnings.len(), told, "{pixel:e} {radiance:e}: {warnings:?}");
            let dome = dome.unwrap();
            let at = Receiver { alone: true, ..Receiver::everywhere(Vec3::ZERO) };
            let sample = dome.sample_li(&at, 0.5, [0.3, 0.6]).unwrap();
            let found = sample.li.r / sample.pdf;
            assert!(found.is_finite() && found > 0.0 && dome.importance(&at).is_finite(), "{found} {dome:?}");
        }
    }

    #[test]
    fn a_black_image_is_no_light_and_told() {
        let (dome, warnings) = dome([f32::NAN, 0.0, -0.0, 0.0, 0.0, 0.0, 0.0, -3.0], 1.0);
        assert!(dome.is_none() && warnings.len() == 1 && warnings[0].contains("black"), "{warnings:?}");
    }
}
