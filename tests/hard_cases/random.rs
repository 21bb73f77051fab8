//! Random scenes that break every rule but those of indices: built and rendered without a panic, and without a number
//! that is none in a picture.
//!
//! `PENUMBRA_MUTATIONS=1000000` runs it for longer, `PENUMBRA_SEED` from another start; fuzz/fuzz_targets/scene.rs
//! searches by coverage, and what it found is in tests/data/scene/corpus.

#[path = "../support/rng.rs"]
#[allow(dead_code, reason = "each test binary uses a part")]
mod rng;
#[path = "../support/wild.rs"]
mod wild;

use rng::Rng;

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn whatever_is_built_renders() {
    let seed = number("PENUMBRA_SEED", 1);
    // What ends the process leaves its bytes here.
    let last = concat!(env!("CARGO_TARGET_TMPDIR"), "/wild");
    for i in 0..number("PENUMBRA_MUTATIONS", 2_000) {
        let mut rng = Rng(seed.wrapping_mul(1 << 32) + i);
        let data: Vec<u8> = (0..64 + rng.below(700)).map(|_| rng.below(256) as u8).collect();
        std::fs::write(last, &data).unwrap();
        let held = std::panic::catch_unwind(|| wild::hold(&data));
        assert!(held.is_ok(), "scene {i} of PENUMBRA_SEED={seed}");
    }
}

#[test]
fn what_the_fuzzer_found_renders() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/scene/corpus");
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let held = std::panic::catch_unwind(|| wild::hold(&std::fs::read(&path).unwrap()));
        assert!(held.is_ok(), "{}", path.display());
    }
}
