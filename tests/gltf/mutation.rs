//! Damage that keeps the JSON well formed and so reaches deep into the door: values of a rich
//! document are replaced, removed, repeated and swapped, and bytes of its buffer turned to NaN,
//! infinity and large numbers.
//!
//! `PENUMBRA_MUTATIONS=1000000` runs it for longer, `PENUMBRA_SEED` from another start.

use penumbra::import::ImportOptions;
use serde_json::{Value, json};

use super::glb::Glb;
use super::read;
use super::rng::Rng;

/// JSON pointers of everything in `value`.
fn pointers(value: &Value, at: &str, out: &mut Vec<String>) {
    out.push(at.to_owned());
    match value {
        Value::Object(map) => map.iter().for_each(|(key, v)| pointers(v, &format!("{at}/{key}"), out)),
        Value::Array(list) => list.iter().enumerate().for_each(|(i, v)| pointers(v, &format!("{at}/{i}"), out)),
        _ => {}
    }
}

/// Something else in place of `old`, mostly of the same kind, so that the file still parses.
fn surprise(old: &Value, rng: &mut Rng) -> Value {
    let words = [
        "VEC2",
        "VEC3",
        "VEC4",
        "SCALAR",
        "MAT4",
        "MAT3",
        "STEP",
        "CUBICSPLINE",
        "LINEAR",
        "translation",
        "rotation",
        "scale",
        "weights",
        "pointer",
        "BLEND",
        "MASK",
        "spot",
        "point",
        "rect",
        "dome",
        "data:,x",
        "..",
        "ATTRIBUTES",
        "TRIANGLES",
        "/nodes/0/rotation",
        "/nodes/1/children",
        "/meshes/0/weights",
        "/cameras/0/perspective/yfov",
        "/nodes/0/x/y",
    ];
    let numbers = [
        json!(0),
        json!(1),
        json!(2),
        json!(3),
        json!(4),
        json!(5),
        json!(6),
        json!(7),
        json!(8),
        json!(-1),
        json!(0.5),
        json!(255),
        json!(65535),
        json!(u32::MAX),
        json!(u64::MAX),
        json!(1u64 << 63),
        json!(1e38),
        json!(1e308),
        json!(-1e308),
        json!(1e-320),
        json!(5120),
        json!(5121),
        json!(5122),
        json!(5123),
        json!(5125),
        json!(5126),
    ];
    let kind = if rng.below(12) == 0 { rng.below(4) } else { 4 };
    match (kind, old) {
        (0, _) => [Value::Null, json!([]), json!({}), json!(true)][rng.below(4)].clone(),
        (1, _) | (4, Value::String(_)) => json!(rng.one(&words)),
        (4, Value::Array(list)) => list.iter().map(|v| surprise(v, rng)).collect(),
        (4, Value::Object(map)) => {
            let key = map.keys().nth(rng.below(map.len())).cloned().unwrap_or_default();
            map.iter().filter(|(k, _)| **k != key).map(|(k, v)| (k.clone(), v.clone())).collect()
        }
        // Small integers are indices that exist and types that fit; the others are more daring.
        _ if rng.below(2) == 0 => numbers[rng.below(9)].clone(),
        _ => rng.one(&numbers).clone(),
    }
}

fn mutate(document: &mut Value, rng: &mut Rng) {
    let mut all = Vec::new();
    pointers(document, "", &mut all);
    let target = all[1 + rng.below(all.len() - 1)].clone();
    let other = document.pointer(&all[rng.below(all.len())]).cloned().unwrap_or_default();
    let (parent, key) = target.rsplit_once('/').unwrap();
    match rng.below(6) {
        0 => match document.pointer_mut(parent) {
            Some(Value::Object(map)) => drop(map.remove(key)),
            Some(Value::Array(list)) => drop(list.remove(key.parse().unwrap())),
            _ => {}
        },
        1 => {
            let copy = document.pointer(&target).cloned().unwrap_or_default();
            if let Some(Value::Array(list)) = document.pointer_mut(parent) {
                list.push(copy);
            }
        }
        2 if other.to_string().len() < 400 => *document.pointer_mut(&target).unwrap() = other,
        _ => {
            let value = document.pointer_mut(&target).unwrap();
            *value = surprise(value, rng);
        }
    }
}

fn mutate_bytes(bytes: &mut [u8], rng: &mut Rng) {
    let patterns = [f32::NAN, f32::INFINITY, f32::MAX, -1e30, 1e-40, 0.0, f32::from_bits(u32::MAX)];
    let at = 4 * rng.below(bytes.len() / 4);
    let value = patterns[rng.below(patterns.len())].to_le_bytes();
    bytes[at..at + 4].copy_from_slice(&value);
}

fn number(name: &str, default: u64) -> u64 {
    std::env::var(name).ok().and_then(|text| text.parse().ok()).unwrap_or(default)
}

#[test]
fn no_well_formed_damage_panics() {
    let example = include_str!("../../docs/gltf.md").split("```json").nth(1).unwrap().split("```").next().unwrap();
    let lights = Glb { json: serde_json::from_str(example).unwrap(), bin: vec![0; 4] };
    let seeds: Vec<Glb> = [
        &include_bytes!("../data/gltf/corpus/all.glb")[..],
        include_bytes!("../data/gltf/corpus/01_alpha_blend.glb"),
        include_bytes!("../data/gltf/draco.glb"),
    ]
    .into_iter()
    .map(|bytes| {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        Glb { json: serde_json::from_slice(&bytes[20..20 + length]).unwrap(), bin: bytes[28 + length..].to_vec() }
    })
    .chain([lights, super::stamps::rich()])
    .collect();
    let mut rng = Rng(number("PENUMBRA_SEED", 1) | 1 << 40);
    let mut accepted = 0_u64;
    let cases = number("PENUMBRA_MUTATIONS", 4000);
    for case in 0..cases {
        // The richest file gets most of the turns.
        let seed = &seeds[[0, 0, 0, 1, 2, 3, 4, 4][rng.below(8)]];
        let mut glb = Glb { json: seed.json.clone(), bin: seed.bin.clone() };
        for _ in 0..1 + rng.below(3) {
            mutate(&mut glb.json, &mut rng);
        }
        for _ in 0..rng.below(3) {
            mutate_bytes(&mut glb.bin, &mut rng);
        }
        let bytes = glb.bytes();
        let frame = [None, Some(0.0), Some(7.5)][rng.below(3)];
        let options = ImportOptions { frame, ..ImportOptions::default() };
        let done = std::panic::catch_unwind(|| read(&bytes, &options).0.is_ok());
        let Ok(ok) = done else {
            let path = std::env::temp_dir().join(format!("gltf-mutation-{case}.glb"));
            std::fs::write(&path, &bytes).unwrap();
            panic!("case {case} panics; the file is {}", path.display());
        };
        accepted += u64::from(ok);
    }
    // Most of the damage has to get past the parser, or nothing is tested.
    assert!(accepted * 4 > cases, "{accepted} of {cases} were read");
}
