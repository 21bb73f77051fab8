//! What a file says of how it wants to be rendered.

use std::sync::Arc;

/// Settings of a render as authored (UsdRender's RenderSettings); what is `None` or empty is not
/// authored, and what the user sets comes first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderDesc {
    /// Path or name of the camera.
    pub camera: Option<Arc<str>>,
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    /// Names of passes (`PASSES`), in the order of the file.
    pub passes: Vec<Arc<str>>,
    /// Where the file wants its picture.
    pub product: Option<Arc<str>>,
}
