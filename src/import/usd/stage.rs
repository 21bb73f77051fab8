//! A stage that is being read: what every part of the door asks.

use std::cell::{Cell, RefCell};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::rc::Rc;
use std::sync::mpsc;

use openusd::sdf::{self, FromValue, ValueKind};
use openusd::tf::Token;
use openusd::usd::{Attribute, InterpolationType, Prim, Stage, TimeCode};

use super::super::ImportOptions;
use super::authored::Authored;
use super::clip_sets::Missing;
use super::clips::Declared;
use super::extent::Extent;
use super::files::Files;
use super::layer::{Kept, Met, Site};
use super::retime::Retime;
use super::units::Units;
use super::{cycles, diagnostics, render, skel, variants, wording};
use crate::error::{Error, Place, Result, Warnings};
use crate::import::{Interpolation, Purpose};
use crate::math::DAffine3;

/// A composed stage, the time at which it is read, and how its space lies in ours.
pub(super) struct Reading<'a> {
    pub stage: Stage,
    /// When values are read; `EARLIEST` where neither the user nor the stage names a frame.
    pub time: TimeCode,
    /// Time codes after `time` between which the shutters of the cameras are open; `None` where none is
    /// open for longer than an instant. Known once the prims were walked.
    pub shutter: Cell<Option<[f64; 2]>>,
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
    /// Purposes that are shown beside `default`.
    pub purposes: Vec<Purpose>,
    /// Purposes of the material bindings that count, the strongest first; empty for all-purpose ones.
    pub binding_purposes: Vec<Token>,
    /// How many of its layers were searched for cycles.
    pub layers: Cell<usize>,
    /// True where a layer has value clips.
    pub clipped: Cell<bool>,
    /// Classes that prims of layers that are referred to name; they are implied in others.
    pub classes: RefCell<HashSet<sdf::Path>>,
    pub declared: RefCell<Declared>,
    pub extent: Extent,
    pub missing_clips: RefCell<Missing>,
    /// What was told so far.
    pub warnings: RefCell<Warnings>,
    /// Whether there is a material of a MaterialX document at a path without prim.
    pub documents: RefCell<HashMap<sdf::Path, bool>>,
    /// The skeletons that were met.
    pub skeletons: skel::Skeletons,
    authored: RefCell<Authored>,
    /// Threads that hold what they opened until this is gone: to let go of it would cost time that is needed.
    pub crew: RefCell<Vec<mpsc::Sender<()>>>,
    /// What was met in layers on their way.
    pub met: Rc<RefCell<Met>>,
    kept: Kept,
}

impl<'a> Reading<'a> {
    /// Opens the stage whose root layer is `path`.
    ///
    /// # Errors
    /// A root layer that is missing or broken, a variant that does not exist.
    pub fn open(path: &Path, options: &'a ImportOptions) -> Result<Self> {
        let place = Place::file(path);
        if let Err(source) = std::fs::metadata(path) {
            return Err(Error::io(path, "can't read", source));
        }
        let (files, schemas) = Files::open(path);
        let met = files.met();
        let interpolation = match options.interpolation {
            Interpolation::Held => InterpolationType::Held,
            Interpolation::Linear => InterpolationType::Linear,
        };
        let builder = Stage::builder().interpolation_type(interpolation);
        let opened = builder.resolver(files).schema_registry(schemas).open(&path.to_string_lossy());
        let stage = opened
            .map_err(|e| Error::invalid(&place, format!("can't be opened as USD: {}", wording::plain(&chain(&e)))))?;
        let mut warnings = Warnings::new();
        let time = time(&stage, options.frame, &place, &mut warnings);
        let extent = Extent::new(options.frame, stage.has_authored_time_code_range());
        let units = Units::of_root(&stage, &place, &mut warnings);
        let root = sdf::Path::abs_root();
        // What the metadata that files call `doc` is named in memory.
        let doc = stage.field::<sdf::Value>(&root, "documentation").ok().flatten();
        let blender = matches!(doc, Some(sdf::Value::String(text)) if text.starts_with("Blender v"));
        let mut reading = Self {
            stage,
            time,
            shutter: Cell::new(None),
            place,
            options,
            meters: units.meters,
            to_world: units.to_world(),
            blender,
            purposes: Vec::new(),
            binding_purposes: Vec::new(),
            layers: Cell::new(0),
            clipped: Cell::new(false),
            classes: RefCell::default(),
            declared: RefCell::default(),
            extent,
            missing_clips: RefCell::default(),
            warnings: RefCell::new(warnings),
            documents: RefCell::default(),
            skeletons: skel::Skeletons::default(),
            authored: RefCell::default(),
            crew: RefCell::default(),
            met,
            kept: Kept::default(),
        };
        cycles::mend(&reading);
        variants::select(&reading.stage, &options.variants, &reading.place)?;
        let included = render::Purposes::of(&reading);
        reading.purposes = options.purposes.clone().unwrap_or(included.shown);
        reading.binding_purposes = included.bindings;
        Ok(reading)
    }

