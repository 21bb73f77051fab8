//! A stage that is being read: what every part of the door asks.

use std::cell::RefCell;
use std::path::Path;

use openusd::sdf::{self, FromValue};
use openusd::usd::{Prim, Stage, TimeCode};

use super::super::ImportOptions;
use crate::error::{Error, Place, Result, Warnings};
use crate::math::{DAffine3, DMat3, DVec3};

/// A composed stage, the time at which it is read, and how its space lies in ours.
pub(super) struct Reading<'a> {
    pub stage: Stage,
    /// When values are read; `EARLIEST` where neither the user nor the stage names a frame.
    pub time: TimeCode,
    /// The root layer.
    pub place: Place,
    pub options: &'a ImportOptions,
    /// Metres per unit of the stage.
    pub meters: f64,
    /// The stage's space to ours: y up, metres.
    pub to_world: DAffine3,
    /// True for files that Blender wrote, by the root layer's own metadata; some of their values mean
    /// something else than UsdLux says.
    pub blender: bool,
    /// What was told so far.
    pub warnings: RefCell<Warnings>,
}

impl<'a> Reading<'a> {
    /// Opens the stage whose root layer is `path`.
    ///
    /// # Errors
    /// A root layer that is missing or broken, a frame or variant that makes no sense.
    pub fn open(path: &Path, options: &'a ImportOptions) -> Result<Self> {
        let place = Place::file(path);
        if let Err(source) = std::fs::metadata(path) {
            return Err(Error::io(path, "can't read", source));
        }
        let opened = Stage::builder().schema_registry(openusd_schemas::schema_registry()).open(&path.to_string_lossy());
        let stage = opened.map_err(|e| Error::invalid(&place, format!("can't be opened as USD: {e}")))?;
        let time = match options.frame {
            Some(frame) => TimeCode::new(frame),
            None if stage.has_authored_time_code_range() => TimeCode::new(stage.start_time_code()),
            None => TimeCode::EARLIEST,
        };
        let meters = number(&stage, "metersPerUnit").filter(|m| m.is_finite() && *m > 0.0).unwrap_or(0.01);
        let z_up = token(&stage, "upAxis").is_some_and(|axis| axis == "Z");
        // z up to y up: (x, y, z) is (x, z, −y).
        let turn = if z_up { DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y) } else { DMat3::IDENTITY };
        let to_world = DAffine3::from_mat3(turn * DMat3::from_diagonal(DVec3::splat(meters)));
        let blender = token(&stage, "documentation").is_some_and(|doc| doc.starts_with("Blender"));
        let warnings = RefCell::new(Warnings::new());
        Ok(Self { stage, time, place, options, meters, to_world, blender, warnings })
    }

    /// The place of the prim or property at `path`.
    pub fn place_of(&self, path: &sdf::Path) -> Place {
        self.place.at(path.as_str())
    }

    /// Tells of something that was replaced or left out at the prim or property at `path`.
    pub fn warn(&self, path: &sdf::Path, what: impl Into<String>) {
        self.warnings.borrow_mut().push(&self.place_of(path), what);
    }

    /// The value of attribute `name` of `prim` at the time that is read, authored or the schema's
    /// fallback. `None` where there is none; a value of another type is told of.
    pub fn value<T>(&self, prim: &Prim, name: &str) -> Option<T>
    where
        T: FromValue,
        T::Error: Into<openusd::Error>,
    {
        let attribute = prim.attribute(name);
        match attribute.get_at::<T>(self.time) {
            Ok(value) => value,
            Err(error) => {
                self.warn(attribute.path(), format!("{error}; taken for not authored"));
                None
            }
        }
    }
}

fn number(stage: &Stage, key: &str) -> Option<f64> {
    match stage.stage_metadata(key).ok()?? {
        sdf::Value::Double(value) => Some(value),
        sdf::Value::Float(value) => Some(f64::from(value)),
        _ => None,
    }
}

fn token(stage: &Stage, key: &str) -> Option<String> {
    match stage.stage_metadata(key).ok()?? {
        sdf::Value::Token(value) => Some(value.to_string()),
        sdf::Value::String(value) => Some(value),
        _ => None,
    }
}
