//! The glTF door: each feature, each kind of bad input, files of Blender and of other people.

mod assets;
mod bad;
mod bad_lights;
mod blender;
mod corpus;
mod deformation;
mod features;
#[path = "../support/glb.rs"]
mod glb;
mod lights;
mod materials;
mod mutation;
#[path = "../support/rng.rs"]
mod rng;
mod stamps;

use penumbra::desc::{Attribute, SceneDesc, check};
use penumbra::error::{Error, Place, Warnings};
use penumbra::import::{ImportOptions, gltf};

use glb::Glb;

/// Reads `bytes` as "test.glb"; what comes out keeps the rules of `SceneDesc`.
fn read(bytes: &[u8], options: &ImportOptions) -> (Result<SceneDesc, Error>, Vec<String>) {
    let mut warnings = Warnings::new();
    let scene = gltf::from_bytes(bytes, None, &Place::file("test.glb"), options, &mut warnings);
    if let Ok(scene) = &scene {
        check(scene).unwrap();
    }
    (scene, warnings.iter().map(ToString::to_string).collect())
}

/// Reads a document that has to be fine.
fn load(glb: &Glb) -> SceneDesc {
    load_with(glb, &ImportOptions::default())
}

fn load_with(glb: &Glb, options: &ImportOptions) -> SceneDesc {
    let (scene, warnings) = read(&glb.bytes(), options);
    assert_eq!(warnings, [""; 0]);
    scene.unwrap()
}

/// Reads a document that has to be told of exactly once.
fn load_warned(glb: &Glb, words: &[&str]) -> SceneDesc {
    let (scene, warnings) = read(&glb.bytes(), &ImportOptions::default());
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    for word in words.iter().chain(&["test.glb"]) {
        assert!(warnings[0].contains(word), "'{word}' in '{}'", warnings[0]);
    }
    scene.unwrap()
}

/// The error of a document that can't be read.
fn refused(bytes: &[u8], words: &[&str]) -> Error {
    let error = read(bytes, &ImportOptions::default()).0.expect_err("an error");
    let message = error.to_string();
    for word in words.iter().chain(&["test.glb"]) {
        assert!(message.contains(word), "'{word}' in '{message}'");
    }
    error
}

/// The values of a per-point attribute.
fn points<T>(attribute: &Attribute<T>) -> &[T] {
    match attribute {
        Attribute::Point(values) => values,
        Attribute::Corner(_) => panic!("an attribute of corners"),
    }
}
