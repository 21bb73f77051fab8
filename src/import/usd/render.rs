//! UsdRender settings to `RenderDesc`.

use super::stage::Reading;
use crate::desc::RenderDesc;

/// What the stage says of its own render.
pub(super) fn read(_reading: &Reading<'_>) -> RenderDesc {
    RenderDesc::default()
}
