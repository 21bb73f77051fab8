//! Rectangles and ellipses, with the image of a textured rectangle.

use std::f64::consts::PI;
use std::sync::Arc;

use super::lamp_shader::LampShader;
use super::mend::Mended;
use super::texels::texels;
use crate::desc::{ColorSpace, Filter, ImageDesc, LightDesc, LightKind, PixelData, SceneDesc, TextureDesc, Wrap};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Disk, Emission, Flat, Rect, Spread};
use crate::math::{DVec2, Rgb};
use crate::texture::{Image, Texture};

/// Radiance of a rectangle by its image.
#[derive(Debug)]
struct Picture {
    texture: Texture,
    factor: Rgb,
    mean: Rgb,
}

impl Emission for Picture {
    fn radiance(&self, _triangle: u32, uv: [f32; 2]) -> Rgb {
        let [r, g, b, _] = self.texture.lookup(uv, 0.0);
        self.factor * Rgb::new(r, g, b)
    }

    fn mean(&self, _triangle: u32) -> Rgb {
        self.mean
    }
}

/// The emitter of `light`, a rectangle or an ellipse, of which `flat` tells all but spread, sides and
/// size; `None` where it emits nothing.
///
/// What its `shader` varies over a rectangle becomes an image of it.
pub fn prepare(
    desc: &SceneDesc,
    light: &LightDesc,
    flat: Flat,
    shader: Option<&LampShader>,
    mended: &mut Mended,
) -> Option<AnyEmitter> {
    let (LightKind::Rect { width, height, spread, two_sided, .. }
    | LightKind::Disk { width, height, spread, two_sided, .. }) = light.kind
    else {
        return None;
    };
    let half = [half_size("width", width, mended), half_size("height", height, mended)];
    let [Some(x), Some(y)] = half else { return None };
    let flat = Flat { spread: cone(spread, mended), two_sided, ..flat };
    let drawn = shader.filter(|shader| shader.by_place()).map(|shader| shader.picture(light, 2.0 * DVec2::new(x, y)));
    let LightKind::Rect { image, .. } = light.kind else {
        let Some(drawn) = drawn else { return Some(Disk::new(flat, [x, y]).into()) };
        mended.note("its nodes vary over it, which round areas do not: their mean over the square around it is taken");
        let radiance = picture(&drawn, flat.radiance, mended)?.mean;
        return Some(Disk::new(Flat { radiance, ..flat }, [x, y]).into());
    };
    let picture = match (&drawn, image) {
        (Some(drawn), _) => picture(drawn, flat.radiance, mended)?,
        (None, Some(image)) => picture(&desc.images[image as usize], flat.radiance, mended)?,
        (None, None) => return Some(Rect::new(flat, [x, y]).into()),
    };
    // The same all over: no need to ask.
    let constant = picture.texture.constant().is_some();
    let rect = Rect::new(Flat { radiance: picture.mean, ..flat }, [x, y]);
    Some(if constant { rect.into() } else { rect.textured(Arc::new(picture)).into() })
}

fn half_size(what: &str, size: f64, mended: &mut Mended) -> Option<f64> {
    mended.size(what, size).map(|size| 0.5 * f64::from(size))
}

fn cone(angle: f64, mended: &mut Mended) -> Spread {
    if angle.is_nan() {
        mended.note("its spread is NaN: taken as none");
        return Spread::FULL;
    }
    Spread::new(mended.clamped("spread", angle, [0.0, PI]))
}

/// Radiance of `image` times `factor`; `None` for black.
fn picture(image: &ImageDesc, factor: Rgb, mended: &mut Mended) -> Option<Picture> {
    let (texels, is_bad) = texels(image, factor, mended);
    // The mean of texels is that of what bilinear lookups give, too.
    let sum = texels.iter().fold([0.0_f64; 3], |sum, t| {
        let t = t.to_array();
        std::array::from_fn(|c| sum[c] + f64::from(t[c]))
    });
    let mean = factor * Rgb::from(sum.map(|sum| sum / texels.len() as f64));
    if mean.is_black() {
        mended.note(format!("its image \"{}\" is black", image.name));
        return None;
    }
    let mut good = image.clone();
    // A good image keeps its size in memory.
    if is_bad {
        let pixels = PixelData::F32(texels.iter().flat_map(|texel| texel.to_array()).collect());
        good = ImageDesc { channels: 3, color_space: ColorSpace::Linear, pixels, ..good };
    }
    // What was wrong with its colors is told already.
    let made = match Image::new(good, &mut Warnings::new()) {
        Ok(made) => Arc::new(made),
        Err(error) => {
            mended.note(format!("its image \"{}\" can't be used ({error})", image.name));
            return None;
        }
    };
    let desc = TextureDesc {
        place: image.place.clone(),
        image: 0,
        wrap_u: Wrap::Clamp,
        wrap_v: Wrap::Clamp,
        filter: Filter::Linear,
    };
    Some(Picture { texture: Texture::new(made, &desc), factor, mean })
}
