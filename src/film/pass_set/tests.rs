//! What lists of passes mean and call for.

use super::super::aov::AovKind;
use super::*;

fn set(list: &str) -> PassSet {
    PassSet::parse(list).expect("known")
}

fn groups(names: &[&str]) -> Vec<Arc<str>> {
    names.iter().map(|&name| name.into()).collect()
}

fn names(set: &PassSet) -> Vec<String> {
    set.iter().map(|chosen| chosen.name()).collect()
}

#[test]
fn lists_are_parsed() {
    assert_eq!(names(&set("")), ["combined"]);
    assert_eq!(names(&set(" AO , combined,ao")), ["combined", "ao"]);
    assert_eq!(names(&set("shadow")), ["shadow"]);
    let aov = Aov { name: "wet".into(), kind: AovKind::Value };
    let all = set("ao,all").resolve(&groups(&["key"]), &[aov]).expect("there");
    assert_eq!(names(&all).len(), PASSES.iter().filter(|pass| !pass.is_error()).count());
    let more = set("all,error_ao").resolve(&[], &[]).expect("there");
    assert!(names(&more).contains(&"error_ao".to_owned()) && names(&more).contains(&"shadow".to_owned()));
    assert_eq!(PassSet::default(), set("combined"));
}

#[test]
fn lists_come_back_as_they_are_typed() {
    for list in ["combined,ao", "combined_fill,combined_key,shadow_*", "depth,shadow_a b.c"] {
        assert_eq!(set(list).to_string(), list);
    }
    assert_eq!(set("shadow_key,Shadow_*,shadow_fill").to_string(), "shadow_*");
    assert_eq!(set(&PassSet::all().to_string()), PassSet::all());
}

#[test]
fn an_unknown_pass_is_told_with_the_known() {
    let message = PassSet::parse("ao,shadows").expect_err("unknown");
    assert!(message.contains("'shadows'") && message.contains("shadow,") && message.contains("crypto_asset"));
    assert!(PassSet::parse("shadow_").expect_err("no group").contains("shadow_<group>"));
}

#[test]
fn samples_are_dealt_only_where_an_error_is_asked_for() {
    use crate::film::Quantity;
    for list in ["combined,ao,shadow,sample_count", "all"] {
        let plain = set(list);
        assert!(!plain.has_error() && plain.sequence_place(9) == 9, "{list}");
    }
    for list in ["error", "error_ao", "error_shadow", "error_trust"] {
        assert_eq!(set(list).sequence_place(9), 1 << 32 | 1, "{list}");
    }
    assert!(set("error").has_error() && set("error_trust").has_error() && !set("error_ao").has_error());
    let asked = set("ao").with_error();
    assert!(asked.has_error() && asked.needs(Quantity::Combined) && names(&asked) == ["ao"]);
    assert!(set("error").with_catchers().replicated().contains(Quantity::CatcherLit));
    assert!(!set("combined").with_catchers().replicated().contains(Quantity::CatcherLit));
}

#[test]
fn groups_are_those_of_the_scene() {
    let there = groups(&["fill", "key", "rim.001"]);
    let resolve = |list: &str| set(list).resolve(&there, &[]).expect("there");
    let picked = resolve("shadow_key,combined_fill");
    assert_eq!(names(&picked), ["combined_fill", "shadow_key"]);
    assert_eq!(picked.groups(), &groups(&["fill", "key"])[..]);
    assert_eq!(names(&resolve("ao,combined_*")), ["ao", "combined_fill", "combined_key", "combined_rim.001"]);
    let layers: Vec<String> = resolve("shadow_rim.001").iter().map(|chosen| chosen.layer()).collect();
    assert_eq!(layers, ["Shadow_rim_001"]);
    assert_eq!(names(&resolve("shadow_rim_001")), ["shadow_rim.001"]);
    assert!(resolve("ao,shadow").groups().is_empty());
    assert_eq!(resolve("all").groups(), &there[..]);
}

