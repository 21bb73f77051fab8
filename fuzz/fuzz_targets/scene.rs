//! Any scene through preparation and every pass: an error or a picture of numbers, never a panic.
//!
//! `cargo +nightly fuzz run scene fuzz/corpus/scene tests/data/scene/corpus`; what it finds that is new goes, minimised
//! (`cargo fuzz cmin`), to `tests/data/scene/corpus`, which the tests replay.

#![no_main]

#[path = "../../tests/support/scene.rs"]
#[allow(dead_code, reason = "each user takes a part")]
mod scene;
#[path = "../../tests/support/wild.rs"]
mod wild;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| wild::hold(data));
