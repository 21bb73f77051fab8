//! Lights as `penumbra info` shows them: what is not the default is said.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use penumbra::desc::{ConeDesc, DecayDesc, DecayLaw, LightDesc, LightKind, LinkSet, SceneDesc, ShadowDesc, Visibility};
use serde_json::{Map, Value, json};

use super::numbers;

/// Names in a line of text; the rest is counted.
const SHOWN: usize = 4;

/// One light as JSON.
pub fn describe(light: &LightDesc, scene: &SceneDesc) -> Value {
    let (kind, unit) = match light.kind {
        LightKind::Point { .. } if light.shaping.cone.is_some() => ("spot", "W/sr"),
        LightKind::Point { .. } => ("point", "W/sr"),
        LightKind::Distant { .. } => ("distant", "W/m2"),
        LightKind::Sphere { .. } => ("sphere", "W/(m2 sr)"),
        LightKind::Rect { .. } => ("rectangle", "W/(m2 sr)"),
        LightKind::Disk { .. } => ("disk", "W/(m2 sr)"),
        LightKind::Cylinder { .. } => ("cylinder", "W/(m2 sr)"),
        LightKind::Dome { .. } | LightKind::ShadedDome { .. } => ("dome", "W/(m2 sr)"),
        LightKind::Portal { .. } => ("portal", "W/(m2 sr)"),
    };
    let mut value = json!({ "name": &*light.name, "kind": kind, "value": light.kind.color(), "unit": unit });
    let Some(fields) = value.as_object_mut() else { return value };
    shape(light.kind, fields);
    if let Some(image) = light.kind.image() {
        fields.insert("image".into(), json!(&*scene.images[image as usize].name));
    }
    shaping(light, scene, fields);
    decay(light.decay, fields);
    rules(light, scene, fields);
    value
}

fn shape(kind: LightKind, fields: &mut Map<String, Value>) {
    let mut set = |key: &str, value: Value| fields.insert(key.into(), value);
    match kind {
        LightKind::Point { .. } | LightKind::Dome { .. } | LightKind::ShadedDome { .. } => {}
        LightKind::Sphere { radius, facing, .. } => {
            set("radius_m", json!(radius));
            if facing {
                set("facing", json!(true));
            }
        }
        LightKind::Portal { width, height } => {
            set("size_m", json!([width, height]));
        }
        LightKind::Rect { width, height, spread, two_sided, .. }
        | LightKind::Disk { width, height, spread, two_sided, .. } => {
            set("size_m", json!([width, height]));
            if spread < PI {
                set("spread_deg", json!(spread.to_degrees()));
            }
            if two_sided {
                set("two_sided", json!(true));
            }
        }
        LightKind::Cylinder { radius, length, .. } => {
            set("radius_m", json!(radius));
            set("length_m", json!(length));
        }
        LightKind::Distant { angle, .. } => {
            set("angle_deg", json!(angle.to_degrees()));
        }
    }
}

fn shaping(light: &LightDesc, scene: &SceneDesc, fields: &mut Map<String, Value>) {
    let shaping = &light.shaping;
    let mut set = |key: &str, value: Value| fields.insert(key.into(), value);
    match shaping.cone {
        None => {}
        Some(ConeDesc::Ramp { inner, outer }) => {
            set("cone_deg", json!([inner.to_degrees(), outer.to_degrees()]));
        }
        Some(ConeDesc::Blend { angle, blend }) => {
            set("cone_deg", json!(angle.to_degrees()));
            set("cone_blend", json!(blend));
        }
        Some(ConeDesc::Soft { angle, softness }) => {
            set("cone_deg", json!(angle.to_degrees()));
            set("cone_softness", json!(softness));
        }
    }
    if shaping.focus != 0.0 {
        set("focus", json!(shaping.focus));
    }
    if let Some(ies) = shaping.ies {
        set("ies", json!(&*scene.ies[ies.profile as usize].name));
    }
}

fn decay(decay: DecayDesc, fields: &mut Map<String, Value>) {
    let mut set = |key: &str, value: Value| fields.insert(key.into(), value);
    match decay.law {
        DecayLaw::Quadratic => {}
        DecayLaw::Constant => _ = set("decay", json!("none")),
        DecayLaw::Linear => _ = set("decay", json!("linear")),
        DecayLaw::Polynomial { kc, kl, kq } => _ = set("decay", json!([kc, kl, kq])),
    }
    if decay.smooth != 0.0 {
        set("smooth_m2", json!(decay.smooth));
    }
    if decay.range.is_finite() {
        set("range_m", json!(decay.range));
    }
}

