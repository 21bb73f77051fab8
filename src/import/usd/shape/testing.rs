//! Stages of a few lines for tests.

use std::io::Write;

use openusd::sdf;
use openusd_schemas::geom::PrimvarsAPI;

use super::super::stage::Reading;
use super::{Built, Source, Wants, build, read};
use crate::error::Warnings;
use crate::import::ImportOptions;

/// Reads the prim at `path` of a stage with the text `usda` after its header.
pub(super) fn source(usda: &str, path: &str) -> (Option<Source>, Warnings) {
    let mut file = tempfile::Builder::new().suffix(".usda").tempfile().unwrap();
    write!(file, "#usda 1.0\n{usda}").unwrap();
    let options = ImportOptions::default();
    let reading = Reading::open(file.path(), &options).unwrap();
    let prim = reading.stage.prim(sdf::path(path).unwrap()).unwrap();
    let parent = reading.stage.prim(prim.path().parent().unwrap()).unwrap();
    let inherited = PrimvarsAPI::from_prim_unchecked(parent).find_inheritable_primvars().unwrap();
    let source = read(&reading, &prim, &inherited, None);
    (source, reading.warnings.take())
}

/// The same, built; warnings as text.
pub(super) fn built(usda: &str, path: &str, wants: &Wants, subdivision: u32) -> (Option<Built>, Vec<String>) {
    let (source, mut warnings) = source(usda, path);
    let place = crate::error::Place::default().at(path);
    let built = source.and_then(|source| build(source, wants, subdivision, &place, &mut warnings));
    (built, warnings.iter().map(|w| w.what.clone()).collect())
}

impl Built {
    pub fn into_mesh(self) -> crate::desc::MeshDesc {
        match self {
            Self::Mesh(mesh) => mesh,
            Self::Rounds(rounds) => panic!("{} is no mesh", rounds.name),
        }
    }

    pub fn into_rounds(self) -> crate::desc::RoundsDesc {
        match self {
            Self::Rounds(rounds) => rounds,
            Self::Mesh(mesh) => panic!("{} is a mesh", mesh.name),
        }
    }
}

#[test]
fn sources_go_to_other_threads() {
    fn is_send<T: Send>() {}
    is_send::<Source>();
}
