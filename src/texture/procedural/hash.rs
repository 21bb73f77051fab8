//! Hashes that scatter values over cells. Pictures agree with Cycles only if these agree bit by bit.
//!
//! `lookup3`: Bob Jenkins: *lookup3.c*, 2006, public domain, `hashword` with initial value 0.
//! `pcg`: Mark Jarzynski, Marc Olano: *Hash Functions for GPU Rendering*, JCGT 9(3), 2020, `pcg2d` to
//! `pcg4d`; Cycles shifts with sign and drops the top bit.

/// Jenkins' hash of up to four words.
pub const fn lookup3<const N: usize>(key: [u32; N]) -> u32 {
    let start = 0xdead_beef_u32.wrapping_add((N as u32) << 2).wrapping_add(13);
    let (mut a, mut b, mut c) = (start.wrapping_add(key[0]), start, start);
    if N > 1 {
        b = b.wrapping_add(key[1]);
    }
    if N > 2 {
        c = c.wrapping_add(key[2]);
    }
    if N > 3 {
        a = a.wrapping_sub(c) ^ c.rotate_left(4);
        c = c.wrapping_add(b);
        b = b.wrapping_sub(a) ^ a.rotate_left(6);
        a = a.wrapping_add(c);
        c = c.wrapping_sub(b) ^ b.rotate_left(8);
        b = b.wrapping_add(a);
        a = a.wrapping_sub(c) ^ c.rotate_left(16);
        c = c.wrapping_add(b);
        b = b.wrapping_sub(a) ^ a.rotate_left(19);
        a = a.wrapping_add(c);
        c = c.wrapping_sub(b) ^ b.rotate_left(4);
        b = b.wrapping_add(a);
        a = a.wrapping_add(key[3]);
    }
    c = (c ^ b).wrapping_sub(b.rotate_left(14));
    a = (a ^ c).wrapping_sub(c.rotate_left(11));
    b = (b ^ a).wrapping_sub(a.rotate_left(25));
    c = (c ^ b).wrapping_sub(b.rotate_left(16));
    a = (a ^ c).wrapping_sub(c.rotate_left(4));
    b = (b ^ a).wrapping_sub(a.rotate_left(14));
    (c ^ b).wrapping_sub(b.rotate_left(24))
}

/// Hash of the bits of floats, as a number from 0 to 1.
pub const fn unit<const N: usize>(key: [f32; N]) -> f32 {
    let mut bits = [0; N];
    let mut i = 0;
    while i < N {
        bits[i] = key[i].to_bits();
        i += 1;
    }
    lookup3(bits) as f32 * (1.0 / 4_294_967_296.0)
}

const PCG_MUL: i32 = 1_664_525;
const PCG_ADD: i32 = 1_013_904_223;

/// 31 bits as a number from 0 to 1.
#[inline(always)]
fn from_31_bits(v: i32) -> f32 {
    (v & 0x7fff_ffff) as f32 * (1.0 / 2_147_483_648.0)
}

/// Two numbers from 0 to 1 for a cell of the plane.
#[inline(always)]
pub fn pcg2(cell: [i32; 2]) -> [f32; 2] {
    let [x, y] = cell.map(|v| v.wrapping_mul(PCG_MUL).wrapping_add(PCG_ADD));
    let x = x.wrapping_add(y.wrapping_mul(PCG_MUL));
    let y = y.wrapping_add(x.wrapping_mul(PCG_MUL));
    let [x, y] = [x, y].map(|v| v ^ (v >> 16));
    let x = x.wrapping_add(y.wrapping_mul(PCG_MUL));
    let y = y.wrapping_add(x.wrapping_mul(PCG_MUL));
    [x, y].map(from_31_bits)
}

/// Three numbers from 0 to 1 for a cell of space.
#[inline(always)]
pub fn pcg3(cell: [i32; 3]) -> [f32; 3] {
    let stir = |[x, y, z]: [i32; 3]| {
        let x = x.wrapping_add(y.wrapping_mul(z));
        let y = y.wrapping_add(z.wrapping_mul(x));
        let z = z.wrapping_add(x.wrapping_mul(y));
        [x, y, z]
    };
    let v = stir(cell.map(|v| v.wrapping_mul(PCG_MUL).wrapping_add(PCG_ADD)));
    stir(v.map(|v| v ^ (v >> 16))).map(from_31_bits)
}

/// Four numbers from 0 to 1 for a cell of space and `w`.
#[inline(always)]
pub fn pcg4(cell: [i32; 4]) -> [f32; 4] {
    let stir = |[x, y, z, w]: [i32; 4]| {
        let x = x.wrapping_add(y.wrapping_mul(w));
        let y = y.wrapping_add(z.wrapping_mul(x));
        let z = z.wrapping_add(x.wrapping_mul(y));
        let w = w.wrapping_add(y.wrapping_mul(z));
        [x, y, z, w]
    };
    let v = stir(cell.map(|v| v.wrapping_mul(PCG_MUL).wrapping_add(PCG_ADD)));
    stir(v.map(|v| v ^ (v >> 16))).map(from_31_bits)
}
