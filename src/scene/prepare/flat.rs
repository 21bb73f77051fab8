//! Rectangles and ellipses, with the image of a textured rectangle.

use std::f64::consts::PI;
use std::sync::Arc;

use super::mend::Mended;
use crate::desc::{Filter, ImageDesc, LightDesc, LightKind, SceneDesc, TextureDesc, Wrap};
use crate::error::Warnings;
use crate::light::{AnyEmitter, Disk, Emission, Flat, Rect, Spread};
use crate::math::Rgb;
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
        self.factor * Rgb::new(r, g, b).map(|v| v.max(0.0))
    }

    fn mean(&self, _triangle: u32) -> Rgb {
        self.mean
    }
}

/// The emitter of `light`, a rectangle or an ellipse, of which `flat` tells all but spread, sides and
/// size; `None` where it emits nothing.
pub fn prepare(
    desc: &SceneDesc,
    light: &LightDesc,
    flat: Flat,
    mended: &mut Mended,
    warnings: &mut Warnings,
) -> Option<AnyEmitter> {
    let (LightKind::Rect { width, height, spread, two_sided, .. }
    | LightKind::Disk { width, height, spread, two_sided, .. }) = light.kind
    else {
        return None;
    };
    let half = [half_size("width", width, mended), half_size("height", height, mended)];
    let [Some(x), Some(y)] = half else { return None };
    let flat = Flat { spread: cone(spread, mended), two_sided, ..flat };
    let LightKind::Rect { image, .. } = light.kind else { return Some(Disk::new(flat, [x, y]).into()) };
    let Some(image) = image else { return Some(Rect::new(flat, [x, y]).into()) };
    let picture = picture(&desc.images[image as usize], flat.radiance, mended, warnings)?;
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
fn picture(image: &ImageDesc, factor: Rgb, mended: &mut Mended, warnings: &mut Warnings) -> Option<Picture> {
    let name = &image.name;
    let made = match Image::new(image.clone(), warnings) {
        Ok(made) => Arc::new(made),
        Err(error) => {
            mended.note(format!("its image \"{name}\" can't be used ({error})"));
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
    let mean = factor * mean(&made, mended);
    if mean.is_black() {
        mended.note(format!("its image \"{name}\" is black"));
        return None;
    }
    Some(Picture { texture: Texture::new(made, &desc), factor, mean })
}

/// Mean of what bilinear lookups give, which is that of the texels.
fn mean(image: &Image, mended: &mut Mended) -> Rgb {
    let (mut sum, mut negative) = ([0.0_f64; 3], 0_usize);
    for y in 0..image.height() {
        for x in 0..image.width() {
            let texel = image.texel(x, y);
            for (sum, &value) in sum.iter_mut().zip(&texel[..3]) {
                *sum += f64::from(value.max(0.0));
            }
            negative += usize::from(texel[..3].iter().any(|v| *v < 0.0));
        }
    }
    if negative > 0 {
        mended.note(format!("{negative} pixels of its image \"{}\" are negative: taken as 0", image.name()));
    }
    let texels = f64::from(image.width()) * f64::from(image.height());
    Rgb::from(sum.map(|sum| sum / texels))
}
