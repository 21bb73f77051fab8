//! Gradient noise in one to four dimensions.
//!
//! Ken Perlin: *Improving Noise*, SIGGRAPH 2002 (quintic fade, gradients to the edges of a cube), with
//! Stefan Gustavson's gradients in one, two and four dimensions (`sdnoise1234`, public domain), lookup3
//! in place of the permutation table, and the scales of Open Shading Language that bring the range near
//! -1 to 1.

use super::hash::lookup3;
use super::round::{floor, fused, mix, to_int, trunc};

/// Brings the noise of each number of dimensions to about -1 to 1.
const SCALE: [f32; 4] = [0.25, 0.6616, 0.982, 0.8344];

/// Noise repeats after this distance on each axis, so that far coordinates keep some precision.
const PERIOD: f32 = 100_000.0;

/// Coordinates from here on have no fraction left worth the name, and noise is 0 at whole numbers: they
/// are moved to the middle of a cell.
const COARSE: f32 = 1_000_000.0;

/// Noise from about -1 to 1.
pub fn signed<const N: usize>(p: [f32; N]) -> f32 {
    let [noise] = perlin(p.map(repeat::<N>));
    SCALE[N - 1] * noise
}

/// Three of them, of which the first is that of [`signed`] in two and three dimensions: Open Shading Language's noise of
/// vectors, whose gradients go by a byte each of the hash.
pub fn signed_vector<const N: usize>(p: [f32; N]) -> [f32; 3] {
    perlin::<N, 3>(p.map(repeat::<N>)).map(|noise| SCALE[N - 1] * noise)
}

/// `x` brought into the period.
fn repeat<const N: usize>(x: f32) -> f32 {
    if x.abs() < PERIOD {
        return x;
    }
    // In three and four dimensions Cycles takes the remainder by a rounded quotient.
    let wrapped = if N < 3 { x % PERIOD } else { fused(-trunc(x / PERIOD), PERIOD, x) };
    wrapped + if x.abs() >= COARSE { 0.5 } else { 0.0 }
}

fn perlin<const N: usize, const C: usize>(p: [f32; N]) -> [f32; C] {
    let low = p.map(floor);
    let cell = low.map(to_int);
    let mut inside = p;
    for (inside, low) in inside.iter_mut().zip(low) {
        *inside -= low;
    }
    // Bit d of a corner's number is its step along axis d.
    let mut values = [[0.0; C]; 16];
    for (corner, value) in values.iter_mut().enumerate().take(1 << N) {
        let (mut key, mut from_corner) = ([0; N], inside);
        for d in 0..N {
            let step = (corner >> d & 1) as u32;
            key[d] = (cell[d] as u32).wrapping_add(step);
            from_corner[d] -= step as f32;
        }
        let hash = lookup3(key);
        *value = std::array::from_fn(|channel| gradient(hash >> (8 * channel), from_corner));
    }
    for (d, inside) in inside.iter().enumerate() {
        let t = fade(*inside);
        for i in 0..1 << (N - 1 - d) {
            values[i] = std::array::from_fn(|channel| mix(values[2 * i][channel], values[2 * i + 1][channel], t));
        }
    }
    values[0]
}

/// The quintic with vanishing first and second derivatives at 0 and 1.
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// Dot product of the gradient picked by `hash` with the offset from the corner.
fn gradient<const N: usize>(hash: u32, p: [f32; N]) -> f32 {
    let negate = |x: f32, bit: u32| f32::from_bits(x.to_bits() ^ (hash >> bit & 1) << 31);
    match N {
        1 => negate((1 + (hash & 7)) as f32, 3) * p[0],
        2 => {
            let steep = hash & 7 < 4;
            let (u, v) = if steep { (p[0], p[1]) } else { (p[1], p[0]) };
            negate(u, 0) + negate(2.0 * v, 1)
        }
        3 => {
            let h = hash & 15;
            let u = if h < 8 { p[0] } else { p[1] };
            let x_or_z = if h == 12 || h == 14 { p[0] } else { p[2] };
            let v = if h < 4 { p[1] } else { x_or_z };
            negate(u, 0) + negate(v, 1)
        }
        _ => {
            let h = hash & 31;
            let u = if h < 24 { p[0] } else { p[1] };
            let v = if h < 16 { p[1] } else { p[2] };
            let s = if h < 8 { p[2] } else { p[3] };
            negate(u, 0) + negate(v, 1) + negate(s, 2)
        }
    }
}
