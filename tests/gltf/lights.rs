//! Lights of `extras.penumbra` and EXT_lights_ies, and the rules of lights and meshes.

use std::f64::consts::PI;

use penumbra::desc::{
    ColorSpace, ConeDesc, DecayLaw, IesRef, InstanceDesc, LightDesc, LightKind, LightLinks, LinkSet, SceneDesc,
    Visibility,
};
use penumbra::error::Warnings;
use penumbra::import::{ImportOptions, gltf};
use serde_json::{Value, json};

use super::glb::Glb;
use super::{load, load_warned, read};

/// Ten candela down, none at the horizon.
const IES: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 0\n0 45 90\n0\n10 5 0\n";

fn ies_uri() -> String {
    format!("data:,{}", IES.replace('\n', "%0A").replace(' ', "%20"))
}

fn node(name: &str, penumbra: Value) -> Value {
    json!({"name": name, "extras": {"penumbra": penumbra}})
}

/// A document of one node with a light.
fn lamp(light: Value) -> Glb {
    let mut glb = Glb::new();
    glb.push("nodes", node("Lamp", json!({ "light": light })));
    glb
}

fn only(scene: &SceneDesc) -> &LightDesc {
    assert_eq!(scene.lights.len(), 1);
    &scene.lights[0]
}

fn kind(light: Value) -> LightKind {
    only(&load(&lamp(light))).kind
}

fn close(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{value} is not {expected}");
}

#[test]
fn each_kind_by_radiance_and_by_defaults() {
    let (one, rgb) = ([1.0; 3], [0.5, 1.0, 2.0]);
    let radiance = |light: &Value| {
        let mut light = light.clone();
        light["radiance"] = json!([1, 2, 4]);
        light["color"] = json!(0.5);
        light
    };
    for (light, expected) in [
        (json!({"type": "sphere"}), LightKind::Sphere { radius: 0.5, radiance: one, facing: false }),
        (
            json!({"type": "sphere", "radius": 2, "facing": true}),
            LightKind::Sphere { radius: 2.0, radiance: one, facing: true },
        ),
        (
            json!({"type": "rect", "width": 2}),
            LightKind::Rect { width: 2.0, height: 2.0, radiance: one, spread: PI, two_sided: false, image: None },
        ),
        (
            json!({"type": "disk", "height": 3, "spread": 0.5, "two_sided": 1}),
            LightKind::Disk { width: 1.0, height: 3.0, radiance: one, spread: 0.5, two_sided: true },
        ),
        (
            json!({"type": "cylinder", "radius": 0.25, "length": 4}),
            LightKind::Cylinder { radius: 0.25, length: 4.0, radiance: one },
        ),
        (json!({"type": "dome"}), LightKind::Dome { radiance: one, image: None }),
    ] {
        assert_eq!(kind(light.clone()), expected);
        assert_eq!(kind(radiance(&light)).color(), rgb, "{light}");
    }
    let point = json!({"type": "point", "intensity": 3, "color": [1, 0.5, 0]});
    assert_eq!(kind(point), LightKind::Point { intensity: [3.0, 1.5, 0.0] });
    let sun = json!({"type": "distant", "irradiance": [3, 2, 1]});
    assert_eq!(kind(sun), LightKind::Distant { irradiance: [3.0, 2.0, 1.0], angle: 0.0 });
}

#[test]
fn power_is_that_of_blenders_lamps() {
    let p = 100.0;
    for (light, expected) in [
        (json!({"type": "point"}), p / (4.0 * PI)),
        (json!({"type": "sphere", "radius": 0}), p / (4.0 * PI)),
        (json!({"type": "sphere", "radius": 0.5}), p / (4.0 * PI * PI * 0.25)),
        (json!({"type": "rect", "width": 2, "height": 0.5}), p / PI),
        (json!({"type": "rect", "width": 2, "height": 0.5, "two_sided": true}), p / (2.0 * PI)),
        (json!({"type": "disk", "width": 2, "height": 1}), p / (PI * PI * 0.5)),
        (json!({"type": "cylinder", "radius": 0.1, "length": 2}), p / (PI * 2.0 * PI * 0.1 * 2.0)),
    ] {
        let mut with_power = light.clone();
        with_power["power"] = json!(p);
        let color = kind(with_power).color();
        assert_eq!((color[0], color[1]), (color[1], color[2]), "{light}");
        close(color[0], expected);
    }
    let radiance = kind(json!({"type": "distant", "angle": 0.4, "radiance": 10})).color()[0];
    close(radiance, 10.0 * PI * 0.2_f64.sin().powi(2));
}

