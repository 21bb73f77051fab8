//! How an input of a material reaches its texture: which one, by which coordinates, under which affine map.

use super::lookup::Texture;
use crate::desc::{self, TextureTransform};

/// A texture as one input of a material uses it, ready for lookups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into the scene's textures.
    pub texture: u32,
    /// Which UV set of the mesh.
    pub uv_set: u32,
    /// Applied to the UV before the lookup.
    pub transform: UvTransform,
}

impl TextureRef {
    /// Linear color and alpha at the mesh's `uv` of [`Self::uv_set`]; `footprint` is in units of that UV.
    pub fn lookup(&self, textures: &[Texture], uv: [f32; 2], footprint: f32) -> [f32; 4] {
        textures[self.texture as usize].lookup(self.transform.apply(uv), self.transform.footprint(footprint))
    }
}

impl From<desc::TextureRef> for TextureRef {
    fn from(desc: desc::TextureRef) -> Self {
        Self { texture: desc.texture, uv_set: desc.uv_set, transform: desc.transform.into() }
    }
}

/// Rows of a 2×3 matrix, in `f32` for the render.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvTransform {
    rows: [[f32; 3]; 2],
    /// Largest singular value of the linear part: how much a footprint grows at most.
    stretch: f32,
}

impl UvTransform {
    /// Texture coordinates as they are.
    pub const IDENTITY: Self = Self { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], stretch: 1.0 };

    /// The mapped coordinates.
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        self.rows.map(|[a, b, c]| a * u + b * v + c)
    }

    /// Width of a footprint after the map; the wider axis counts.
    pub fn footprint(&self, width: f32) -> f32 {
        width * self.stretch
    }
}

impl From<TextureTransform> for UvTransform {
    fn from(TextureTransform(rows): TextureTransform) -> Self {
        let [[a, b, _], [c, d, _]] = rows;
        // Singular values of a 2×2 matrix: sqrt of (e + f) and (e - f), e half the sum of squares.
        let e = 0.5 * (a * a + b * b + c * c + d * d);
        let f = (e * e - (a * d - b * c).powi(2)).max(0.0).sqrt();
        Self { rows: rows.map(|row| row.map(|x| x as f32)), stretch: (e + f).sqrt() as f32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_points_and_footprints() {
        let (sin, cos) = 0.7_f64.sin_cos();
        // Scale by (3, 2), then rotate, then shift.
        let map = UvTransform::from(TextureTransform([[3.0 * cos, -2.0 * sin, 0.25], [3.0 * sin, 2.0 * cos, -1.0]]));
        let [u, v] = map.apply([1.0, 0.0]);
        assert!((f64::from(u) - (3.0 * cos + 0.25)).abs() < 1e-6 && (f64::from(v) - (3.0 * sin - 1.0)).abs() < 1e-6);
        assert!((map.footprint(0.5) - 1.5).abs() < 1e-6);
        assert_eq!(UvTransform::from(TextureTransform::IDENTITY), UvTransform::IDENTITY);
        let flat = UvTransform::from(TextureTransform([[0.0, 0.0, 0.5], [0.0, 0.0, 0.5]]));
        assert_eq!((flat.apply([9.0, -9.0]), flat.footprint(1.0)), ([0.5, 0.5], 0.0));
    }
}
