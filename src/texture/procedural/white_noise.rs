//! White noise: hashes of the coordinates' bits.

use crate::math::Vec3;

use super::Dimensions;
use super::hash::{lookup3, unit};

/// A number from 0 to 1 for each cell of whole coordinates x and y, or of all three: Open Shading Language's
/// `cellnoise`, which MaterialX shares.
pub fn cell(p: Vec3, dimensions: u8) -> f32 {
    let [x, y, z] = p.to_array().map(|x| x.floor() as i32 as u32);
    let hash = if dimensions < 3 { lookup3([x, y]) } else { lookup3([x, y, z]) };
    (f64::from(hash) / f64::from(u32::MAX)) as f32
}

/// What is picked for white noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WhiteNoise {
    /// Coordinates read.
    pub dimensions: Dimensions,
}

impl WhiteNoise {
    /// A number from 0 to 1.
    pub fn value(&self, p: Vec3, w: f32) -> f32 {
        match self.dimensions {
            Dimensions::One => unit([w]),
            Dimensions::Two => unit([p.x, p.y]),
            Dimensions::Three => unit([p.x, p.y, p.z]),
            Dimensions::Four => unit([p.x, p.y, p.z, w]),
        }
    }

    /// Three numbers from 0 to 1; the first is the value.
    pub fn color(&self, p: Vec3, w: f32) -> [f32; 3] {
        let (green, blue) = match self.dimensions {
            Dimensions::One => (unit([w, 1.0]), unit([w, 2.0])),
            Dimensions::Two => (unit([p.x, p.y, 1.0]), unit([p.x, p.y, 2.0])),
            Dimensions::Three => (unit([p.x, p.y, p.z, 1.0]), unit([p.x, p.y, p.z, 2.0])),
            Dimensions::Four => (unit([p.z, p.x, w, p.y]), unit([w, p.z, p.y, p.x])),
        };
        [self.value(p, w), green, blue]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash of MaterialX's `mx_noise.glsl`, worked out on its own.
    #[test]
    fn cells_are_those_of_materialx() {
        let of = |p: [f32; 3], dimensions| f64::from(cell(p.into(), dimensions));
        for (found, expected) in [
            (of([3.5, 7.25, 9.0], 2), 0.984_289_292_630),
            (of([-1.5, 0.75, 9.0], 2), 0.041_623_512_758),
            (of([3.0, 7.0, -0.5], 3), 0.145_173_044_443),
        ] {
            assert!((found - expected).abs() < 1e-7, "{found} is not {expected}");
        }
    }
}
