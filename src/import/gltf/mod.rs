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
    let posed = match options.frame {
        Some(frame) if !root.animations.is_empty() => {
            Some(animation::pose(container.json, reader, frame / options.fps, place, warnings)?)
        }
        _ => None,
    };
    let reader = accessor::Reader { root: posed.as_ref().unwrap_or(&root), buffers: &buffers };
    scene::Builder { reader, base_dir, place, options, file_size: bytes.len() }.build(warnings)
}