#[test]
fn shaping_and_decay() {
    let with = |key: &str, value: Value| {
        let mut light = json!({"type": "sphere"});
        light[key] = value;
        let light = only(&load(&lamp(light))).clone();
        (light.shaping, light.decay)
    };
    for (cone, expected) in [
        (json!({"angle": 0.5}), ConeDesc::Blend { angle: 0.5, blend: 0.0 }),
        (json!({"angle": 0.5, "blend": 0.25}), ConeDesc::Blend { angle: 0.5, blend: 0.25 }),
        (json!({"angle": 0.5, "softness": 0.25}), ConeDesc::Soft { angle: 0.5, softness: 0.25 }),
        (json!({"inner": 0.25, "outer": 0.5}), ConeDesc::Ramp { inner: 0.25, outer: 0.5 }),
    ] {
        assert_eq!(with("cone", cone).0.cone, Some(expected));
    }
    assert_eq!(with("focus", json!(4)).0.focus, 4.0);
    assert_eq!(with("focus_tint", json!([0.5, 0, 1])).0.focus_tint, [0.5, 0.0, 1.0]);
    for (decay, expected) in [
        (json!("none"), DecayLaw::Constant),
        (json!("linear"), DecayLaw::Linear),
        (json!("quadratic"), DecayLaw::Quadratic),
        (json!([1, 0.5, 0.25]), DecayLaw::Polynomial { kc: 1.0, kl: 0.5, kq: 0.25 }),
    ] {
        assert_eq!(with("decay", decay).1.law, expected);
    }
    let (shaping, decay) = with("smooth", json!(0.5));
    assert_eq!((shaping.cone, shaping.ies, decay.smooth, decay.range), (None, None, 0.5, f64::INFINITY));
    assert_eq!(with("range", json!(8)).1.range, 8.0);
}

#[test]
fn a_light_stands_at_its_node_and_in_place_of_a_plainer_one() {
    let mut glb = Glb::new();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let mut own = node("Lamp", json!({"light": {"type": "rect"}}));
    own["translation"] = json!([1, 2, 3]);
    own["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
    glb.push("nodes", own);
    let scene = load(&glb);
    let light = only(&scene);
    assert!(matches!(light.kind, LightKind::Rect { .. }));
    assert_eq!((&*light.name, light.place.node.as_deref()), ("Lamp", Some("Lamp")));
    assert_eq!(light.transform.translation.to_array(), [1.0, 2.0, 3.0]);
}

#[test]
fn lamps_are_hidden_from_the_camera_unless_it_is_said() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "directional"}]}});
    glb.push("nodes", node("rect", json!({"light": {"type": "rect"}})));
    glb.push("nodes", node("dome", json!({"light": {"type": "dome"}})));
    glb.push(
        "nodes",
        node("seen", json!({"light": {"type": "disk"}, "visibility": {"camera": true, "glossy": false}})),
    );
    glb.push(
        "nodes",
        json!({"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 0}}, "extras": {"angle": 0.1}}),
    );
    let seen = load(&glb).lights.iter().map(|light| light.visibility).collect::<Vec<_>>();
    let hidden = Visibility { camera: false, ..Visibility::ALL };
    assert_eq!(seen, [hidden, Visibility::ALL, Visibility { glossy: false, ..Visibility::ALL }, hidden]);
}

#[test]
fn rules_apply_to_the_nodes_mesh_and_punctual_light() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    glb.set("/nodes/0/extensions", json!({"KHR_lights_punctual": {"light": 0}}));
    let rays = json!({"camera": false, "diffuse": false, "glossy": true, "transmission": false, "shadow": 0});
    let rules = json!({"visibility": rays, "light_group": "key", "cast_shadow": false});
    glb.set("/nodes/0/extras", json!({"penumbra": rules}));
    let scene = load(&glb);
    let links = LightLinks { group: Some("key".into()), cast_shadow: false, ..LightLinks::default() };
    assert_eq!((&only(&scene).links, &scene.instances[0].links), (&links, &links));
    let visibility = Visibility { camera: false, diffuse: false, glossy: true, transmission: false, shadow: false };
    assert_eq!((only(&scene).visibility, scene.instances[0].visibility), (visibility, visibility));
}

