//! What a file says of how it wants to be rendered.

use std::sync::Arc;

use super::AovDesc;
use crate::error::Place;

/// Settings of a render as authored (UsdRender's RenderSettings); what is `None` or empty is not
/// authored, and what the user sets comes first.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDesc {
    /// Path or name of the camera.
    pub camera: Option<Arc<str>>,
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Width of a pixel over its height.
    pub pixel_aspect: f64,
    /// What a picture of another shape than the camera's frame shows.
    pub conform: Conform,
    /// The part of the picture that is wanted: left, top, width and height in pixels.
    pub crop: Option<[u32; 4]>,
    /// The same in shares of the picture, whatever its size: left, top, right and lower edge, 0 to 1. The pixels
    /// are those whose centres are within. `crop` goes before it.
    pub window: Option<[f64; 4]>,
    /// True where the background is not seen by the camera: alpha is 0 there, and the environment pass is as ever.
    /// False where alpha is 1 there, even of a black one. `None` goes by what is there: alpha is 1 in front of a
    /// dome and 0 in front of nothing.
    pub film_transparent: Option<bool>,
    /// Roughness up to which a transparent film is so seen through glass, too; `None` for no glass.
    pub transparent_glass: Option<f64>,
    /// Opacity from which on a surface is what normal, UV, depth, position and index passes show; thinner ones
    /// are looked through. 0 for the first surface, whatever it is.
    pub pass_alpha_threshold: f64,
    /// Names of passes (`PASSES`), in the order of the file.
    pub passes: Vec<Arc<str>>,
    /// AOVs that materials may fill, in the order of the file, each name once.
    pub aovs: Vec<AovDesc>,
    /// Where the file wants its picture, the first one.
    pub product: Option<Arc<str>>,
    /// Where in the file that is said.
    pub product_place: Place,
    /// Each of its pictures, where it wants more than one of the same view; `passes` are those of all.
    pub products: Vec<ProductDesc>,
}

/// One of several pictures of a view.
#[derive(Clone, Debug, PartialEq)]
pub struct ProductDesc {
    /// Where the file wants it.
    pub name: Arc<str>,
    /// Where in the file that is said.
    pub place: Place,
    /// Its passes, as `RenderDesc::passes`.
    pub passes: Vec<Arc<str>>,
}

impl Default for RenderDesc {
    fn default() -> Self {
        Self {
            camera: None,
            resolution: None,
            pixel_aspect: 1.0,
            conform: Conform::Expand,
            crop: None,
            window: None,
            film_transparent: None,
            transparent_glass: None,
            pass_alpha_threshold: 0.5,
            passes: Vec::new(),
            aovs: Vec::new(),
            product: None,
            product_place: Place::default(),
            products: Vec::new(),
        }
    }
}

/// What a picture of another shape than the camera's frame shows (UsdRender's `aspectRatioConformPolicy`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conform {
    /// All of the frame, and more on two sides.
    #[default]
    Expand,
    /// Nothing but the frame, less of it on two sides.
    Crop,
    /// The frame's height, and the width that follows.
    Width,
    /// The frame's width, and the height that follows.
    Height,
    /// The frame, with pixels of another shape.
    Pixels,
}

impl RenderDesc {
    /// The part of a picture of `whole` pixels that is wanted: left, top, width and height.
    pub fn part(&self, whole: [u32; 2]) -> Option<[u32; 4]> {
        if self.crop.is_some() {
            return self.crop;
        }
        let [left, top, right, bottom] = self.window?;
        // The first pixel whose centre is not before the edge.
        let pixel = |edge: f64, count: u32| (edge * f64::from(count) - 0.5).ceil().clamp(0.0, f64::from(count)) as u32;
        let (x, y) = (pixel(left, whole[0]), pixel(top, whole[1]));
        let width = pixel(right, whole[0]).saturating_sub(x);
        Some([x, y, width, pixel(bottom, whole[1]).saturating_sub(y)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_has_the_pixels_whose_centres_are_within() {
        let part = |window, whole| RenderDesc { window: Some(window), ..RenderDesc::default() }.part(whole);
        assert_eq!(part([0.0, 0.0, 1.0, 1.0], [7, 5]), Some([0, 0, 7, 5]));
        assert_eq!(part([0.25, 0.5, 1.0, 1.0], [8, 4]), Some([2, 2, 6, 2]));
        // Centres at 0.5, 1.5, 2.5 and 3.5 of 4.
        assert_eq!(part([0.2, 0.1, 0.6, 0.9], [4, 4]), Some([1, 0, 1, 4]));
        assert_eq!(part([0.2, 0.2, 0.3, 0.3], [4, 4]), Some([1, 1, 0, 0]));
        let crop = Some([1, 2, 3, 4]);
        let both = RenderDesc { crop, window: Some([0.0; 4]), ..RenderDesc::default() };
        assert_eq!(both.part([9, 9]), crop);
    }
}
