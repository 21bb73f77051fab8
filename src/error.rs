//! What went wrong, where, and what was done about it.
//!
//! An [`Error`] ends a command; a [`Warning`] tells of a substitute and the work goes on. Both name
//! a [`Place`]: the file and the node, prim or object in it.

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Result with the crate's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Where in the input something stands: a file, and a node or prim path in it.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub struct Place {
    /// The file; empty for scenes that come from memory.
    pub file: Option<Arc<Path>>,
    /// Path of the node, prim or object inside the file; empty for the file as a whole.
    pub node: Option<Arc<str>>,
}

impl Place {
    /// A whole file.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self { file: Some(path.into().into()), node: None }
    }

    /// A node of the same file.
    pub fn at(&self, node: impl AsRef<str>) -> Self {
        Self { file: self.file.clone(), node: Some(node.as_ref().into()) }
    }
}

impl fmt::Debug for Place {
    /// With the sign `-` nothing: what is the same elsewhere then reads the same.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if f.sign_minus() {
            return f.write_str("Place");
        }
        let Self { file, node } = self;
        f.debug_struct("Place").field("file", file).field("node", node).finish()
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.file, &self.node) {
            (Some(file), Some(node)) => write!(f, "{}, {node}", file.display()),
            (Some(file), None) => write!(f, "{}", file.display()),
            (None, Some(node)) => write!(f, "{node}"),
            (None, None) => write!(f, "scene"),
        }
    }
}

/// Why a command could not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input is well formed but asks for something that this build does not do.
    #[error("{place}: {what}")]
    Unsupported {
        /// Where.
        place: Place,
        /// What is not supported, and what would help.
        what: String,
    },
    /// The input is broken.
    #[error("{place}: {what}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        what: String,
    },
    /// The operating system refused to read or write.
    #[error("{place}: {what}")]
    Io {
        /// Which file.
        place: Place,
        /// What was attempted, as "can't read", "can't write".
        what: String,
        /// The system's answer.
        #[source]
        source: std::io::Error,
    },
    /// The user or the host stopped it.
    #[error("cancelled")]
    Cancelled,
}

impl Error {
    /// Broken input at `place`.
    pub fn invalid(place: &Place, what: impl Into<String>) -> Self {
        Self::Invalid { place: place.clone(), what: what.into() }
    }

    /// Input at `place` that this build does not support.
    pub fn unsupported(place: &Place, what: impl Into<String>) -> Self {
        Self::Unsupported { place: place.clone(), what: what.into() }
    }

    /// A file that could not be read or written.
    pub fn io(path: &Path, what: impl Into<String>, source: std::io::Error) -> Self {
        Self::Io { place: Place::file(path), what: what.into(), source }
    }
}

/// A wish that work be stopped: whoever has it holds one end, the work asks at the other.
#[derive(Clone, Debug, Default)]
pub struct Stop(Arc<AtomicBool>);

impl Stop {
    /// Wishes it, for good.
    pub fn wish(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True once it is wished.
    pub fn is_wished(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// The end of work that is not wanted any more.
    ///
    /// # Errors
    /// [`Error::Cancelled`] once it is wished.
    pub fn check(&self) -> Result<()> {
        if self.is_wished() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Something in the input that was replaced or left out; the render goes on.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Warning {
    /// Where.
    pub place: Place,
    /// What was wrong and what was done about it.
    pub what: String,
    /// True for what may be as it should be, and only whoever made the file can tell: nothing to stop for.
    pub is_note: bool,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.what)
    }
}

/// The warnings of one import or render, each at most once.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    list: Vec<Warning>,
    known: HashSet<Warning>,
}

impl Warnings {
    /// No warnings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a warning unless the same one is there already.
    pub fn push(&mut self, place: &Place, what: impl Into<String>) {
        self.add(Warning { place: place.clone(), what: what.into(), is_note: false });
    }

    /// Adds a note, likewise.
    pub fn note(&mut self, place: &Place, what: impl Into<String>) {
        self.add(Warning { place: place.clone(), what: what.into(), is_note: true });
    }

    /// Adds `warning`, likewise; true where it is new.
    pub fn add(&mut self, warning: Warning) -> bool {
        let is_new = self.known.insert(warning.clone());
        if is_new {
            self.list.push(warning);
        }
        is_new
    }

    /// Adds those of `other`.
    pub fn extend(&mut self, other: Self) {
        other.list.into_iter().for_each(|warning| _ = self.add(warning));
    }

    /// How many are no notes.
    pub fn faults(&self) -> usize {
        self.list.iter().filter(|warning| !warning.is_note).count()
    }

    /// All, in the order in which they came.
    pub fn iter(&self) -> impl Iterator<Item = &Warning> {
        self.list.iter()
    }

    /// How many.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// True where there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}
