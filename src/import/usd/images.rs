//! Image files that a stage names: next to its layers, or inside of a `.usdz`.

use openusd::sdf;
use openusd::sdf::AssetPath;

use super::stage::Reading;
use crate::desc::{ColorSpace, ImageDesc};

/// Images read so far, each once for each colour space.
#[derive(Default)]
pub(super) struct Images {
    /// In the order of `SceneDesc::images`.
    pub images: Vec<ImageDesc>,
}

impl Images {
    /// Index of the image that `asset`, an attribute of the prim at `path`, names. `None`, with a warning,
    /// for one that can't be read.
    pub fn load(
        &mut self,
        _reading: &Reading<'_>,
        _path: &sdf::Path,
        _asset: &AssetPath,
        _space: ColorSpace,
    ) -> Option<u32> {
        None
    }
}
