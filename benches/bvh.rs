//! Rays per second against Embree.
fn main() {}
