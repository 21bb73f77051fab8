//! Radiance of the images of lights: texels in linear light, and what is done about those that are none.

use rayon::prelude::*;

use super::mend::{LARGEST, Mended};
use crate::desc::{ColorSpace, ImageDesc};
use crate::math::Rgb;
use crate::math::srgb_to_linear;

/// The texels of `image`, to be multiplied by `factor`, and whether some had to be mended.
pub fn texels(image: &ImageDesc, factor: Rgb, mended: &mut Mended) -> (Vec<Rgb>, bool) {
    let mut texels = linear_texels(image);
    let bad = clean(&mut texels, (LARGEST / factor.max_component()).min(f32::MAX)).notes();
    if !bad.is_empty() {
        mended.note(format!("its image \"{}\" has {}", image.name, bad.join(", ")));
    }
    (texels, !bad.is_empty())
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
