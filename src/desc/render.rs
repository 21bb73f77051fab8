//! What a file says of how it wants to be rendered.

use std::sync::Arc;

use super::{AovDesc, FramingDesc};
use crate::error::Place;

/// Settings of a render as authored (UsdRender's RenderSettings); what is `None` or empty is not
/// authored, and what the user sets comes first.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDesc {
    /// What its picture shows, the first one.
    pub framing: FramingDesc,
    /// The part of the picture that is wanted: left, top, width and height in pixels. It goes before the framing's
    /// `window`.
    pub crop: Option<[u32; 4]>,
    /// True where the background is not seen by the camera: alpha is 0 there, and the environment pass is as ever.
    /// False where alpha is 1 there, even of a black one. `None` goes by what is there: alpha is 1 in front of a
    /// dome and 0 in front of nothing.
    pub film_transparent: Option<bool>,
    /// Roughness up to which a transparent film is so seen through glass, too; `None` for no glass.
    pub transparent_glass: Option<f64>,
    /// How many surfaces fewer than a path a shadow ray passes unscattered: Cycles before 5.0 lets it pass one fewer.
    pub fewer_in_shadow: u32,
    /// Opacity from which on a surface is what normal, UV, depth, position and index passes show; thinner ones
    /// are looked through. 0 for the first surface, whatever it is.
    pub pass_alpha_threshold: f64,
    /// Names of passes (`PASSES`), in the order of the file; of several pictures those of the ones that are framed as
    /// the first.
    pub passes: Vec<Arc<str>>,
    /// AOVs that materials may fill, in the order of the file, each name once.
    pub aovs: Vec<AovDesc>,
    /// Where the file wants its picture, the first one.
    pub product: Option<Arc<str>>,
    /// Where in the file that is said.
    pub product_place: Place,
    /// Each of its pictures, where it wants more than one.
    pub products: Vec<ProductDesc>,
}

/// One of several pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct ProductDesc {
    /// Where the file wants it.
    pub name: Arc<str>,
    /// Where in the file that is said.
    pub place: Place,
    /// Its passes, as `RenderDesc::passes`.
    pub passes: Vec<Arc<str>>,
    /// What it shows.
    pub framing: FramingDesc,
}

impl Default for RenderDesc {
    fn default() -> Self {
        Self {
            framing: FramingDesc::default(),
            crop: None,
            film_transparent: None,
            transparent_glass: None,
            fewer_in_shadow: 0,
            pass_alpha_threshold: 0.5,
            passes: Vec::new(),
            aovs: Vec::new(),
            product: None,
            product_place: Place::default(),
            products: Vec::new(),
        }
    }
}

impl RenderDesc {
    /// The part of a picture of `whole` pixels that is wanted: its upper left pixel, and width and height.
    pub fn part(&self, whole: [u32; 2]) -> Option<([i32; 2], [u32; 2])> {
        if let Some([left, top, width, height]) = self.crop {
            return Some(([left, top].map(|n| i32::try_from(n).unwrap_or(i32::MAX)), [width, height]));
        }
        let [left, top, right, bottom] = self.framing.window?;
        // The first pixel whose centre is not before the edge.
        let pixel = |edge: f64, count: u32| (edge * f64::from(count) - 0.5).ceil().clamp(-FAR, FAR) as i32;
        let (x, y) = (pixel(left, whole[0]), pixel(top, whole[1]));
        let size = [pixel(right, whole[0]) - x, pixel(bottom, whole[1]) - y];
        Some(([x, y], size.map(|n| n.max(0) as u32)))
    }
}

/// No picture has pixels farther from its corner.
const FAR: f64 = 1e9;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_has_the_pixels_whose_centres_are_within() {
        let framed = |window| FramingDesc { window: Some(window), ..FramingDesc::default() };
        let part = |window, whole| RenderDesc { framing: framed(window), ..RenderDesc::default() }.part(whole);
        assert_eq!(part([0.0, 0.0, 1.0, 1.0], [7, 5]), Some(([0, 0], [7, 5])));
        assert_eq!(part([0.25, 0.5, 1.0, 1.0], [8, 4]), Some(([2, 2], [6, 2])));
        // Centres at 0.5, 1.5, 2.5 and 3.5 of 4.
        assert_eq!(part([0.2, 0.1, 0.6, 0.9], [4, 4]), Some(([1, 0], [1, 4])));
        assert_eq!(part([0.2, 0.2, 0.3, 0.3], [4, 4]), Some(([1, 1], [0, 0])));
        // Beyond the frame.
        assert_eq!(part([-0.5, 0.0, 1.25, 1.5], [8, 4]), Some(([-4, 0], [14, 6])));
        let crop = Some([1, 2, 3, 4]);
        let both = RenderDesc { crop, framing: framed([0.0; 4]), ..RenderDesc::default() };
        assert_eq!(both.part([9, 9]), Some(([1, 2], [3, 4])));
    }
}
