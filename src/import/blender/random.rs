//! The number of 0 to 1 that an object's material may ask for: Cycles' own.

/// Of an instance, by the id that Blender gives it.
pub fn of_id(id: u32) -> f64 {
    f64::from(id) / f64::from(u32::MAX)
}

/// Of an object that is no instance, by its name.
pub fn of_name(name: &str) -> f64 {
    let hash = name.bytes().fold(0_u32, |hash, byte| hash.wrapping_mul(37).wrapping_add(byte.into()));
    of_id(mixed(hash, 0))
}

/// Of a number, 0 to 1.
pub fn of_number(x: u32) -> f32 {
    let start = start_of(1);
    jenkins(start.wrapping_add(x), start, start) as f32 / u32::MAX as f32
}

/// Bob Jenkins' lookup3 of two words, <https://burtleburtle.net/bob/c/lookup3.c>.
fn mixed(x: u32, y: u32) -> u32 {
    let start = start_of(2);
    jenkins(start.wrapping_add(x), start.wrapping_add(y), start)
}

/// What lookup3 begins with for so many words.
fn start_of(words: u32) -> u32 {
    0xdead_beef_u32.wrapping_add(words << 2).wrapping_add(13)
}

fn jenkins(mut a: u32, mut b: u32, mut c: u32) -> u32 {
    let step = |to: u32, from: u32, by: u32| (to ^ from).wrapping_sub(from.rotate_left(by));
    c = step(c, b, 14);
    a = step(a, c, 11);
    b = step(b, a, 25);
    c = step(c, b, 16);
    a = step(a, c, 4);
    b = step(b, a, 14);
    step(c, b, 24)
}
