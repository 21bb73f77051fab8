//! Keeps apart, for the light-path passes and the light groups, what reached the camera by which kind
//! of scattering and from which light.

use crate::bsdf::ByLobe;
use crate::film::{GroupSample, PixelSample, Split};
use crate::light::Rules;
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

/// The sums of the light group of a light with `rules`; `None` where no pass asks for it.
pub fn group<'a>(sample: &'a mut PixelSample, rules: &Rules) -> Option<&'a mut GroupSample> {
    sample.groups.get_mut(usize::from(rules.group?))
}

/// Adds `l`, which came to the camera without scattering.
pub fn add_unscattered(sample: &mut PixelSample, rules: &Rules, l: Rgb) {
    sample.combined += l;
    if let Some(group) = group(sample, rules) {
        group.combined += l;
    }
}

/// Adds light that the first surface scattered, by class.
pub fn add_direct(sample: &mut PixelSample, rules: &Rules, l: ByLobe) {
    let sum = l.sum();
    sample.combined += sum;
    sample.direct += to_film(l);
    if let Some(group) = group(sample, rules) {
        group.combined += sum;
    }
}

/// Adds `l`, which was scattered more than once, first as `shares` say.
pub fn add_indirect(sample: &mut PixelSample, rules: &Rules, shares: ByLobe, l: Rgb) {
    sample.combined += l;
    sample.indirect += to_film(shares * l);
    if let Some(group) = group(sample, rules) {
        group.combined += l;
    }
}
