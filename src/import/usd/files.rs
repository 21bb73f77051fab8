//! How layers are read: found as the openusd crate finds them, but large files by all threads at once. Most of
//! the time that it takes goes into memory that is touched for the first time, which every thread can do.

use std::borrow::Cow;
use std::cell::RefCell;
use std::fs::{self, File};
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;
use std::time::SystemTime;

use openusd::ar::{Asset, AssetBuffer, AssetInfo, DefaultResolver, ResolvedPath, Resolver};
use openusd::usd::SchemaRegistry;
use rayon::prelude::*;

use super::layer::{self, Met};

/// Bytes that a thread reads at a time; smaller files are left to the crate.
const PIECE: usize = 1 << 22;

/// The crate's resolver with other files.
pub(super) struct Files {
    inner: DefaultResolver,
    /// The root layer, read before it was asked for.
    root: RefCell<Option<(PathBuf, Vec<u8>)>>,
    /// What was met in layers on their way.
    met: Rc<RefCell<Met>>,
}

impl Files {
    /// Those of the stage whose root layer is `path`, and the schemas, which are made while that is read.
    pub fn open(path: &Path) -> (Self, Arc<SchemaRegistry>) {
        // Packages are asked for what is in them, never whole.
        let is_package = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("usdz"));
        let read = || if is_package { None } else { Some((fs::canonicalize(path).ok()?, read(path)?)) };
        let (root, schemas) = rayon::join(read, openusd_schemas::schema_registry);
        (Self { inner: DefaultResolver::new(), root: RefCell::new(root), met: Rc::default() }, schemas)
    }

    /// What is met in the layers that are read.
    pub fn met(&self) -> Rc<RefCell<Met>> {
        self.met.clone()
    }

    /// All of the large file at `path`.
    fn take(&self, path: &Path) -> Option<Vec<u8>> {
        let mut root = self.root.borrow_mut();
        let is_root = |(root, _): &mut (PathBuf, Vec<u8>)| fs::canonicalize(path).is_ok_and(|path| path == *root);
        root.take_if(is_root).map(|(_, bytes)| bytes).or_else(|| read(path))
    }
}

/// All of a large file; `None` for others, and where it can't be read.
fn read(path: &Path) -> Option<Vec<u8>> {
    let file = fs::metadata(path).ok().filter(|file| file.is_file())?;
    let size = usize::try_from(file.len()).ok().filter(|&size| size >= PIECE)?;
    // Zeros that the system gives, which nobody writes.
    let mut bytes = vec![0; size];
    let piece = |(number, piece): (usize, &mut [u8])| {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start((number * PIECE) as u64))?;
        file.read_exact(piece)
    };
    bytes.par_chunks_mut(PIECE).enumerate().try_for_each(piece).ok()?;
    Some(bytes)
}

impl Resolver for Files {
    fn open_asset(&self, path: &ResolvedPath) -> io::Result<Box<dyn Asset>> {
        let asset = match self.take(path) {
            Some(bytes) => Box::new(Cursor::new(AssetBuffer::Owned(bytes))),
            None => self.inner.open_asset(path)?,
        };
        layer::mend(asset, &path.to_string(), &mut self.met.borrow_mut())
    }

    fn create_identifier(&self, asset_path: &str, anchor: Option<&ResolvedPath>) -> String {
        // An address stands for itself; as a path it would lose a slash.
        if asset_path.contains("://") {
            return asset_path.into();
        }
        self.inner.create_identifier(asset_path, anchor)
    }

    fn resolve(&self, asset_path: &str) -> Option<ResolvedPath> {
        self.inner.resolve(asset_path)
    }

    fn resolve_for_new_asset(&self, asset_path: &str) -> Option<ResolvedPath> {
        self.inner.resolve_for_new_asset(asset_path)
    }

    fn get_extension<'a>(&self, asset_path: &'a str) -> &'a str {
        self.inner.get_extension(asset_path)
    }

    fn is_context_dependent_path(&self, asset_path: &str) -> bool {
        self.inner.is_context_dependent_path(asset_path)
    }

    fn in_memory_identifier<'a>(&self, asset_path: &'a str) -> Cow<'a, str> {
        self.inner.in_memory_identifier(asset_path)
    }

    fn get_asset_info(&self, asset_path: &str, path: &ResolvedPath) -> AssetInfo {
        self.inner.get_asset_info(asset_path, path)
    }

    fn get_modification_timestamp(&self, asset_path: &str, path: &ResolvedPath) -> Option<SystemTime> {
        self.inner.get_modification_timestamp(asset_path, path)
    }

    fn identity(&self) -> String {
        self.inner.identity()
    }

    fn cache_id(&self) -> Option<u64> {
        self.inner.cache_id()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_files_are_read_whole_and_others_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        for size in [0, PIECE - 1, PIECE, 2 * PIECE + 7] {
            let bytes: Vec<u8> = (0..size).map(|i| (i % 251) as u8).collect();
            fs::write(&path, &bytes).unwrap();
            assert!(read(&path) == (size >= PIECE).then_some(bytes), "{size}");
        }
        assert!(read(dir.path()).is_none() && read(&dir.path().join("none")).is_none());
    }

    /// The root layer is handed over once; then, and for other files, the disk is asked.
    #[test]
    fn the_root_layer_is_read_ahead() {
        let dir = tempfile::tempdir().unwrap();
        let [root, other] = ["root", "other"].map(|name| dir.path().join(name));
        fs::write(&root, vec![1; PIECE]).unwrap();
        fs::write(&other, vec![2; PIECE]).unwrap();
        let (files, _) = Files::open(&root);
        fs::write(&root, vec![3; PIECE]).unwrap();
        let first = |path: &Path| files.take(path).unwrap()[0];
        assert_eq!([first(&other), first(&root), first(&root)], [2, 1, 3]);
    }
}