/// Blender's interface has no dictionaries, but texts.
#[test]
fn a_text_of_json_does_as_well() {
    let mut glb = Glb::new();
    glb.push("nodes", node("Lamp", json!(r#"{"light": {"type": "point", "intensity": 2}, "light_group": "key"}"#)));
    let scene = load(&glb);
    assert_eq!(only(&scene).kind, LightKind::Point { intensity: [2.0; 3] });
    assert_eq!(only(&scene).links.group.as_deref(), Some("key"));
    glb.json["nodes"][0]["extras"]["penumbra"] = json!("{light");
    assert!(load_warned(&glb, &["Lamp", "extras.penumbra", "not JSON", "ignored"]).lights.is_empty());
}

/// A lamp with `links`; meshes "A" with children "A1", itself with "A2", and "B" twice.
fn linked(links: Value) -> Glb {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([]);
    let mut lamp = links;
    lamp["light"] = json!({"type": "point"});
    for (value, children) in [
        (node("Lamp", lamp), vec![]),
        (json!({"name": "A", "mesh": 0}), vec![2]),
        (json!({"name": "A1", "mesh": 0}), vec![3]),
        (json!({"name": "A2", "mesh": 0}), vec![]),
        (json!({"name": "B", "mesh": 0}), vec![]),
        (json!({"name": "Pair"}), vec![6]),
        (json!({"name": "B", "mesh": 0}), vec![]),
    ] {
        let node = glb.push("nodes", value);
        if !children.is_empty() {
            glb.json["nodes"][node]["children"] = json!(children);
        }
    }
    glb
}

fn names<'a>(set: &LinkSet, instances: &'a [InstanceDesc]) -> Vec<&'a str> {
    set.instances.iter().map(|&i| &*instances[i as usize].name).collect()
}

#[test]
fn links_name_nodes_with_all_below_them() {
    for (links, exclude, expected) in [
        (json!({"include": ["A1"]}), false, vec!["A1", "A2"]),
        (json!({"include": ["A2", "A1", "A2"]}), false, vec!["A1", "A2"]),
        (json!({"exclude": ["A"]}), true, vec!["A", "A1", "A2"]),
        (json!({"include": "B"}), false, vec!["B", "B"]),
        (json!({"include": ["Pair/B"]}), false, vec!["B"]),
        (json!({"include": []}), false, vec![]),
    ] {
        for key in ["receivers", "blockers"] {
            let scene = load(&linked(json!({ key: links })));
            let LightLinks { receivers, blockers, .. } = &only(&scene).links;
            let [set, other] = if key == "receivers" { [receivers, blockers] } else { [blockers, receivers] };
            let set = set.as_ref().unwrap();
            assert_eq!((names(set, &scene.instances), set.exclude), (expected.clone(), exclude), "{links}");
            assert_eq!(*other, None);
        }
    }
    let pair = load(&linked(json!({"receivers": {"include": ["Pair/B"]}})));
    assert_eq!(only(&pair).links.receivers.as_ref().unwrap().instances, [4]);
}

#[test]
fn links_of_an_emissive_mesh_are_its_own() {
    let mut glb = linked(json!({}));
    glb.json["nodes"][4]["extras"] = json!({"penumbra": {"blockers": {"exclude": ["B"]}}});
    let scene = load(&glb);
    let linked: Vec<bool> = scene.instances.iter().map(|i| i.links.blockers.is_some()).collect();
    assert_eq!(linked, [false, false, false, true, false]);
    assert_eq!(only(&scene).links, LightLinks::default());
}

#[test]
fn links_to_what_is_not_there_are_told() {
    let lit = |links: Value, words: &[&str]| {
        let scene = load_warned(&linked(json!({ "receivers": links })), words);
        only(&scene).links.receivers.clone()
    };
    let words = ["Lamp", "receivers", "'Z', 'Pears'", "left out"];
    let some = lit(json!({"include": ["Z", "A2", "Pears"]}), &words).unwrap();
    assert_eq!((some.instances, some.exclude), (vec![2], false));
    assert_eq!(lit(json!({"include": ["Z"]}), &["Lamp", "receivers", "'Z'", "lights everything"]), None);
    // Lamps can't be lit.
    assert_eq!(lit(json!({"exclude": ["Lamp"]}), &["Lamp", "receivers", "'Lamp'"]), None);
    let shadows = linked(json!({"blockers": {"include": "Z"}}));
    let scene = load_warned(&shadows, &["Lamp", "blockers", "'Z'", "everything stops its light"]);
    assert_eq!(only(&scene).links.blockers, None);
}

#[test]
fn what_is_not_understood_is_told_by_node_and_key() {
    for (light, words) in [
        (json!({"type": "sphere", "raduis": 1}), &["light.raduis", "not known", "radius"][..]),
        (json!({"type": "sphere", "width": 1}), &["light.width", "not known"]),
        (json!({"type": "distant", "cone": {"angle": 1}}), &["light.cone", "not known"]),
        (json!({"type": "distant", "radiance": 1}), &["light.radiance", "not known"]),
        (json!({"type": "sphere", "radius": "1"}), &["light.radius", "not a number", "ignored"]),
        (json!({"type": "rect", "two_sided": 2}), &["light.two_sided", "true or false", "ignored"]),
        (json!({"type": "rect", "color": [1, 2]}), &["light.color", "a number or three", "ignored"]),
        (json!({"type": "rect", "radiance": 1, "power": 1}), &["light.power", "ignored", "radiance"]),
        (json!({"type": "rect", "decay": "cubic"}), &["light.decay", "quadratic is taken"]),
        (json!({"type": "rect", "cone": {}}), &["light.cone.angle", "no cone"]),
        (json!({"type": "rect", "cone": 3}), &["light.cone", "not an object"]),
        (json!({"type": "rect", "cone": {"angle": 1, "blur": 1}}), &["light.cone.blur", "not known", "blend"]),
        (json!({"type": "rect", "cone": {"angle": 1, "blend": 0, "softness": 1}}), &["light.cone.softness", "ignored"]),
        (json!({"type": "rect", "image": true}), &["light.image", "ignored"]),
    ] {
        let words: Vec<&str> = words.iter().copied().chain(["Lamp", "extras.penumbra."]).collect();
        assert_eq!(load_warned(&lamp(light), &words).lights.len(), 1);
    }
    for (light, words) in [
        (json!({"type": "tube"}), &["light.type", "'tube'", "cylinder"][..]),
        (json!({"radius": 1}), &["light.type", "missing"]),
        (json!([1]), &["light", "not an object"]),
    ] {
        assert!(load_warned(&lamp(light), words).lights.is_empty());
    }
    for (penumbra, words) in [
        (json!({"lihgt": {}}), &["extras.penumbra.lihgt", "not known", "light_group"][..]),
        (json!(7), &["extras.penumbra", "not an object"]),
        (json!({"visibility": {"shadow": true, "shadows": true}}), &["visibility.shadows", "not known"]),
        (json!({"light_group": 3}), &["light_group", "not a text"]),
        (json!({"receivers": {"include": [1]}}), &["receivers.include", "not a list of names"]),
        (json!({"receivers": {"include": ["N"], "exclude": ["N"]}}), &["receivers.exclude", "ignored"]),
    ] {
        let mut glb = Glb::triangle();
        glb.set("/nodes/0/extras", json!({ "penumbra": penumbra }));
        let words: Vec<&str> = words.iter().copied().chain(["N"]).collect();
        assert_eq!(load_warned(&glb, &words).instances.len(), 1);
    }
    let mut empty = Glb::new();
    empty.push("nodes", node("Empty", json!({"light_group": "key"})));
    load_warned(&empty, &["Empty", "neither a mesh nor a light"]);
}

#[test]
fn extras_of_others_are_left_alone() {
    for extras in [json!(null), json!("text"), json!([1, 2]), json!({"penumbra": null}), json!({"other": 1})] {
        let mut glb = Glb::triangle();
        glb.set("/nodes/0/extras", extras);
        assert_eq!(load(&glb).instances[0].links, LightLinks::default());
    }
}

#[test]
fn profiles_and_images_come_from_files_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my lamp.ies"), IES).unwrap();
    let image = image::Rgb32FImage::from_pixel(4, 2, image::Rgb([1.0, 2.0, 300.0]));
    image.save(folder.path().join("sky.hdr")).unwrap();
    image::RgbImage::from_pixel(2, 2, image::Rgb([255, 128, 0])).save(folder.path().join("card.png")).unwrap();
    let mut glb = Glb::new();
    let measured = json!({"type": "point", "ies": "my%20lamp.ies", "ies_angle_scale": 0.5, "ies_keep_power": true});
    for (name, light) in [
        ("a", measured),
        ("b", json!({"type": "disk", "ies": "my%20lamp.ies"})),
        ("card", json!({"type": "rect", "image": "card.png", "radiance": 5})),
        ("sky", json!({"type": "dome", "image": "sky.hdr"})),
        ("card 2", json!({"type": "rect", "image": "card.png"})),
    ] {
        glb.push("nodes", node(name, json!({ "light": light })));
    }
    let path = folder.path().join("scene.glb");
    std::fs::write(&path, glb.bytes()).unwrap();
    let mut warnings = Warnings::new();
    let scene = gltf::load(&path, &ImportOptions::default(), &mut warnings).unwrap();
    assert!(warnings.is_empty(), "{:?}", warnings.iter().collect::<Vec<_>>());
    let ies: Vec<_> = scene.lights.iter().filter_map(|light| light.shaping.ies).collect();
    let plain = IesRef { profile: 0, angle_scale: 0.0, keep_power: false };
    assert_eq!(ies, [IesRef { angle_scale: 0.5, keep_power: true, ..plain }, plain]);
    assert_eq!((scene.ies.len(), &scene.ies[0].candela[..]), (1, &[10.0, 5.0, 0.0][..]));
    let images: Vec<_> = scene.lights.iter().map(|light| light.kind.image()).collect();
    assert_eq!(images, [None, None, Some(0), Some(1), Some(0)]);
    let spaces: Vec<_> = scene.images.iter().map(|image| (&*image.name, image.color_space)).collect();
    assert_eq!(spaces, [("card.png", ColorSpace::Srgb), ("sky.hdr", ColorSpace::Linear)]);
    assert_eq!(scene.lights[2].kind.color(), [5.0; 3]);
}

