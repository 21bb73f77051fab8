//! Animation at one time: every channel writes its value into the JSON, which is then read as if it
//! had been authored so. A node's channel is a short form of a JSON pointer, and
//! KHR_animation_pointer's channels name theirs; so both go one way, and whatever the rest of this
//! door reads can be animated.

use std::collections::HashSet;

use serde::Deserialize;
use serde_json::{Map, Value};

use super::accessor::Reader;
use super::document::label;
use super::json::{Animation, Channel, Root};
use super::sampler::{Interpolation, sample};
use crate::error::{Error, Place, Result, Warnings};

/// The document at `time` in seconds.
///
/// # Errors
/// JSON that doesn't parse; a channel that can't be evaluated is a warning.
pub(super) fn pose(json: &[u8], reader: Reader<'_>, time: f64, place: &Place, warnings: &mut Warnings) -> Result<Root> {
    let invalid = |e: serde_json::Error| Error::invalid(place, format!("the JSON is not glTF 2.0: {e}"));
    let authored: Value = serde_json::from_slice(json).map_err(invalid)?;
    let mut posed = authored.clone();
    apply(&mut posed, reader, time, true, place, warnings);
    if let Ok(root) = Root::deserialize(posed) {
        return Ok(root);
    }
    let what =
        "an animation pointer (KHR_animation_pointer) writes what its target can't hold; all pointers are left out";
    warnings.push(place, what);
    let mut posed = authored;
    apply(&mut posed, reader, time, false, place, &mut Warnings::new());
    Root::deserialize(posed).map_err(invalid)
}

fn apply(document: &mut Value, reader: Reader<'_>, time: f64, pointers: bool, place: &Place, warnings: &mut Warnings) {
    // Of several animations of one property the first counts.
    let mut done: HashSet<String> = HashSet::new();
    for (i, animation) in reader.root.animations.iter().enumerate() {
        let here = place.at(label("animation", i, animation.name.as_deref()));
        for (c, channel) in animation.channels.iter().enumerate() {
            let Some(pointer) = target(channel) else { continue };
            if done.contains(&pointer) || (!pointers && channel.target.extensions.pointer.is_some()) {
                continue;
            }
            let written =
                evaluate(reader, animation, channel, &pointer, time).and_then(|value| write(document, &pointer, value));
            if let Err(what) = written {
                warnings.push(&here, format!("channel {c} ({pointer}): {what}; it is left out"));
            }
            done.insert(pointer);
        }
    }
}

/// The JSON pointer of a channel's target; `None` where it has none.
fn target(channel: &Channel) -> Option<String> {
    let target = &channel.target;
    if let Some(pointer) = &target.extensions.pointer {
        return Some(pointer.pointer.clone());
    }
    Some(format!("/nodes/{}/{}", target.node?, target.path))
}

/// The property of a node that a pointer names.
fn node_property(pointer: &str) -> Option<&str> {
    let (index, property) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
    index.bytes().all(|b| b.is_ascii_digit()).then_some(property)
}

fn evaluate(
    reader: Reader<'_>,
    animation: &Animation,
    channel: &Channel,
    pointer: &str,
    time: f64,
) -> Result<Value, String> {
    let sampler = animation.samplers.get(channel.sampler).ok_or("names a sampler that does not exist")?;
    let times = reader.floats::<1>(sampler.input)?.into_flattened();
    let (values, components) = reader.flat(sampler.output)?;
    let interpolation = Interpolation::from_name(sampler.interpolation.as_deref())?;
    let property = node_property(pointer);
    let numbers = sample(&times, &values, interpolation, property == Some("rotation"), time)?;
    if numbers.iter().any(|v| !v.is_finite()) {
        return Err("the value is not finite".into());
    }
    let expected = match property {
        Some("translation" | "scale") => 3,
        Some("rotation") => 4,
        _ => numbers.len(),
    };
    if numbers.len() != expected {
        return Err(format!("{} numbers where {expected} are needed", numbers.len()));
    }
    Ok(match numbers[..] {
        [one] if pointer.ends_with("/visible") => Value::Bool(one != 0.0),
        [one] if components == 1 && !pointer.ends_with("/weights") => Value::from(one),
        _ => Value::from(numbers),
    })
}

/// Puts `value` where `pointer` (RFC 6901) leads. Objects on the way that are absent are made:
/// what is not written has its default, and a default can be animated.
fn write(document: &mut Value, pointer: &str, value: Value) -> Result<(), String> {
    let tokens: Vec<String> = pointer
        .strip_prefix('/')
        .ok_or("not a pointer")?
        .split('/')
        .map(|t| t.replace("~1", "/").replace("~0", "~"))
        .collect();
    if !matches!(tokens[0].as_str(), "nodes" | "meshes" | "materials" | "cameras" | "extensions") {
        return Err("is not something that can be animated".into());
    }
    if matches!(node_property(pointer), Some("translation" | "rotation" | "scale"))
        && document.pointer(&format!("/nodes/{}/matrix", tokens[1])).is_some()
    {
        return Err("the node has a matrix, which can't be animated".into());
    }
    let mut at = document;
    for (depth, token) in tokens.iter().enumerate() {
        // The lists of the root, and what stands in them, are never made.
        let may_create = depth >= 2;
        at = match at {
            Value::Object(map) => {
                if may_create && !map.contains_key(token) {
                    map.insert(token.clone(), Value::Object(Map::new()));
                }
                map.get_mut(token).ok_or_else(|| format!("there is no '{token}'"))?
            }
            Value::Array(list) => {
                let index = token.parse::<usize>().ok();
                index.and_then(|i| list.get_mut(i)).ok_or_else(|| format!("there is no element '{token}'"))?
            }
            _ => return Err(format!("'{token}' leads into a plain value")),
        };
    }
    *at = value;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn pointers_write_deep_and_make_defaults_explicit() {
        let mut document = json!({"materials": [{"name": "m"}], "accessors": [{"count": 3}]});
        let pointer = "/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength";
        write(&mut document, pointer, json!(5.0)).unwrap();
        assert_eq!(document.pointer(pointer), Some(&json!(5.0)));
        assert!(write(&mut document, "/accessors/0/count", json!(1e9)).is_err());
        assert!(write(&mut document, "/materials/7/alphaCutoff", json!(0.5)).is_err());
        assert!(write(&mut document, "/materials/0/name/x", json!(0.5)).is_err());
        assert!(write(&mut document, "materials", json!(0.5)).is_err());
    }

    #[test]
    fn a_matrix_stays() {
        let mut document = json!({"nodes": [{"matrix": [1]}]});
        assert!(write(&mut document, "/nodes/0/scale", json!([1, 1, 1])).is_err());
        assert!(write(&mut document, "/nodes/0/weights", json!([1])).is_ok());
    }
}
