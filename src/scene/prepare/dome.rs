//! Domes: constant, of an image, or of a graph.

use std::sync::Arc;

use rayon::prelude::*;

use super::cache::{Cache, DomeParts};
use super::emissive::Shared;
use super::mend::Mended;
use super::texels::texels;
use super::{graphs, lamp};
use crate::desc::{LightDesc, SceneDesc};
use crate::light::{Dome, DomeImage, DomeRadiance};
use crate::math::{Mat3, Rgb};
use crate::scene::surroundings::Surroundings;

/// Height of the map that light sampling goes by where a graph looks up no image; it is twice as wide.
const MAP: usize = 256;

/// Its least and largest height where it does.
const MAP_OF_IMAGE: [usize; 2] = [512, 1024];

/// Texels of the map that have less than this share of the mean are taken to have it: what the graph has
/// between the points that were looked at is dark at most, never lost.
const FLOOR: f32 = 1e-3;

/// The dome of `radiance`, with the image of that index; `orientation` turns the image's space into
/// render space. `None` for a black image.
pub fn prepare(
    desc: &SceneDesc,
    radiance: Rgb,
    image: Option<u32>,
    orientation: Mat3,
    mended: &mut Mended,
) -> Option<Dome> {
    let Some(image) = image else { return Some(Dome::new(radiance, None)) };
    let source = &desc.images[image as usize];
    let (texels, _) = texels(source, radiance, mended);
    let image = DomeImage::new(source.width as usize, source.height as usize, texels, orientation);
    if image.is_none() {
        mended.note(format!("its image \"{}\" is black", source.name));
    }
    image.map(|image| Dome::new(radiance, Some(image)))
}

/// The dome of shader `shader`, as it was if `cache` has it; `None` for one that is black all over.
pub fn shaded(
    desc: &SceneDesc,
    light: &LightDesc,
    shader: u32,
    shared: &Shared<'_>,
    cache: &mut Cache,
) -> Option<Dome> {
    let of = &desc.dome_shaders[shader as usize];
    if graphs::follows_camera(&of.graph, [of.radiance]) {
        return made(desc, light, shader, shared);
    }
    let parts = || {
        let looked_up = graphs::looked_up(&of.graph, [of.radiance]).into_iter();
        let texture = |i: u32| {
            let texture = &desc.textures[i as usize];
            (texture.clone(), desc.images[texture.image as usize].clone())
        };
        DomeParts { shader: of.clone(), transform: light.transform, textures: looked_up.map(texture).collect() }
    };
    cache.dome(parts, || made(desc, light, shader, shared))
}

fn made(desc: &SceneDesc, light: &LightDesc, shader: u32, shared: &Shared<'_>) -> Option<Dome> {
    let of = &desc.dome_shaders[shader as usize];
    let Shared { domes, textures, camera, origin, .. } = *shared;
    let program = domes[shader as usize].clone();
    let surroundings = Surroundings { program, textures: textures.clone(), camera, origin };
    let radiance: DomeRadiance = Arc::new(move |wi| surroundings.radiance(wi));
    let looked_up = graphs::looked_up(&of.graph, [of.radiance]);
    let heights = looked_up.iter().map(|&t| desc.images[desc.textures[t as usize].image as usize].height as usize);
    let height = heights.max().map_or(MAP, |height| height.clamp(MAP_OF_IMAGE[0], MAP_OF_IMAGE[1]));
    let axes = lamp::axes(light, &mut Mended::default());
    let orientation = Mat3::from_cols(axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), axes.z_axis.as_vec3());
    let map = map(&radiance, 2 * height, height, orientation);
    Some(Dome::shaded(DomeImage::new(2 * height, height, map, orientation)?, radiance))
}

/// The largest of four values in each texel, for a density that misses little.
fn map(radiance: &DomeRadiance, width: usize, height: usize, orientation: Mat3) -> Vec<Rgb> {
    let texel = |i: usize| {
        let at = |dx: f64, dy: f64| {
            let u = ((i % width) as f64 + dx) / width as f64;
            let v = ((i / width) as f64 + dy) / height as f64;
            radiance(orientation * DomeImage::direction([u, v]))
        };
        let corners = [at(0.25, 0.25), at(0.75, 0.25), at(0.25, 0.75), at(0.75, 0.75)];
        corners.into_iter().fold(Rgb::BLACK, |a, b| Rgb::new(a.r.max(b.r), a.g.max(b.g), a.b.max(b.b)))
    };
    let mut map: Vec<Rgb> = (0..width * height).into_par_iter().map(texel).collect();
    // In the order of the texels, for the same bits on any number of threads.
    let mean = map.iter().map(|texel| f64::from(texel.max_component())).sum::<f64>() / map.len() as f64;
    let floor = (mean * f64::from(FLOOR)) as f32;
    map.iter_mut().filter(|texel| texel.max_component() < floor).for_each(|texel| *texel = Rgb::splat(floor));
    map
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::desc::{Blending, ColorSpace, ImageDesc, LightDesc, LightKind, PixelData};
    use crate::error::{Place, Warnings};
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
            blending: Blending::default(),
            pixels: PixelData::F32(pixels.to_vec()),
        };
        let desc = SceneDesc { images: vec![image.into()], ..SceneDesc::default() };
        let kind = LightKind::Dome { radiance: [radiance.into(); 3], image: Some(0) };
        let light = LightDesc::new("world", Place::default(), DAffine3::IDENTITY, kind);
        let (mut mended, mut warnings) = (Mended::default(), Warnings::new());
        let dome = prepare(&desc, Rgb::splat(radiance), Some(0), Mat3::IDENTITY, &mut mended);
        mended.tell(&light, dome.is_none(), &mut warnings);
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
        let expected = "light \"world\": its image \"sky.exr\" has 2 pixels not a number: taken as 0, 2 pixels negative: \
                        taken as 0, 1 pixel infinite: taken as 3, the largest of the others";
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
