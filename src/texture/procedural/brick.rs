//! Brick: rows of bricks with mortar between, each brick with a tint of its own.

use crate::math::Vec3;

use super::round::{cell, saturate, smoothstep};

/// What is picked for a brick texture. A frequency of 0 in either place makes all rows alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Brick {
    /// Shift of every `offset_frequency`th row, in widths of a brick.
    pub offset: f32,
    /// Every how many rows are shifted.
    pub offset_frequency: u32,
    /// Width of bricks in every `squash_frequency`th row, relative to the others.
    pub squash: f32,
    /// Every how many rows are squashed.
    pub squash_frequency: u32,
}

/// What can be linked to a brick texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrickSockets {
    /// Frequency of the whole pattern.
    pub scale: f32,
    /// Width of the mortar on each side of a brick's edge.
    pub mortar_size: f32,
    /// Share of the mortar over which it fades into the brick.
    pub mortar_smooth: f32,
    /// Added to every brick's tint.
    pub bias: f32,
    /// Width of a brick.
    pub brick_width: f32,
    /// Height of a row.
    pub row_height: f32,
}

/// A brick texture at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrickValue {
    /// Mix of the brick's two colours, 0 to 1.
    pub tint: f32,
    /// How much mortar shows, 0 to 1: the factor.
    pub mortar: f32,
}

impl Brick {
    /// Tint and mortar at a position.
    pub fn value(&self, p: Vec3, sockets: &BrickSockets) -> BrickValue {
        let p = p * sockets.scale;
        let row = cell(p.y / sockets.row_height);
        let (mut width, mut shift) = (sockets.brick_width, 0.0);
        if self.offset_frequency > 0 && self.squash_frequency > 0 {
            if i64::from(row) % i64::from(self.squash_frequency) == 0 {
                width *= self.squash;
            }
            if i64::from(row) % i64::from(self.offset_frequency) == 0 {
                shift = width * self.offset;
            }
        }
        let brick = cell((p.x + shift) / width);
        let x = (p.x + shift) - width * brick as f32;
        let y = p.y - sockets.row_height * row as f32;
        let edge = x.min(y).min((width - x).min(sockets.row_height - y));
        let mortar = if edge >= sockets.mortar_size {
            0.0
        } else if sockets.mortar_smooth == 0.0 {
            1.0
        } else {
            smoothstep((1.0 - edge / sockets.mortar_size) / sockets.mortar_smooth)
        };
        let number = ((row as u32) << 16).wrapping_add(brick as u32 & 0xffff);
        BrickValue { tint: saturate(tint(number) + sockets.bias), mortar }
    }
}

impl BrickValue {
    /// The colour of bricks between `color1` and `color2` in `mortar`.
    pub fn color(&self, color1: [f32; 3], color2: [f32; 3], mortar: [f32; 3]) -> [f32; 3] {
        std::array::from_fn(|c| {
            // Where mortar is all there is, the tint has no part, whatever it is.
            let brick =
                if self.mortar == 1.0 { color1[c] } else { (1.0 - self.tint) * color1[c] + self.tint * color2[c] };
            brick * (1.0 - self.mortar) + mortar[c] * self.mortar
        })
    }
}

/// A number from 0 to 1 for a brick: Hugo Elias' integer noise.
fn tint(n: u32) -> f32 {
    let n = n.wrapping_add(1013) & 0x7fff_ffff;
    let n = (n >> 13) ^ n;
    let n = n.wrapping_mul(n.wrapping_mul(n).wrapping_mul(60_493).wrapping_add(19_990_303)).wrapping_add(1_376_312_589);
    0.5 * ((n & 0x7fff_ffff) as f32 / 1_073_741_824.0)
}
