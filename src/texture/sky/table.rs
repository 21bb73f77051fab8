//! A sky in XYZ by azimuth and height, mirrored about the sun.

use rayon::prelude::*;

use crate::math::Vec3;

/// Texels around the horizon.
pub const WIDTH: usize = 512;

/// Rows from the lowest up, texels by azimuth.
pub struct Table {
    texels: Vec<Vec3>,
    height: usize,
}

impl Table {
    /// Fills the half on one side of the sun by column and row, and mirrors it.
    pub fn new(height: usize, texel: impl Fn(usize, usize) -> Vec3 + Sync) -> Self {
        let mut texels = vec![Vec3::ZERO; WIDTH * height];
        texels.par_chunks_mut(WIDTH).enumerate().for_each(|(y, row)| {
            for x in 0..WIDTH / 2 {
                row[x] = texel(x, y);
                row[WIDTH - 1 - x] = row[x];
            }
        });
        Self { texels, height }
    }

    /// Bilinear between texel centres; `x` and `y` from 0 to 1, held at the edges.
    pub fn lookup(&self, x: f32, y: f32) -> Vec3 {
        let place = |x: f32, size: usize| {
            let x = x * size as f32 - 0.5;
            let low = x.floor();
            let hold = |i: f32| i.max(0.0).min((size - 1) as f32) as usize;
            (hold(low), hold(low + 1.0), x - low)
        };
        let ((x0, x1, tx), (y0, y1, ty)) = (place(x, WIDTH), place(y, self.height));
        let row = |y: usize| self.texels[y * WIDTH + x0] * (1.0 - tx) + self.texels[y * WIDTH + x1] * tx;
        row(y0) * (1.0 - ty) + row(y1) * ty
    }
}
