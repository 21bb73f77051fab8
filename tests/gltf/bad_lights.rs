//! Bad input of lights, from the file to what is traced: one warning that names the light, and the
//! light that shines in its place.

use std::f64::consts::PI;

use penumbra::film::PassSet;
use penumbra::import::ImportOptions;
use penumbra::scene::{View, prepare};
use penumbra::settings::Settings;
use serde_json::{Value, json};

use super::glb::Glb;
use super::read;

/// A triangle and a camera.
fn stage() -> Glb {
    let mut glb = Glb::triangle();
    glb.push("cameras", json!({"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}));
    glb.push("nodes", json!({"camera": 0, "translation": [0.3, 0.3, 4]}));
    glb
}

/// The stage with this light of `extras.penumbra`.
fn lamp(light: Value) -> Glb {
    let mut glb = stage();
    glb.push("nodes", json!({"name": "Lamp", "extras": {"penumbra": {"light": light}}}));
    glb
}

/// With this light of KHR_lights_punctual.
fn punctual(light: Value) -> Glb {
    let mut glb = stage();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    glb.push("nodes", json!({"name": "Lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    glb
}

fn sun(angle: f64) -> Glb {
    let mut glb = punctual(json!({"type": "directional"}));
    glb.json["nodes"][2]["extras"] = json!({"angle": angle});
    glb
}

/// With this light of EXT_lights_ies; ten candela down, none at the horizon.
fn measured(light: Value) -> Glb {
    let uri = "data:,TILT=NONE%0A1%20-1%201%203%201%201%202%200%200%200%0A1%201%200%0A0%2045%2090%0A0%0A10%205%200";
    let mut glb = stage();
    glb.json["extensions"] = json!({"EXT_lights_ies": {"lights": [{ "uri": uri }]}});
    let mut light = light;
    light["light"] = json!(0);
    glb.push("nodes", json!({"name": "Lamp", "extensions": {"EXT_lights_ies": light}}));
    glb
}

/// With a triangle that emits.
fn emissive(factor: Value, strength: f64) -> Glb {
    let mut glb = stage();
    let extensions = json!({"KHR_materials_emissive_strength": {"emissiveStrength": strength}});
    glb.push("materials", json!({"name": "Lamp", "emissiveFactor": factor, "extensions": extensions}));
    glb.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    glb
}

/// The lights that are traced, in words, and all warnings of reading and preparing them.
fn traced(glb: &Glb) -> (Vec<String>, Vec<String>) {
    let (scene, mut warnings) = read(&glb.bytes(), &ImportOptions::default());
    let settings = Settings { passes: PassSet::parse("combined").unwrap(), ..Settings::default() };
    let prepared = prepare(scene.unwrap(), &View { camera: None, size: Some([4, 4]) }, &settings).unwrap();
    warnings.extend(prepared.warnings.iter().map(ToString::to_string));
    (prepared.scene.lights.iter().map(|light| format!("{:?}", light.emitter)).collect(), warnings)
}

/// `bad` is lit as `good` is, and one warning says so.
fn taken_as(bad: &Glb, said: &str, good: &Glb) {
    let (expected, none) = traced(good);
    assert_eq!((expected.len(), none.len()), (1, 0), "{none:?}");
    let (found, warnings) = traced(bad);
    assert_eq!(found, expected);
    assert!(warnings.len() == 1 && warnings[0].contains("Lamp") && warnings[0].contains(said), "{said}: {warnings:?}");
}

/// Nothing shines, no dome either: one warning names the light, and one the dark.
fn dark(bad: &Glb, said: &str) {
    let (found, warnings) = traced(bad);
    assert!(found.is_empty(), "{said}: {found:?}");
    let [named, dark] = ["Lamp", "in the dark"].map(|word| warnings.iter().filter(|w| w.contains(word)).count());
    assert_eq!((named, dark, warnings.len()), (1, 1, 2), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("Lamp") && w.contains(said)), "{said}: {warnings:?}");
}

#[test]
fn strengths() {
    let negative = "its intensity is negative: taken as 0";
    dark(&punctual(json!({"type": "point", "intensity": -3})), negative);
    dark(&punctual(json!({"type": "point", "intensity": -3, "color": [-1, -1, 0]})), negative);
    let point = |color: Value| punctual(json!({"type": "point", "color": color}));
    taken_as(&point(json!([-1, 0.5, 1])), negative, &point(json!([0, 0.5, 1])));
    dark(&measured(json!({"multiplier": -2})), negative);
    taken_as(&measured(json!({"color": [-1, 0.5, 1]})), negative, &measured(json!({"color": [0, 0.5, 1]})));
    dark(&lamp(json!({"type": "rect", "power": 3, "color": -1})), negative);
    let bright = |radiance: f64| lamp(json!({"type": "dome", "radiance": radiance}));
    taken_as(&bright(1e39), "its intensity is too bright: taken as 1e30", &bright(1e30));
    // Not bad: turned down.
    assert_eq!(traced(&lamp(json!({"type": "rect", "power": 0}))), (vec![], vec![]));
}

#[test]
fn emission() {
    let ones = || json!([1, 1, 1]);
    taken_as(&emissive(ones(), 1e39), "its emission is too bright: taken as 1e30", &emissive(ones(), 1e30));
    let negative = "its emission is negative: taken as 0";
    dark(&emissive(ones(), -5.0), negative);
    dark(&emissive(json!([-1, 0, 0]), -5.0), negative);
    taken_as(&emissive(json!([-1, 1, 1]), 5.0), negative, &emissive(json!([0, 1, 1]), 5.0));
    // Not bad: no light but the dome's.
    let (lights, warnings) = traced(&emissive(ones(), 0.0));
    assert!(lights[0].contains("Dome") && warnings.len() == 1 && warnings[0].contains("no light"), "{warnings:?}");
}

#[test]
fn sizes_and_angles() {
    for light in [
        json!({"type": "rect", "width": 0, "height": 1}),
        json!({"type": "rect", "width": 0, "height": 1, "power": 5}),
        json!({"type": "disk", "width": 0, "height": 1, "power": 0.1, "two_sided": true}),
    ] {
        dark(&lamp(light), "its width is 0; it emits nothing and is left out");
    }
    dark(&lamp(json!({"type": "sphere", "radius": 0, "radiance": 3})), "its radius is 0; it emits nothing");
    dark(&lamp(json!({"type": "sphere", "radius": 0})), "its radius is 0; it emits nothing");
    dark(&lamp(json!({"type": "cylinder", "length": 0, "power": 3})), "its length is 0; it emits nothing");

    let lamp_sun = |angle: f64| lamp(json!({"type": "distant", "angle": angle}));
    for (angle, said, taken) in [(-1.0, "its angle is -1: taken as 0", 0.0), (9.0, "its angle is 9: taken as 3.1", PI)]
    {
        taken_as(&sun(angle), said, &sun(taken));
        taken_as(&lamp_sun(angle), said, &lamp_sun(taken));
    }
    let spot = |inner: f64, outer: f64| {
        punctual(json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}}))
    };
    taken_as(&spot(0.6, 0.5), "its inner cone angle is 0.6: taken as 0.5", &spot(0.5, 0.5));
    taken_as(&spot(-1.0, 0.5), "its inner cone angle is -1: taken as 0", &spot(0.0, 0.5));
    taken_as(&spot(0.0, 7.0), "its cone angle is 7: taken as 3.1", &spot(0.0, PI));
    dark(&spot(0.0, 0.0), "its shaping leaves no light");
    dark(&spot(0.0, -1.0), "its cone angle is -1: taken as 0");
    let ranged = |range: f64| punctual(json!({"type": "point", "range": range}));
    taken_as(&ranged(-3.0), "its range is -3: taken as endless", &punctual(json!({"type": "point"})));
}

/// A scene whose author gave lights is not lit by another when they are left out.
#[test]
fn lights_that_cannot_be_placed_or_known() {
    dark(&lamp(json!({"type": "tube"})), "'tube' is not known: the light is left out");
    dark(&lamp(json!({"radius": 1})), "light.type is missing: the light is left out");
    dark(&punctual(json!({"type": "tube"})), "light type 'tube' is not known; the light is left out");
    let mut beyond = punctual(json!({"type": "point"}));
    beyond.json["nodes"][2]["extensions"]["KHR_lights_punctual"] = json!({"light": 4});
    dark(&beyond, "names light 4 of 1; it is left out");

    let rect = json!({"type": "rect"});
    let mut flat = lamp(rect.clone());
    flat.json["nodes"][2]["scale"] = json!([1, 0, 1]);
    dark(&flat, "the transform is singular or not finite");
    // Rules of a light that is left out have nothing wrong with them.
    flat.json["nodes"][2]["extras"]["penumbra"]["light_group"] = json!("key");
    dark(&flat, "the transform is singular or not finite");

    let mut below = lamp(rect);
    below.push("nodes", json!({"name": "Flat", "scale": [1, 0, 1], "children": [2]}));
    let (lights, warnings) = traced(&below);
    assert!(lights.is_empty() && warnings.len() == 3, "{warnings:?}");
    for (warning, words) in warnings.iter().zip(["Flat: the transform is singular", "Flat/Lamp: the light is left out"])
    {
        assert!(warning.contains(words), "{warning}");
    }
    // What is hidden is not missed.
    below.json["nodes"][3]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    let (lights, warnings) = traced(&below);
    assert!(lights[0].contains("Dome") && warnings.len() == 1, "{warnings:?}");
}

/// JSON has no NaN and no number beyond 1e308.
#[test]
fn what_is_no_number_in_json_is_no_file() {
    for value in ["NaN", "Infinity", "1e400"] {
        let extras = format!(r#"{{"penumbra": {{"light": {{"type": "point", "intensity": {value}}}}}}}"#);
        let document = format!(r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"extras": {extras}}}]}}"#);
        super::refused(document.as_bytes(), &["line 1"]);
    }
}