#[test]
fn images_and_profiles_of_the_file_itself_go_by_index() {
    let mut glb = Glb::new();
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbImage::new(2, 2).write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = glb.view(png.get_ref());
    glb.push("images", json!({"name": "Card", "bufferView": view, "mimeType": "image/png"}));
    glb.json["extensions"] = json!({"EXT_lights_ies": {"lights": [{"uri": ies_uri(), "name": "Spot"}]}});
    glb.push("nodes", node("Card", json!({"light": {"type": "rect", "image": 0, "ies": 0}})));
    let scene = load(&glb);
    assert_eq!((only(&scene).kind.image(), &*scene.images[0].name), (Some(0), "Card"));
    assert_eq!((only(&scene).shaping.ies.unwrap().profile, &*scene.ies[0].name), (0, "Spot"));
}

#[test]
fn files_that_are_not_there_or_broken_have_a_substitute() {
    for (light, words) in [
        (json!({"type": "dome", "radiance": 2, "image": "sky.hdr"}), &["sky.hdr", "its radiance alone"][..]),
        (json!({"type": "rect", "image": 3}), &["image 3 of 0", "its radiance alone"]),
        (json!({"type": "rect", "image": "data:image/png;base64,AAAA"}), &["its radiance alone"]),
        (json!({"type": "point", "ies": "lamp.ies"}), &["lamp.ies", "shines evenly"]),
        (json!({"type": "point", "ies": "data:,TILT=NONE%0A1%20-1%20x"}), &["line 2", "shines evenly"]),
        (json!({"type": "point", "ies": 0}), &["IES profile 0 of 0", "shines evenly"]),
    ] {
        let words: Vec<&str> = words.iter().copied().chain(["light 'Lamp'"]).collect();
        let scene = load_warned(&lamp(light), &words);
        assert_eq!((only(&scene).kind.image(), only(&scene).shaping.ies), (None, None));
        assert!(scene.images.is_empty() && scene.ies.is_empty());
    }
}

