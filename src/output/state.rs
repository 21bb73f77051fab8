//! State files: all that a render needs to go on, beside the picture that it made.
//!
//! ```text
//! magic, byte order | length of head, head (JSON), digest of it | body | digest of the body
//! ```
//!
//! The head says what the state is of, as names and values; the body is the render's own. It is written in full or
//! not at all, and one that is cut off or damaged is told from a sound one.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use super::file;
use crate::error::{Error, Place, Result};
use crate::math::Digest;

/// What the file begins with; the number at the end is the format's.
const MAGIC: &[u8; 16] = b"PenumbraState 1\n";

/// Reads as another number where bytes are in another order.
const ORDER: u32 = 0x0102_0304;

/// No head is longer, in bytes.
const MOST_HEAD: u64 = 1 << 20;

/// Where the state of the picture `out` is.
pub fn path_of(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".state");
    name.into()
}

/// Names and values that say what a state is of.
pub type Head = Vec<(String, String)>;

/// Writes a state, in full or not at all; what is there stays until the new one is whole. What killed processes have
/// left of theirs is removed.
///
/// # Errors
/// [`Error::Io`] that names the file where it can't be written.
pub fn write(path: &Path, head: &Head, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    file::sweep(path);
    file::replace(path, |file| {
        let mut out = Hashed { inner: BufWriter::with_capacity(1 << 20, file), digest: Digest::default() };
        out.write_all(MAGIC)?;
        out.write_all(&ORDER.to_ne_bytes())?;
        let head = serde_json::to_vec(head)?;
        out.write_all(&(head.len() as u64).to_le_bytes())?;
        out.write_all(&head)?;
        out.end()?;
        body(&mut out)?;
        out.end()?;
        out.flush()
    })
}

/// A state that is being read.
pub struct StateFile {
    path: PathBuf,
    /// What it is of.
    pub head: Head,
    body: Hashed<BufReader<File>>,
}

/// Opens the state `path` and reads its head.
///
/// # Errors
/// [`Error::Io`] where it can't be read, [`Error::Invalid`] where it is not a state, is damaged, or comes from a
/// machine of another byte order.
pub fn open(path: &Path) -> Result<StateFile> {
    let file = File::open(path).map_err(|source| Error::io(path, "can't read", source))?;
    let mut body = Hashed { inner: BufReader::with_capacity(1 << 20, file), digest: Digest::default() };
    let head = read_head(&mut body).map_err(|error| damaged(path, error))?;
    Ok(StateFile { path: path.to_owned(), head, body })
}

fn read_head(from: &mut Hashed<BufReader<File>>) -> io::Result<Head> {
    let broken = |what: &str| io::Error::new(io::ErrorKind::InvalidData, what.to_owned());
    let (mut magic, mut order, mut length) = ([0; MAGIC.len()], [0; 4], [0; 8]);
    from.read_exact(&mut magic)?;
    if magic != *MAGIC {
        return Err(broken("it is no state file that this version knows"));
    }
    from.read_exact(&mut order)?;
    if u32::from_ne_bytes(order) != ORDER {
        return Err(broken("it comes from a machine with another order of bytes"));
    }
    from.read_exact(&mut length)?;
    let length = u64::from_le_bytes(length);
    if length > MOST_HEAD {
        return Err(broken("its head is too long"));
    }
    let mut head = vec![0; length as usize];
    from.read_exact(&mut head)?;
    from.check()?;
    Ok(serde_json::from_slice(&head)?)
}

impl StateFile {
    /// What can't be used: the error of reading its body.
    pub fn damaged(&self, error: io::Error) -> Error {
        damaged(&self.path, error)
    }

    /// Makes sure that all of the body was read, and is what was written.
    ///
    /// # Errors
    /// [`Error::Invalid`] where it is not.
    pub fn finish(mut self) -> Result<()> {
        let end = self.body.check().and_then(|()| match self.body.read(&mut [0])? {
            0 => Ok(()),
            _ => Err(io::Error::new(io::ErrorKind::InvalidData, "there is more in it than there should be")),
        });
        end.map_err(|error| damaged(&self.path, error))
    }
}

impl Read for StateFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.body.read(bytes)
    }
}

fn damaged(path: &Path, error: io::Error) -> Error {
    let why = match error.kind() {
        io::ErrorKind::UnexpectedEof => "it is cut off".to_owned(),
        _ => error.to_string(),
    };
    Error::invalid(&Place::file(path), format!("can't go on from this state: {why}"))
}

/// Bytes with the digest of those so far.
struct Hashed<T> {
    inner: T,
    digest: Digest,
}

impl<T: Write> Hashed<T> {
    /// Writes the digest of what was written since the last one.
    fn end(&mut self) -> io::Result<()> {
        let digest = std::mem::take(&mut self.digest).finish();
        self.inner.write_all(&digest.to_le_bytes())
    }
}

impl<T: Read> Hashed<T> {
    /// Reads the digest of what was read since the last one.
    fn check(&mut self) -> io::Result<()> {
        let mut digest = [0; 8];
        self.inner.read_exact(&mut digest)?;
        match std::mem::take(&mut self.digest).finish() == u64::from_le_bytes(digest) {
            true => Ok(()),
            false => Err(io::Error::new(io::ErrorKind::InvalidData, "it is damaged")),
        }
    }
}

impl<T: Write> Write for Hashed<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.digest.write(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for Hashed<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.digest.write(&bytes[..read]);
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn saved(path: &Path) -> (Head, Vec<u8>) {
        let head = vec![("scene".to_owned(), "abc".to_owned())];
        let body: Vec<u8> = (0..10_000_u32).map(|i| ((i * i) >> 3) as u8).collect();
        write(path, &head, |out| out.write_all(&body)).expect("written");
        (head, body)
    }

    /// The body of the state at `path`, of `length` bytes.
    fn read(path: &Path, length: usize) -> Result<Vec<u8>> {
        let mut state = open(path)?;
        let mut body = vec![0; length];
        state.read_exact(&mut body).map_err(|error| state.damaged(error))?;
        state.finish()?;
        Ok(body)
    }

    #[test]
    fn a_state_comes_back_as_it_was_and_bad_ones_are_told() {
        let folder = tempfile::tempdir().expect("folder");
        let path = path_of(&folder.path().join("out.exr"));
        assert!(path.ends_with("out.exr.state"));
        let (head, body) = saved(&path);
        assert_eq!(open(&path).expect("opens").head, head);
        assert_eq!(read(&path, body.len()).expect("reads"), body);
        let whole = fs::read(&path).expect("there");
        for at in (0..whole.len()).step_by(97) {
            let mut other = whole.clone();
            other[at] ^= 0x10;
            fs::write(&path, &other).expect("written");
            assert!(read(&path, body.len()).is_err(), "byte {at} of {}", whole.len());
            fs::write(&path, &whole[..at]).expect("written");
            let error = read(&path, body.len()).expect_err("cut off");
            assert!(error.to_string().contains("it is cut off"), "{error}");
        }
        fs::write(&path, [&whole[..], b"x"].concat()).expect("written");
        assert!(read(&path, body.len()).expect_err("too long").to_string().contains("more in it"));
        fs::write(&path, b"#usda 1.0 is something else altogether").expect("written");
        assert!(read(&path, 1).expect_err("another file").to_string().contains("no state file"));
    }
}
