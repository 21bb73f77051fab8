//! The fuzzer's corpus (`fuzz/`) once more: its seeds, and what it finds worth keeping.

use penumbra::import::ImportOptions;

use super::read;

#[test]
fn the_fuzzers_corpus_does_no_harm() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/gltf/corpus");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let bytes = std::fs::read(entry.unwrap().path()).unwrap();
        for frame in [None, Some(7.5)] {
            let _ = read(&bytes, &ImportOptions { frame, ..ImportOptions::default() });
        }
        count += 1;
    }
    assert!(count >= 6, "{count} files");
}