fn rules(light: &LightDesc, scene: &SceneDesc, fields: &mut Map<String, Value>) {
    let mut set = |key: &str, value: Value| fields.insert(key.into(), value);
    if let Some(group) = &light.links.group {
        set("group", json!(&**group));
    }
    if !light.links.cast_shadow {
        set("cast_shadow", json!(false));
    }
    let ShadowDesc { color, distance, falloff, gamma } = light.links.shadow;
    if color != [0.0; 3] {
        set("shadow_color", json!(color));
    }
    if distance.is_finite() {
        set("shadow_distance_m", json!(distance));
    }
    if falloff != 0.0 {
        set("shadow_falloff_m", json!(falloff));
        set("shadow_falloff_gamma", json!(gamma));
    }
    for (key, links) in [("receivers", &light.links.receivers), ("blockers", &light.links.blockers)] {
        if let Some(links) = links {
            set(key, link_set(links, scene));
        }
    }
    let Visibility { camera, diffuse, glossy, transmission, .. } = light.visibility;
    let rays = [("camera", camera), ("diffuse", diffuse), ("glossy", glossy), ("transmission", transmission)];
    // Lamps are not seen by the camera, domes are.
    let by_default = |ray: &str| ray != "camera" || light.kind.is_dome();
    let odd: Map<String, Value> = rays
        .iter()
        .filter(|(ray, seen)| *seen != by_default(ray))
        .map(|(ray, seen)| ((*ray).into(), json!(seen)))
        .collect();
    if !odd.is_empty() {
        set("visibility", json!(odd));
    }
}

/// The objects of a link, by name.
fn link_set(links: &LinkSet, scene: &SceneDesc) -> Value {
    let names: BTreeSet<&str> = links.instances.iter().map(|&i| &*scene.instances[i as usize].name).collect();
    json!({ if links.exclude { "exclude" } else { "include" }: names })
}

/// Names of the light groups that lights and objects are in.
pub fn groups(scene: &SceneDesc) -> Value {
    let links = scene.lights.iter().map(|l| &l.links).chain(scene.instances.iter().map(|i| &i.links));
    json!(links.filter_map(|links| links.group.as_deref()).collect::<BTreeSet<&str>>())
}

/// One light, as [`describe`] gives it, in a line of text.
pub fn line(light: &Value) -> String {
    let text = |key: &str| light[key].as_str().unwrap_or_default();
    let mut line = format!("{} light {}: {} {}", text("kind"), light["name"], numbers(&light["value"]), text("unit"));
    let number = |value: &Value| value.as_f64().map(short).unwrap_or_default();
    let list = |value: &Value, between: &str| match value.as_array() {
        Some(list) => list.iter().map(number).collect::<Vec<_>>().join(between),
        None => number(value),
    };
    let mut say = |key: &str, words: &dyn Fn(&Value) -> String| {
        if let Some(value) = light.get(key) {
            line += &format!(", {}", words(value));
        }
    };
    say("radius_m", &|v| format!("radius {} m", number(v)));
    say("length_m", &|v| format!("length {} m", number(v)));
    say("size_m", &|v| format!("{} m", list(v, " x ")));
    say("angle_deg", &|v| format!("{} degrees wide", number(v)));
    say("facing", &|_| "faces whoever looks".into());
    say("two_sided", &|_| "two-sided".into());
    say("spread_deg", &|v| format!("spread {} degrees", number(v)));
    say("image", &|v| format!("image {v}"));
    say("cone_deg", &|v| format!("cone {} degrees", list(v, " to ")));
    say("cone_blend", &|v| format!("blend {}", number(v)));
    say("cone_softness", &|v| format!("softness {}", number(v)));
    say("focus", &|v| format!("focus {}", number(v)));
    say("ies", &|v| format!("IES profile {v}"));
    say("decay", &|v| format!("decay {}", v.as_str().map_or_else(|| list(v, ", "), String::from)));
    say("smooth_m2", &|v| format!("smoothed by {} m2", number(v)));
    say("range_m", &|v| format!("range {} m", number(v)));
    say("group", &|v| format!("group {v}"));
    say("cast_shadow", &|_| "casts no shadow".into());
    say("shadow_color", &|v| format!("shadows of color {}", list(v, " ")));
    say("shadow_distance_m", &|v| format!("shadows within {} m", number(v)));
    say("shadow_falloff_m", &|v| format!("fading over {} m", number(v)));
    say("shadow_falloff_gamma", &|v| format!("falloff gamma {}", number(v)));
    say("receivers", &|v| format!("lights {}", objects(v)));
    say("blockers", &|v| format!("stopped by {}", objects(v)));
    for (ray, seen) in light["visibility"].as_object().into_iter().flatten() {
        line += &format!(", {} by {ray}", if *seen == json!(true) { "seen" } else { "not seen" });
    }
    line
}

/// `only "A", "B"` or `all but "A"`.
fn objects(links: &Value) -> String {
    let (word, list) = match (links["include"].as_array(), links["exclude"].as_array()) {
        (Some(list), _) => ("only", list.as_slice()),
        (None, list) => ("all but", list.map(Vec::as_slice).unwrap_or_default()),
    };
    let mut names: Vec<String> = list.iter().take(SHOWN).map(Value::to_string).collect();
    match list.len() {
        0 => names.push("nothing".into()),
        count if count > SHOWN => names.push(format!("{} more", count - SHOWN)),
        _ => {}
    }
    format!("{word} {}", names.join(", "))
}

/// At most four digits after the point.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