#[test]
fn a_group_that_is_not_there_is_told_with_those_that_are() {
    let list = set("combined,shadow_kye");
    let message = list.resolve(&groups(&["key", "fill"]), &[]).expect_err("unknown");
    assert_eq!(message, "there is no light group 'kye'; the scene has: key, fill");
    let none = "the scene has no light groups";
    assert!(list.resolve(&[], &[]).expect_err("none").ends_with(none));
    assert_eq!(set("shadow_*").resolve(&[], &[]).expect_err("nothing left"), none);
    assert_eq!(names(&set("ao,shadow_*").resolve(&[], &[]).expect("ao is left")), ["ao"]);
    assert!(set("combined_*").resolve(&groups(&["a.b", "a_b"]), &[]).expect_err("one layer").contains("combined_a_b"));
}

#[test]
fn absent_passes_are_absent_work() {
    let combined = set("combined");
    assert!(combined.needs_light() && combined.needs_indirect());
    assert!(!combined.needs_ao() && !combined.needs_shadow() && !combined.needs_first_hit());
    assert!(!combined.needs_split() && !combined.needs_color() && !combined.needs_cryptomatte());
    let ao = set("ao,depth");
    assert!(ao.needs_ao() && ao.needs_first_hit() && !ao.needs_light());
    let shadow = set("shadow");
    assert!(shadow.needs_shadow() && shadow.needs_irradiance() && !shadow.needs_indirect());
    assert!(!set("unshadowed").needs_irradiance());
}

#[test]
fn passes_of_groups_call_for_what_their_sums_need() {
    let there = groups(&["fill", "key"]);
    let shadow = set("shadow_key").resolve(&there, &[]).expect("there");
    assert!(!shadow.needs_shadow() && !shadow.needs_irradiance() && !shadow.needs_light());
    assert_eq!(shadow.needs_shadow_of_groups(), [true]);
    let one = set("combined_*,shadow_key").resolve(&there, &[]).expect("there");
    assert_eq!(one.needs_shadow_of_groups(), [false, true]);
    let combined = set("combined_key").resolve(&there, &[]).expect("there");
    assert!(combined.needs_indirect() && combined.needs_light() && !combined.needs_shadow());
    let nothing = set("ao,shadow_*").resolve(&[], &[]).expect("ao");
    assert!(!nothing.needs_light() && !nothing.needs_irradiance());
}

#[test]
fn aovs_are_those_of_the_scene_in_its_order() {
    let aov = |name: &str, kind| Aov { name: name.into(), kind };
    let there = [aov("wet", AovKind::Value), aov("albedo.raw", AovKind::Color)];
    let resolve = |list: &str| set(list).resolve(&[], &there);
    let all = resolve("ao,aov:*").expect("there");
    assert_eq!(names(&all), ["ao", "aov:wet", "aov:albedo.raw"]);
    assert_eq!((all.aov_numbers(), all.needs_aovs(), all.needs_light()), (5, true, false));
    let shown: Vec<_> = all.iter().skip(1).map(|chosen| (chosen.layer(), chosen.channels())).collect();
    assert_eq!(shown, [("wet".to_owned(), "X"), ("albedo_raw".to_owned(), "RGBA")]);
    assert_eq!(resolve("aov:albedo_raw").expect("by its layer").aovs(), &there[1..]);
    assert_eq!(resolve("all").expect("there").aovs(), there);
    assert!(!resolve("ao").expect("ao").needs_aovs());
    assert_eq!(set("aov:wet,aov:*,AOV:dry").to_string(), "aov:*");
    let unknown = resolve("aov:dry").expect_err("unknown");
    assert_eq!(unknown, "there is no AOV 'dry'; the scene has: wet, albedo.raw");
    let nothing = set("aov:*,shadow_*").resolve(&[], &[]).expect_err("nothing left");
    assert_eq!(nothing, "the scene has no light groups and no AOVs");
    let taken = [aov("Depth", AovKind::Value)];
    let message = set("depth,aov:*").resolve(&[], &taken).expect_err("one layer");
    assert_eq!(message, "the passes 'depth' and 'aov:Depth' would share the layer Depth");
    let many: Vec<Aov> = (0..256).map(|i| aov(&i.to_string(), AovKind::Value)).collect();
    assert!(set("all").resolve(&[], &many).expect_err("too many").contains("256"));
    assert_eq!(set("all").resolve(&[], &many[1..]).expect("as many as there can be").aov_numbers(), 255);
}
