//! UsdLux lights to `LightDesc`.

use super::images::Images;
use super::stage::Reading;
use super::walk::Placed;
use crate::desc::LightDesc;

/// True for the schemas of lights with a shape of their own or none; meshes and volumes with LightAPI are
/// shapes that emit.
pub(super) fn is_light(_kind: &str) -> bool {
    false
}

/// The light at `placed`; `None`, with a warning, for one that is not rendered.
pub(super) fn read(_reading: &Reading<'_>, _placed: &Placed, _images: &mut Images) -> Option<LightDesc> {
    None
}
