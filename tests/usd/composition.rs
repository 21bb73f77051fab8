//! What composition gives: layers, references, payloads, variants, classes, relocates.

use penumbra::import::ImportOptions;

use super::{at_frame, load, stage, try_load};

#[test]
fn arcs_bring_in_prims_and_retime_them() {
    let loaded = load("composition.usda", &at_frame(20.0));
    loaded.said_nothing();
    // OpenUSD's translations at time code 20.
    let expected = [
        // The sublayer at (20 − 10) / 2.
        ("/World/FromSublayer/T", [5.0, 1.0, 0.0]),
        ("/World/Referenced/T", [0.0, 1.0, 100.0]),
        // The reference at 20 − 13.
        ("/World/Retimed/T", [7.0, 1.0, 0.0]),
        // The payload at 20 / 4.
        ("/World/Payload/T", [5.0, 1.0, 0.0]),
        // A class is stronger than a reference, what is specialized is weaker.
        ("/World/Inherits/T", [7.0, 1.0, 0.0]),
        ("/World/Specializes/T", [0.0, 1.0, 100.0]),
        ("/World/Relocated/Away", [0.0, 1.0, 100.0]),
        // The reference defines it.
        ("/World/Over/T", [0.0, 1.0, 100.0]),
    ];
    for (path, origin) in expected {
        assert_eq!(loaded.origin(path), origin, "{path}");
    }
    // No class, nothing that is inactive or only an `over`.
    let mut paths = loaded.paths();
    paths.sort_unstable();
    let mut all = expected.map(|(path, _)| path);
    all.sort_unstable();
    assert_eq!(paths, all);
}

#[test]
fn names_are_those_of_prims_and_assets_those_of_components() {
    let loaded = load("composition.usda", &at_frame(20.0));
    let instance = loaded.one("/World/Retimed/T");
    assert_eq!((&*instance.name, &*instance.asset), ("T", "World"));
    let numbers: std::collections::BTreeSet<u32> = loaded.scene.instances.iter().map(|i| i.object_index).collect();
    assert_eq!(numbers.len(), loaded.scene.instances.len());
}

#[test]
fn the_command_line_selects_variants() {
    let select = |variants: &[&str]| ImportOptions {
        variants: variants.iter().map(|v| (*v).to_owned()).collect(),
        ..ImportOptions::default()
    };
    let origin = |variants: &[&str]| load("variants.usda", &select(variants)).origin("/Car/T");
    assert_eq!(origin(&[]), [1.0, 0.0, 0.0]);
    // OpenUSD's after SetVariantSelection.
    assert_eq!(origin(&["/Car{size=large}"]), [2.0, 3.0, 0.0]);
    // A set within a variant; in one argument or two.
    assert_eq!(origin(&["/Car{size=large}{trim=rich}"]), [2.0, 4.0, 0.0]);
    assert_eq!(origin(&["/Car{size=large}", "/Car{trim=rich}"]), [2.0, 4.0, 0.0]);
    let offered = load("variants.usda", &select(&[])).scene.variants;
    assert!(offered.contains(&"/Car{size=large}".to_owned()), "{offered:?}");
    let error = |variant: &str| match try_load(&stage("variants.usda"), &select(&[variant])) {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{variant} is taken"),
    };
    assert!(error("/Bus{size=large}").ends_with("there is no prim /Bus; / has Car"), "{}", error("/Bus{size=large}"));
    assert!(error("/Car{color=red}").ends_with("/Car has no variant set 'color'; it has size"));
    assert!(error("/Car{size=huge}").ends_with("variant set 'size' of /Car has no 'huge'; there are large, small"));
    assert!(error("large").ends_with("expected /Prim{set=choice}"));
    // Whatever the root layer is kept in.
    for name in ["variants.usdc", "variants.usdz"] {
        assert_eq!(load(name, &select(&["/Car{size=large}{trim=rich}"])).origin("/Car/T"), [2.0, 4.0, 0.0], "{name}");
    }
    // The file on disk is as it was.
    assert_eq!(origin(&[]), [1.0, 0.0, 0.0]);
}

#[test]
fn value_clips_give_their_samples() {
    // OpenUSD's, from one clip and the other.
    assert_eq!(load("clips.usda", &at_frame(5.0)).origin("/Clipped/T"), [5.0, 0.0, 0.0]);
    assert_eq!(load("clips.usda", &at_frame(15.0)).origin("/Clipped/T"), [0.0, 55.0, 0.0]);
}
