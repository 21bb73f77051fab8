//! Stages of a few lines for tests.

use std::cell::RefCell;
use std::path::PathBuf;

use openusd_schemas::geom::XformCache;

use super::super::images::Images;
use super::super::stage::Reading;
use super::super::walk::Placed;
use super::Profiles;
use crate::desc::LightDesc;
use crate::import::ImportOptions;
use crate::math::{DAffine3, DMat3, DVec3};

/// A stage in a folder of its own.
pub(in super::super) struct Stage {
    pub folder: tempfile::TempDir,
    path: PathBuf,
    said: RefCell<String>,
}

impl Stage {
    /// A stage of `metadata`, in metres and y up unless it says otherwise, and `prims`.
    pub fn new(metadata: &str, prims: &str) -> Self {
        let meters = if metadata.contains("metersPerUnit") { "" } else { "metersPerUnit = 1" };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("stage.usda");
        std::fs::write(&path, format!("#usda 1.0\n(\n{meters}\n{metadata}\n)\n{prims}\n")).unwrap();
        Self { folder, path, said: RefCell::default() }
    }

    /// What `f` makes of the prim at `path`, placed as the walk would.
    pub fn with<T>(&self, path: &str, f: impl FnOnce(&Reading<'_>, &Placed) -> T) -> T {
        let options = ImportOptions::default();
        let reading = Reading::open(&self.path, &options).unwrap();
        let prim = reading.stage.prim(path).unwrap();
        let matrix = XformCache::new(reading.time).local_to_world_transform(&prim).unwrap();
        let row = |i: usize| DVec3::new(matrix.0[4 * i], matrix.0[4 * i + 1], matrix.0[4 * i + 2]);
        let local = DAffine3 { matrix3: DMat3::from_cols(row(0), row(1), row(2)), translation: row(3) };
        let placed = Placed {
            path: prim.path().clone(),
            kind: prim.type_name().unwrap().map(|t| t.to_string()).unwrap_or_default().into(),
            world: reading.to_world * local,
            motion: Vec::new(),
            visible: true,
            prim,
        };
        let found = f(&reading, &placed);
        for warning in reading.warnings.take().iter() {
            *self.said.borrow_mut() += &format!("{}: {}\n", warning.place.node.as_deref().unwrap_or(""), warning.what);
        }
        found
    }

    /// The light at `path`.
    pub fn light(&self, path: &str) -> Option<LightDesc> {
        self.light_with(path, &mut Images::default(), &mut Profiles::default())
    }

    /// The light at `path`, and the files that it uses.
    pub fn light_with(&self, path: &str, images: &mut Images, profiles: &mut Profiles) -> Option<LightDesc> {
        self.with(path, |reading, placed| super::read(reading, placed, images, profiles))
    }

    /// All warnings so far.
    pub fn said(&self) -> String {
        self.said.borrow().clone()
    }
}
