//! The glTF 2.0 door: `.gltf` and `.glb` files to a `SceneDesc`.
//!
//! Specification: <https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html>; extensions:
//! <https://github.com/KhronosGroup/glTF/tree/main/extensions>. glTF's world is already ours: y up,
//! metres, counter-clockwise front faces, v downwards.
//!
//! The object index of an instance is the index of its node plus 1, the material index that of the
//! material plus 1 (0 for glTF's default material): glTF has no numbers for these passes.

mod accessor;
mod animation;
mod attributes;
mod buffer;
mod camera;
mod clean;
mod container;
mod covered;
mod deform;
mod document;
mod draco;
mod extras;
mod fields;
mod frames;
mod instancing;
mod json;
mod lamp;
mod light;
mod lights;
mod links;
mod material;
mod mesh;
mod meshopt;
mod node;
mod sampler;
mod scene;
mod stamp;
mod texture;
mod topology;
mod uri;

use std::path::Path;

use super::ImportOptions;
use crate::desc::SceneDesc;
use crate::error::{Error, Place, Result, Warnings};

/// Reads the file at `path`.
///
/// # Errors
/// A file or buffer that can't be read, one whose structure is broken, and extensions that it
/// requires and that are not supported, each named.
pub fn load(path: &Path, options: &ImportOptions, warnings: &mut Warnings) -> Result<SceneDesc> {
    let bytes = std::fs::read(path).map_err(|source| Error::io(path, "can't read", source))?;
    from_bytes(&bytes, Some(path.parent().unwrap_or(Path::new(""))), &Place::file(path), options, warnings)
}

/// Reads a `.gltf` or `.glb` that is in memory. External files are looked for in `base_dir`;
/// without it they are an error.
///
/// # Errors
/// As [`load`].
pub fn from_bytes(
    bytes: &[u8],
    base_dir: Option<&Path>,
    place: &Place,
    options: &ImportOptions,
    warnings: &mut Warnings,
) -> Result<SceneDesc> {
    let container = container::split(bytes, place)?;
    let root = document::parse(container.json, place, warnings)?;
    let buffers = buffer::Buffers::load(&root, container.bin, base_dir, place)?;
    let reader = accessor::Reader { root: &root, buffers: &buffers };
    let build = |root: &json::Root, moving: bool, warnings: &mut Warnings| {
        let reader = accessor::Reader { root, buffers: &buffers };
        scene::Builder { reader, base_dir, place, options, file_size: bytes.len(), moving }.build(warnings)
    };
    let Some(frame) = options.frame.filter(|_| !root.animations.is_empty()) else {
        if options.vectors && !root.animations.is_empty() {
            warnings.push(place, "the vector pass is asked for, but no frame is given: nothing moves");
        }
        return build(&root, false, warnings);
    };
    let at = |frame: f64, moving: bool, warnings: &mut Warnings| {
        build(&animation::pose(container.json, reader, frame / options.fps, place, warnings)?, moving, warnings)
    };
    let mut scene = at(frame, false, warnings)?;
    if options.vectors {
        // What is wrong with the file was told for the frame itself.
        let then = |after: f64| Ok((after, at(frame + after, true, &mut Warnings::new())?));
        frames::add(&mut scene, &[then(-1.0)?, then(1.0)?]);
    }
    Ok(scene)
}
