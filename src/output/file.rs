//! Files that are there in full or not at all.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

use crate::error::{Error, Result};

/// Lets `write` fill a temporary file beside `path`, then puts it in the place of `path` in one step.
///
/// Whoever reads `path` meanwhile sees the old file. Where something fails (a full disk, a folder that
/// can't be written) the temporary file is removed, the old file stays, and the error names `path`.
pub(super) fn replace(path: &Path, write: impl FnOnce(&File) -> io::Result<()>) -> Result<()> {
    let failed = |source| Error::io(path, "can't write", source);
    // A link stays a link: what it points at is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if fs::metadata(&target).is_ok_and(|data| !data.is_file()) {
        return Err(failed(io::Error::other("it is there and is not a regular file")));
    }
    let temporary = beside(&target).map_err(failed)?;
    let file = File::create_new(&temporary).map_err(failed)?;
    let leftover = Leftover(&temporary);
    // Disks that fill up late, and network shares, tell so at the latest here.
    write(&file).and_then(|()| file.sync_all()).map_err(failed)?;
    drop(file);
    fs::rename(&temporary, &target).map_err(failed)?;
    std::mem::forget(leftover);
    // The new name is on the disk, too, where the system offers that.
    if let Some(folder) = target.parent() {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
    Ok(())
}

/// A temporary file that was not written to for so long has lost its writer.
const ABANDONED: Duration = Duration::from_secs(60);

/// Removes the temporary files that killed processes have left of `path`.
pub(super) fn sweep(path: &Path) {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let Some(name) = target.file_name().map(|name| format!(".{}.", name.to_string_lossy())) else { return };
    let is_ours = |file: &str| {
        let middle = file.strip_prefix(&name).and_then(|rest| rest.strip_suffix(".part"));
        middle.is_some_and(|middle| !middle.is_empty() && middle.chars().all(|c| c.is_ascii_digit() || c == '-'))
    };
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // What can't be listed or removed does no harm but to the disk's room.
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let age = entry.metadata().and_then(|data| data.modified()).ok().and_then(|at| at.elapsed().ok());
        if is_ours(&entry.file_name().to_string_lossy()) && age.is_some_and(|age| age > ABANDONED) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Removes the file on every way out but the good one, a panic included.
struct Leftover<'a>(&'a Path);

impl Drop for Leftover<'_> {
    fn drop(&mut self) {
        // Nothing helps where this fails too; the error to tell is the first one.
        let _ = fs::remove_file(self.0);
    }
}

/// Finds out, before hours of work, whether `path` could be written now.
///
/// # Errors
/// As [`replace`] would give.
pub fn check_writable(path: &Path) -> Result<()> {
    let failed = |source| Error::io(path, "can't write", source);
    if fs::metadata(path).is_ok_and(|data| !data.is_file()) {
        return Err(failed(io::Error::other("it is there and is not a regular file")));
    }
    let probe = beside(&fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())).map_err(failed)?;
    File::create_new(&probe).and_then(|_| fs::remove_file(&probe)).map_err(failed)
}

/// A name in the same folder that no other writer, in this process or another, takes.
fn beside(path: &Path) -> io::Result<PathBuf> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let name = path.file_name().ok_or_else(|| io::Error::other("it does not name a file"))?;
    let unique = format!(".{}-{}.part", process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
    let mut hidden = std::ffi::OsString::from(".");
    hidden.push(name);
    hidden.push(unique);
    Ok(path.with_file_name(hidden))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("folder");
        entries.map(|entry| entry.expect("entry").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("out.exr");
        fs::write(&path, "old").expect("write");
        let error = replace(&path, |mut file| {
            file.write_all(b"half of it")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .expect_err("disk full");
        let Error::Io { place, source, .. } = &error else { panic!("{error}") };
        assert_eq!(place.file.as_deref(), Some(path.as_path()));
        assert_eq!(source.kind(), io::ErrorKind::StorageFull);
        assert_eq!(fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(names(folder.path()), ["out.exr"]);
    }

    #[test]
    fn a_good_write_replaces_the_old_file() {
        let folder = tempfile::tempdir().expect("folder");
        let path = folder.path().join("out.png");
        for text in ["one", "two"] {
            replace(&path, |mut file| file.write_all(text.as_bytes())).expect("write");
            assert_eq!(fs::read_to_string(&path).expect("read"), text);
        }
        check_writable(&path).expect("writable");
        assert_eq!(names(folder.path()), ["out.png"]);
    }

    #[test]
    fn what_killed_writers_left_is_swept_away() {
        let folder = tempfile::tempdir().expect("folder");
        let old = std::time::SystemTime::now() - 2 * ABANDONED;
        for (name, is_old) in [
            (".out.state.12-0.part", true),
            (".out.state.13-7.part", false),
            (".out.state.x.part", true),
            (".other.state.12-0.part", true),
        ] {
            let file = File::create(folder.path().join(name)).expect("written");
            if is_old {
                file.set_modified(old).expect("dated");
            }
        }
        sweep(&folder.path().join("out.state"));
        let mut left = names(folder.path());
        left.sort();
        assert_eq!(left, [".other.state.12-0.part", ".out.state.13-7.part", ".out.state.x.part"]);
    }

    #[test]
    fn places_that_are_no_file_are_refused() {
        let folder = tempfile::tempdir().expect("folder");
        for path in [folder.path().to_owned(), folder.path().join("no/such/out.exr"), "/".into(), "/dev/full".into()] {
            let error = replace(&path, |_| Ok(())).expect_err("refused");
            assert!(error.to_string().contains(&*path.to_string_lossy()), "{error}");
            assert_eq!(check_writable(&path).expect_err("refused").to_string(), error.to_string());
        }
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().expect("folder");
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").expect("write");
        std::os::unix::fs::symlink(&file, &link).expect("link");
        replace(&link, |mut out| out.write_all(b"new")).expect("write");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        assert_eq!(fs::read_to_string(&file).expect("read"), "new");
    }
}
