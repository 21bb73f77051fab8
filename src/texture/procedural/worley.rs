//! Worley noise as MaterialX has it: one point in each cell of whole coordinates.
//!
//! Steven Worley: *A Cellular Texture Basis Function*, SIGGRAPH 1996; cells and their order are those of
//! `mx_worley_noise_vec3` of MaterialX 1.39 (`libraries/stdlib/genglsl/lib/mx_noise.glsl`), which looks at the
//! nearest ring of cells alone, so that points of a `jitter` above 1 are missed where they are farther.

use super::hash::lookup3;

/// Farther than any point.
const FAR: f32 = 1e6;

/// The nearest points to a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worley {
    /// Distances to the nearest, second and third point.
    pub distances: [f32; 3],
    /// Three numbers of 0 to 1 for the cell in which the nearest point lies.
    pub cell: [f32; 3],
    /// One number for it.
    pub number: f32,
}

/// The nearest points to `p`, in the plane or in space. With a `jitter` of 0 they are the middles of the cells, with 1
/// anywhere in them.
pub fn worley<const N: usize>(p: [f32; N], jitter: f32) -> Worley {
    let corner = p.map(|x| x.floor() as i32);
    let inside: [f32; N] = std::array::from_fn(|axis| p[axis] - p[axis].floor());
    let mut squares = [FAR; 3];
    let mut nearest = [0.0; N];
    // The last axis goes fastest: of points that are equally far the first counts.
    for ring in 0..3_usize.pow(N as u32) {
        let step: [i32; N] = std::array::from_fn(|axis| (ring / 3_usize.pow((N - 1 - axis) as u32) % 3) as i32 - 1);
        let random = cells(std::array::from_fn::<_, N, _>(|axis| corner[axis].wrapping_add(step[axis])));
        let off: [f32; N] =
            std::array::from_fn(|axis| step[axis] as f32 + (random[axis] - 0.5) * jitter + 0.5 - inside[axis]);
        let square = off.iter().map(|d| d * d).sum();
        if square < squares[0] {
            squares = [square, squares[0], squares[1]];
            nearest = off;
        } else if square < squares[1] {
            squares = [squares[0], square, squares[1]];
        } else if square < squares[2] {
            squares[2] = square;
        }
    }
    let cell = std::array::from_fn::<_, N, _>(|axis| (nearest[axis] + p[axis]).floor() as i32);
    Worley { distances: squares.map(f32::sqrt), cell: cells(cell), number: zero_to_one(lookup3(cell.map(word))) }
}

/// Three numbers of 0 to 1 for a cell.
fn cells<const N: usize>(cell: [i32; N]) -> [f32; 3] {
    std::array::from_fn(|i| {
        let i = i as u32;
        zero_to_one(match cell[..] {
            [x, y] => lookup3([word(x), word(y), i]),
            [x, y, z] => lookup3([word(x), word(y), word(z), i]),
            _ => 0,
        })
    })
}

fn word(x: i32) -> u32 {
    x as u32
}

fn zero_to_one(hash: u32) -> f32 {
    (f64::from(hash) / f64::from(u32::MAX)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of MaterialX's `mx_noise.glsl` (1.39), compiled as C++.
    #[test]
    fn points_are_those_of_materialx() {
        let close = |a: [f32; 3], b: [f32; 3]| {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-6), "{a:?} is not {b:?}");
        };
        let flat = worley([3.7, -1.3], 1.0);
        close(flat.distances, [0.362_642_65, 0.450_528_98, 0.611_646_3]);
        close(flat.cell, [0.464_804_8, 0.423_969_45, 0.644_834_3]);
        close([flat.number; 3], [0.170_778_23; 3]);
        let space = worley([0.3, -2.6, 7.45], 0.6);
        close(space.distances, [0.414_374_38, 0.550_835_7, 0.928_309]);
        close(space.cell, [0.423_922_1, 0.974_078_83, 0.431_719_07]);
        close([space.number; 3], [0.568_374_7; 3]);
    }

    #[test]
    fn without_jitter_points_are_the_middles_of_cells() {
        let found = worley([0.25, 0.5], 0.0);
        assert_eq!(found.distances, [0.25, 0.75, (0.25_f32 * 0.25 + 1.0).sqrt()]);
    }
}
