//! Buffers and views of them (glTF 2.0, section 3.6.1): loaded whole, handed out as slices.

use std::borrow::Cow;
use std::path::Path;

use super::document::label;
use super::json::{BufferView, Root};
use super::uri::{self, Target};
use crate::error::{Error, Place, Result};

/// The bytes of a file.
pub(super) struct Buffers<'a> {
    data: Vec<Option<Cow<'a, [u8]>>>,
    /// Views that were compressed, by their index.
    decoded: Vec<Option<Vec<u8>>>,
    /// Bytes in all buffers: what bounds the size of things that the file only describes.
    pub total_bytes: usize,
}

impl<'a> Buffers<'a> {
    /// Loads every buffer; `bin` is the binary chunk of a .glb.
    ///
    /// # Errors
    /// A buffer that is missing, shorter than it says or not decodable.
    pub fn load(root: &Root, bin: Option<&'a [u8]>, base: Option<&Path>, place: &Place) -> Result<Self> {
        let mut data = Vec::with_capacity(root.buffers.len());
        for (i, buffer) in root.buffers.iter().enumerate() {
            let here = place.at(label("buffer", i, buffer.name.as_deref()));
            let bytes = match (&buffer.uri, bin) {
                (Some(uri), _) => Some(Cow::Owned(read(uri, base, &here)?)),
                (None, Some(bin)) if i == 0 => Some(Cow::Borrowed(bin)),
                // The uncompressed twin of compressed data; nothing reads it.
                (None, _) => None,
            };
            if let Some(bytes) = &bytes
                && bytes.len() < buffer.byte_length
            {
                let what = format!("holds {} bytes of {}: the file is truncated", bytes.len(), buffer.byte_length);
                return Err(Error::invalid(&here, what));
            }
            data.push(bytes);
        }
        let total_bytes = data.iter().flatten().map(|bytes| bytes.len()).sum();
        let mut buffers = Self { data, decoded: Vec::new(), total_bytes };
        if root.buffer_views.iter().any(|view| view.extensions.meshopt.is_some()) {
            buffers.decoded = super::meshopt::decode_views(root, &buffers, place)?;
            buffers.total_bytes += buffers.decoded.iter().flatten().map(Vec::len).sum::<usize>();
        }
        Ok(buffers)
    }

    /// `length` bytes of a buffer.
    pub fn slice(&self, buffer: Option<usize>, offset: usize, length: usize) -> Result<&[u8], String> {
        let index = buffer.ok_or("names no buffer")?;
        let bytes = self.data.get(index).ok_or_else(|| format!("names buffer {index} of {}", self.data.len()))?;
        let bytes = bytes.as_ref().ok_or_else(|| format!("reads buffer {index}, which has no data"))?;
        offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
            format!("reaches from byte {offset} over {length} bytes in buffer {index}, which has {}", bytes.len())
        })
    }

    /// The bytes of a buffer view and the view itself.
    pub fn view<'r>(&self, root: &'r Root, index: usize) -> Result<(&[u8], &'r BufferView), String> {
        let count = root.buffer_views.len();
        let view = root.buffer_views.get(index).ok_or_else(|| format!("names buffer view {index} of {count}"))?;
        if let Some(Some(bytes)) = self.decoded.get(index) {
            return Ok((bytes, view));
        }
        let bytes = self.slice(view.buffer, view.byte_offset, view.byte_length);
        Ok((bytes.map_err(|e| format!("buffer view {index} {e}"))?, view))
    }
}

/// The bytes that a URI leads to.
fn read(uri: &str, base: Option<&Path>, place: &Place) -> Result<Vec<u8>> {
    match uri::resolve(uri, base).map_err(|e| Error::invalid(place, e))? {
        Target::Data { bytes, .. } => Ok(bytes),
        Target::File(path) => std::fs::read(&path).map_err(|source| Error::Io {
            place: place.clone(),
            what: format!("can't read {}", path.display()),
            source,
        }),
    }
}
