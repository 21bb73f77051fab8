//! Cells around a place, each with a point and a colour.

use crate::texture::procedural::hash::{pcg2, pcg3, pcg4, unit};
use crate::texture::procedural::round::{floor, to_int};

/// The grid of cells as seen from the cell that a place lies in.
pub struct Cells<const N: usize, const PCG: bool> {
    /// The cell's lower corner.
    pub corner: [f32; N],
    /// The place, from that corner.
    pub inside: [f32; N],
    /// How far points stray from their cell's corner.
    pub randomness: f32,
    cell: [i32; N],
}

impl<const N: usize, const PCG: bool> Cells<N, PCG> {
    /// The grid around `p`, its points straying by `randomness` of a cell.
    pub fn new(p: [f32; N], randomness: f32) -> Self {
        let corner = p.map(floor);
        let inside = std::array::from_fn(|axis| p[axis] - corner[axis]);
        Self { corner, inside, cell: corner.map(to_int), randomness }
    }

    /// The point of the cell `step` cells away, from this cell's corner.
    #[inline(always)]
    pub fn point(&self, step: [i32; N]) -> [f32; N] {
        let stray: [f32; N] = if N == 1 || !PCG { jenkins(self.far_corner(step)) } else { pcg(self.far_cell(step)) };
        std::array::from_fn(|axis| step[axis] as f32 + stray[axis] * self.randomness)
    }

    /// The colour of the cell `step` cells away.
    pub fn color(&self, step: [i32; N]) -> [f32; 3] {
        let (corner, cell) = (self.far_corner(step), self.far_cell(step));
        match N {
            1 => [unit([corner[0]]), unit([corner[0], 1.0]), unit([corner[0], 2.0])],
            2 if PCG => pcg3([cell[0], cell[1], 0]),
            2 => jenkins([corner[0], corner[1]]),
            3 | 4 if PCG => pcg(cell),
            3 => jenkins(corner),
            _ => {
                let [x, y, z, w] = [corner[0], corner[1], corner[2], corner[3]];
                [unit([x, y, z, w]), unit([z, x, w, y]), unit([w, z, y, x])]
            }
        }
    }

    #[inline(always)]
    fn far_corner(&self, step: [i32; N]) -> [f32; N] {
        std::array::from_fn(|axis| self.corner[axis] + step[axis] as f32)
    }

    #[inline(always)]
    fn far_cell(&self, step: [i32; N]) -> [i32; N] {
        std::array::from_fn(|axis| self.cell[axis].wrapping_add(step[axis]))
    }
}

/// `M` numbers from 0 to 1 for a cell of whole numbers.
#[inline(always)]
fn pcg<const N: usize, const M: usize>(cell: [i32; N]) -> [f32; M] {
    let mut all = [0.0; 4];
    match N {
        2 => all[..2].copy_from_slice(&pcg2([cell[0], cell[1]])),
        3 => all[..3].copy_from_slice(&pcg3([cell[0], cell[1], cell[2]])),
        _ => all = pcg4([cell[0], cell[1], cell[2], cell[3]]),
    }
    std::array::from_fn(|i| all[i])
}

/// `M` numbers from 0 to 1 for a cell by its corner.
#[inline(always)]
fn jenkins<const N: usize, const M: usize>(corner: [f32; N]) -> [f32; M] {
    std::array::from_fn(|i| match (N, i) {
        (_, 0) => unit(corner),
        (2, _) => unit([corner[0], corner[1], i as f32]),
        (3, _) => unit([corner[0], corner[1], corner[2], i as f32]),
        // Four coordinates fill the hash: they are turned around instead.
        _ => unit(std::array::from_fn::<f32, 4, _>(|axis| corner[(axis + 4 - i) % 4])),
    })
}

/// Steps to the cells around in four dimensions, the first axis fastest. The first 3 or 9 or 27 serve
/// fewer dimensions.
const STEPS: [[i32; 4]; 81] = {
    let mut steps = [[0; 4]; 81];
    let mut i = 0;
    while i < 81 {
        steps[i] = [i as i32 % 3 - 1, i as i32 / 3 % 3 - 1, i as i32 / 9 % 3 - 1, i as i32 / 27 - 1];
        i += 1;
    }
    steps
};

/// Steps to the cells around and to the own cell, the first axis fastest.
pub fn steps<const N: usize>() -> impl Iterator<Item = [i32; N]> {
    STEPS[..3_usize.pow(N as u32)].iter().map(|step| std::array::from_fn(|axis| step[axis]))
}
