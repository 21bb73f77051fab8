//! A thin sheet: what passes is scattered as if reflected and then mirrored to the other side, as
//! KHR_materials_transmission prescribes.

use crate::math::Vec3;

/// The direction on the other side of the sheet.
#[inline]
pub(super) fn mirrored(wi: Vec3) -> Vec3 {
    Vec3::new(wi.x, wi.y, -wi.z)
}
