//! Any bytes through the glTF door: an error or a scene that keeps its own rules, never a panic.
//!
//! `cargo +nightly fuzz run gltf fuzz/corpus/gltf tests/data/gltf/corpus -- -dict=fuzz/gltf.dict`; what it finds that
//! is new goes, minimised (`cargo fuzz cmin`), to `tests/data/gltf/corpus`, which the tests replay.

#![no_main]

use libfuzzer_sys::fuzz_target;
use penumbra::error::{Place, Warnings};
use penumbra::import::{ImportOptions, gltf};

fuzz_target!(|data: &[u8]| {
    for frame in [None, Some(7.5)] {
        let options = ImportOptions { frame, ..ImportOptions::default() };
        let mut warnings = Warnings::new();
        if let Ok(scene) = gltf::from_bytes(data, None, &Place::default(), &options, &mut warnings) {
            penumbra::desc::check(&scene).expect("the door keeps the rules of SceneDesc");
        }
    }
});
