//! What a file says of how it wants to be rendered.

use std::sync::Arc;

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
    /// The part of the picture that is wanted: left, top, width and height in pixels.
    pub crop: Option<[u32; 4]>,
    /// The background is not seen by the camera: alpha is 0 there, and the environment pass is as ever.
    pub film_transparent: bool,
    /// Opacity from which on a surface is what normal, UV, depth, position and index passes show; thinner ones
    /// are looked through. 0 for the first surface, whatever it is.
    pub pass_alpha_threshold: f64,
    /// Names of passes (`PASSES`), in the order of the file.
    pub passes: Vec<Arc<str>>,
    /// Where the file wants its picture.
    pub product: Option<Arc<str>>,
}

impl Default for RenderDesc {
    fn default() -> Self {
        Self {
            camera: None,
            resolution: None,
            pixel_aspect: 1.0,
            crop: None,
            film_transparent: false,
            pass_alpha_threshold: 0.5,
            passes: Vec::new(),
            product: None,
        }
    }
}