    /// True where a layer that is referred to has classes, which are implied in others.
    pub fn has_referenced_classes(&self) -> bool {
        !self.classes.borrow().is_empty()
    }

    /// The place of the prim or property at `path`.
    pub fn place_of(&self, path: &sdf::Path) -> Place {
        self.place.at(path.as_str())
    }

    /// Tells of something that was replaced or left out at the prim or property at `path`.
    pub fn warn(&self, path: &sdf::Path, what: impl Into<String>) {
        self.warnings.borrow_mut().push(&self.place_of(path), what);
    }

    /// Tells of what could not be composed and of schemas that are not known, once everything was read.
    pub fn warn_of_composition(&self) {
        diagnostics::tell(self);
        for (path, what) in self.authored.borrow_mut().unknown.drain(..) {
            self.warn(&path, what);
        }
        for (layer, path, what) in self.met.borrow_mut().told.drain(..) {
            self.warnings.borrow_mut().push(&Place::file(layer).at(path), what);
        }
    }

    /// Takes note of what is known of `prim`, the one that is asked next: its authored properties and type.
    pub fn recall(&self, prim: &Prim, names: &Rc<[Token]>, type_name: &Token) {
        self.authored.borrow_mut().recall(prim, Some(names.clone()), Some(type_name.clone()));
    }

    /// The authored properties of `prim`.
    pub fn names(&self, prim: &Prim) -> Rc<[Token]> {
        self.authored.borrow_mut().names(prim)
    }

    /// The type of `prim` as authored; empty for one without.
    pub fn type_name(&self, prim: &Prim) -> Token {
        self.authored.borrow_mut().type_name(prim)
    }

    /// True where no API schema is applied to `prim`.
    pub fn is_plain(&self, prim: &Prim) -> bool {
        self.authored.borrow_mut().is_plain(prim)
    }

    /// The value of attribute `name` of `prim` at the time that is read, authored or the schema's
    /// fallback. `None` where there is none; a value of another type is told of.
    pub fn value<T>(&self, prim: &Prim, name: &str) -> Option<T>
    where
        T: FromValue,
        T::Error: Into<openusd::Error>,
    {
        let Some(fallback) = self.authored.borrow_mut().fallback(prim, name) else {
            return self.value_of(&prim.attribute(name), self.time);
        };
        let value = fallback.filter(|value| T::accepts_kind(ValueKind::from(value)))?;
        T::try_from(value).ok()
    }

    /// The value of `attribute` at `time`; as [`value`](Self::value).
    pub fn value_of<T>(&self, attribute: &Attribute, time: TimeCode) -> Option<T>
    where
        T: FromValue,
        T::Error: Into<openusd::Error>,
    {
        if let Some(spline) = self.spline(attribute) {
            let value = spline.at(time).filter(|value| T::accepts_kind(ValueKind::from(value)))?;
            return T::try_from(value).ok();
        }
        self.extent.note(self, attribute);
        let time = Retime::of(self, attribute).map_or(time, |retime| retime.asked(time));
        match attribute.get_at::<T>(time) {
            Ok(Some(value)) => Some(value),
            Ok(None) => self.held(attribute, time),
            Err(error) => {
                self.warn(attribute.path(), format!("{error}; taken for not authored"));
                None
            }
        }
    }

    /// The curve that gives `attribute` its values.
    pub fn spline(&self, attribute: &Attribute) -> Option<Rc<Site>> {
        // Few stages have any, and others are not to be searched.
        if self.met.borrow().splines { self.kept.spline(&self.stage, attribute) } else { None }
    }

