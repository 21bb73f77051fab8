//! The fuzzer's corpus (`fuzz/`) once more: its seeds, and what it and the mutations found.
//!
//! `rich.usda` has something of everything; usd-core wrote `rich.usdc` (`Sdf.Layer.Export`) and `rich.usdz`
//! (`Sdf.ZipFileWriter`, with its texture and profile) of it.

use std::path::PathBuf;

use penumbra::desc::RoundsDesc;
use penumbra::import::ImportOptions;

use super::{Loaded, at_frame, try_load};

/// A file of the corpus.
pub fn corpus() -> PathBuf {
    [env!("CARGO_MANIFEST_DIR"), "tests/data/usd/corpus"].iter().collect()
}

#[test]
fn the_fuzzers_corpus_does_no_harm() {
    let mut count = 0;
    for entry in std::fs::read_dir(corpus()).unwrap() {
        let path = entry.unwrap().path();
        if !path.extension().is_some_and(|ext| ext.to_string_lossy().starts_with("usd")) {
            continue;
        }
        for options in [ImportOptions::default(), at_frame(7.5)] {
            let _ = try_load(&path, &options);
        }
        count += 1;
    }
    assert!(count >= 3, "{count} files");
}

#[test]
fn the_rich_stage_is_the_same_in_all_its_forms() {
    let load = |name: &str| try_load(&corpus().join(name), &at_frame(7.5)).unwrap();
    let (text, binary, package) = (load("rich.usda"), load("rich.usdc"), load("rich.usdz"));
    for other in [&binary, &package] {
        assert_eq!(other.paths(), text.paths());
        assert_eq!(other.scene.materials.len(), text.scene.materials.len());
        assert_eq!(other.scene.lights.len(), text.scene.lights.len());
        let rounds = |loaded: &Loaded| {
            let of = |r: &RoundsDesc| (r.points.clone(), r.radii.clone(), r.strands.clone(), r.colors.clone());
            loaded.scene.rounds.iter().map(|r| of(r)).collect::<Vec<_>>()
        };
        assert_eq!(rounds(other), rounds(&text));
    }
    // Three prims of curves without normals, and points.
    assert!(text.scene.rounds.len() >= 4, "{}", text.scene.rounds.len());
    assert!(text.paths().len() >= 24 && text.scene.lights.len() >= 6, "{:?}", text.paths());
}
