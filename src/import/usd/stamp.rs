//! What *Export for Penumbra* stamped on a prim, as custom properties that other programs ignore.

use std::path::{Path, PathBuf};

use openusd::usd::Prim;

use super::super::blender::{Moment, Stamp};
use super::stage::Reading;
use super::values::Values;

/// At a lamp.
pub(super) const LIGHT: &str = "userProperties:penumbra:light";
/// At a camera.
pub(super) const CAMERA: &str = "userProperties:penumbra:camera";
/// At a prim beside the dome.
pub(super) const WORLD: &str = "userProperties:penumbra:world";

/// What the walk calls a prim that shows something only by its stamp.
pub(super) const KIND: &str = "penumbra stamp";

/// True for the properties by which a prim without a shape may show something: a camera that UsdGeom does
/// not know, the world.
pub(super) fn shows(name: &str) -> bool {
    matches!(name, CAMERA | WORLD)
}

/// The stamp `name` of a prim or of its parent, since Blender's objects are the parents of their data. One
/// that can't be read is told, and is none.
pub(super) fn read(values: &Values<'_>, name: &str) -> Option<Stamp> {
    let own = text(values.reading, values.prim, name).map(|text| (values.prim.clone(), text));
    let (prim, text) = own.or_else(|| {
        let parent = values.prim.parent()?;
        let text = text(values.reading, &parent, name)?;
        Some((parent, text))
    })?;
    let time = values.reading.time;
    let moment = if time.is_earliest_time() { Moment::Authored } else { Moment::Frame(time.value()) };
    let stamp = Stamp::parse(&text, moment, &folder(values.reading, &prim, name));
    stamp.map_err(|what| values.warn(format!("{name} is left out, UsdLux and UsdGeom count: {what}"))).ok()
}

fn text(reading: &Reading<'_>, prim: &Prim, name: &str) -> Option<String> {
    reading.names(prim).iter().any(|known| known.as_str() == name).then(|| reading.value(prim, name)).flatten()
}

/// Folder of the layer that says `name`, from which its files are looked for.
fn folder(reading: &Reading<'_>, prim: &Prim, name: &str) -> PathBuf {
    let stack = prim.attribute(name).property_stack().unwrap_or_default();
    let layer = stack.first().map(|site| PathBuf::from(&site.layer));
    let root = || reading.place.file.as_deref().map(Path::to_path_buf);
    layer.or_else(root).and_then(|file| file.parent().map(Path::to_path_buf)).unwrap_or_default()
}
