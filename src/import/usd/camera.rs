//! UsdGeomCamera to `CameraDesc`.

use super::stage::Reading;
use super::walk::Placed;
use crate::desc::CameraDesc;

/// The camera at `placed`; `None`, with a warning, for one that can't be looked through.
pub(super) fn read(_reading: &Reading<'_>, _placed: &Placed) -> Option<CameraDesc> {
    None
}
