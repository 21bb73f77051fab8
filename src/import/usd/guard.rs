//! The last line of defence: a fault of the openusd crate, whose composing may panic on stages that nobody has
//! tried it with, becomes an error that names the file.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

use crate::error::{Error, Place};

thread_local! {
    /// True while a panic is to be told as an error, not on the terminal.
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// What `work` gives.
///
/// # Errors
/// What it panics with. Nothing that it has touched may be used after that.
pub(super) fn guarded<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let others = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                others(info);
            }
        }));
    });
    let before = QUIET.replace(true);
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    QUIET.set(before);
    done.map_err(|panic| {
        let text = panic.downcast_ref::<&str>().map(ToString::to_string);
        text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no reason given".into())
    })
}

/// The error for the stage at `path`, whose reader panicked.
pub(super) fn broken(path: &Path, reason: &str) -> Error {
    Error::invalid(&Place::file(path), format!("can't be read: composing it broke down ({reason})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panics_become_errors_that_name_the_file() {
        assert_eq!(guarded(|| 1), Ok(1));
        for reason in [guarded(|| panic!("no {}", 1)), guarded(|| panic!("no 1"))] {
            let error = broken(Path::new("a.usda"), &reason.map(|()| 0).unwrap_err());
            assert_eq!(error.to_string(), "a.usda: can't be read: composing it broke down (no 1)");
        }
    }
}
