//! From XYZ to the rendering space.

use crate::math::{Rgb, Vec3};

/// Digits of the matrix from XYZ to linear Rec. 709 with white D65.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToRgb {
    /// Bruce Lindbloom's, in Blender up to 4.5.
    Blender4,
    /// From the primaries of ITU-R BT.709, in Blender from 5.0; up to 2.4e-4 from the other.
    Blender5,
}

impl ToRgb {
    /// Negative light is cut off.
    pub fn convert(self, xyz: Vec3) -> Rgb {
        let [r, g, b] = match self {
            Self::Blender4 => [
                [3.240_454_2, -1.537_138_5, -0.498_531_4],
                [-0.969_266, 1.876_010_8, 0.041_556],
                [0.055_643_4, -0.204_025_9, 1.057_225_2],
            ],
            Self::Blender5 => [
                [3.240_97, -1.537_383_2, -0.498_610_76],
                [-0.969_243_65, 1.875_967_5, 0.041_555_06],
                [0.055_630_08, -0.203_976_96, 1.056_971_5],
            ],
        };
        let dot = |row: [f32; 3]| Vec3::from(row).dot(xyz).max(0.0);
        Rgb::new(dot(r), dot(g), dot(b))
    }
}