#[test]
fn measured_lights_of_the_extension_are_in_candela() {
    let mut glb = Glb::new();
    let view = glb.view(IES.as_bytes());
    glb.json["extensionsRequired"] = json!(["EXT_lights_ies"]);
    let profiles = json!([
        {"uri": ies_uri()},
        {"bufferView": view, "mimeType": "application/x-ies-lm-63", "name": "Down"},
        {"uri": "data:,nothing"},
    ]);
    glb.json["extensions"] =
        json!({"EXT_lights_ies": {"lights": profiles}, "KHR_lights_punctual": {"lights": [{"type": "point"}]}});
    let measured = |name: &str, light: Value| json!({"name": name, "extensions": {"EXT_lights_ies": light}});
    glb.push("nodes", measured("plain", json!({"light": 0})));
    glb.push("nodes", measured("tinted", json!({"light": 1, "multiplier": 68.3, "color": [1, 0.5, 2]})));
    glb.json["nodes"][1]["extensions"]["KHR_lights_punctual"] = json!({"light": 0});
    let scene = load(&glb);
    let intensity = |light: &LightDesc| {
        let LightKind::Point { intensity } = light.kind else { panic!() };
        intensity
    };
    close(intensity(&scene.lights[0])[0], 10.0 / 683.0);
    let [r, g, b] = intensity(&scene.lights[1]);
    close(r, 1.0);
    assert_eq!((g, b), (0.5 * r, 2.0 * r));
    assert_eq!((scene.lights.len(), &*scene.ies[1].name), (2, "Down"));
    let shaping = scene.lights[1].shaping.ies;
    assert_eq!(shaping, Some(IesRef { profile: 1, angle_scale: 0.0, keep_power: false }));

    glb.json["nodes"] = json!([measured("broken", json!({"light": 2, "multiplier": 6.83}))]);
    let scene = load_warned(&glb, &["light 'broken'", "IES profile", "1000 cd"]);
    close(intensity(only(&scene))[0], 10.0);
    assert_eq!(only(&scene).shaping.ies, None);
    glb.json["nodes"] = json!([measured("none", json!({"light": 3}))]);
    assert!(load_warned(&glb, &["none", "IES light 3 of 3", "left out"]).lights.is_empty());
}

/// The example of docs/gltf.md is read as it stands.
#[test]
fn the_example_of_the_documentation_is_read() {
    let docs = include_str!("../../docs/gltf.md");
    let example = docs.split("```json").nth(1).unwrap().split("```").next().unwrap();
    let (scene, warnings) = read(example.as_bytes(), &ImportOptions::default());
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("panel.ies") && warnings[0].contains("shines evenly"), "{warnings:?}");
    let scene = scene.unwrap();
    let light = |name: &str| scene.lights.iter().find(|light| &*light.name == name).unwrap();
    let key = light("Key");
    assert!(matches!(key.kind, LightKind::Rect { width, height, .. } if (width, height) == (1.2, 0.6)));
    assert_eq!((key.links.group.as_deref(), key.links.cast_shadow), (Some("key"), true));
    assert!(key.links.receivers.as_ref().is_some_and(|set| set.exclude && set.instances.len() == 1));
    assert!(light("Rim").visibility.camera && light("Rim").decay.law == DecayLaw::Linear);
    assert!(!scene.instances.iter().find(|i| &*i.name == "Backdrop").unwrap().visibility.shadow);
}