    /// The sample before `time` where a block follows it: OpenUSD holds that value up to the block, the
    /// openusd crate does not.
    fn held<T>(&self, attribute: &Attribute, time: TimeCode) -> Option<T>
    where
        T: FromValue,
        T::Error: Into<openusd::Error>,
    {
        if let Ok(Some((before, after))) = attribute.bracketing_time_samples(time) {
            return if before < after { attribute.get_at::<T>(TimeCode::new(before)).ok().flatten() } else { None };
        }
        None
    }
}

/// The time code of `frame`, or that at which the stage starts.
fn time(stage: &Stage, frame: Option<f64>, place: &Place, warnings: &mut Warnings) -> TimeCode {
    if !stage.has_authored_time_code_range() {
        return frame.map_or(TimeCode::EARLIEST, TimeCode::new);
    }
    let (start, end) = (stage.start_time_code(), stage.end_time_code());
    let Some(frame) = frame else { return TimeCode::new(start) };
    if frame < start || frame > end {
        let what = format!(
            "frame {frame} is outside of the stage's time codes {start} to {end}; what has samples there shows them"
        );
        warnings.push(place, what);
    }
    TimeCode::new(frame)
}

/// `error` with its causes.
pub(super) fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let more = error.to_string();
        if !text.contains(&more) {
            text = format!("{text}: {more}");
        }
        cause = error.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read<T>(text: &str, look: impl FnOnce(&Reading<'_>) -> T) -> T {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("stage.usda");
        std::fs::write(&path, text).expect("a file");
        let options = ImportOptions::default();
        look(&Reading::open(&path, &options).expect("a stage"))
    }

    #[test]
    fn files_of_blender_are_known_by_the_root_layer_alone() {
        let blender = |text: &str| read(text, |reading| reading.blender);
        assert!(blender("#usda 1.0\n(\n doc = \"Blender v5.0.1\"\n)\n"));
        assert!(!blender("#usda 1.0\n(\n doc = \"Made for Blender v5\"\n)\n"));
        assert!(!blender("#usda 1.0\ndef Xform \"A\" ( doc = \"Blender v5.0.1\" ) {}\n"));
    }

    /// Units that are not authored are centimetres, y up.
    #[test]
    fn units_have_the_fallbacks_of_openusd() {
        let units = |metadata: &str| {
            let text = format!("#usda 1.0\n( {metadata} )\n");
            read(&text, |r| (r.meters, r.to_world.transform_vector3(crate::math::DVec3::Z), r.warnings.borrow().len()))
        };
        assert_eq!(units(""), (0.01, crate::math::DVec3::new(0.0, 0.0, 0.01), 0));
        assert_eq!(units("metersPerUnit = 2 upAxis = \"Z\""), (2.0, crate::math::DVec3::new(0.0, 2.0, 0.0), 0));
        assert_eq!(units("metersPerUnit = -1"), (0.01, crate::math::DVec3::new(0.0, 0.0, 0.01), 1));
    }

    #[test]
    fn values_are_authored_or_fallbacks_or_of_another_type() {
        let text = "#usda 1.0\ndef Sphere \"S\" { double radius = 3 }\ndef Sphere \"T\" {}\n";
        read(text, |reading| {
            let prim = |path: &str| reading.stage.prim(path).expect("a prim");
            let radius = |path: &str| reading.value::<f64>(&prim(path), "radius");
            // Once more, since what is authored is kept for the prim that was asked last.
            for _ in 0..2 {
                assert_eq!((radius("/S"), radius("/T")), (Some(3.0), Some(1.0)));
            }
            assert_eq!(reading.value::<f32>(&prim("/T"), "radius"), None);
            assert_eq!(reading.value::<bool>(&prim("/T"), "doubleSided"), Some(false));
            assert_eq!(reading.value::<f64>(&prim("/T"), "no:such"), None);
        });
    }

    #[test]
    fn frames_are_those_that_the_stage_starts_with() {
        let time = |text: &str| read(text, |reading| reading.time);
        assert!(time("#usda 1.0\n").is_earliest_time());
        assert_eq!(time("#usda 1.0\n( startTimeCode = 7 endTimeCode = 9 )\n"), TimeCode::new(7.0));
    }
}
