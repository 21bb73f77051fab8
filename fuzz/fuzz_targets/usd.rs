//! Any bytes through the USD door: an error or a scene that keeps its own rules, never a panic.
//!
//! `cargo +nightly fuzz run usd fuzz/corpus/usd tests/data/usd/corpus -- -dict=fuzz/usd.dict`; what it finds that
//! is new goes, minimised (`cargo fuzz cmin`), to `tests/data/usd/corpus`, which the tests replay.

#![no_main]

use libfuzzer_sys::fuzz_target;
use penumbra::error::Warnings;
use penumbra::import::{self, ImportOptions};

fuzz_target!(|data: &[u8]| {
    let ending = match data {
        [b'#', b'u', b's', b'd', b'a', ..] => "usda",
        [b'P', b'K', ..] => "usdz",
        _ => "usdc",
    };
    // A stage is a file, since its layers are found from there.
    let path = std::env::temp_dir().join(format!("penumbra-fuzz-{}.{ending}", std::process::id()));
    std::fs::write(&path, data).expect("a temporary file");
    for frame in [None, Some(7.5)] {
        let options = ImportOptions { frame, ..ImportOptions::default() };
        let mut warnings = Warnings::new();
        match import::scene(&path, &options, &mut warnings) {
            Ok(scene) => penumbra::desc::check(&scene).expect("the door keeps the rules of SceneDesc"),
            // The door makes an error of a panic; here it stays one.
            Err(error) => assert!(!error.to_string().contains("broke down"), "{error}"),
        }
    }
});
