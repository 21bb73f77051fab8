//! Magic: sines of sines, a turbulence of colours.

use std::f32::consts::TAU;

use crate::math::Vec3;

/// What is picked for a magic texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Magic {
    /// How often sines are taken of sines, 0 to 10.
    pub depth: u8,
}

impl Magic {
    /// The colour at a position; the factor is the mean of its channels.
    pub fn color(&self, p: Vec3, scale: f32, distortion: f32) -> [f32; 3] {
        // One period is enough, and keeps far positions precise.
        let [px, py, pz] = p.to_array().map(|c| c % TAU);
        let mut x = ((px + py + pz) * 5.0 * scale).sin();
        let mut y = ((-px + py - pz) * 5.0 * scale).cos();
        let mut z = -((-px - py + pz) * 5.0 * scale).cos();
        if self.depth > 0 {
            x *= distortion;
            y *= distortion;
            z *= distortion;
        }
        for step in 0..self.depth {
            match step {
                0 => y = -(x - y + z).cos() * distortion,
                1 => x = (x - y - z).cos() * distortion,
                2 => z = (-x - y - z).sin() * distortion,
                3 => x = -(-x + y - z).cos() * distortion,
                4 => y = -(-x + y + z).sin() * distortion,
                5 => y = -(-x + y + z).cos() * distortion,
                6 => x = (x + y + z).cos() * distortion,
                7 => z = (x + y - z).sin() * distortion,
                8 => x = -(-x - y + z).cos() * distortion,
                9 => y = -(x - y + z).sin() * distortion,
                _ => break,
            }
        }
        let range = if distortion == 0.0 { 1.0 } else { distortion * 2.0 };
        [x, y, z].map(|c| 0.5 - c / range)
    }

    /// The mean of the colour's channels.
    pub fn factor(&self, p: Vec3, scale: f32, distortion: f32) -> f32 {
        let [r, g, b] = self.color(p, scale, distortion);
        (r + g + b) * (1.0 / 3.0)
    }
}
