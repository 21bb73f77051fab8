//! Keeps apart, for the light-path passes, what reached the camera by which kind of scattering.

use crate::bsdf::ByLobe;
use crate::film::{PixelSample, Split};
use crate::math::Rgb;

/// `by_lobe` as the film's own type.
pub fn to_film(by_lobe: ByLobe) -> Split {
    Split { diffuse: by_lobe.diffuse, glossy: by_lobe.glossy, transmission: by_lobe.transmission }
}

/// Share of each class in the first scattering of a path, per channel; the shares sum to 1.
pub fn shares(weight: ByLobe) -> ByLobe {
    let sum = weight.sum();
    ByLobe {
        diffuse: weight.diffuse.safe_div(sum),
        glossy: weight.glossy.safe_div(sum),
        transmission: weight.transmission.safe_div(sum),
    }
}

/// Adds `l`, which was scattered `scatterings` times (at least once), first as `shares` say.
pub fn add_scattered(sample: &mut PixelSample, shares: ByLobe, l: Rgb, scatterings: u32) {
    sample.combined += l;
    let target = if scatterings == 1 { &mut sample.direct } else { &mut sample.indirect };
    *target += to_film(shares * l);
}
